//! Presses of keys.

use eframe::egui::{Event, Key, Modifiers, Ui};

use crate::write_back::presses::Press;

/// Presses since the last frame of the window. The modifiers are taken at each press: a slow window may see Alt and an
/// arrow pressed and released within one frame, after which no modifier is down. With modifiers no control sees them.
pub fn presses(ui: &Ui, press: &Press) -> usize {
    let has = |modifier| press.keys.contains(modifier);
    let key = press.keys.rsplit('+').next().and_then(Key::from_name);
    let wanted = Modifiers {
        alt: has("Alt+"),
        shift: has("Shift+"),
        command: has("Ctrl+"),
        ..Modifiers::NONE
    };
    let is_press = |event: &Event| {
        matches!(event, Event::Key { key: pressed, pressed: true, modifiers, .. }
            if Some(*pressed) == key && modifiers.matches_exact(wanted))
    };
    ui.input_mut(|input| {
        let count = input.events.iter().filter(|event| is_press(event)).count();
        if wanted.any() {
            input.events.retain(|event| !is_press(event));
        }
        count
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::write_back::presses;

    #[test]
    fn the_window_knows_every_key() {
        let last = |press: &Press| press.keys.rsplit('+').next().and_then(Key::from_name);
        let unknown = presses::presses().find(|press| last(press).is_none());
        assert_eq!(unknown, None);
    }
}
