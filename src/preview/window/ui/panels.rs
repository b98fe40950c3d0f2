//! Toolbar and panels: channels, cameras, keys, error scores.
//! The panels draw the state that they are given and return requests.

use eframe::egui::{self, Response, Ui, Widget, WidgetText};

use super::{
    channel_menu::{MENU, side_menu},
    charts,
};
use crate::{
    viewer::{protocol::Task, scene_summary::SceneSummary, view_settings::ViewSettings},
    write_back::presses::KeyAction,
};
use reflet_metric::Scores;
use reflet_scene::desc::Method;

/// A user request.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewRequest {
    /// View through the scene's camera of this index.
    SceneCamera(usize),
    /// Follow the cuts of the timeline.
    FollowCuts,
    /// Do what a key does.
    Press(KeyAction),
    /// Change the scene.
    Task(Task),
}

impl From<Task> for ViewRequest {
    fn from(task: Task) -> Self {
        Self::Task(task)
    }
}

/// A control with its label beside it, truncated where it is too long.
pub fn named(ui: &mut Ui, control: impl Widget, name: impl Into<WidgetText>) -> Response {
    ui.horizontal(|ui| {
        let control = ui.add(control);
        let label = ui.add(egui::Label::new(name).truncate());
        control.labelled_by(label.id)
    })
    .inner
}

/// Whether no drag and no input of text goes on: changes are written now.
pub fn is_input_over(ui: &Ui) -> bool {
    !ui.input(|i| i.pointer.any_down()) && !ui.ctx().egui_wants_keyboard_input()
}

/// Space after each group of the toolbar, points.
const GAP: f32 = 8.0;

/// Controls that stay together where a narrow window wraps the toolbar.
fn group(ui: &mut Ui, name: &str, content: impl FnOnce(&mut Ui)) {
    let id = ui.scope_id().with(name);
    let known: Option<f32> = ui.data(|data| data.get_temp(id));
    let left = ui.available_size_before_wrap().x;
    if known.is_some_and(|width| width > left && left < ui.max_rect().width() - 1.0) {
        ui.end_row();
    }
    let width = ui.horizontal(content).response.rect.width();
    if known.is_none_or(|known| (known - width).abs() > 0.5) {
        ui.data_mut(|data| data.insert_temp(id, width));
        ui.ctx().request_discard("the width of a group has changed");
    }
    ui.add_space(GAP);
}

/// The toolbar. Its groups keep their widths, so that no setting moves the picture.
pub fn bar(
    ui: &mut Ui,
    settings: &mut ViewSettings,
    summary: &SceneSummary,
    requests: &mut Vec<ViewRequest>,
) {
    ui.horizontal_wrapped(|ui| {
        group(ui, "a", |ui| {
            side_menu(ui, "texture", &mut settings.a, &summary.shadow_lights);
        });
        group(ui, "b", |ui| {
            let wipe = ui.checkbox(&mut settings.wipe, "wipe");
            if wipe.changed() {
                settings.start_wipe();
            }
            wipe.on_hover_text("B: compare with another method or texture");
            ui.add_enabled_ui(settings.wipe, |ui| {
                side_menu(
                    ui,
                    "texture of the right side",
                    &mut settings.b,
                    &summary.shadow_lights,
                );
            });
        });
        group(ui, "camera", |ui| cameras(ui, settings, summary, requests));
        let mut button = |ui: &mut Ui, text: &str, hover: &str, action| {
            if ui.button(text).on_hover_text(hover).clicked() {
                requests.push(ViewRequest::Press(action));
            }
        };
        group(ui, "of the camera", |ui| {
            let hover = "F: show the selection, or the scene";
            button(ui, "frame", hover, KeyAction::Frame);
            button(ui, "copy camera", "C: as scene text", KeyAction::Copy);
        });
        group(ui, "of the picture", |ui| {
            let hover = "X: this method against rt";
            button(ui, "error", hover, KeyAction::Compare);
            let hover = "F12: write a PNG file";
            button(ui, "screenshot", hover, KeyAction::Screenshot);
            ui.checkbox(&mut settings.image_frame, "safe area")
                .on_hover_text("G: the frame of image.size, with its safe area");
            if ui.button("keys").on_hover_text("H").clicked() {
                settings.help = !settings.help;
            }
        });
    });
}

/// The menu of the scene's cameras.
fn cameras(
    ui: &mut Ui,
    settings: &ViewSettings,
    summary: &SceneSummary,
    requests: &mut Vec<ViewRequest>,
) {
    let name = |index: usize| summary.cameras.get(index).map(|(name, _)| name.as_str());
    let label = ui.weak("camera");
    let menu = egui::ComboBox::from_id_salt("camera")
        .selected_text(
            settings
                .scene_camera
                .and_then(name)
                .unwrap_or("free camera"),
        )
        .width(MENU)
        .truncate()
        .show_ui(ui, |ui| {
            let cuts = settings.follows_cuts && settings.scene_camera.is_some();
            let has_cuts = !summary.cuts.is_empty();
            if has_cuts && ui.selectable_label(cuts, "by the cuts").clicked() {
                requests.push(ViewRequest::FollowCuts);
            }
            for (index, (name, _)) in summary.cameras.iter().enumerate() {
                let is_shown = settings.scene_camera == Some(index) && !(has_cuts && cuts);
                if ui.selectable_label(is_shown, name).clicked() {
                    requests.push(ViewRequest::SceneCamera(index));
                }
            }
        });
    menu.response.labelled_by(label.id);
}

/// Scores of the last comparison of a method with `rt`. The panel has the same height with and without them, so that
/// panels below stay in place.
pub fn comparison(
    ui: &mut Ui,
    comparison: Option<(Method, &Scores)>,
    is_old: bool,
    settings: &mut ViewSettings,
) {
    let number = |of: &dyn Fn(&Scores) -> Option<String>| {
        let text = comparison.and_then(|(_, scores)| of(scores));
        text.unwrap_or("–".to_owned())
    };
    egui::CollapsingHeader::new("Error against rt")
        .default_open(true)
        .show(ui, |ui| {
            let numbers = [
                ("SSIM", number(&|s| Some(format!("{:.4}", s.ssim?)))),
                ("PSNR", number(&|s| Some(format!("{:.1} dB", s.psnr_db)))),
                ("FLIP", number(&|s| Some(format!("{:.4}", s.flip_mean)))),
                ("99 %", number(&|s| Some(format!("{:.4}", s.flip_p99)))),
            ];
            egui::Grid::new("scores").num_columns(4).show(ui, |ui| {
                for row in numbers.chunks(2) {
                    for (name, value) in row {
                        ui.label(*name).on_hover_text(match *name {
                            "FLIP" => "mean over the picture",
                            "99 %" => "FLIP that 99 % of the pixels do not exceed",
                            _ => "over the picture",
                        });
                        ui.monospace(value);
                    }
                    ui.end_row();
                }
            });
            let method = comparison.map(|(method, _)| method.name());
            let of_what = match method {
                None => "X compares this method with rt".to_owned(),
                Some(method) if is_old => {
                    format!("{method}, of an earlier view; X compares again")
                }
                Some(method) => format!("{method}, of this view"),
            };
            let of_what = egui::RichText::new(of_what).weak();
            ui.add(egui::Label::new(of_what).truncate());
            let mut shows = settings.error_map && comparison.is_some();
            let switch = egui::Checkbox::new(&mut shows, "show where (FLIP)");
            if ui.add_enabled(comparison.is_some(), switch).changed() {
                settings.error_map = shows;
            }
            charts::flip_scale(ui);
        });
}
