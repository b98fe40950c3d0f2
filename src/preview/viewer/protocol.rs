//! Messages between the window and the rendering thread.

use std::{path::PathBuf, sync::mpsc::Sender, time::Instant};

use super::{frame_texture::FrameTexture, scene_summary::SceneSummary, view_channel::ViewChannel};
use crate::{
    live::{Edit, Refusal, Reload},
    watch::Changes,
    write_back::{FlightPoint, Inspected, KeyEdit, Numbers, SceneItem, outline::LeftOut},
};
use reflet_base::math::Bounds;
use reflet_metric::Scores;
use reflet_render::{renderer::stats::FrameStats, runtime::parameters::ParameterOverrides};
use reflet_scene::desc::{CameraDesc, Method};

/// Contents of one side of the wipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// Reflection method; `auto` is decided as in `render`.
    pub method: Method,
    /// Displayed channel.
    pub channel: ViewChannel,
}

/// Camera of a view.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewCamera {
    /// The scene's camera of this name, posed for the view's frame.
    Scene(String),
    /// Free camera, moved by the user.
    Free(CameraDesc),
}

/// A requested picture.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Camera.
    pub camera: ViewCamera,
    /// Name of the scene's camera that was chosen, whose view decides what is `auto`, also in free flight; `None`
    /// while the cuts choose.
    pub chosen: Option<String>,
    /// Frame of the timeline.
    pub frame: u32,
    /// Whether the timeline is playing.
    pub plays: bool,
    /// Viewport size, pixels.
    pub size: [u32; 2],
    /// Left side, or the whole picture.
    pub a: Side,
    /// Right side of a wipe.
    pub b: Option<Side>,
    /// Time budget while something moves: one sub-frame, and the resolution is reduced to meet it,
    /// milliseconds.
    pub draft_ms: Option<f64>,
    /// Time budget of the first picture at rest, milliseconds; further ones follow until all samples are there.
    pub rest_ms: f64,
    /// Things that are left out.
    pub left_out: LeftOut,
    /// Sub-frames of a picture in place of the scene's number.
    pub samples: Option<u32>,
    /// Whether pictures at rest are denoised, where there is a denoiser.
    pub denoises: bool,
}

impl View {
    /// Whether anything but the time differs.
    pub fn differs_from(&self, other: &Self) -> bool {
        let of = |view: &Self| Self {
            frame: 0,
            plays: false,
            ..view.clone()
        };
        of(self) != of(other)
    }

    /// Whether camera, frame and left side are equal, at any size.
    pub fn shows_same_content(&self, other: &Self) -> bool {
        (&self.camera, self.frame, self.a) == (&other.camera, other.frame, other.a)
    }
}

/// A one-time task for the rendering thread.
#[derive(Clone, Debug, PartialEq)]
pub enum Task {
    /// Files changed; with the time of the first event.
    Reload(Changes, Instant),
    /// File watching is limited, and why; `None` once it works again.
    Unwatched(Option<String>),
    /// Change a material.
    Edit(Box<Edit>),
    /// Change the script's parameters.
    SetParameters(ParameterOverrides),
    /// Pick in, compare or save a frame, once it is posed.
    Frame(Box<FrameRequest>),
    /// Clear the selection.
    Unpick,
    /// Select an item of the scene.
    Select(SceneItem),
    /// Show an item with other numbers during a drag.
    Drag(SceneItem, Numbers),
    /// Show the numbers of the scene text again: a drag has ended without an end.
    DropDrag,
    /// Write numbers of an item into the scene text.
    Write(SceneItem, Numbers),
    /// Write a number of a material, by its index, into the scene text.
    WriteMaterial(usize, Numbers),
    /// Write values of parameters into the scene text, once they are shown.
    WriteParameters(ParameterOverrides),
    /// Change keys of a track in the scene text.
    Key(KeyEdit),
    /// Write a flight of the camera of this name as keys into the scene text.
    Flight(String, Vec<FlightPoint>),
    /// Undo the last written edit (`false`), or redo the last undone one (`true`).
    Undo(bool),
}

impl Task {
    /// Whether it changes a text of the scene.
    pub fn writes(&self) -> bool {
        matches!(
            self,
            Self::Write(..)
                | Self::WriteMaterial(..)
                | Self::WriteParameters(_)
                | Self::Key(_)
                | Self::Flight(..)
                | Self::Undo(_)
        )
    }
}

/// Where a screenshot goes.
#[derive(Clone, Debug, PartialEq)]
pub enum ScreenshotGoal {
    /// A new file in a folder, whose name has this prefix.
    File {
        /// Destination folder.
        folder: PathBuf,
        /// Prefix of the file name.
        stem: String,
    },
    /// Whoever asked.
    Reply(Reply),
}

/// Takes the bytes of a PNG file, or why there are none. No two are equal.
#[derive(Clone, Debug)]
pub struct Reply(pub Sender<Result<Vec<u8>, String>>);

impl PartialEq for Reply {
    fn eq(&self, _: &Self) -> bool {
        false
    }
}

/// A screenshot to write.
#[derive(Clone, Debug, PartialEq)]
pub struct Screenshot {
    /// Where it goes.
    pub goal: ScreenshotGoal,
    /// Position of the wipe line, 0 to 1, if the view has two sides.
    pub wipe_at: f32,
    /// Whether the error map replaces the left side.
    pub error_map: bool,
}

/// An action on the left side of a view, in its frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameRequest {
    /// The view.
    pub view: View,
    /// The action.
    pub action: FrameAction,
}

/// An action on a rendered frame.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameAction {
    /// Compare its method with `rt`; the revision number is returned with the result.
    Compare(u64),
    /// Write a screenshot.
    Screenshot(Screenshot),
    /// Select the instance at this position, 0 to 1 from the top left.
    Pick([f32; 2]),
}

/// A finished frame.
#[derive(Clone, Debug)]
pub struct FinishedFrame {
    /// Running number of rendered pictures.
    pub number: u64,
    /// Number of saves since the start that it shows.
    pub saves: u64,
    /// Frame of the timeline.
    pub frame: u32,
    /// Camera that it was rendered with.
    pub camera: CameraDesc,
    /// Viewport size that it was rendered for, pixels.
    pub size: [u32; 2],
    /// Whether it was rendered within the time budget of something that moves.
    pub is_draft: bool,
    /// Left side, and the right side of a wipe.
    pub sides: Vec<Visualization>,
    /// The selected instance, if it still exists.
    pub picked: Option<Picked>,
}

/// The selected instance in the displayed frame.
#[derive(Clone, Debug)]
pub struct Picked {
    /// Name of the instance, with a number where several share it.
    pub label: String,
    /// Index into the world's materials.
    pub material: usize,
    /// World-space bounds; empty while it is hidden.
    pub bounds: Bounds,
    /// Triangle count of its mesh; `None` for an exact sphere or capsule.
    pub triangles: Option<usize>,
    /// Outline of its visible part, at the picture's size; `None` where it is not visible.
    pub outline: Option<FrameTexture>,
}

/// One side, rendered.
#[derive(Clone, Debug)]
pub struct Visualization {
    /// Displayed channel.
    pub channel: ViewChannel,
    /// The picture.
    pub texture: FrameTexture,
    /// Statistics of its frame.
    pub stats: FrameStats,
    /// Legend of its colors, or why it is empty; empty text for finished pictures.
    pub legend: String,
}

/// Comparison of the left side's method with `rt`.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The view.
    pub view: View,
    /// Revision number of the request.
    pub edits: u64,
    /// Scores of the whole frame.
    pub scores: Scores,
    /// FLIP per pixel, as colors.
    pub error_map: FrameTexture,
}

/// Value of the picture at a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PixelValue {
    /// Name of the value: an AOV as in `--aov`, `pixel` or `shown`.
    pub name: &'static str,
    /// Text of the value, with its unit.
    pub text: String,
}

/// A report of the rendering thread.
#[derive(Clone, Debug)]
pub enum Report {
    /// The scene changed.
    SceneSummary(Box<SceneSummary>),
    /// Result of new script parameters.
    ParametersApplied(Reload),
    /// Script parameters were rejected.
    Refused(Box<Refusal>),
    /// A reload, and the time from the file event to the new picture, milliseconds.
    Reloaded(Reload, f64),
    /// Start of a script that runs in the background; `None` once it has ended.
    ScriptRunning(Option<Instant>),
    /// A finished frame.
    Frame(Box<FinishedFrame>),
    /// A finished comparison.
    Compared(Box<Comparison>),
    /// Result of a pick.
    Picked(Option<Picked>),
    /// Values of the clicked pixel.
    Pixel(Vec<PixelValue>),
    /// The selection was cleared.
    Unpicked,
    /// The selected item, as in the scene text; `None` for an instance that the text does not place.
    Inspected(Option<Box<Inspected>>),
    /// File watching is limited, why, and what to do; `None` once it works again.
    Unwatched(Option<String>),
    /// A message for the status line.
    Message(String),
    /// The queue is empty.
    Idle,
}
