//! The message of the status line: it disappears after a while, or at the next user
//! action.

use eframe::egui::{Event, InputState, Ui};

/// Display time of a message, seconds.
const DURATION_S: f64 = 12.0;

/// The current message, if any.
#[derive(Clone, Debug, Default)]
pub struct StatusMessage {
    text: String,
    /// Time of its first display, seconds; `None` before.
    since: Option<f64>,
    /// Text shown where there is no other message.
    permanent: String,
}

impl StatusMessage {
    /// Replaces the message.
    pub fn set(&mut self, text: impl Into<String>) {
        (self.text, self.since) = (text.into(), None);
    }

    /// Sets the message that is shown whenever there is no newer one.
    pub fn set_permanent(&mut self, text: impl Into<String>) {
        self.permanent = text.into();
        self.set("");
    }

    /// The text to show; empty for none.
    pub fn text(&self) -> &str {
        if self.text.is_empty() {
            &self.permanent
        } else {
            &self.text
        }
    }

    /// Clears a message that was shown long enough, or when the user `acts` again. Returns the
    /// seconds until the next check; `None` where there is nothing to expire.
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

    /// Clears the message at the next key or click.
    pub fn expire_on_input(&mut self, ui: &Ui, now_s: f64) {
        let is_pressed = |event: &Event| matches!(event, Event::Key { pressed, repeat, .. } if *pressed && !*repeat);
        let acts = |i: &InputState| i.pointer.any_pressed() || i.events.iter().any(is_pressed);
        if ui.input(acts) {
            self.expire(true, now_s);
        }
    }

    /// Clears the message when its time is over, and schedules the repaint for that.
    pub fn tick(&mut self, ui: &Ui, now_s: f64) {
        if let Some(left_s) = self.expire(false, now_s) {
            ui.ctx().request_repaint_after_secs(left_s as f32 + 0.01);
        }
    }

    /// Restarts the display time, for a hovered message.
    pub fn extend(&mut self) {
        self.since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn status_message_expires_with_time_or_the_next_action() {
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
