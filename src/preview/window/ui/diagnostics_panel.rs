//! The diagnostics panel: errors with their places, over the picture, foldable to a line.

use std::collections::BTreeSet;

use eframe::egui::{self, Rect, RichText, Ui, vec2};

use crate::live::{BuildProblem, Problems};
use reflet_gpu::ShaderError;
use reflet_scene::diagnostic::{Diagnostic, Severity};

/// Maximum size of the list, points, and the largest fraction of the picture's height that it
/// covers.
const MAX_SIZE: egui::Vec2 = vec2(860.0, 220.0);
const MAX_HEIGHT_FRACTION: f32 = 0.4;
/// Margin around the list, and inside of its frame, points.
const MARGIN: f32 = 8.0;

/// One entry of the panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DiagnosticEntry {
    /// Error, and the expectation.
    pub message: String,
    /// Place of the error: `file:line:column`, a file, or a description.
    pub place: Option<String>,
    /// Help and notes, each with its kind.
    pub more: Vec<(&'static str, String)>,
}

/// Whether the list is folded.
#[derive(Clone, Debug, Default)]
pub struct FoldState(Option<BTreeSet<String>>);

impl FoldState {
    /// Folds the list until there is an entry that is not among these.
    fn fold(&mut self, entries: &[DiagnosticEntry]) {
        self.0 = Some(entries.iter().map(DiagnosticEntry::kind).collect());
    }

    /// Unfolds for a new entry; returns whether the list is folded.
    fn update(&mut self, entries: &[DiagnosticEntry]) -> bool {
        let is_known = |known: &BTreeSet<_>| entries.iter().all(|m| known.contains(&m.kind()));
        self.0 = self.0.take().filter(is_known);
        self.0.is_some()
    }
}

impl DiagnosticEntry {
    fn from_diagnostic(diagnostic: &Diagnostic) -> Self {
        let help = diagnostic.help.iter().map(|help| ("help", help.clone()));
        let related = diagnostic.related.iter().map(|(span, note)| {
            let place = span
                .in_words()
                .map_or(String::new(), |place| format!("{place}: "));
            ("note", format!("{place}{note}"))
        });
        Self {
            message: diagnostic.message.clone(),
            place: place_of(diagnostic),
            more: help.chain(related).collect(),
        }
    }

    /// All errors that keep the newest content from being shown.
    pub fn all(problems: &Problems) -> Vec<Self> {
        let of_scene = problems.scene.iter().chain(&problems.pose);
        let errors = of_scene.filter(|diagnostic| diagnostic.severity == Severity::Error);
        let mut all: Vec<_> = errors.map(Self::from_diagnostic).collect();
        all.extend(problems.unbuilt().map(|problem| match problem {
            BuildProblem::Shader(error) => Self::of_shader(error),
            BuildProblem::Device(text) => Self::of_text(text),
        }));
        all.extend(problems.undrawn.iter().map(|text| Self::of_text(text)));
        all
    }

    fn of_shader(error: &ShaderError) -> Self {
        let at = error.location.as_ref();
        let place = at.map(|at| format!("{}:{}:{}", at.file, at.line, at.column.max(1)));
        Self {
            message: error.message.clone(),
            place: Some(place.unwrap_or_else(|| error.file.to_string())),
            more: error.notes.iter().map(|n| ("note", n.clone())).collect(),
        }
    }

    fn of_text(text: &str) -> Self {
        Self {
            message: text.to_owned(),
            place: None,
            more: Vec::new(),
        }
    }

    /// Identity of an error, independent of line and frame.
    fn kind(&self) -> String {
        let place = self.place.iter().flat_map(|place| place.chars());
        let all = self.message.chars().chain(place);
        all.filter(|c| !c.is_ascii_digit()).collect()
    }

    /// The message, below it the place, then what to do.
    pub fn show(&self, ui: &mut Ui) {
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.add(egui::Label::new(RichText::new(&self.message).strong()).wrap());
        if let Some(place) = &self.place {
            ui.horizontal(|ui| {
                let copy = egui::Button::new("copy").small();
                if ui.add(copy).on_hover_text("copy this place").clicked() {
                    ui.ctx().copy_text(place.clone());
                }
                let place = RichText::new(place).monospace();
                ui.add(egui::Label::new(place.color(ui.visuals().hyperlink_color)).truncate());
            });
        }
        for (what, text) in &self.more {
            ui.add(egui::Label::new(RichText::new(format!("{what}: {text}")).weak()).wrap());
        }
    }
}

/// Place of a diagnostic: `file:line:column`, or the file.
fn place_of(diagnostic: &Diagnostic) -> Option<String> {
    let file = || diagnostic.file.as_ref();
    diagnostic
        .span
        .in_words()
        .or_else(|| file().map(|file| file.display().to_string()))
}

/// The message of a diagnostic after its place.
pub fn located(diagnostic: &Diagnostic) -> String {
    let place = place_of(diagnostic).map_or(String::new(), |place| format!("{place}: "));
    format!("{place}{}", diagnostic.message)
}

/// The list, at the bottom of the picture and over it: beside it, an error would change the
/// picture's size.
pub fn overlay(ui: &Ui, picture: Rect, problems: &Problems, fold: &mut FoldState) {
    if problems.is_empty() {
        return;
    }
    let room = picture.size() - egui::Vec2::splat(4.0 * MARGIN);
    let size = MAX_SIZE
        .min(vec2(room.x, room.y * MAX_HEIGHT_FRACTION))
        .max(vec2(40.0, 24.0));
    egui::Area::new(egui::Id::unique("reflet problems"))
        .pivot(egui::Align2::LEFT_BOTTOM)
        .fixed_pos(picture.left_bottom() + vec2(MARGIN, -MARGIN))
        .constrain_to(picture)
        .show(ui.ctx(), |ui| {
            let frame = egui::Frame::popup(ui.style()).inner_margin(MARGIN);
            frame.show(ui, |ui| {
                ui.set_width(size.x);
                list(ui, &DiagnosticEntry::all(problems), fold, size.y);
            });
        });
}

/// The list with its fold button; `height` limits all but its first line, points.
pub fn list(ui: &mut Ui, entries: &[DiagnosticEntry], fold: &mut FoldState, height: f32) {
    let is_folded = fold.update(entries);
    let title = match (is_folded, entries) {
        (true, [only]) => only.message.clone(),
        // The button first: it must not be cut off.
        (true, [first, ..]) => format!("{} errors: {}", entries.len(), first.message),
        (false, [_]) => "Reload failed, the picture is unchanged".to_owned(),
        (_, all) => format!(
            "Reload failed, the picture is unchanged: {} errors",
            all.len()
        ),
    };
    ui.horizontal(|ui| {
        let right = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right, |ui| {
            if is_folded {
                if ui.button("unfold").on_hover_text("all of it").clicked() {
                    *fold = FoldState::default();
                }
            } else if (ui.button("fold"))
                .on_hover_text("to one line, until the next error")
                .clicked()
            {
                fold.fold(entries);
            }
            let left = egui::Layout::left_to_right(egui::Align::Center);
            ui.with_layout(left.with_main_align(egui::Align::Min), |ui| {
                let title = RichText::new(title).color(ui.visuals().error_fg_color);
                ui.add(egui::Label::new(title).truncate());
            });
        });
    });
    if is_folded {
        return;
    }
    ui.add_space(3.0);
    egui::ScrollArea::vertical()
        .id_salt("problems")
        .max_height(height)
        .show(ui, |ui| {
            // Space for the scroll bar.
            ui.set_width(ui.available_width() - MARGIN);
            for (index, entry) in entries.iter().enumerate() {
                if index > 0 {
                    ui.add_space(2.0);
                    ui.separator();
                }
                ui.scope(|ui| entry.show(ui));
            }
        });
}
