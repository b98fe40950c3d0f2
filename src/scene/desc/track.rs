//! Tracks of scene text: values that change with time.

mod read;

use glam::Vec3;

pub(crate) use self::read::tracks;
pub(super) use self::read::{shown, track};
use super::At;
use crate::{diagnostic::Span, range::ABOVE_0, table::Table};

/// Tracks, each with the index of its [`Field`](crate::number::Field) in the table of the thing that it
/// changes.
pub type Tracks = Vec<(usize, TrackDesc)>;

declared! {
    /// Shape of a path between its keys.
    #[words]
    pub enum CurveKind = Linear {
        /// holds a key's value until the next.
        Step = "step",
        /// straight lines between keys.
        Linear = "linear",
        /// smooth through all keys, its speed too; may overshoot if keys are spaced unevenly.
        CatmullRom = "catmull_rom",
        /// smooth through all keys, without loops or cusps between them.
        Centripetal = "centripetal",
        /// shaped by the keys' `handle_in` and `handle_out`.
        Bezier = "bezier",
    }

    /// Change of speed between two points of time.
    #[words]
    pub enum Ease = None {
        /// constant speed.
        None = "none",
        /// starts slowly.
        In = "in",
        /// ends slowly.
        Out = "out",
        /// starts and ends slowly.
        InOut = "in_out",
    }

    /// `eye = { … }`, a track of three numbers: `keys` or `follow` replace the value in the thing's own table;
    /// `orbit`, `rate` and `oscillate` are then added to it, in this order.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct TrackDesc {
        /// Values at points of time, at least one. Before the first key and after the last one their values are
        /// held.
        pub keys: Vec<KeyDesc>,
        /// Shape of the path between keys. Default `"linear"`.
        pub curve: CurveKind,
        /// Change of speed from the first key to the last. Default `"none"`.
        pub ease: Ease,
        /// Length of a loop, from the first key back to it, seconds, above 0 and after the last key. The loop runs
        /// for ever, before the first key too. Default: no loop.
        pub loop_s: Option<f32>,
        /// Whether the path is followed at constant speed, by arc length. Then only the times of the first and the
        /// last key count, and the `ease` of the track, none of a key. Default false.
        pub constant_speed: bool,
        /// Takes the position from an instance or a group, wherever that moves.
        pub follow: Option<FollowDesc>,
        /// Moves the position on a circle around an axis.
        pub orbit: Option<OrbitDesc>,
        /// Steady change per second, from time 0 on.
        pub rate: Option<Vec3>,
        /// Swings the value to and fro as a sine wave.
        pub oscillate: Option<OscillateDesc>,
    }

    /// `roughness = { … }`, a track of one number: `keys` replace the value in the thing's own table; `rate` and
    /// `oscillate` are then added to it.
    pub struct NumberTrackDesc;

    /// `uv_scale = { … }`, a track of two numbers: `keys` replace the value in the thing's own table; `rate` and
    /// `oscillate` are then added to it.
    pub struct PairTrackDesc;

    /// `scale = { … }`, a track of one number for all three axes or of three: `keys` replace the value in the
    /// thing's own table; `rate` and `oscillate` are then added to it.
    pub struct ScaleTrackDesc;

    /// `base_color = { … }`, a track of a color: `keys` replace the value in the thing's own table, mixed in linear
    /// light; `rate` and `oscillate` are then added to it.
    pub struct ColorTrackDesc;

    /// `shown = { keys = [{ at_s = 0, value = false }, { at_s = 2, value = true }] }`: times at which an
    /// instance, group or decal is shown or hidden.
    ///
    /// - `keys`: times from which on it is shown (`true`) or hidden (`false`), at least one; the first value also
    ///   holds before its time.
    /// - `loop_s`: length of a loop, from the first key back to it, seconds, above 0 and after the last key. The
    ///   loop runs for ever, before the first key too. Default: no loop.
    pub struct ShownTrackDesc(TrackDesc);

    /// `keys = [{ at_s = 0, value = true }, …]`, in the order of time.
    ///
    /// - `at_s`: time of the key, seconds; later than the key before.
    /// - `value`: whether the instance, group or decal is shown from this time on.
    pub struct ShownKeyDesc(KeyDesc);

    /// `keys = [{ at_s = 0, value = [0, 1, 5] }, …]`, in the order of time.
    #[derive(Clone, Debug, PartialEq)]
    pub struct KeyDesc {
        /// Time of the key, seconds; later than the key before.
        pub at_s: f32,
        /// Value at this time.
        pub value: Vec3,
        /// Change of speed from this key to the next. Default `"none"`; any other does not go with
        /// `constant_speed`.
        pub ease: Ease,
        /// For `"bezier"`: control point before the key, relative to the key. Default: a third of the way to the
        /// key before.
        pub handle_in: Option<Vec3>,
        /// For `"bezier"`: control point after the key, relative to the key. Default: a third of the way to the
        /// next key.
        pub handle_out: Option<Vec3>,
        /// Place of the key in scene text.
        pub at: Span,
    }

    /// `keys = [{ at_s = 0, value = 0.5 }, …]`, in the order of time.
    pub struct NumberKeyDesc;

    /// `keys = [{ at_s = 0, value = [1, 1] }, …]`, in the order of time.
    pub struct PairKeyDesc;

    /// `keys = [{ at_s = 0, value = 1.5 }, …]`, in the order of time.
    pub struct ScaleKeyDesc;

    /// `keys = [{ at_s = 0, value = "#ff8000" }, …]`, in the order of time.
    pub struct ColorKeyDesc;

    /// `follow = { instance = "car", offset = [0, 1, 0] }`: takes the position from an instance or a group.
    #[derive(Clone, Debug, PartialEq)]
    #[table("follow = { … }", refers(instance: "instance" | "group"))]
    pub struct FollowDesc {
        /// `name` of the instance or the group to follow.
        pub instance: At<String>,
        /// Point in the instance's model space, meters, that is followed; it turns and grows with the instance.
        /// Default [0, 0, 0].
        pub offset: Vec3 = Vec3::ZERO,
    }

    /// `orbit = { center = [0, 1, 0], period_s = 8 }`: turns the position about an axis.
    #[derive(Clone, Debug, PartialEq)]
    #[table("orbit = { … }", check(Self::check))]
    pub struct OrbitDesc {
        /// Point on the axis, meters. Default [0, 0, 0].
        pub center: Vec3 = Vec3::ZERO,
        /// Direction of the axis, not 0; the turn is counterclockwise when the axis points at the viewer. Default
        /// [0, 1, 0].
        pub axis: Vec3 = Vec3::Y,
        /// Time of one turn, seconds, above 0: more is slower.
        pub period_s: f32 [ABOVE_0],
        /// Angle at time 0, in turns: 0.25 is a quarter turn ahead. Default 0.
        pub phase: f32 = 0.0,
    }

    /// `oscillate = { amplitude = [0, 0, 20], period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
    #[derive(Clone, Debug, PartialEq)]
    pub struct OscillateDesc {
        /// Largest distance from the middle value, to both sides.
        pub amplitude: Vec3,
        /// Time of one swing to and fro, seconds, above 0: more is slower.
        pub period_s: f32,
        /// Phase at time 0, in swings: 0.25 begins at the largest value. Default 0.
        pub phase: f32,
    }

    /// `oscillate = { amplitude = 0.2, period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
    pub struct NumberOscillateDesc;

    /// `oscillate = { amplitude = [0.2, 0], period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
    pub struct PairOscillateDesc;

    /// `oscillate = { amplitude = 0.2, period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
    pub struct ScaleOscillateDesc;

    /// `oscillate = { amplitude = [0.2, 0, 0], period_s = 2 }`: adds `amplitude * sin(2π (t / period_s + phase))`.
    pub struct ColorOscillateDesc;
}

impl OrbitDesc {
    fn check(&self, t: &mut Table) {
        if t.has("axis") && self.axis == Vec3::ZERO {
            let help = "write `axis = [0, 1, 0]` for a horizontal orbit";
            t.refuse("zero-direction", "axis", "`axis` must not be zero", help);
        }
    }
}
