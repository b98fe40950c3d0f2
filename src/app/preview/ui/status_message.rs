//! The last word about what was done, in the status line: it leaves after a while, or at the next
//! action.

use eframe::egui::{Event, InputState, Ui};

/// How long a note is shown, seconds.
const DURATION_S: f64 = 12.0;

/// What is said, if anything.
#[derive(Clone, Debug, Default)]
pub struct StatusMessage {
    text: String,
    /// Since when it is shown, seconds; `None` before its first picture.
    since: Option<f64>,
    /// What is said where there is nothing else.
    permanent: String,
}

impl StatusMessage {
    /// Says something in place of what was said.
    pub fn set(&mut self, text: impl Into<String>) {
        (self.text, self.since) = (text.into(), None);
    }

    /// Says something that stays true: it is there whenever there is nothing newer.
    pub fn set_permanent(&mut self, text: impl Into<String>) {
        self.permanent = text.into();
        self.set("");
    }

    /// What is said.
    pub fn text(&self) -> &str {
        if self.text.is_empty() {
            &self.permanent
        } else {
            &self.text
        }
    }

    /// Forgets what is over: it was shown long enough, or somebody `acts` on another thing. Seconds
    /// until it must be looked at again; `None` where it can stay as it is.
    fn expire(&mut self, acts: bool, now_s: f64) -> Option<f64> {
        if self.text.is_empty() {
            return None;
        }
        let left_s = DURATION_S - (now_s - *self.since.get_or_insert(now_s));
        let is_over = left_s <= 0.0 || (acts && left_s < DURATION_S);
        if is_over {
            self.set("");
        }
        (!is_over).then_some(left_s)
    }

    /// Makes room where somebody does the next thing.
    pub fn expire_on_input(&mut self, ui: &Ui, now_s: f64) {
        let is_pressed = |event: &Event| matches!(event, Event::Key { pressed, repeat, .. } if *pressed && !*repeat);
        let acts = |i: &InputState| i.pointer.any_pressed() || i.events.iter().any(is_pressed);
        if ui.input(acts) {
            self.expire(true, now_s);
        }
    }

    /// Lets it leave when it is time, and has the window drawn then, not before.
    pub fn tick(&mut self, ui: &Ui, now_s: f64) {
        if let Some(left_s) = self.expire(false, now_s) {
            ui.ctx().request_repaint_after_secs(left_s as f32 + 0.01);
        }
    }

    /// Reuse it for a while longer: somebody reads it.
    pub fn extend(&mut self) {
        self.since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_leaves_after_a_while_or_at_the_next_action() {
        let mut message = StatusMessage::default();
        assert_eq!(message.expire(true, 1.0), None, "nothing to wait for");
        message.set("saved");
        assert_eq!(
            message.expire(true, 5.0),
            Some(DURATION_S),
            "said by this action"
        );
        assert_eq!(message.expire(false, 8.0), Some(DURATION_S - 3.0));
        assert_eq!(message.expire(false, 5.0 + DURATION_S), None);
        assert_eq!(message.text(), "");
        message.set("saved again");
        message.expire(false, 20.0);
        message.extend();
        assert_eq!(message.expire(false, 21.0), Some(DURATION_S), "it was read");
        message.expire(true, 22.0);
        assert_eq!(message.text(), "");
        message.set_permanent("no file is followed");
        message.set("saved");
        assert_eq!(message.expire(false, 30.0), Some(DURATION_S));
        assert_eq!(message.text(), "saved");
        message.expire(true, 31.0);
        assert_eq!(message.expire(true, 99.0), None);
        assert_eq!(message.text(), "no file is followed");
    }
}
