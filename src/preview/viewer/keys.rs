//! Effects of presses on time and view.

use super::{timeline::Timeline, view_state::ViewState};
use crate::write_back::presses::{FIRST_METHODS, KeyAction};

impl Timeline {
    /// Moves time as a key does; returns whether it is such a key.
    pub fn press(&mut self, action: KeyAction, now_s: f64) -> bool {
        match action {
            KeyAction::Play => self.toggle(now_s),
            KeyAction::Step(by) => self.step(by),
            KeyAction::Start => self.seek(self.start(), now_s),
            KeyAction::End => self.seek(self.end(), now_s),
            KeyAction::Loop => self.repeats = !self.repeats,
            _ => return false,
        }
        true
    }
}

impl ViewState {
    /// Does what a key does to time and view alone; returns whether it is such a key.
    pub fn press(&mut self, action: KeyAction, now_s: f64) -> bool {
        if (self.timeline.as_mut()).is_some_and(|time| time.press(action, now_s)) {
            return true;
        }
        let settings = &mut self.settings;
        match action {
            KeyAction::Method(index) => {
                settings.a.method = FIRST_METHODS
                    .get(index)
                    .copied()
                    .unwrap_or(settings.a.method);
            }
            KeyAction::Wipe => {
                settings.wipe = !settings.wipe;
                settings.start_wipe();
            }
            KeyAction::SafeArea => settings.image_frame = !settings.image_frame,
            KeyAction::Help => settings.help = !settings.help,
            KeyAction::SceneCamera => self.show_scene_camera(),
            _ => return false,
        }
        true
    }
}
