//! Kinds of lights, and the table of the values of lights that may change over time.

use std::f64::consts::PI;

use glam::Vec3;

use super::LightDesc;
use crate::{
    number::{Field, Form, Lanes, plain},
    range::{ABOVE_0, ANY, FROM_0, LIMIT, Range, range},
    table::Table,
};

/// Range of the angle up to which a beam has full brightness, degrees.
const INNER_DEG: Range = range(0.0, 90.0).below();
/// Range of the angle at which a beam ends, degrees.
const OUTER_DEG: Range = INNER_DEG.above();

/// Smallest radius of a point or spot light with a size, meters.
const LEAST_RADIUS_M: f32 = 1e-10;

/// Least difference of the cosines between which the edge of a beam fades.
const LEAST_FADE: f64 = 1e-3;
/// Least fade of a narrow beam, relative to 1 minus the cosine at which it ends: 32-bit cosines show no harder edge.
const LEAST_FADE_SHARE: f64 = 0.1;

/// Lumens of a watt of light at 555 nm (SI, luminous efficacy), by which exporters of glTF convert.
const LUMENS_PER_WATT: f32 = 683.0;

/// Largest luminous intensity of a light, candela, whatever key says it.
pub const MOST_CD: f32 = LIMIT as f32;

/// Keys that say how bright a light with a place is, of which it has one.
pub const BRIGHTNESS: [&str; 3] = ["intensity_cd", "flux_lm", "power_w"];

/// Solid angle over which a flat light would spread its flux with its intensity straight ahead, steradians (Lambert).
const FLAT_SR: f64 = PI;

/// [`FLAT_SR`] in words.
const FLAT_WORDS: &str = "3.14";

declared! {
    /// `kind` of a light, with the keys that only this kind has.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[kinds(Self::check)]
    pub enum LightKind {
        /// `"point"`: shines in all directions from `position`.
        Point = "point" {
            /// Position of the light, meters.
            position: Vec3,
            /// Luminous intensity, candela, 0 or more. More is brighter. A light has exactly one of `intensity_cd`,
            /// `flux_lm` and `power_w`.
            #[by(|t| intensity(t, 4.0 * PI, "12.57"))]
            intensity_cd: f32,
            /// Radius of the glowing ball that the light is, meters, 0 or more; its intensity stays
            /// `intensity_cd`. More gives softer shadows and larger highlights; 0, or less than 1e-10, is a
            /// point without a size. Default 0.
            radius_m: f32 [FROM_0] = 0.0,
        },
        /// `"spot"`: a cone from `position`, along `direction` or towards `target`.
        Spot = "spot" {
            /// Position of the light, meters.
            position: Vec3,
            /// Direction of the beam, of any length but 0.
            #[by(direction_or_target)]
            direction: Vec3,
            /// Point at the middle of the beam, meters, in place of `direction`; the beam keeps pointing there
            /// when the light moves.
            target: Option<Vec3>,
            /// Angle from the middle of the beam up to which it has full brightness, degrees, 0 to `outer_deg`.
            /// However hard it is written, the edge fades over a twentieth of `outer_deg` below 8 degrees, and over
            /// less than half a degree above. Default 0.
            inner_deg: f32 [INNER_DEG] = 0.0,
            /// Angle from the middle of the beam at which it ends, degrees, above 0 and below 90. Default 45.
            outer_deg: f32 [OUTER_DEG] = 45.0,
            /// Luminous intensity in the middle of the beam, candela, 0 or more; it stays where the angles move.
            #[by(|t| intensity(t, beam_sr(inner_deg?, outer_deg?), BEAM_WORDS))]
            intensity_cd: f32,
            /// Radius of a glowing ball that shines inside the cone, meters, 0 or more: more gives softer
            /// shadows; 0, or less than 1e-10, is a point without a size. Default 0.
            radius_m: f32 [FROM_0] = 0.0,
        },
        /// `"directional"`: parallel light, like the sun.
        Directional = "directional" {
            /// Direction in which the light travels, of any length but 0.
            #[by(direction)]
            direction: Vec3,
            /// Illuminance on a surface that faces the light, lux, 0 or more.
            intensity_lux: f32 [FROM_0],
            /// Angle that the light spans in the sky, degrees, 0 to 90; the sun spans 0.53. More has softer
            /// shadows. Default 0.
            angle_deg: f32 [range(0.0, 90.0)] = 0.0,
        },
        /// `"rect"`: a flat rectangle around `position` that shines to one side, along `direction` or towards
        /// `target`, with the same radiance in all directions of that side. Reflections show it, the camera
        /// itself does not: where it shall be seen, add a shape with `emission`.
        Rect = "rect" {
            /// Position of the center of the light, meters.
            position: Vec3,
            /// Direction in which it shines, of any length but 0.
            #[by(direction_or_target)]
            direction: Vec3,
            /// Point that the rectangle faces, meters, in place of `direction`; it keeps facing it when the
            /// light moves.
            target: Option<Vec3>,
            /// Direction of the second edge, turned as far as needed to lie in the rectangle's plane. If it is
            /// along `direction`, +Z takes its place. Default [0, 1, 0].
            up: Vec3 = Vec3::Y,
            /// Edge lengths of the rectangle, meters, above 0; the second edge is along `up`.
            size: [f32; 2] [ABOVE_0],
            /// Luminous intensity straight ahead, candela, 0 or more.
            #[by(|t| intensity(t, FLAT_SR, FLAT_WORDS))]
            intensity_cd: f32,
        },
        /// `"disk"`: a flat disk around `position` that shines to one side as a `"rect"` does.
        Disk = "disk" {
            /// Position of the center of the light, meters.
            position: Vec3,
            /// Direction in which it shines, of any length but 0.
            #[by(direction_or_target)]
            direction: Vec3,
            /// Point that the disk faces, meters, in place of `direction`; it keeps facing it when the light
            /// moves.
            target: Option<Vec3>,
            /// Radius of the disk, meters, above 0.
            radius_m: f32 [ABOVE_0],
            /// Luminous intensity straight ahead, candela, 0 or more.
            #[by(|t| intensity(t, FLAT_SR, FLAT_WORDS))]
            intensity_cd: f32,
        },
    }
}

/// Field of some kinds of lights; `None` for other kinds.
macro_rules! field {
    ($light:expr, $field:ident: $($kind:ident)|+) => {
        match $light {
            $(LightKind::$kind { $field, .. })|+ => Some($field),
            _ => None,
        }
    };
}

impl LightKind {
    /// Index of the kind in [`Self::NAMES`]; the shaders' constants are `LIGHT_` and this name.
    pub fn index(&self) -> usize {
        let is_it = |name: &&str| *name == self.name();
        Self::NAMES.iter().position(is_it).unwrap_or_default()
    }

    /// Whether the light has a size, so that its light is sampled. A radius below an atom's counts as a
    /// point: its square over the square of a distance may be 0 in 32-bit floats.
    pub fn has_size(&self) -> bool {
        self.is_flat()
            || self.radius_m() >= LEAST_RADIUS_M
            || field!(self, angle_deg: Directional).is_some_and(|angle| *angle > 0.0)
    }

    /// Whether the light is flat, and shines from one side of a plane around its position.
    pub fn is_flat(&self) -> bool {
        self.edges().is_some()
    }

    /// Edges of the smallest rectangle around a flat light, meters, across its direction; `None` for other kinds.
    pub fn edges(&self) -> Option<[Vec3; 2]> {
        let direction = self.direction()?.normalize_or(Vec3::NEG_Y);
        match *self {
            Self::Rect { up, size, .. } => {
                let up = up - direction * up.dot(direction);
                let up = up.try_normalize().unwrap_or_else(|| {
                    let up = Vec3::Z - direction * direction.z;
                    up.normalize_or(Vec3::Y)
                });
                Some([direction.cross(up) * size[0], up * size[1]])
            }
            Self::Disk { radius_m, .. } => {
                let up = direction.any_orthonormal_vector() * 2.0 * radius_m;
                Some([direction.cross(up), up])
            }
            _ => None,
        }
    }

    /// Radius of the smallest ball around the light's surface, meters; 0 for a light without a place.
    pub fn radius_m(&self) -> f32 {
        let half = |size: &[f32; 2]| 0.5 * Vec3::new(size[0], size[1], 0.0).length();
        let radius_m = field!(self, radius_m: Point | Spot | Disk).copied();
        let radius_m = radius_m.or(field!(self, size: Rect).map(half));
        radius_m.unwrap_or_default()
    }

    /// Angles from the middle of a beam up to which it has full brightness and at which it ends, degrees; `None` for a
    /// light without a beam.
    pub fn cone_deg(&self) -> Option<[f32; 2]> {
        Some([
            *field!(self, inner_deg: Spot)?,
            *field!(self, outer_deg: Spot)?,
        ])
    }

    /// Scale and offset of the share of its intensity that a beam has at an angle, `saturate(cos * scale + offset)`
    /// squared: linear in the cosine between the two cones (KHR_lights_punctual). `None` for a light without a beam.
    pub fn cone_falloff(&self) -> Option<[f32; 2]> {
        let [inner_deg, outer_deg] = self.cone_deg()?;
        let [outer, fade] = beam(inner_deg, outer_deg);
        let scale = (1.0 / fade).min(1e30) as f32;
        let offset = (outer / fade - f64::from(scale)) as f32;
        // Rounding must not darken the middle of a narrow beam, where both are large.
        let is_dark = scale + offset < 1.0;
        Some([scale, if is_dark { offset.next_up() } else { offset }])
    }

    /// Ratio of the light's flux to its intensity, steradians; `None` for a light without a place.
    fn steradians(&self) -> Option<f64> {
        Some(match *self {
            Self::Directional { .. } => return None,
            Self::Point { .. } => 4.0 * PI,
            Self::Spot {
                inner_deg,
                outer_deg,
                ..
            } => beam_sr(inner_deg, outer_deg),
            Self::Rect { .. } | Self::Disk { .. } => FLAT_SR,
        })
    }

    /// Luminous flux of a white light, lumens; `None` for a light without a place.
    fn flux_lm(&self) -> Option<f32> {
        Some((f64::from(self.intensity()) * self.steradians()?) as f32)
    }

    fn set_flux_lm(&mut self, lumens: f32) {
        let steradians = self.steradians();
        let intensity_cd = field!(self, intensity_cd: Point | Spot | Rect | Disk);
        if let Some((intensity_cd, steradians)) = intensity_cd.zip(steradians) {
            *intensity_cd = (f64::from(lumens) / steradians) as f32;
        }
    }

    /// Multiplies the lengths of the light by a factor, and its intensity so that it lights as before.
    pub fn scale(&mut self, factor: f32) {
        if let Some(radius_m) = field!(self, radius_m: Point | Spot | Disk) {
            *radius_m *= factor;
        }
        if let Some(size) = field!(self, size: Rect) {
            *size = size.map(|edge_m| edge_m * factor);
        }
        if let Some(intensity_cd) = field!(self, intensity_cd: Point | Spot | Rect | Disk) {
            *intensity_cd *= factor * factor;
        }
    }

    /// The light as a point or a cone; a flat one as a wide cone.
    pub fn without_size(mut self) -> Self {
        if self.is_flat() {
            return Self::Spot {
                position: self.position().unwrap_or_default(),
                direction: self.direction().unwrap_or_default(),
                target: None,
                intensity_cd: self.intensity(),
                inner_deg: 0.0,
                outer_deg: 89.0,
                radius_m: 0.0,
            };
        }
        if let Some(radius_m) = field!(&mut self, radius_m: Point | Spot) {
            *radius_m = 0.0;
        }
        self
    }

    /// Luminous intensity in candela, or of a directional light the illuminance in lux.
    pub fn intensity(&self) -> f32 {
        let intensity = field!(self, intensity_cd: Point | Spot | Rect | Disk);
        *intensity
            .or(field!(self, intensity_lux: Directional))
            .unwrap_or(&0.0)
    }

    /// Radiance of the light's surface at its brightest, per unit of color; 0 for a light without a size.
    pub fn radiance(&self) -> f32 {
        if !self.has_size() {
            return 0.0;
        }
        let apparent = match *self {
            Self::Rect { size, .. } => size[0] * size[1],
            Self::Directional { angle_deg, .. } => {
                PI as f32 * (0.5 * angle_deg).to_radians().sin().powi(2)
            }
            _ => PI as f32 * self.radius_m() * self.radius_m(),
        };
        if apparent > 0.0 {
            self.intensity() / apparent
        } else {
            0.0
        }
    }

    /// Position of the light; `None` if directional.
    pub fn position(mut self) -> Option<Vec3> {
        self.position_mut().copied()
    }

    /// Direction in which the light shines; `None` for a point light.
    pub fn direction(mut self) -> Option<Vec3> {
        self.direction_mut().copied()
    }

    /// Mutable [`Self::position`].
    pub fn position_mut(&mut self) -> Option<&mut Vec3> {
        field!(self, position: Point | Spot | Rect | Disk)
    }

    /// Mutable [`Self::direction`].
    pub fn direction_mut(&mut self) -> Option<&mut Vec3> {
        field!(self, direction: Spot | Directional | Rect | Disk)
    }

    /// Point that the light faces; the outer `None` for kinds that cannot face one.
    pub fn target_mut(&mut self) -> Option<&mut Option<Vec3>> {
        field!(self, target: Spot | Rect | Disk)
    }

    /// Direction of the second edge of a rectangle; `None` for other kinds.
    pub fn up_mut(&mut self) -> Option<&mut Vec3> {
        field!(self, up: Rect)
    }
}

impl LightKind {
    fn check(&self, t: &mut Table) {
        let mut light = *self;
        let target = light.target_mut().and_then(|target| *target);
        if target.is_some() && target == light.position() {
            refuse_direction(t, "target", "`target` must differ from `position`");
        }
        match *self {
            Self::Rect { up: Vec3::ZERO, .. } if t.clean() => {
                let help = "write `up = [0, 1, 0]`";
                t.refuse("zero-direction", "up", "`up` must not be zero", help);
            }
            Self::Spot {
                inner_deg,
                outer_deg,
                ..
            } if t.clean() && inner_deg > outer_deg => {
                let message = format!("`inner_deg` must be 0 to `outer_deg`, which is {outer_deg}");
                let help = format!(
                    "write `inner_deg = {outer_deg}` and `outer_deg = {inner_deg}`, the angles where the light begins to fade and where it ends"
                );
                t.refuse("out-of-range", "inner_deg", &message, &help);
            }
            _ => {}
        }
    }
}

/// 1 minus the cosine of the angle at which a beam ends, and the difference of the cosines between which its edge fades:
/// exact for narrow beams too.
fn beam(inner_deg: f32, outer_deg: f32) -> [f64; 2] {
    let beyond = |deg: f32| 2.0 * (0.5 * f64::from(deg).to_radians()).sin().powi(2);
    let outer = beyond(outer_deg);
    let least = LEAST_FADE.min(outer * LEAST_FADE_SHARE);
    [outer, (outer - beyond(inner_deg)).max(least)]
}

/// Solid angle of a beam, weighted by its share of the intensity (see [`LightKind::cone_falloff`]), steradians.
fn beam_sr(inner_deg: f32, outer_deg: f32) -> f64 {
    let [outer, fade] = beam(inner_deg, outer_deg);
    // The integral of a squared ramp is a third of its length.
    2.0 * PI * (outer - fade * 2.0 / 3.0)
}

/// [`beam_sr`] in words.
const BEAM_WORDS: &str = "2π (1 - (2 cos `inner_deg` + cos `outer_deg`) / 3)";

/// Reads the intensity of a light, candela, from the key of [`BRIGHTNESS`] that is written. Its flux is larger by the solid
/// angle `steradians`, which the manual shows as `words`.
fn intensity(t: &mut Table, steradians: f64, words: &str) -> Option<f32> {
    let [candela, lumens, watts] = BRIGHTNESS;
    t.one_of(true, &BRIGHTNESS.each_ref().map(std::slice::from_ref));
    let intensity_cd = t.find(candela, FROM_0);
    let flux_lm = t.find(lumens, FROM_0);
    let power_w: Option<f32> = t.find(watts, FROM_0);
    let (kept, wider) = match words {
        BEAM_WORDS => (
            " Where the angles move later, the candela stays, and the flux changes.",
            ", or a larger `outer_deg`",
        ),
        _ => ("", ""),
    };
    t.explain(lumens, || {
        format!(
            "Luminous flux of a white light, lumens, 0 or more, in place of `{candela}`: divided by {words}, it is the \
             candela, at most {MOST_CD:e}. A bulb of 60 W, or 8 W with LEDs, gives about 800.{kept}"
        )
    });
    t.explain(watts, || {
        format!(
            "Radiant power, watts, 0 or more, in place of `{candela}`: {LUMENS_PER_WATT} lumens each, as exporters of glTF \
             convert. It is not the power that a bulb takes, most of which becomes heat.{kept}"
        )
    });
    let flux_lm = flux_lm.or(power_w.map(|watts| watts * LUMENS_PER_WATT));
    let from_flux = || Some(f64::from(flux_lm?) / steradians);
    let intensity_cd = intensity_cd.or_else(|| Some(from_flux()? as f32))?;
    if intensity_cd > MOST_CD {
        let key = if t.has(lumens) { lumens } else { watts };
        let message = format!("`{key}` makes the light brighter than {MOST_CD:e} candela");
        t.refuse("out-of-range", key, &message, &format!("write less{wider}"));
    }
    Some(intensity_cd)
}

/// Reads `direction`, as it is written.
fn direction(t: &mut Table) -> Option<Vec3> {
    let direction = t.need("direction", ANY)?;
    not_zero(t, direction)
}

/// Reads `direction`, as it is written, or 0 where the light has a `target` in its place.
fn direction_or_target(t: &mut Table) -> Option<Vec3> {
    t.one_of(true, &[&["direction"], &["target"]]);
    match t.find("direction", ANY) {
        Some(direction) => not_zero(t, direction),
        None => Some(Vec3::ZERO),
    }
}

fn not_zero(t: &mut Table, direction: Vec3) -> Option<Vec3> {
    if direction == Vec3::ZERO {
        refuse_direction(t, "direction", "`direction` must not be zero");
        return None;
    }
    Some(direction)
}

fn refuse_direction(t: &mut Table, key: &str, message: &str) {
    let help = match key {
        "target" => "write a point that it shines at, such as `target = [0, 0, 0]`",
        _ => "write the way of its light, such as `direction = [0, -1, 0]` for down",
    };
    t.refuse("zero-direction", key, message, help);
}

/// Row of [`LIGHT`] for a field that only some kinds of lights have.
macro_rules! of_lights {
    ($key:ident: $form:ident $range:ident in $($kind:ident)|+, $what:literal) => {
        Field {
            key: stringify!($key),
            what: $what,
            form: Form::$form,
            range: $range,
            get: |light| field!(light.kind, $key: $($kind)|+).map(Lanes::lanes),
            put: |light, value| {
                if let Some(field) = field!(&mut light.kind, $key: $($kind)|+) {
                    *field = Lanes::from_lanes(value);
                }
            },
        }
    };
}

/// Values of a light that tracks and scripts may change; afterwards call [`LightDesc::settle`].
pub static LIGHT: [Field<LightDesc>; 10] = [
    of_lights! { position: Vector ANY in Point | Spot | Rect | Disk, "position, meters" },
    Field {
        key: "direction",
        what: "direction in which the light shines, of any length but 0",
        form: Form::Vector,
        range: ANY,
        get: |light| light.kind.direction(),
        put: |light, value| {
            if let Some(target) = light.kind.target_mut() {
                *target = None;
            }
            if let Some(direction) = light.kind.direction_mut() {
                *direction = value;
            }
        },
    },
    Field {
        key: "target",
        what: "point that a spot, rectangle or disk faces, meters; in place of `direction`",
        form: Form::Vector,
        range: ANY,
        get: |light| {
            let mut kind = light.kind;
            let target = *kind.target_mut()?;
            target.or_else(|| Some(kind.position()? + kind.direction()?))
        },
        put: |light, value| {
            if let Some(target) = light.kind.target_mut() {
                *target = Some(value);
            }
        },
    },
    of_lights! { intensity_cd: Number FROM_0 in Point | Spot | Rect | Disk, "luminous intensity, candela" },
    of_lights! { intensity_lux: Number FROM_0 in Directional, "illuminance of a directional light, lux" },
    plain!(color, "linear color", Color, FROM_0),
    of_lights! { inner_deg: Number INNER_DEG in Spot, "" },
    of_lights! { outer_deg: Number OUTER_DEG in Spot, "angle from the middle at which a spot's beam ends, degrees" },
    // After the angles, which say what candela a flux is.
    Field {
        key: BRIGHTNESS[1],
        what: "luminous flux, in place of `intensity_cd`, lumens",
        form: Form::Number,
        range: FROM_0,
        get: |light| light.kind.flux_lm().map(Lanes::lanes),
        put: |light, lumens| light.kind.set_flux_lm(lumens.x),
    },
    Field {
        key: BRIGHTNESS[2],
        what: "radiant power, in place of `intensity_cd`, watts",
        form: Form::Number,
        range: FROM_0,
        get: |light| Some((light.kind.flux_lm()? / LUMENS_PER_WATT).lanes()),
        put: |light, watts| light.kind.set_flux_lm(watts.x * LUMENS_PER_WATT),
    },
];
