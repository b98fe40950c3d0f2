//! The timeline's row below the picture.

use eframe::egui::{self, Ui};

use crate::{viewer::timeline::Timeline, write_back::presses::KeyAction};

/// Width below which the slider has a row of its own, points.
const ONE_ROW: f32 = 620.0;

/// The row below the picture. While playing it displays the `shown` frame: the clock is ahead
/// of slow pictures. If it is stuck, because the current frame cannot be posed, it displays both.
pub fn panel(ui: &mut Ui, timeline: &mut Timeline, shown: Option<u32>, is_stuck: bool, now_s: f64) {
    let wanted = timeline.frame();
    let stuck = shown.filter(|shown| is_stuck && *shown != wanted);
    let shown = shown.filter(|_| timeline.is_playing());
    let mut frame = shown.unwrap_or(wanted);
    let told = stuck.unwrap_or(frame);
    let pace = timeline.pace(now_s);
    let range = timeline.start()..=timeline.end();
    let mut is_moved = false;
    let slider = |ui: &mut Ui, frame: &mut u32| {
        let right = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right, |ui| {
            ui.weak(&pace);
            ui.spacing_mut().slider_width = (ui.available_width() - 8.0).max(40.0);
            let slider = egui::Slider::new(frame, range.clone()).show_value(false);
            ui.add(slider).on_hover_text("scrub").changed()
        })
        .inner
    };
    let is_wide = ui.available_width() >= ONE_ROW;
    let row = egui::Layout::left_to_right(egui::Align::Center).with_main_wrap(!is_wide);
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, row, |ui| {
        buttons(ui, timeline, now_s);
        let label = ui.label("frame");
        let number = egui::DragValue::new(&mut frame).range(timeline.start()..=timeline.end());
        is_moved |= ui.add(number).labelled_by(label.id).changed();
        ui.label(format!("of {}", timeline.end()));
        ui.monospace(format!("{:7.3} s", f64::from(told) * timeline.frame_s()));
        if let Some(shown) = stuck {
            let text = format!("frame {shown} shown, {wanted} wanted");
            ui.colored_label(ui.visuals().error_fg_color, text);
        }
        if is_wide {
            is_moved |= slider(ui, &mut frame);
        }
    });
    if !is_wide {
        ui.horizontal(|ui| is_moved |= slider(ui, &mut frame));
    }
    if is_moved {
        timeline.seek(frame, now_s);
    }
}

fn buttons(ui: &mut Ui, timeline: &mut Timeline, now_s: f64) {
    let play = match timeline.is_playing() {
        true => "pause",
        false => "play",
    };
    for (text, hover, action) in [
        ("|<", "Home: first frame", KeyAction::Start),
        ("<", "left arrow: one frame back", KeyAction::Step(-1)),
        (play, "Space", KeyAction::Play),
        (">", "right arrow: one frame on", KeyAction::Step(1)),
        (">|", "End: last frame", KeyAction::End),
    ] {
        if ui.button(text).on_hover_text(hover).clicked() {
            timeline.press(action, now_s);
        }
    }
    ui.checkbox(&mut timeline.repeats, "loop")
        .on_hover_text("L: the first frame follows the last");
}
