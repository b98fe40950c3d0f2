//! What the window and the rendering thread tell each other.

use std::{path::PathBuf, time::Instant};

use super::{frame_texture::FrameTexture, scene_summary::SceneSummary, view_channel::ViewChannel};
use crate::{
    app::{
        live::{Edit, Refusal, Reload},
        params::ParameterOverrides,
        watch::Changes,
    },
    bench::metric::Scores,
    math::Bounds,
    render::stats::FrameStats,
    scene::desc::{CameraDesc, Method},
};

/// One side of the wipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// How reflections are found.
    pub method: Method,
    /// What of the frame.
    pub channel: ViewChannel,
}

/// From where a picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewCamera {
    /// The scene's camera of this name, where it is in the view's frame.
    Through(String),
    /// One that a person moves.
    Free(CameraDesc),
}

/// What the window wants to see.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub camera: ViewCamera,
    /// When: a frame of the timeline.
    pub frame: u32,
    /// Whether frames follow each other by themselves.
    pub plays: bool,
    /// Pixels of the viewport.
    pub size: [u32; 2],
    /// The left side, or all of it.
    pub a: Side,
    /// The right side of a wipe.
    pub b: Option<Side>,
    /// While something moves: one sub-frame, and so few pixels that it takes about this long,
    /// milliseconds.
    pub draft_ms: Option<f64>,
}

impl View {
    /// Whether the same frame is another picture in it.
    pub fn differs_from(&self, other: &Self) -> bool {
        let of = |view: &Self| Self {
            frame: 0,
            plays: false,
            ..view.clone()
        };
        of(self) != of(other)
    }

    /// Whether it shows the same of the scene as another, in whatever size.
    pub fn shows_same_content(&self, other: &Self) -> bool {
        (&self.camera, self.frame, self.a) == (&other.camera, other.frame, other.a)
    }
}

/// Something to do once.
#[derive(Clone, Debug)]
pub enum Task {
    /// Files changed; since when that is known.
    Reload(Changes, Instant),
    /// Tell why saves are seen only now and then; `None` when that is over.
    Unwatched(Option<String>),
    /// Change a material.
    Edit(Edit),
    /// Change the script's parameters.
    SetParameters(ParameterOverrides),
    /// Pick in, compare or save a frame, once it is posed.
    Frame(FrameRequest),
    /// Select no instance.
    Unpick,
}

/// A picture to write.
#[derive(Clone, Debug, PartialEq)]
pub struct Screenshot {
    /// Where its file goes.
    pub folder: PathBuf,
    /// What the file's name begins with.
    pub stem: String,
    /// Where the line of the wipe is, 0 to 1, if the view has two sides.
    pub wipe_at: f32,
    /// Whether the error map is shown in place of the left side.
    pub error_map: bool,
}

/// What is done on demand with the left side of a view, in its frame.
#[derive(Clone, Debug)]
pub struct FrameRequest {
    /// Of what.
    pub view: View,
    /// What is done.
    pub action: FrameAction,
}

/// What can be done with a frame on demand.
#[derive(Clone, Debug)]
pub enum FrameAction {
    /// Compare its method with `rt`; the number comes back with the answer.
    Compare(u64),
    /// Write what is shown of it.
    Screenshot(Screenshot),
    /// Select the instance at this part of the picture, from the top left.
    Pick([f32; 2]),
}

/// A finished frame.
#[derive(Clone, Debug)]
pub struct FinishedFrame {
    /// Counts pictures that were drawn.
    pub number: u64,
    /// Frame of the timeline.
    pub frame: u32,
    /// From where it was taken.
    pub camera: CameraDesc,
    /// The viewport that it was drawn for, pixels.
    pub size: [u32; 2],
    /// The left side, and the right one of a wipe.
    pub sides: Vec<Visualization>,
    /// The selected instance, if it is still there.
    pub picked: Option<Picked>,
}

/// The selected instance in the frame that is shown.
#[derive(Clone, Debug)]
pub struct Picked {
    /// Its name; of several with the same one, also which.
    pub label: String,
    /// Index into the world's materials.
    pub material: usize,
    /// ReportContext it in world space; empty while it is hidden.
    pub bounds: Bounds,
    /// Of its mesh.
    pub triangles: usize,
    /// The line around what is seen of it, as large as the picture; `None` where nothing is.
    pub outline: Option<FrameTexture>,
}

/// One side, drawn.
#[derive(Clone, Debug)]
pub struct Visualization {
    /// What it shows.
    pub channel: ViewChannel,
    /// The picture.
    pub texture: FrameTexture,
    /// Of its frame.
    pub stats: FrameStats,
    /// What its colors mean, or why there is nothing; empty for finished pictures.
    pub legend: String,
}

/// The left side's method against `rt`.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Of what.
    pub view: View,
    /// The number that its task had.
    pub edits: u64,
    /// Whole frame.
    pub scores: Scores,
    /// FLIP per pixel.
    pub error_map: FrameTexture,
}

/// What the rendering thread has to say.
#[derive(Clone, Debug)]
pub enum Report {
    /// The scene is another.
    SceneSummary(Box<SceneSummary>),
    /// What other parameters did.
    ParametersApplied(Reload),
    /// Parameters that do not work.
    Refused(Box<Refusal>),
    /// A reload, and from the first word of it to the new picture, milliseconds.
    Reloaded(Reload, f64),
    /// Since when a script runs that pictures do not wait for; `None` when it has ended.
    ScriptRunning(Option<Instant>),
    /// A frame.
    Frame(Box<FinishedFrame>),
    /// An error map.
    Compared(Box<Comparison>),
    /// What was clicked.
    Picked(Option<Picked>),
    /// No instance is selected any more.
    Unpicked,
    /// Why saves are seen only now and then, and what to do; `None` when that is over.
    Unwatched(Option<String>),
    /// Something to tell in the status line.
    Message(String),
    /// Nothing is left to do.
    Idle,
}
