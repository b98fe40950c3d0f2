//! The panel of the selected item: its numbers, written into the scene text when a drag or an input
//! ends; and the outline of the scene.

use eframe::egui::{self, Ui};

use super::{
    number_row::{Input, row},
    panels::ViewRequest,
};
use crate::{
    viewer::{
        protocol::{PixelValue, Task},
        scene_summary::OutlineRow,
    },
    write_back::{SceneItem, handles::Handle, presses::KeyAction, selection::Selection},
};

/// Height of a row of the outline, and maximum height of the outline, points.
const ROW: f32 = 18.0;
const OUTLINE: f32 = 180.0;

/// State of the outline that brings the row of the selected item into view.
#[derive(Clone, Copy, Debug, Default)]
pub struct OutlineScroll {
    /// Whether the row of the selected item is brought into view.
    is_due: bool,
    /// Whether the selection that comes next was chosen in the outline.
    is_chosen_there: bool,
}

impl OutlineScroll {
    /// Notes that another item will be shown than `before`.
    pub fn select(&mut self, before: Option<SceneItem>, item: Option<SceneItem>) {
        if item.is_some() && item != before {
            self.is_due = !std::mem::take(&mut self.is_chosen_there);
        }
    }
}

/// Panel with the numbers of the selected item.
pub fn panel(ui: &mut Ui, selection: &mut Selection, requests: &mut Vec<ViewRequest>) {
    let Some(shown) = selection.shown().cloned() else {
        return;
    };
    let header = egui::CollapsingHeader::new("Selected").default_open(true);
    header.show(ui, |ui| {
        ui.add(egui::Label::new(&shown.label).truncate());
        ui.add(egui::Label::new(egui::RichText::new(&shown.place).weak()).truncate());
        if let Some(why) = &shown.refused {
            ui.weak(why);
        }
        for (now, before) in selection.numbers.iter_mut().zip(&shown.numbers) {
            let input = row(ui, now);
            if let Some((_, why)) = shown.held.iter().find(|(key, _)| *key == now.key) {
                ui.weak(why);
            }
            match input {
                Input::Ended if now != before => {
                    requests.push(Task::Write(shown.item, now.clone()).into());
                }
                Input::Changed => requests.push(Task::Drag(shown.item, now.clone()).into()),
                _ => {}
            }
        }
        ui.horizontal(|ui| {
            for handle in Handle::ALL {
                ui.selectable_value(&mut selection.handle, handle, handle.name());
            }
        });
        ui.horizontal(|ui| {
            if ui.button("undo").on_hover_text("Ctrl+Z").clicked() {
                requests.push(ViewRequest::Press(KeyAction::Undo(false)));
            }
            if ui.button("redo").on_hover_text("Ctrl+Shift+Z").clicked() {
                requests.push(ViewRequest::Press(KeyAction::Undo(true)));
            }
        });
    });
}

/// Panel with the values of the clicked pixel at the time of the click.
pub fn pixel(ui: &mut Ui, values: &[PixelValue]) {
    if values.is_empty() {
        return;
    }
    egui::CollapsingHeader::new("Pixel").show(ui, |ui| {
        egui::Grid::new("pixel").num_columns(2).show(ui, |ui| {
            for PixelValue { name, text } in values {
                ui.weak(*name);
                ui.add(egui::Label::new(text).truncate());
                ui.end_row();
            }
        });
    });
}

/// Panel with the scene's outline; a click selects an item.
pub fn outline(
    ui: &mut Ui,
    rows: &[OutlineRow],
    selected: Option<SceneItem>,
    scroll: &mut OutlineScroll,
    requests: &mut Vec<ViewRequest>,
) {
    if rows.is_empty() {
        return;
    }
    egui::CollapsingHeader::new("Outline").show(ui, |ui| {
        let mut area = egui::ScrollArea::vertical()
            .id_salt("outline")
            .max_height(OUTLINE);
        // A row that was clicked in the picture is brought into view; a click here moves nothing.
        if std::mem::take(&mut scroll.is_due)
            && let Some(row) = rows.iter().position(|row| Some(row.item) == selected)
        {
            let height = ROW + ui.spacing().item_spacing.y;
            area = area.vertical_scroll_offset((row as f32 - 3.0).max(0.0) * height);
        }
        area.show_rows(ui, ROW, rows.len(), |ui, range| {
            for row in &rows[range] {
                ui.horizontal(|ui| {
                    ui.add_space(12.0 * f32::from(row.depth));
                    let is_selected = selected == Some(row.item);
                    if ui.selectable_label(is_selected, &row.label).clicked() {
                        scroll.is_chosen_there = true;
                        requests.push(Task::Select(row.item).into());
                    }
                });
            }
        });
    });
}
