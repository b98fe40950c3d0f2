//! Presses of keys.

use eframe::egui::{Event, Key, Modifiers, Ui};

use crate::viewer::keys::Press;

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
    use egui_kittest::Harness;

    use super::*;
    use crate::viewer::keys;

    #[test]
    fn a_key_with_a_modifier_is_another_key() {
        let on = keys::presses().find(|press| press.keys == "ArrowRight");
        let on = on.expect("one frame on");
        let draw = move |ui: &mut Ui, counted: &mut usize| *counted += presses(ui, on);
        let mut harness = Harness::new_ui_state(draw, 0);
        // Pressed and released before the window looks.
        harness.key_press_modifiers(Modifiers::ALT, Key::ArrowRight);
        harness.run();
        assert_eq!(*harness.state(), 0);
        harness.key_press(Key::ArrowRight);
        harness.key_press(Key::ArrowRight);
        harness.run();
        assert_eq!(*harness.state(), 2);
        let last = |press: &Press| press.keys.rsplit('+').next().and_then(Key::from_name);
        let unknown = keys::presses().find(|press| last(press).is_none());
        assert_eq!(unknown, None, "a key that the window does not know");
    }
}
