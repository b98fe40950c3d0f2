//! Keys of viewers and their actions: the list of them, and the presses that the window and the pages understand.

use serde::{Deserialize, Serialize};

use reflet_scene::desc::Method;

/// Methods with a key and a button of their own, in the order of menus.
pub const FIRST_METHODS: [Method; 4] = [Method::Hybrid, Method::Ssr, Method::Rt, Method::Path];

/// Methods to compare them with, in the order of menus.
pub fn rivals() -> impl Iterator<Item = Method> {
    let others = |method: &Method| *method != Method::Auto && !FIRST_METHODS.contains(method);
    Method::ALL.into_iter().filter(others)
}

/// Action of a key or a button.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KeyAction {
    /// Play or pause.
    Play,
    /// Step by frames.
    Step(i64),
    /// Go to the first frame.
    Start,
    /// Go to the last frame.
    End,
    /// Loop or end at the end.
    Loop,
    /// Choose a method of the left side, by its index into [`FIRST_METHODS`].
    Method(usize),
    /// Begin or end the wipe.
    Wipe,
    /// Show or hide the frame of the image.
    SafeArea,
    /// Show or hide the list of keys.
    Help,
    /// Look through the scene's camera again.
    SceneCamera,
    /// Frame the selection, else the scene.
    Frame,
    /// Clear the selection.
    Unpick,
    /// Move the selected item by meters along the axes of its parent, and write its place.
    Nudge([f64; 3]),
    /// Undo the last written change (`false`), or redo the last undone one (`true`).
    Undo(bool),
    /// Begin or end the recording of a camera flight.
    Record,
    /// Copy the camera as scene text.
    Copy,
    /// Compare with `rt`.
    Compare,
    /// Write a screenshot.
    Screenshot,
    /// Close the window.
    Close,
}

/// A press of a key.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// Modifiers, in the order Ctrl, Alt and Shift, and the key's name in browsers, in which a letter is a capital:
    /// `Alt+Shift+PageUp`. Ctrl is the command key on macOS.
    pub keys: &'static str,
    /// Action of the press.
    pub action: KeyAction,
}

/// A row of the list of keys.
#[derive(Clone, Copy, Debug)]
pub struct KeyRow {
    /// The keys as people know them.
    pub keys: &'static str,
    /// Text about their effect.
    pub what: &'static str,
    /// Their presses; empty where a face of the viewer has a use of its own for them.
    pub presses: &'static [Press],
}

/// Rows of the list: keys, what they do, and the presses with their actions.
macro_rules! rows {
    ($($keys:literal: $what:literal $(=> $($press:literal $action:expr),+)?;)+) => {
        &[$(KeyRow {
            keys: $keys,
            what: $what,
            presses: &[$($(Press { keys: $press, action: $action }),+)?],
        }),+]
    };
}

/// A move of the selection by 0.1 m along an axis, and ten times as far.
const fn near(x: i8, y: i8, z: i8) -> KeyAction {
    KeyAction::Nudge([0.1 * x as f64, 0.1 * y as f64, 0.1 * z as f64])
}
const fn far(x: i8, y: i8, z: i8) -> KeyAction {
    KeyAction::Nudge([x as f64, y as f64, z as f64])
}

/// All keys, and the actions of the mouse.
pub static KEYS: &[KeyRow] = {
    use KeyAction::*;
    rows! {
        "left drag": "orbit around the target";
        "middle drag": "pan";
        "right drag": "look around";
        "right drag + W A S D Q E": "fly; Shift: four times as fast";
        "wheel": "closer, farther";
        "right drag + wheel": "flying speed";
        "click": "select the instance under the pointer, and its material";
        "Esc": "close this list or the error map; otherwise deselect" => "Escape" Unpick;
        "Alt + arrows, Page Up, Page Down": "move the selection by 0.1 m, with Shift by 1 m, in the scene text" =>
            "Alt+ArrowLeft" near(-1, 0, 0), "Alt+Shift+ArrowLeft" far(-1, 0, 0),
            "Alt+ArrowRight" near(1, 0, 0), "Alt+Shift+ArrowRight" far(1, 0, 0),
            "Alt+ArrowUp" near(0, 0, -1), "Alt+Shift+ArrowUp" far(0, 0, -1),
            "Alt+ArrowDown" near(0, 0, 1), "Alt+Shift+ArrowDown" far(0, 0, 1),
            "Alt+PageUp" near(0, 1, 0), "Alt+Shift+PageUp" far(0, 1, 0),
            "Alt+PageDown" near(0, -1, 0), "Alt+Shift+PageDown" far(0, -1, 0);
        "Ctrl Z, Ctrl Shift Z": "undo, redo what was written" =>
            "Ctrl+Z" Undo(false), "Ctrl+Shift+Z" Undo(true), "Ctrl+Y" Undo(true);
        "Space": "play, pause" => " " Play;
        "left, right arrow": "one frame back, on" => "ArrowLeft" Step(-1), "ArrowRight" Step(1);
        "Home, End": "first, last frame" => "Home" Start, "End" End;
        "L": "loop: the first frame follows the last" => "L" Loop;
        "F": "frame the selection, or the scene" => "F" Frame;
        "1 2 3 4": "hybrid, ssr, rt, path" => "1" Method(0), "2" Method(1), "3" Method(2), "4" Method(3);
        "B": "wipe between two methods or textures; drag its line" => "B" Wipe;
        "G": "the frame of image.size, with its safe area" => "G" SafeArea;
        "C": "copy the camera as scene text" => "C" Copy;
        "R": "back to the scene's camera" => "R" SceneCamera;
        "X": "error against rt, as numbers and as a map" => "X" Compare;
        "F12": "write what is shown to a PNG file, without labels and outline" => "F12" Screenshot;
        "Ctrl O, or a dropped file": "open another scene or model";
        "H": "this list" => "H" Help;
        "Ctrl Q": "close" => "Ctrl+Q" Close;
    }
};

/// Presses of all keys.
pub fn presses() -> impl Iterator<Item = &'static Press> + Clone {
    KEYS.iter().flat_map(|row| row.presses)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_press_does_one_thing_and_keys_of_methods_are_listed() {
        for press in presses() {
            let same = presses().filter(|other| other.keys == press.keys);
            assert_eq!(same.count(), 1, "{press:?}");
        }
        let methods = FIRST_METHODS.map(|method| method.name());
        assert!(KEYS.iter().any(|row| row.what == methods.join(", ")));
    }
}
