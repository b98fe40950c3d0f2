//! Presses of keys.

use eframe::egui::{Event, Key, Ui};

/// Presses of a key without modifiers since the last frame of the window. The modifiers are those of each press: a slow
/// window may see Alt and an arrow pressed and released within one frame, after which no modifier is down.
pub fn presses(ui: &Ui, wanted: Key) -> usize {
    let is_press = |event: &&Event| {
        matches!(event, Event::Key { key, pressed: true, modifiers, .. }
            if *key == wanted && modifiers.is_none())
    };
    ui.input(|input| input.events.iter().filter(is_press).count())
}

#[cfg(test)]
mod tests {
    use eframe::egui::Modifiers;
    use egui_kittest::Harness;

    use super::*;

    #[test]
    fn a_key_with_a_modifier_is_another_key() {
        let draw = |ui: &mut Ui, counted: &mut usize| *counted += presses(ui, Key::ArrowRight);
        let mut harness = Harness::new_ui_state(draw, 0);
        // Pressed and released before the window looks.
        harness.key_press_modifiers(Modifiers::ALT, Key::ArrowRight);
        harness.run();
        assert_eq!(*harness.state(), 0);
        harness.key_press(Key::ArrowRight);
        harness.key_press(Key::ArrowRight);
        harness.run();
        assert_eq!(*harness.state(), 2);
    }
}
