//! Messages of a page.

use serde::Deserialize;

/// Input of a viewer.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Input {
    /// The last picture is shown; the next may come.
    Shown,
    /// Move the camera by a drag, in parts of the picture's height.
    Orbit { by: [f32; 2] },
    /// Turn the camera on the spot, by a drag like that of `orbit`.
    Look { by: [f32; 2] },
    /// Move the camera across the view, by a drag like that of `orbit`.
    Pan { by: [f32; 2] },
    /// Come closer by notches of the wheel.
    Dolly { notches: f32 },
    /// Look through a camera of the scene; without a name as the cuts choose, or again through the last one.
    Camera { name: Option<String> },
    /// Frame the selection, else the scene.
    Frame,
    /// Go to a frame.
    Seek { frame: u32 },
    /// Step by frames.
    Step { by: i64 },
    /// Play or pause.
    Play,
    /// Loop or end at the end.
    Loop,
    /// Choose the method of a side, 0 or 1.
    Method { side: usize, name: String },
    /// Choose the channel of a side, 0 or 1.
    Channel { side: usize, name: String },
    /// Begin or end the wipe.
    Wipe,
    /// Select at a place of the picture, 0 to 1 from the top left.
    Pick { at: [f32; 2] },
    /// Select a row of the outline.
    Select { row: usize },
    /// Clear the selection.
    Unpick,
    /// Change numbers of the selected item; write them at the end of a drag.
    Number {
        key: String,
        values: Vec<f64>,
        write: bool,
    },
    /// Change a parameter of the script; write it at the end of a drag.
    Parameter {
        name: String,
        value: serde_json::Value,
        write: bool,
    },
    /// Undo the last written change, or redo the last undone one.
    Undo { again: bool },
}
