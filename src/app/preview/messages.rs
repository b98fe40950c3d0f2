//! Mistakes with their places, facts about the scene, and the list of keys.

use eframe::egui::{self, Color32, RichText, Ui};

use super::facts::Facts;
use crate::{
    app::live::Problems,
    scene::{
        diagnostic::{Diagnostic, Severity},
        script::DEADLINE,
    },
};

/// Keys and what they do.
pub const KEYS: [(&str, &str); 20] = [
    ("left drag", "orbit around the target"),
    ("middle drag", "pan"),
    ("right drag", "look around"),
    ("right drag + W A S D Q E", "fly; Shift: four times as fast"),
    (
        "wheel",
        "closer, farther; with the right button: flying speed",
    ),
    (
        "click",
        "select the instance under the pointer, and its material",
    ),
    (
        "Esc",
        "close this list or the error map; else select nothing",
    ),
    ("Space", "play, pause"),
    ("left, right arrow", "one frame back, on"),
    ("Home, End", "first, last frame"),
    ("L", "loop: the first frame follows the last"),
    ("F", "frame the selection, or the scene"),
    ("1 2 3", "hybrid, ssr, rt"),
    ("B", "wipe between two methods or textures; drag its line"),
    ("C", "copy the camera as scene text"),
    ("R", "back to the scene's camera"),
    ("X", "error against rt, as numbers and as a map"),
    (
        "F12",
        "write what is shown to a PNG file, without labels and outline",
    ),
    ("H", "this list"),
    ("Ctrl Q", "close"),
];

/// What the window is busy with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Doing {
    /// Frame after frame; with what it leaves out for that.
    Plays(String),
    /// Another picture.
    Draws,
    /// Nothing: nothing has changed.
    Rests,
}

/// The status line. `script_s` is how long a script has been running that pictures do not wait for.
pub fn status(ui: &mut Ui, picture: u64, doing: &Doing, script_s: Option<f64>, note: &str) {
    ui.horizontal(|ui| {
        if let Some(script_s) = script_s {
            let most_s = DEADLINE.as_secs();
            let text = format!("script running {script_s:.1} s");
            ui.colored_label(ui.visuals().warn_fg_color, text)
                .on_hover_text(format!(
                    "a call is ended after {most_s} s, or by a newer save"
                ));
            ui.separator();
        }
        ui.label(match doing {
            Doing::Plays(less) => format!("playing: picture {picture}{less}"),
            Doing::Draws => format!("drawing after picture {picture} …"),
            Doing::Rests => format!("still: nothing changed since picture {picture}"),
        });
        if !note.is_empty() {
            ui.separator();
            ui.weak(note);
        }
    });
}

/// Where a message points: `file:line:column`, or the file.
pub fn place_of(diagnostic: &Diagnostic) -> Option<String> {
    if let Some(source) = &diagnostic.span.source {
        let place = source.place(diagnostic.span.range.start);
        return Some(format!(
            "{}:{}:{}",
            source.path.display(),
            place.line,
            place.column
        ));
    }
    diagnostic
        .file
        .as_ref()
        .map(|file| file.display().to_string())
}

/// What keeps the newest content from being shown, with its places; click copies one.
pub fn problems(ui: &mut Ui, problems: &Problems) {
    let red = Color32::from_rgb(255, 110, 100);
    ui.colored_label(
        red,
        RichText::new("Not taken over; what is shown stays:").strong(),
    );
    egui::ScrollArea::vertical()
        .id_salt("problems")
        .max_height(160.0)
        .show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            let mut entry = |place: Option<String>, message: &str, help: Option<&str>| {
                ui.horizontal_wrapped(|ui| {
                    if let Some(place) = place {
                        let text = RichText::new(&place).monospace();
                        if ui.link(text).on_hover_text("copy this place").clicked() {
                            ui.ctx().copy_text(place);
                        }
                    }
                    ui.label(message);
                    if let Some(help) = help {
                        ui.weak(help);
                    }
                });
            };
            for diagnostic in problems.scene.iter().chain(&problems.pose) {
                if diagnostic.severity == Severity::Error {
                    entry(
                        place_of(diagnostic),
                        &diagnostic.message,
                        diagnostic.help.as_deref(),
                    );
                }
            }
            if let Some(error) = &problems.shader {
                let at = error.location.as_ref();
                let place = at.map(|at| format!("{}:{}:{}", at.file, at.line, at.column.max(1)));
                let place = place.unwrap_or_else(|| error.file.to_string());
                entry(Some(place), &error.message, None);
            }
            if let Some(why) = &problems.refused {
                entry(None, why, None);
            }
        });
}

/// Facts and warnings about the scene.
pub fn scene(ui: &mut Ui, facts: &Facts) {
    let title = match facts.warnings.len() {
        0 => "Scene".to_owned(),
        1 => "Scene (1 warning)".to_owned(),
        n => format!("Scene ({n} warnings)"),
    };
    egui::CollapsingHeader::new(title)
        .id_salt("scene")
        .show(ui, |ui| {
            let size = facts.bounds.max - facts.bounds.min;
            if !facts.bounds.is_empty() {
                ui.label(format!(
                    "{:.2} × {:.2} × {:.2} m, U = {:.3} m",
                    size.x, size.y, size.z, facts.unit_m
                ));
            }
            for dropped in &facts.dropped {
                ui.weak(format!("left out: {dropped}"));
            }
            for warning in &facts.warnings {
                let place = place_of(warning).map_or(String::new(), |place| format!("{place}: "));
                ui.label(format!("{place}{}", warning.message));
            }
        });
}

/// What the script printed.
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

/// The list of keys.
pub fn help(ui: &mut Ui) {
    egui::Grid::new("keys")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for (key, what) in KEYS {
                ui.monospace(key);
                ui.label(what);
                ui.end_row();
            }
        });
}
