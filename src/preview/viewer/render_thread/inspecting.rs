//! The inspected item, whose numbers the window shows: selected by a click or in the outline, written
//! back, and found again after reloads.

use super::worker::Worker;
use crate::{
    live::Live,
    viewer::protocol::Report,
    write_back::{FlightPoint, KeyEdit, Numbers, SceneItem},
};

impl Worker {
    /// Selects an item: sends its numbers, and outlines it if it is an instance.
    pub(super) fn select(&mut self, item: SceneItem) {
        let index = item.instance_in(self.live.world());
        self.selected = index.and_then(|index| self.instance_name(index));
        self.show_item(Some(item));
    }

    /// Sends the numbers of an item.
    pub(super) fn show_item(&mut self, item: Option<SceneItem>) {
        let name = item.and_then(|item| item.named(self.live.desc()));
        let name = name.and_then(|(name, _)| name.map(str::to_owned));
        self.item = item.map(|item| (item, name));
        let inspected = item.and_then(|item| self.live.inspect(item));
        self.send(Report::Inspected(inspected.map(Box::new)));
    }

    /// Sends the numbers of the item again, which is found by its name in a reloaded scene.
    pub(super) fn show_item_again(&mut self) {
        if let Some((item, name)) = self.item.take() {
            let again = item.again(self.live.desc(), name.as_deref());
            self.show_item(again);
        }
    }

    /// Shows an item with other numbers; returns whether the picture changes.
    pub(super) fn drag(&mut self, item: SceneItem, numbers: &Numbers) -> bool {
        self.with_problems(|live| live.drag(item, numbers).ok)
    }

    /// Shows the scene on disk after a drag that is not written; returns whether the picture changes.
    pub(super) fn drop_drag(&mut self) -> bool {
        self.with_problems(Live::drop_drag)
    }

    /// Makes a change, and tells of the scene's mistakes if they are others then.
    fn with_problems(&mut self, change: impl FnOnce(&mut Live) -> bool) -> bool {
        let before = self.live.problems.clone();
        let is_shown = change(&mut self.live);
        if self.live.problems != before {
            self.send_summary();
        }
        is_shown
    }

    /// Writes numbers into the text; the reload after the save shows them. Returns whether the picture changes
    /// because the write failed, so that numbers shown by a drag are dropped.
    pub(super) fn write(&mut self, item: SceneItem, numbers: &Numbers) -> bool {
        let Err(why) = self.live.write(item, numbers) else {
            return false;
        };
        let was_dragged = self.live.drop_drag();
        self.send(Report::Message(format!("not written: {why}")));
        self.show_item(Some(item));
        was_dragged
    }

    /// Writes a number of a material into the text, as the selected instance has it.
    pub(super) fn write_material(&mut self, material: usize, numbers: &Numbers) {
        let shown = self.selected_instance();
        let done = self.live.write_material(material, shown, numbers);
        self.send(Report::Message(match done {
            Ok(table) => format!("{} is written into {table}", numbers.key),
            Err(why) => {
                let key = numbers.key;
                format!("{key} is not written, and shown until the scene is saved: {why}")
            }
        }));
    }

    /// Writes values of parameters into the text, if the picture shows them; others wait.
    pub(super) fn write_parameters(&mut self) {
        let is_shown = |values: &mut _| self.live.parameters() == values;
        let Some(values) = self.unwritten.take_if(is_shown) else {
            return;
        };
        if let Err(why) = self.live.write_parameters(&values) {
            self.send(Report::Message(format!("not written: {why}")));
        }
    }

    /// Changes keys of a track in the text; the reload after the save shows them.
    pub(super) fn edit_key(&mut self, edit: &KeyEdit) {
        if let Err(why) = self.live.edit_key(edit) {
            self.send(Report::Message(format!("not written: {why}")));
            // Keys that were dragged are shown where they are.
            self.send_summary();
        }
    }

    /// Writes a flight of a camera into the text.
    pub(super) fn write_flight(&mut self, camera: &str, points: &[FlightPoint]) {
        let done = self.live.write_flight(camera, points);
        self.send(Report::Message(match done {
            Ok(count) => {
                format!("the flight is written into [motion.camera.{camera}], {count} keys")
            }
            Err(why) => format!("the flight is not written: {why}"),
        }));
    }

    /// Undoes the last edit, or redoes the last undone one.
    pub(super) fn undo(&mut self, again: bool) {
        let done = self.live.undo(again);
        let text = done.unwrap_or_else(|why| format!("not undone: {why}"));
        self.send(Report::Message(text));
    }
}
