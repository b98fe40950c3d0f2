//! What changes with time, as people write it: the frames of a film, and the tracks that move
//! cameras, instances, lights and materials.

use glam::Vec3;

use super::{At, Entry};
use crate::scene::diagnostic::Span;

/// `[timeline]`: the frames of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineDesc {
    /// Frames a second, above 0 and at most 1000. Frame F shows the time F / fps. Default 24.
    pub fps: f32,
    /// First frame, 0 to 1000000. Default 0.
    pub start: u32,
    /// Last frame, itself shown, 0 to 1000000; not before `start`.
    pub end: u32,
}

/// `[motion]`: what moves, by name; what has no motion keeps the value of its own table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotionDesc {
    /// `camera.NAME`: paths of a camera.
    pub cameras: Vec<Entry<CameraMotionDesc>>,
    /// `instance.NAME`: motion of an instance, by its `name`, which is dynamic then, and changing
    /// numbers of its own `material`.
    pub instances: Vec<Entry<InstanceMotionDesc>>,
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
            && self.lights.is_empty()
            && self.materials.is_empty()
            && self.models.is_empty()
    }
}

/// Which of a table of [`Field`](crate::scene::motion::number::Field)s, and how it changes.
pub type Tracks = Vec<(usize, TrackDesc)>;

/// `[motion.camera.NAME]`
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraMotionDesc {
    /// - `eye`: track of the position, meters.
    /// - `target`: track of the point looked at, meters; `{ follow = { instance = "car" } }` looks
    ///   at an instance.
    /// - `up`: track of the direction that is up in the picture.
    /// - `fov_deg`: track of the vertical field of view, degrees, 1 to 170.
    /// - `near_m`: track of the nearest visible distance, meters, above 0.
    pub tracks: Tracks,
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
    /// Changing numbers of its own `material = { … }`, which it must have and which may be empty;
    /// what that leaves open begins at what is below it.
    pub material: Option<MaterialMotionDesc>,
}

impl InstanceMotionDesc {
    /// Whether it is more than its material that changes.
    pub fn moves(&self) -> bool {
        let tracks = [&self.translation, &self.rotation_deg, &self.scale];
        self.material.is_none() || tracks.iter().any(|track| track.is_some())
    }
}

/// `[motion.light.NAME]`: only what the light's `kind` has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightMotionDesc {
    /// - `position`: track of where it stands, meters.
    /// - `direction`: track of the direction in which it shines, of any length but 0.
    /// - `target`: track of the point that a spot's middle meets, meters; in place of `direction`.
    /// - `intensity_cd`: track of the luminous intensity, candela, 0 or more.
    /// - `intensity_lux`: track of the illuminance of a directional light, lux, 0 or more.
    /// - `color`: track of the linear color, 0 or more.
    /// - `inner_deg`: track of the half angle of a spot that is fully lit, degrees, 0 to
    ///   `outer_deg`.
    /// - `outer_deg`: track of the half angle where a spot ends, degrees, above 0 and below 90.
    pub tracks: Tracks,
}

/// `[motion.material.NAME]`: numbers of a `[material.NAME]`, wherever it is used. What a track
/// reaches beyond a number's range is cut off there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialMotionDesc {
    /// - `base_color`: track of the linear base color, 0 to 1.
    /// - `metallic`: track of the metalness, 0 to 1.
    /// - `roughness`: track of the perceptual roughness, 0 to 1.
    /// - `normal_scale`: track of the strength of the normal map, 0 to 4.
    /// - `occlusion_strength`: track of the strength of the file's occlusion map, 0 to 1.
    /// - `emission`: track of the linear emitted color, 0 or more.
    /// - `emission_strength`: track of the factor on `emission`, 0 or more.
    /// - `uv_scale`: track of the texture repetitions, two numbers.
    /// - `alpha_cutoff`: track of the alpha below which it is cut out, 0 to 1; the material's own
    ///   table must have an `alpha_cutoff`, which may be 0.
    /// - `reflectivity`: track of the specular reflectance at normal incidence, 0 to 1.
    /// - `checker_a`: track of the first color of its `checker`, 0 to 1.
    /// - `checker_b`: track of the second color of its `checker`, 0 to 1.
    /// - `checker_size_m`: track of the edge of a cell of its `checker`, meters, above 0.
    pub tracks: Tracks,
}

/// `[motion.model.NAME]`: of a model with a `file`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModelMotionDesc {
    /// `material.NAME`: changing numbers of the file's material of that name, or of all of them as
    /// `"*"`, over what `[model.M.material.NAME]` says; an instance's own `material` wins.
    pub materials: Vec<Entry<MaterialMotionDesc>>,
}

/// How a path runs between its keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurveKind {
    /// `"step"`: keeps a key's value until the next.
    Step,
    /// `"linear"`: straight pieces.
    #[default]
    Linear,
    /// `"catmull_rom"`: smooth through all keys, its speed too; may overshoot where keys lie unevenly.
    CatmullRom,
    /// `"centripetal"`: smooth through all keys, without loops or cusps between them.
    Centripetal,
    /// `"bezier"`: shaped by the keys' `handle_in` and `handle_out`.
    Bezier,
}

/// How time passes on the way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ease {
    /// `"none"`: evenly.
    #[default]
    None,
    /// `"in"`: starts slowly.
    In,
    /// `"out"`: ends slowly.
    Out,
    /// `"in_out"`: starts and ends slowly.
    InOut,
}

/// `eye = { … }`, a track of three numbers: `keys` or `follow` replace the value of the thing's own
/// table; `orbit`, `rate` and `oscillate` are then added to it, in this order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrackDesc {
    /// Values at points of time, at least one; held before the first and after the last.
    pub keys: Vec<KeyDesc>,
    /// How the path runs between keys. Default `"linear"`.
    pub curve: CurveKind,
    /// How time passes from the first key to the last. Default `"none"`.
    pub ease: Ease,
    /// Seconds after which the path is back at its first key, above 0 and after the last key; it
    /// then starts over, for ever and before the first key too. Default: no loop.
    pub loop_s: Option<f32>,
    /// Whether the way is covered at constant speed, by arc length; only the first and the last
    /// key's times count then, and the track's `ease`, none of a key. Default false.
    pub constant_speed: bool,
    /// Takes the position from an instance, wherever that moves.
    pub follow: Option<FollowDesc>,
    /// Circles around a center.
    pub orbit: Option<OrbitDesc>,
    /// Steady change per second, from time 0.
    pub rate: Option<Vec3>,
    /// Swings to and fro.
    pub oscillate: Option<OscillateDesc>,
}

/// `roughness = { … }`, a track of one number: `keys` replace the value of the thing's own table;
/// `rate` and `oscillate` are then added to it.
pub struct NumberTrackDesc;

/// `uv_scale = { … }`, a track of two numbers: `keys` replace the value of the thing's own table;
/// `rate` and `oscillate` are then added to it.
pub struct PairTrackDesc;

/// `scale = { … }`, a track of one number for all three axes or of three: `keys` replace the value of
/// the thing's own table; `rate` and `oscillate` are then added to it.
pub struct ScaleTrackDesc;

/// `keys = [{ at_s = 0, value = [0, 1, 5] }, …]`, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyDesc {
    /// When, seconds; later than the key before.
    pub at_s: f32,
    /// The value then.
    pub value: Vec3,
    /// How time passes from here to the next key. Default `"none"`; any other does not go with
    /// `constant_speed`.
    pub ease: Ease,
    /// For `"bezier"`: control point before the key, relative to it. Default: a third of the way to
    /// the key before.
    pub handle_in: Option<Vec3>,
    /// For `"bezier"`: control point after the key, relative to it. Default: a third of the way to
    /// the next key.
    pub handle_out: Option<Vec3>,
    /// Where the key is written.
    pub at: Span,
}

/// `keys = [{ at_s = 0, value = 0.5 }, …]`, in the order of time.
pub struct NumberKeyDesc;

/// `keys = [{ at_s = 0, value = [1, 1] }, …]`, in the order of time.
pub struct PairKeyDesc;

/// `keys = [{ at_s = 0, value = 1.5 }, …]`, in the order of time.
pub struct ScaleKeyDesc;

/// `follow = { instance = "car", offset = [0, 1, 0] }`
#[derive(Clone, Debug, PartialEq)]
pub struct FollowDesc {
    /// `name` of an instance.
    pub instance: At<String>,
    /// A point of that instance's model space, meters, so it turns and grows with it. Default [0, 0, 0].
    pub offset: Vec3,
}

/// `orbit = { center = [0, 1, 0], period_s = 8 }`: turns the position about an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct OrbitDesc {
    /// A point of the axis, meters. Default [0, 0, 0].
    pub center: Vec3,
    /// Direction of the axis, not 0; counter-clockwise seen against it. Default [0, 1, 0].
    pub axis: Vec3,
    /// Seconds of one turn, above 0.
    pub period_s: f32,
    /// Where it begins, in turns. Default 0.
    pub phase: f32,
}

/// `oscillate = { amplitude = [0, 0, 20], period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
#[derive(Clone, Debug, PartialEq)]
pub struct OscillateDesc {
    /// Farthest it goes, to both sides.
    pub amplitude: Vec3,
    /// Seconds of one swing to and fro, above 0.
    pub period_s: f32,
    /// Where it begins, in swings. Default 0.
    pub phase: f32,
}

/// `oscillate = { amplitude = 0.2, period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
pub struct NumberOscillateDesc;

/// `oscillate = { amplitude = [0.2, 0], period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
pub struct PairOscillateDesc;

/// `oscillate = { amplitude = 0.2, period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
pub struct ScaleOscillateDesc;

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
