//! The status line, scene facts, and the list of keys.

use eframe::egui::{self, Align2, Label, RichText, Ui, vec2};

use super::{diagnostics_panel::located, status_message::StatusMessage};
use crate::{viewer::scene_summary::SceneSummary, write_back::presses::KEYS};
use reflet_scene::script::DEADLINE;

/// Current activity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Activity {
    /// Playing; with the text about reduced resolution.
    Playing(String),
    /// Rendering a picture.
    Drawing,
    /// Nothing changed.
    Idle,
}

/// The status line. `script_s` is the run time of a background script, seconds.
pub fn status(
    ui: &mut Ui,
    picture: u64,
    doing: &Activity,
    script_s: Option<f64>,
    message: &mut StatusMessage,
) {
    ui.horizontal(|ui| {
        if let Some(script_s) = script_s {
            let most_s = DEADLINE.as_secs();
            let text = format!("script running {script_s:.1} s");
            ui.colored_label(ui.visuals().warn_fg_color, text)
                .on_hover_text(format!(
                    "a call is stopped after {most_s} s of work, or by a newer save"
                ));
            ui.separator();
        }
        // The tooltip shows truncated text in full.
        ui.add(
            Label::new(match (doing, script_s) {
                (Activity::Playing(less), _) => format!("playing: picture {picture}{less}"),
                (Activity::Drawing, _) => format!("drawing after picture {picture} …"),
                (Activity::Idle, Some(_)) => format!("picture {picture} stays meanwhile"),
                (Activity::Idle, None) => format!("idle: nothing changed since picture {picture}"),
            })
            .truncate(),
        );
        if !message.text().is_empty() {
            ui.separator();
            let shown = ui.add(Label::new(RichText::new(message.text()).weak()).truncate());
            if shown.hovered() {
                message.extend();
            }
        }
    });
}

/// Why file watching is limited, and what to do.
pub fn unwatched(ui: &mut Ui, why: &str) {
    let text = format!("Saves: {why}");
    ui.horizontal_wrapped(|ui| ui.colored_label(ui.visuals().warn_fg_color, text));
}

/// Facts and warnings about the scene.
pub fn scene(ui: &mut Ui, summary: &SceneSummary) {
    let title = match summary.warnings.len() {
        0 => "Scene".to_owned(),
        1 => "Scene (1 warning)".to_owned(),
        n => format!("Scene ({n} warnings)"),
    };
    egui::CollapsingHeader::new(title)
        .id_salt("scene")
        .show(ui, |ui| {
            let size = summary.bounds.max - summary.bounds.min;
            if !summary.bounds.is_empty() {
                ui.label(format!(
                    "{:.2} × {:.2} × {:.2} m, U = {:.3} m",
                    size.x, size.y, size.z, summary.unit_m
                ));
            }
            for dropped in &summary.dropped {
                ui.weak(format!("left out: {dropped}"));
            }
            for warning in &summary.warnings {
                ui.label(located(warning));
            }
        });
}

/// Output of the script.
pub fn log(ui: &mut Ui, log: &[String]) {
    if log.is_empty() {
        return;
    }
    egui::CollapsingHeader::new("Script output")
        .id_salt("log")
        .show(ui, |ui| {
            egui::ScrollArea::vertical()
                .id_salt("log lines")
                .max_height(140.0)
                .show(ui, |ui| {
                    for line in log {
                        ui.monospace(line);
                    }
                });
        });
}

/// The list of keys in a scrollable egui window.
pub fn help(ui: &Ui, is_open: &mut bool) {
    let room = ui.ctx().content_rect().shrink(8.0);
    egui::Window::new("Keys")
        .open(is_open)
        .constrain_to(room)
        .pivot(Align2::CENTER_CENTER)
        .default_pos(room.center())
        .default_width(480.0_f32.min(room.width()))
        .max_size(room.size() - vec2(24.0, 56.0))
        .resizable(false)
        .collapsible(false)
        .vscroll(true)
        .show(ui.ctx(), keys);
}

fn keys(ui: &mut Ui) {
    egui::Grid::new("keys")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for row in KEYS {
                ui.monospace(row.keys);
                ui.add(Label::new(row.what).wrap());
                ui.end_row();
            }
        });
}
