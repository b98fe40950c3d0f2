//! The panel of the selected item: its numbers, written into the scene text when a drag or an input
//! ends; and the outline of the scene.

use eframe::egui::{self, Key, Modifiers, Ui};
use glam::Vec2;

use super::{
    number_row::{Input, row},
    panels::ViewRequest,
};
use crate::{
    viewer::{
        handles::{self, Handle, HandleDrag, Handles},
        protocol::PixelValue,
        scene_summary::OutlineRow,
    },
    write_back::{Inspected, Numbers, SceneItem},
};
use reflet_scene::desc::CameraDesc;

/// Step by which a key moves the selection, meters; ten times as much with Shift.
const STEP_M: f64 = 0.1;
/// Height of a row of the outline, and maximum height of the outline, points.
const ROW: f32 = 18.0;
const OUTLINE: f32 = 180.0;

/// The selected item, and its numbers during a drag.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    shown: Option<Inspected>,
    numbers: Vec<Numbers>,
    /// Kind of the displayed handles.
    pub handle: Handle,
    /// The dragged handle.
    dragged: Option<HandleDrag>,
    /// Whether the outline is to bring its row into view.
    scrolls_to_row: bool,
    /// Whether the selection that comes next was chosen in the outline.
    is_chosen_in_outline: bool,
}

impl Selection {
    /// Shows another item, or its current numbers in the scene.
    pub fn show(&mut self, inspected: Option<Inspected>) {
        let item = inspected.as_ref().map(|inspected| inspected.item);
        if item.is_some() && item != self.item() {
            self.scrolls_to_row = !std::mem::take(&mut self.is_chosen_in_outline);
        }
        self.numbers = inspected
            .as_ref()
            .map_or_else(Vec::new, |i| i.numbers.clone());
        self.shown = inspected;
    }

    /// Handles of the item in a camera's picture of this size.
    pub fn handles(&self, camera: &CameraDesc, size: Vec2) -> Option<Handles> {
        let parent = &self.shown.as_ref()?.world_from_parent;
        Handles::new((self.handle, &self.numbers, parent), camera, size)
    }

    /// Edges of a decal's box in a camera's picture of this size.
    pub fn box_edges(&self, camera: &CameraDesc, size: Vec2) -> Vec<[Vec2; 2]> {
        let shown = self.shown.iter();
        shown
            .flat_map(|shown| handles::box_edges((shown, &self.numbers), camera, size))
            .collect()
    }

    /// Starts a drag of a handle.
    pub fn start_drag(&mut self, handles: &Handles, axis: usize) {
        self.dragged = handles.grab(axis, &self.numbers);
    }

    /// Numbers after the drag of a handle by points.
    pub fn dragged(&self, by: Vec2) -> Option<Numbers> {
        self.dragged.as_ref().map(|drag| drag.numbers(by))
    }

    /// Shows other numbers, which are not written yet; returns whether they differ.
    pub fn put(&mut self, numbers: &Numbers) -> bool {
        let known = self.numbers.iter_mut().find(|n| n.key == numbers.key);
        let Some(known) = known.filter(|known| *known != numbers) else {
            return false;
        };
        known.clone_from(numbers);
        true
    }

    /// Ends the drag; returns the item and its numbers to write, if they changed.
    pub fn end_drag(&mut self) -> Option<(SceneItem, Numbers)> {
        let before = self.dragged.take()?.before;
        let now = self.numbers.iter().find(|n| n.key == before.key)?;
        let item = self.item()?;
        (*now != before).then(|| (item, now.clone()))
    }

    /// The selected item.
    pub fn item(&self) -> Option<SceneItem> {
        self.shown.as_ref().map(|inspected| inspected.item)
    }

    /// The request that moves the selection by a step, if it has a position.
    pub fn moved(&self, by: [f64; 3]) -> Option<ViewRequest> {
        let shown = self.shown.as_ref()?;
        let moved = Numbers::moved(&self.numbers, by)?;
        Some(ViewRequest::Write(shown.item, moved))
    }
}

/// Handles keys: Alt with an arrow, Page Up or Page Down moves the selection; others undo and redo.
pub fn keys(ui: &Ui, selection: &Selection) -> Vec<ViewRequest> {
    let mut requests = Vec::new();
    let pressed = |modifiers: Modifiers, key: Key| {
        let shortcut = egui::KeyboardShortcut::new(modifiers, key);
        ui.input_mut(|input| input.consume_shortcut(&shortcut))
    };
    let redo = Modifiers::COMMAND | Modifiers::SHIFT;
    if pressed(redo, Key::Z) || pressed(Modifiers::COMMAND, Key::Y) {
        requests.push(ViewRequest::Undo(true));
    } else if pressed(Modifiers::COMMAND, Key::Z) {
        requests.push(ViewRequest::Undo(false));
    }
    for (key, by) in [
        (Key::ArrowLeft, [-STEP_M, 0.0, 0.0]),
        (Key::ArrowRight, [STEP_M, 0.0, 0.0]),
        (Key::ArrowUp, [0.0, 0.0, -STEP_M]),
        (Key::ArrowDown, [0.0, 0.0, STEP_M]),
        (Key::PageUp, [0.0, STEP_M, 0.0]),
        (Key::PageDown, [0.0, -STEP_M, 0.0]),
    ] {
        let large = pressed(Modifiers::ALT | Modifiers::SHIFT, key);
        if large || pressed(Modifiers::ALT, key) {
            let by = by.map(|x| if large { 10.0 * x } else { x });
            requests.extend(selection.moved(by));
        }
    }
    requests
}

/// Panel with the numbers of the selected item.
pub fn panel(ui: &mut Ui, selection: &mut Selection, requests: &mut Vec<ViewRequest>) {
    let Some(shown) = &selection.shown else {
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
                    requests.push(ViewRequest::Write(shown.item, now.clone()));
                }
                Input::Changed => requests.push(ViewRequest::Drag(shown.item, now.clone())),
                _ => {}
            }
        }
        ui.horizontal(|ui| {
            for (handle, name) in Handle::ALL {
                ui.selectable_value(&mut selection.handle, handle, name);
            }
        });
        ui.horizontal(|ui| {
            if ui.button("undo").on_hover_text("Ctrl+Z").clicked() {
                requests.push(ViewRequest::Undo(false));
            }
            if ui.button("redo").on_hover_text("Ctrl+Shift+Z").clicked() {
                requests.push(ViewRequest::Undo(true));
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
    selection: &mut Selection,
    requests: &mut Vec<ViewRequest>,
) {
    if rows.is_empty() {
        return;
    }
    egui::CollapsingHeader::new("Outline").show(ui, |ui| {
        let selected = selection.item();
        let mut area = egui::ScrollArea::vertical()
            .id_salt("outline")
            .max_height(OUTLINE);
        // A row that was clicked in the picture is brought into view; a click here moves nothing.
        if std::mem::take(&mut selection.scrolls_to_row)
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
                        selection.is_chosen_in_outline = true;
                        requests.push(ViewRequest::Select(row.item));
                    }
                });
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use egui_kittest::{Harness, kittest::Queryable as _};
    use glam::Affine3A;

    use super::*;

    struct State {
        selection: Selection,
        requests: Vec<ViewRequest>,
    }

    fn harness<'a>(refused: Option<&str>) -> Harness<'a, State> {
        let numbers = Numbers {
            key: "translation",
            values: vec![1.0, 2.0, 3.0],
        };
        let mut selection = Selection::default();
        selection.show(Some(Inspected {
            item: SceneItem::Instance(4),
            label: "instance ball".to_owned(),
            place: "scene.toml:7".to_owned(),
            numbers: refused.map_or_else(|| vec![numbers], |_| Vec::new()),
            held: Vec::new(),
            refused: refused.map(str::to_owned),
            world_from_parent: Affine3A::IDENTITY,
        }));
        let rows = [OutlineRow {
            item: SceneItem::Light(2),
            label: "light lamp".to_owned(),
            depth: 1,
        }];
        let draw = move |ui: &mut Ui, state: &mut State| {
            let State {
                selection,
                requests,
            } = state;
            requests.extend(keys(ui, selection));
            panel(ui, selection, requests);
            outline(ui, &rows, selection, requests);
        };
        Harness::builder()
            .with_size(egui::vec2(320.0, 700.0))
            .build_ui_state(
                draw,
                State {
                    selection,
                    requests: Vec::new(),
                },
            )
    }

    #[test]
    fn keys_and_buttons_request_what_they_say() {
        let mut harness = harness(None);
        for label in ["instance ball", "scene.toml:7", "translation"] {
            assert!(
                harness.query_all_by_label(label).next().is_some(),
                "{label}"
            );
        }
        let moved = |values: [f64; 3]| {
            let values = values.to_vec();
            ViewRequest::Write(
                SceneItem::Instance(4),
                Numbers {
                    key: "translation",
                    values,
                },
            )
        };
        for (modifiers, key, request) in [
            (Modifiers::ALT, Key::ArrowRight, moved([1.1, 2.0, 3.0])),
            (
                Modifiers::ALT | Modifiers::SHIFT,
                Key::PageUp,
                moved([1.0, 3.0, 3.0]),
            ),
            (Modifiers::COMMAND, Key::Z, ViewRequest::Undo(false)),
            (
                Modifiers::COMMAND | Modifiers::SHIFT,
                Key::Z,
                ViewRequest::Undo(true),
            ),
        ] {
            harness.key_press_modifiers(modifiers, key);
            harness.run();
            assert_eq!(harness.state_mut().requests.pop(), Some(request), "{key:?}");
        }
        harness.get_by_label("undo").click();
        harness.run();
        assert_eq!(
            harness.state_mut().requests.pop(),
            Some(ViewRequest::Undo(false))
        );
        harness.get_by_label("Outline").click();
        harness.run();
        harness.run();
        harness.get_by_label("light lamp").click();
        harness.run();
        let select = ViewRequest::Select(SceneItem::Light(2));
        assert_eq!(harness.state_mut().requests.pop(), Some(select));
    }

    #[test]
    fn what_cannot_be_changed_says_why() {
        let mut harness = harness(Some("it comes from the command line"));
        let why = "it comes from the command line";
        assert!(harness.query_by_label(why).is_some());
        harness.key_press_modifiers(Modifiers::ALT, Key::ArrowRight);
        harness.run();
        assert!(harness.state().requests.is_empty());
    }
}
