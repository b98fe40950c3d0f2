//! What changes with time, as people write it: the frames of a film, what moves in it, and the
//! parameters of its script.

use super::{At, CameraMotionDesc, Entry, LightMotionDesc, MaterialMotionDesc, TrackDesc};

/// `[timeline]`: the frames of a film.
///
/// - `cuts`: which camera is shown from which frame on, where none is chosen by `--camera`. Before the
///   first cut it is the one without cuts: `main`, else the first.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineDesc {
    /// Frames a second, above 0 and at most 1000. Frame F shows the time F / fps. Default 24.
    pub fps: f32,
    /// First frame, 0 to 1000000. Default 0.
    pub start: u32,
    /// Last frame, itself shown, 0 to 1000000; not before `start`.
    pub end: u32,
}

/// `cuts = [{ frame = 48, camera = "close" }, …]`, in the order of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct CutDesc {
    /// From which frame on, 0 to 1000000.
    pub frame: u32,
    /// Name of the camera that is shown from there on.
    pub camera: At<String>,
}

/// `[motion]`: what moves, by name; what has no motion keeps the value of its own table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionDesc {
    /// `camera.NAME`: paths of a camera.
    pub cameras: Vec<Entry<CameraMotionDesc>>,
    /// `instance.NAME`: motion of an instance, by its `name`, which is dynamic then, and changing
    /// numbers of its own `material`.
    pub instances: Vec<Entry<InstanceMotionDesc>>,
    /// `group.NAME`: motion of a group, and with it of what hangs on it.
    pub groups: Vec<Entry<InstanceMotionDesc>>,
    /// `light.NAME`: motion of a light.
    pub lights: Vec<Entry<LightMotionDesc>>,
    /// `material.NAME`: changing numbers of a `[material.NAME]`.
    pub materials: Vec<Entry<MaterialMotionDesc>>,
    /// `model.NAME`: changing numbers of the materials inside a model's file.
    pub models: Vec<Entry<ModelMotionDesc>>,
}

impl MotionDesc {
    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.cameras.is_empty()
            && self.instances.is_empty()
            && self.groups.is_empty()
            && self.lights.is_empty()
            && self.materials.is_empty()
            && self.models.is_empty()
    }
}

/// `[motion.instance.NAME]`: `translation`, `rotation_deg` and `scale` are of an instance that is
/// placed by these or `rotation_quat`, not by `matrix`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InstanceMotionDesc {
    /// Track of where the model's origin goes, meters.
    pub translation: Option<TrackDesc>,
    /// Track of the turn, degrees about X, then Y, then Z, all fixed axes. Without `keys` it is
    /// applied before the instance's own rotation, so about the model's own axes.
    pub rotation_deg: Option<TrackDesc>,
    /// Track of the factor on the model's size, or of three; must not pass 0, but by a `"step"`.
    pub scale: Option<TrackDesc>,
    /// When it is there. Hidden, it is not, for the camera, for light and for reflections. Default: always.
    pub shown: Option<TrackDesc>,
    /// Changing numbers of its own `material = { … }`, which it must have and which may be empty;
    /// what that leaves open begins at what is below it.
    pub material: Option<MaterialMotionDesc>,
}

impl InstanceMotionDesc {
    /// Whether it is more than its material that changes.
    pub fn moves(&self) -> bool {
        self.material.is_none() || self.shown.is_some() || self.is_placed_by_tracks()
    }

    /// Whether its place changes.
    pub fn is_placed_by_tracks(&self) -> bool {
        let tracks = [&self.translation, &self.rotation_deg, &self.scale];
        tracks.iter().any(|track| track.is_some())
    }
}

/// `[motion.group.NAME]`: `translation`, `rotation_deg` and `scale` are of a group that is placed by
/// these or `rotation_quat`, not by `matrix`.
///
/// - `translation`: track of where the group's origin goes, meters.
/// - `rotation_deg`: track of the turn, degrees about X, then Y, then Z, all fixed axes. Without `keys`
///   it is applied before the group's own rotation, so about its own axes.
/// - `scale`: track of the factor on what hangs on it, or of three; must not pass 0, but by a `"step"`.
/// - `shown`: when what hangs on it is there. Hidden, it is not, for the camera, for light and for
///   reflections, and lights that hang on it are dark. Default: always.
pub struct GroupMotionDesc;

/// `[motion.model.NAME]`: of a model with a `file`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelMotionDesc {
    /// `material.NAME`: changing numbers of the file's material of that name, or of all of them as
    /// `"*"`, over what `[model.M.material.NAME]` says; an instance's own `material` wins.
    pub materials: Vec<Entry<MaterialMotionDesc>>,
}

/// A parameter of the scene's script.
#[derive(Clone, Debug, PartialEq)]
pub enum ParamValue {
    /// A number written without a point.
    Integer(i64),
    /// A number written with one.
    Number(f64),
    /// `true` or `false`.
    Switch(bool),
    /// Text.
    Text(String),
    /// An array of numbers.
    Numbers(Vec<f64>),
}
