//! Keyframes of a file's nodes and their evaluation: glTF 2.0 §3.11 and its appendix C.

mod tracks;

use std::sync::Arc;

use glam::{Affine3A, DQuat, DVec4, Quat, Vec3};
use serde::Serialize;

pub use self::tracks::{Pointed, PointedValue, PointerTrack, WeightTrack};
use reflet_base::math::spline::hermite;

/// Animated property of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Property {
    /// Translation, meters.
    Translation,
    /// Rotation, a quaternion x, y, z, w.
    Rotation,
    /// Scale, a factor along each axis.
    Scale,
    /// Visibility of the node and its children; they are visible where the value is not 0.
    Visible,
}

/// Interpolation between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Step: the value of the previous key.
    Step,
    /// Linear; slerp along the shorter arc for rotations.
    Linear,
    /// Cubic Hermite spline.
    Cubic,
}

impl Interpolation {
    /// Number of values per key: 3 for a spline (in-tangent, value, out-tangent), else 1.
    pub fn values_per_key(self) -> usize {
        match self {
            Self::Cubic => 3,
            Self::Step | Self::Linear => 1,
        }
    }
}

/// Keyframes of one value, which is constant before the first and after the last key; clones share them.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampler {
    /// Times of the keys, seconds, increasing; at least one.
    pub times_s: Arc<[f32]>,
    /// Value of each key; for [`Interpolation::Cubic`] three per key: in-tangent, value, out-tangent.
    pub values: Arc<[DVec4]>,
    /// Interpolation between keys.
    pub interpolation: Interpolation,
}

/// Time by which steps come early, seconds, less than any frame lasts: keys and the begin of playback are rounded to
/// single precision, and a step at the time of a frame is part of that frame.
const STEP_EARLY_S: f64 = 1e-4;

impl Sampler {
    /// The value of a key.
    fn key(&self, index: usize) -> DVec4 {
        match self.interpolation {
            Interpolation::Cubic => self.values[3 * index + 1],
            _ => self.values[index],
        }
    }

    /// The value at a time, seconds; a rotation is normalized.
    pub fn value_at(&self, time_s: f64, property: Property) -> DVec4 {
        let last = self.times_s.len() - 1;
        let reached_s = match self.interpolation {
            Interpolation::Step => time_s + STEP_EARLY_S,
            _ => time_s,
        };
        let next = self.times_s.partition_point(|t| f64::from(*t) <= reached_s);
        let before = next.saturating_sub(1);
        let value = if next == 0 || next > last {
            self.key(before)
        } else {
            self.between(before, time_s, property)
        };
        if property != Property::Rotation {
            return value;
        }
        let unit = value.try_normalize();
        unit.unwrap_or_else(|| self.key(before).normalize_or(DVec4::W))
    }

    fn between(&self, before: usize, time_s: f64, property: Property) -> DVec4 {
        let [start, end] = [before, before + 1].map(|i| f64::from(self.times_s[i]));
        let (span, u) = (end - start, (time_s - start) / (end - start));
        let (a, b) = (self.key(before), self.key(before + 1));
        match self.interpolation {
            Interpolation::Step => a,
            Interpolation::Linear if property == Property::Rotation => slerp(a, b, u),
            Interpolation::Linear => a.lerp(b, u),
            Interpolation::Cubic => {
                // Tangents are per second (appendix C.5).
                let (out, into) = (self.values[3 * before + 2], self.values[3 * before + 3]);
                hermite(a, out * span, b, into * span, u)
            }
        }
    }
}

/// Slerp along the shorter arc (appendix C.4).
fn slerp(a: DVec4, b: DVec4, u: f64) -> DVec4 {
    let cos = a.dot(b);
    let b = if cos < 0.0 { -b } else { b };
    let angle = cos.abs().min(1.0).acos();
    if angle < 1e-6 {
        return a.lerp(b, u);
    }
    (a * (angle * (1.0 - u)).sin() + b * (angle * u).sin()) / angle.sin()
}

/// One property of one node over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Index of the node in its file.
    pub node: usize,
    /// Animated property.
    pub property: Property,
    /// Keyframes.
    pub sampler: Sampler,
}

/// An animation of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation {
    /// Channels.
    pub channels: Vec<Channel>,
    /// Animated weights of morph targets.
    pub weights: Vec<WeightTrack>,
    /// Animated values of materials, lights and cameras (KHR_animation_pointer).
    pub pointers: Vec<PointerTrack>,
    /// Time of the last key of all samplers, seconds.
    pub duration_s: f32,
}

impl Animation {
    /// An animation of these channels, weights and values.
    pub fn new(
        channels: Vec<Channel>,
        weights: Vec<WeightTrack>,
        pointers: Vec<PointerTrack>,
    ) -> Self {
        let of_weights = weights.iter().filter_map(|track| track.samplers.first());
        let of_pointers = pointers.iter().map(|track| &track.sampler);
        let samplers = channels.iter().map(|c| &c.sampler);
        let samplers = samplers.chain(of_weights).chain(of_pointers);
        let ends = samplers.filter_map(|sampler| sampler.times_s.last());
        Self {
            duration_s: ends.copied().fold(0.0, f32::max),
            channels,
            weights,
            pointers,
        }
    }
}

/// An animation of a file, played or not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Listed {
    /// Name of the `[model.NAME]`.
    pub model: String,
    /// Name of the animation in scene text.
    pub name: String,
    /// Time of the animation's last key, seconds; 0 for a broken animation.
    pub duration_s: f32,
    /// Number of animated properties; 0 for a broken animation.
    pub channels: usize,
    /// Whether some instance plays the animation.
    pub played: bool,
}

/// Transform of a node at rest, from the node's space to its parent's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Local {
    /// Scale first, then rotate, then translate.
    Trs {
        /// Translation, meters.
        translation: Vec3,
        /// Rotation, a unit quaternion.
        rotation: Quat,
        /// Scale factor along each axis.
        scale: Vec3,
    },
    /// Any affine transform.
    Matrix(Affine3A),
}

impl Local {
    /// The transform from the node's space to its parent's.
    pub fn transform(&self) -> Affine3A {
        match *self {
            Self::Trs {
                translation,
                rotation,
                scale,
            } => Affine3A::from_scale_rotation_translation(scale, rotation, translation),
            Self::Matrix(matrix) => matrix,
        }
    }

    /// Replaces one component; a matrix is decomposed first and loses its shear.
    pub fn set(&mut self, property: Property, value: DVec4) {
        if let Self::Matrix(matrix) = self {
            let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
            *self = Self::Trs {
                translation,
                rotation,
                scale,
            };
        }
        let Self::Trs {
            translation,
            rotation,
            scale,
        } = self
        else {
            return;
        };
        match property {
            Property::Translation => *translation = value.truncate().as_vec3(),
            Property::Rotation => *rotation = DQuat::from_vec4(value).as_quat(),
            Property::Scale => *scale = not_flat(value.truncate().as_vec3()),
            Property::Visible => {}
        }
    }
}

/// Least scale along an axis, relative to the largest.
const THINNEST: f32 = 1e-5;

/// Replaces a scale of 0 along some axes, which is singular, by a tiny one. A scale of 0 along all axes hides the
/// node and stays.
pub fn not_flat(scale: Vec3) -> Vec3 {
    let least = scale.abs().max_element() * THINNEST;
    let thick = |x: f32| {
        if x.abs() < least {
            least.copysign(x)
        } else {
            x
        }
    };
    Vec3::from_array(scale.to_array().map(thick))
}

/// Replaces a column of (nearly) 0 as [`not_flat`] does, by one at a right angle to the other two.
pub fn not_flat_matrix(mut matrix: Affine3A) -> Affine3A {
    let m = &mut matrix.matrix3;
    let longest = [0, 1, 2].map(|i| m.col(i).length());
    let longest = longest.into_iter().fold(0.0, f32::max);
    for i in 0..3 {
        let normal = m.col((i + 1) % 3).cross(m.col((i + 2) % 3));
        if m.col(i).length() < longest * THINNEST
            && let Some(normal) = normal.try_normalize()
        {
            *m.col_mut(i) = normal * longest * THINNEST;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    use glam::DVec3;

    use super::*;

    fn sampler(interpolation: Interpolation, times_s: &[f32], values: &[DVec4]) -> Sampler {
        Sampler {
            times_s: times_s.into(),
            values: values.into(),
            interpolation,
        }
    }

    fn x(value: f64) -> DVec4 {
        DVec4::new(value, 0.0, 0.0, 0.0)
    }

    fn about_z(angle: f64) -> DVec4 {
        DVec4::from(DQuat::from_rotation_z(angle))
    }

    #[test]
    fn ends_hold_and_keys_are_met() {
        let times = [0.5, 1.0, 3.0];
        let values = [x(2.0), x(-1.0), x(4.0)];
        let tripled: Vec<_> = values.iter().flat_map(|v| [x(7.0), *v, x(-9.0)]).collect();
        for (interpolation, values) in [
            (Interpolation::Step, &values[..]),
            (Interpolation::Linear, &values[..]),
            (Interpolation::Cubic, &tripled[..]),
        ] {
            let track = sampler(interpolation, &times, values);
            for (time, expected) in [
                (-1.0, 2.0),
                (0.0, 2.0),
                (0.5, 2.0),
                (1.0, -1.0),
                (3.0, 4.0),
                (99.0, 4.0),
            ] {
                let got = track.value_at(time, Property::Scale).x;
                assert!(
                    (got - expected).abs() < 1e-12,
                    "{interpolation:?} {time}: {got}"
                );
            }
        }
        let step = sampler(Interpolation::Step, &times, &values);
        assert_eq!(step.value_at(2.999, Property::Translation).x, -1.0);
        for frame in 1..100 {
            let seconds = f64::from(frame) / 24.0;
            let step = sampler(Interpolation::Step, &[0.0, seconds as f32], &values[..2]);
            let started_s = f64::from(41.7_f32);
            let elapsed_s = (41.7 + seconds) - started_s;
            assert_eq!(step.value_at(elapsed_s, Property::Visible).x, -1.0);
        }
        let linear = sampler(Interpolation::Linear, &times, &values);
        assert_eq!(linear.value_at(2.0, Property::Translation).x, 1.5);
    }

    #[test]
    fn one_key_is_a_constant() {
        for (interpolation, values) in [
            (Interpolation::Step, vec![x(3.0)]),
            (Interpolation::Linear, vec![x(3.0)]),
            (Interpolation::Cubic, vec![x(9.0), x(3.0), x(9.0)]),
        ] {
            let track = sampler(interpolation, &[1.0], &values);
            for time in [0.0, 1.0, 2.0] {
                assert_eq!(track.value_at(time, Property::Scale).x, 3.0);
            }
        }
    }

    /// A cubic through the values and derivatives of one polynomial is that polynomial.
    #[test]
    fn cubic_tangents_are_per_second() {
        let f = |t: f64| 2.0 * t * t * t - 3.0 * t * t + 0.5 * t - 4.0;
        let slope = |t: f64| 6.0 * t * t - 6.0 * t + 0.5;
        let times = [0.0, 0.25, 2.0, 5.0];
        let values = times.map(|t| {
            let t = f64::from(t);
            // The in-tangent of the first and the out-tangent of the last key do not count.
            [x(slope(t)), x(f(t)), x(slope(t))]
        });
        let track = sampler(Interpolation::Cubic, &times, values.as_flattened());
        for i in 0..=500 {
            let t = f64::from(i) / 100.0;
            let got = track.value_at(t, Property::Translation).x;
            assert!((got - f(t)).abs() < 1e-9, "{t}: {got} {}", f(t));
        }
    }

    #[test]
    fn rotations_turn_evenly_by_the_shorter_way() {
        // 10° to 350°: the shorter way is back through 0.
        let [a, b] = [10.0_f64, 350.0].map(f64::to_radians);
        for b in [about_z(b), -about_z(b)] {
            let track = sampler(Interpolation::Linear, &[0.0, 2.0], &[about_z(a), b]);
            for i in 0..=20 {
                let share = f64::from(i) / 20.0;
                let got = track.value_at(2.0 * share, Property::Rotation);
                let expected = about_z((10.0 - 20.0 * share).to_radians());
                assert!((got.dot(expected).abs() - 1.0).abs() < 1e-12, "{share}");
                assert!((got.length() - 1.0).abs() < 1e-12);
            }
        }
        // A quarter turn at constant speed, against the closed form of its angle.
        let track = sampler(
            Interpolation::Linear,
            &[0.0, 1.0],
            &[about_z(0.0), about_z(FRAC_PI_2)],
        );
        for i in 0..=16 {
            let share = f64::from(i) / 16.0;
            let q = DQuat::from_vec4(track.value_at(share, Property::Rotation));
            let turned = q * DVec3::X;
            let angle = turned.y.atan2(turned.x);
            assert!((angle - share * FRAC_PI_2).abs() < 1e-12);
        }
        let same = sampler(Interpolation::Linear, &[0.0, 1.0], &[about_z(1.0); 2]);
        assert_eq!(
            same.value_at(0.3, Property::Rotation),
            about_z(1.0).normalize()
        );
    }

    #[test]
    fn cubic_rotations_are_normalized_and_never_zero() {
        // Opposite keys without tangents: halfway their sum is zero.
        let zero = DVec4::ZERO;
        let values = [zero, about_z(0.0), zero, zero, -about_z(0.0), zero];
        let track = sampler(Interpolation::Cubic, &[0.0, 1.0], &values);
        for i in 0..=8 {
            let q = track.value_at(f64::from(i) / 8.0, Property::Rotation);
            assert!((q.length() - 1.0).abs() < 1e-12, "{q}");
        }
        let values = [zero, about_z(0.0), zero, zero, about_z(PI * 0.5), zero];
        let track = sampler(Interpolation::Cubic, &[0.0, 1.0], &values);
        let q = DQuat::from_vec4(track.value_at(0.5, Property::Rotation));
        assert!((q.to_axis_angle().1 - TAU / 8.0).abs() < 1e-9, "{q}");
    }

    #[test]
    fn flat_scales_stay_thin_and_zero_stays_zero() {
        let mut local = Local::Matrix(Affine3A::IDENTITY);
        local.set(Property::Scale, DVec4::new(2.0, 0.0, -1.0, 0.0));
        let linear = local.transform().matrix3;
        assert!(linear.determinant() != 0.0 && linear.determinant().abs() < 1e-4);
        local.set(Property::Scale, DVec4::ZERO);
        assert_eq!(local.transform().matrix3, glam::Mat3A::ZERO);
    }
}
