//! The thing whose numbers the window shows: chosen by a click or in the outline, written back, and
//! found again after reloads.

use super::{instance_key::InstanceKey, worker::Worker};
use crate::app::{
    preview::protocol::Report,
    write_back::{Numbers, Thing},
};

impl Worker {
    /// Shows the numbers of a thing, and outlines it if it is an instance.
    pub(super) fn select(&mut self, thing: Thing) {
        let world = self.live.world();
        let index = match thing {
            Thing::Instance(index) => world.written.iter().position(|w| *w == Some(index)),
            _ => None,
        };
        self.selected = index.and_then(|index| InstanceKey::of(world, index));
        self.show_thing(Some(thing));
    }

    /// Sends the numbers of a thing.
    pub(super) fn show_thing(&mut self, thing: Option<Thing>) {
        let name = thing.and_then(|thing| thing.named(self.live.desc()));
        let name = name.and_then(|(name, _)| name.map(str::to_owned));
        self.thing = thing.map(|thing| (thing, name));
        let inspected = thing.and_then(|thing| self.live.inspect(thing));
        self.send(Report::Inspected(inspected.map(Box::new)));
    }

    /// Sends the numbers again, of the thing of the same name in a reloaded scene.
    pub(super) fn show_thing_again(&mut self) {
        if let Some((thing, name)) = self.thing.take() {
            let again = thing.again(self.live.desc(), name.as_deref());
            self.show_thing(again);
        }
    }

    /// Shows a thing with other numbers; returns whether the picture changes.
    pub(super) fn drag(&mut self, thing: Thing, numbers: &Numbers) -> bool {
        let before = self.live.problems.clone();
        let is_shown = self.live.drag(thing, numbers).ok;
        if self.live.problems != before {
            self.send_summary();
        }
        is_shown
    }

    /// Writes numbers into the text; the save brings them into the picture. Returns whether the picture changes
    /// because they are not written, but were shown by a drag.
    pub(super) fn write(&mut self, thing: Thing, numbers: &Numbers) -> bool {
        let Err(why) = self.live.write(thing, numbers) else {
            return false;
        };
        let was_dragged = self.live.drop_drag();
        self.send(Report::Message(format!("not written: {why}")));
        self.show_thing(Some(thing));
        was_dragged
    }

    /// Takes the last change back, or makes it again.
    pub(super) fn undo(&mut self, again: bool) {
        let done = self.live.undo(again);
        let text = done.unwrap_or_else(|why| format!("not undone: {why}"));
        self.send(Report::Message(text));
    }
}
