//! Tracks as people write them: how a value changes with time.

use glam::Vec3;

use super::At;
use crate::scene::diagnostic::Span;

/// Which of a table of [`Field`](crate::scene::number::Field)s, and how it changes.
pub type Tracks = Vec<(usize, TrackDesc)>;

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

/// `shown = { keys = [{ at_s = 0, value = false }, { at_s = 2, value = true }] }`: whether something is there.
///
/// - `keys`: from when on it is there, or not, at least one; the first also holds before its time.
/// - `loop_s`: seconds after which it starts over, above 0 and after the last key; for ever and before the
///   first key too. Default: no loop.
pub struct ShownTrackDesc;

/// `keys = [{ at_s = 0, value = true }, …]`, in the order of time.
///
/// - `at_s`: when, seconds; later than the key before.
/// - `value`: whether it is there from then on.
pub struct ShownKeyDesc;

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
    /// `name` of an instance or a group.
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
