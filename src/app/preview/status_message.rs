//! The last word about what was done, in the status line: it leaves after a while, or at the next
//! action.

use eframe::egui::{Event, InputState, Ui};

/// How long a note is shown, seconds.
const LASTS_S: f64 = 12.0;

/// What is said, if anything.
#[derive(Clone, Debug, Default)]
pub struct Note {
    text: String,
    /// Since when it is shown, seconds; `None` before its first picture.
    since: Option<f64>,
    /// What is said where there is nothing else.
    lasting: String,
}

impl Note {
    /// Says something in place of what was said.
    pub fn say(&mut self, text: impl Into<String>) {
        (self.text, self.since) = (text.into(), None);
    }

    /// Says something that stays true: it is there whenever there is nothing newer.
    pub fn say_for_good(&mut self, text: impl Into<String>) {
        self.lasting = text.into();
        self.say("");
    }

    /// What is said.
    pub fn text(&self) -> &str {
        if self.text.is_empty() {
            &self.lasting
        } else {
            &self.text
        }
    }

    /// Forgets what is over: it was shown long enough, or somebody `acts` on another thing. Seconds
    /// until it must be looked at again; `None` where it can stay as it is.
    fn age(&mut self, acts: bool, now_s: f64) -> Option<f64> {
        if self.text.is_empty() {
            return None;
        }
        let left_s = LASTS_S - (now_s - *self.since.get_or_insert(now_s));
        let is_over = left_s <= 0.0 || (acts && left_s < LASTS_S);
        if is_over {
            self.say("");
        }
        (!is_over).then_some(left_s)
    }

    /// Makes room where somebody does the next thing.
    pub fn give_way(&mut self, ui: &Ui, now_s: f64) {
        let is_pressed = |event: &Event| matches!(event, Event::Key { pressed, repeat, .. } if *pressed && !*repeat);
        let acts = |i: &InputState| i.pointer.any_pressed() || i.events.iter().any(is_pressed);
        if ui.input(acts) {
            self.age(true, now_s);
        }
    }

    /// Lets it leave when it is time, and has the window drawn then, not before.
    pub fn tick(&mut self, ui: &Ui, now_s: f64) {
        if let Some(left_s) = self.age(false, now_s) {
            ui.ctx().request_repaint_after_secs(left_s as f32 + 0.01);
        }
    }

    /// Reuse it for a while longer: somebody reads it.
    pub fn linger(&mut self) {
        self.since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_leaves_after_a_while_or_at_the_next_action() {
        let mut note = Note::default();
        assert_eq!(note.age(true, 1.0), None, "nothing to wait for");
        note.say("saved");
        assert_eq!(note.age(true, 5.0), Some(LASTS_S), "said by this action");
        assert_eq!(note.age(false, 8.0), Some(LASTS_S - 3.0));
        assert_eq!(note.age(false, 5.0 + LASTS_S), None);
        assert_eq!(note.text(), "");
        note.say("saved again");
        note.age(false, 20.0);
        note.linger();
        assert_eq!(note.age(false, 21.0), Some(LASTS_S), "it was read");
        note.age(true, 22.0);
        assert_eq!(note.text(), "");
        note.say_for_good("no file is followed");
        note.say("saved");
        assert_eq!(note.age(false, 30.0), Some(LASTS_S));
        assert_eq!(note.text(), "saved");
        note.age(true, 31.0);
        assert_eq!(note.age(true, 99.0), None);
        assert_eq!(note.text(), "no file is followed");
    }
}
