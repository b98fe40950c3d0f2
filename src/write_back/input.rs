//! Messages of pages: inputs of their viewers.

use glam::{Vec2, Vec3};
use serde::Deserialize;

use super::{KeyChange, camera_controls::CameraControls, presses::KeyAction};

/// Longest drag, in parts of the picture's height: no window is larger.
pub const MOST_DRAG: f32 = 4.0;
/// Longest flight of a message, seconds; messages that wait for a picture add up.
const MOST_FLIGHT_S: f32 = 4.0;

/// Input of a viewer.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the text of a message names its fields")]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum Input {
    /// The last picture is shown; the next may come.
    Shown,
    /// Move the camera by a drag, in parts of the picture's height.
    Orbit { by: [f32; 2] },
    /// Drag on the picture with the main button: of the handle at `from`, if there is one where the drag starts, else
    /// as `orbit`. Places are 0 to 1 from the top left.
    Drag {
        from: [f32; 2],
        to: [f32; 2],
        by: [f32; 2],
        start: bool,
    },
    /// End of the drag that began at `from`.
    Drop { from: [f32; 2] },
    /// Choose the kind of the handles: `move`, `turn` or `scale`.
    Handles { kind: String },
    /// Turn the camera on the spot, by a drag as for `orbit`.
    Look { by: [f32; 2] },
    /// Move the camera across the view, by a drag as for `orbit`.
    Pan { by: [f32; 2] },
    /// Come closer by notches of the wheel.
    Dolly { notches: f32 },
    /// Look through a camera of the scene; without a name as the cuts choose, or again through the last one.
    Camera { name: Option<String> },
    /// Do what a key or a button does.
    Press { action: KeyAction },
    /// Go to a frame.
    Seek { frame: u32 },
    /// Choose the method of a side, 0 or 1.
    Method { side: usize, name: String },
    /// Choose the channel of a side, 0 or 1.
    Channel { side: usize, name: String },
    /// Select at a place of the picture, 0 to 1 from the top left.
    Pick { at: [f32; 2] },
    /// Select a row of the outline.
    Select { row: usize },
    /// Hide the thing of a row of the outline, or show it again; with `solo`, show it alone, or all again.
    Hide { row: usize, solo: bool },
    /// Render this many sub-frames, or as many as the scene says.
    Samples { count: Option<u32> },
    /// Denoise pictures at rest, or show their noise.
    Denoise { on: bool },
    /// Change numbers of the selected item; write them at the end of a drag.
    Number {
        key: String,
        values: Vec<f64>,
        write: bool,
    },
    /// Show the numbers of the material in a row, or of none.
    Material { row: Option<usize> },
    /// Change numbers of the shown material; write them at the end of a drag.
    MaterialNumber {
        key: String,
        values: Vec<f64>,
        write: bool,
    },
    /// Change keys of a track in the scene text.
    Key {
        kind: String,
        name: String,
        key: String,
        change: KeyChange,
    },
    /// Fly along right, up and forward, each -1 to 1, for some seconds.
    Fly { by: [f32; 3], seconds: f32 },
    /// Change a parameter of the script; write it at the end of a drag.
    Parameter {
        name: String,
        value: serde_json::Value,
        write: bool,
    },
}

impl Input {
    /// Moves the camera as the input says; returns whether it moves cameras.
    pub fn moves(&self, camera: &mut CameraControls) -> bool {
        let part = |by: &[f32; 2]| Vec2::from(by.map(|x| x.clamp(-MOST_DRAG, MOST_DRAG)));
        match self {
            Self::Orbit { by } | Self::Drag { by, .. } => camera.orbit(part(by)),
            Self::Look { by } => camera.look(part(by)),
            Self::Pan { by } => camera.pan(part(by)),
            Self::Dolly { notches } => camera.dolly(notches.clamp(-20.0, 20.0)),
            Self::Fly { by, seconds } => {
                let along = Vec3::from(by.map(|x| x.clamp(-1.0, 1.0)));
                camera.fly(along, seconds.clamp(0.0, MOST_FLIGHT_S));
            }
            _ => return false,
        }
        true
    }
}

/// Drags of a viewer without their end: they are shown to all, and would be written at the end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unfinished {
    /// Start of a drag on the picture.
    pub from: Option<[f32; 2]>,
    /// Whether numbers of the selected item are changed.
    pub number: bool,
    /// Key of the number of the shown material that is changed.
    pub material: Option<String>,
    /// Name of the parameter that is changed.
    pub parameter: Option<String>,
}

impl Unfinished {
    /// Follows the inputs of the viewer.
    pub fn hear(&mut self, input: &Input) {
        match input {
            Input::Drag { from, .. } => self.from = Some(*from),
            Input::Drop { .. } => self.from = None,
            Input::Number { write, .. } => self.number = !write,
            Input::MaterialNumber { key, write, .. } => {
                self.material = (!write).then(|| key.clone());
            }
            Input::Parameter { name, write, .. } => {
                self.parameter = (!write).then(|| name.clone());
            }
            _ => {}
        }
    }
}
