//! Lights as people write them, and what of them may change.

use std::f32::consts::PI;

use glam::Vec3;

use super::Tracks;
use crate::scene::{
    number::{Field, Form, Lanes, plain},
    range::{ANY, FROM_0, range},
};

/// How a light's shadows are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ShadowMode {
    /// `"map"`: depth maps (cube maps for point lights), filtered; not of lights with a size.
    #[default]
    Map,
    /// `"ray"`: shadow rays through the same trees as reflections; exact, hard edged for lights without
    /// a size, soft for those with one.
    Ray,
    /// `"none"`: shines through everything.
    None,
    /// `"auto"`: `map` or `ray`, alike for all lights of a kind: the one that a cost model expects
    /// to take less time if every picture drew all maps; `ray` where a texel would span more than 16
    /// pixels of what the camera sees; `map` where nothing else follows rays. Of lights with a size, `ray`.
    Auto,
}

/// Smallest radius of a point or spot light with a size, meters.
const LEAST_RADIUS_M: f32 = 1e-10;

/// `kind` of a light with what only that kind has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// `"point"`: shines everywhere from `position`.
    Point {
        /// Where it stands, meters.
        position: Vec3,
        /// Luminous intensity, candela, 0 or more.
        intensity_cd: f32,
        /// Radius of a glowing ball of that intensity, meters, 0 or more; 0, and what is below 1e-10, has no size.
        /// More has softer shadows and larger highlights. Default 0.
        radius_m: f32,
    },
    /// `"spot"`: a cone from `position`, along `direction` or towards `target`.
    Spot {
        /// Where it stands, meters.
        position: Vec3,
        /// Direction of the beam, of any length but 0.
        direction: Vec3,
        /// A point that the beam's middle meets, meters, wherever the light moves; in place of
        /// `direction`.
        target: Option<Vec3>,
        /// Luminous intensity in the middle of the beam, candela, 0 or more.
        intensity_cd: f32,
        /// Half angle that is fully lit, degrees, 0 to `outer_deg`. Default 0.
        inner_deg: f32,
        /// Half angle where it ends, degrees, above 0 and below 90. Default 45.
        outer_deg: f32,
        /// Radius of a glowing ball that shines inside the cone, meters, 0 or more; 0, and what is below 1e-10, has no
        /// size. Default 0.
        radius_m: f32,
    },
    /// `"directional"`: parallel light, like the sun.
    Directional {
        /// Direction in which the light travels, of any length but 0.
        direction: Vec3,
        /// Illuminance on a surface that faces it, lux, 0 or more.
        intensity_lux: f32,
        /// Angle that it spans in the sky, degrees, 0 to 90; the sun spans 0.53. More has softer
        /// shadows. Default 0.
        angle_deg: f32,
    },
    /// `"rect"`: a flat rectangle around `position` that shines to one side, along `direction` or towards
    /// `target`; it looks alike bright from everywhere on that side. Reflections show it, the camera itself
    /// does not: put a shape with `emission` where it shall be seen.
    Rect {
        /// Its middle, meters.
        position: Vec3,
        /// Direction in which it shines, of any length but 0.
        direction: Vec3,
        /// A point that it faces, meters, wherever the light moves; in place of `direction`.
        target: Option<Vec3>,
        /// Direction of its second edge; turned as far as it must to be level with the rectangle. Along
        /// `direction` it is replaced by +Z. Default [0, 1, 0].
        up: Vec3,
        /// Edge lengths, meters, above 0; the second along `up`.
        size: [f32; 2],
        /// Luminous intensity straight ahead, candela, 0 or more.
        intensity_cd: f32,
    },
    /// `"disk"`: a flat disk around `position` that shines as a `"rect"` does.
    Disk {
        /// Its middle, meters.
        position: Vec3,
        /// Direction in which it shines, of any length but 0.
        direction: Vec3,
        /// A point that it faces, meters, wherever the light moves; in place of `direction`.
        target: Option<Vec3>,
        /// Radius, meters, above 0.
        radius_m: f32,
        /// Luminous intensity straight ahead, candela, 0 or more.
        intensity_cd: f32,
    },
}

impl LightKind {
    /// Every kind as scene text and messages write it; in the shaders `LIGHT_` and this.
    pub const NAMES: [&'static str; 5] = ["point", "spot", "directional", "rect", "disk"];

    /// Its place in [`Self::NAMES`].
    pub fn index(&self) -> usize {
        match self {
            Self::Point { .. } => 0,
            Self::Spot { .. } => 1,
            Self::Directional { .. } => 2,
            Self::Rect { .. } => 3,
            Self::Disk { .. } => 4,
        }
    }

    /// As scene text writes it.
    pub fn name(&self) -> &'static str {
        Self::NAMES[self.index()]
    }

    /// Whether it has a size, so that its light is sampled. What is smaller than an atom counts as a point: the
    /// square of its radius, divided by that of a distance, may be 0 in 32-bit floats.
    pub fn has_size(&self) -> bool {
        match self {
            Self::Point { radius_m, .. } | Self::Spot { radius_m, .. } => {
                *radius_m >= LEAST_RADIUS_M
            }
            Self::Directional { angle_deg, .. } => *angle_deg > 0.0,
            Self::Rect { .. } | Self::Disk { .. } => true,
        }
    }

    /// Where it stands, if somewhere.
    pub fn position(mut self) -> Option<Vec3> {
        self.position_mut().copied()
    }

    /// Luminous intensity in candela, or illuminance in lux of what is directional.
    pub fn intensity(&self) -> f32 {
        match *self {
            Self::Point { intensity_cd, .. }
            | Self::Spot { intensity_cd, .. }
            | Self::Rect { intensity_cd, .. }
            | Self::Disk { intensity_cd, .. } => intensity_cd,
            Self::Directional { intensity_lux, .. } => intensity_lux,
        }
    }

    /// Radiance per unit of color of its surface, at its brightest; 0 of what has no size.
    pub fn radiance(&self) -> f32 {
        if !self.has_size() {
            return 0.0;
        }
        let apparent = match *self {
            Self::Point { radius_m, .. }
            | Self::Spot { radius_m, .. }
            | Self::Disk { radius_m, .. } => PI * radius_m * radius_m,
            Self::Rect { size, .. } => size[0] * size[1],
            Self::Directional { angle_deg, .. } => {
                PI * (0.5 * angle_deg).to_radians().sin().powi(2)
            }
        };
        if apparent > 0.0 {
            self.intensity() / apparent
        } else {
            0.0
        }
    }

    /// In which direction it shines, if in one.
    pub fn direction(mut self) -> Option<Vec3> {
        self.direction_mut().copied()
    }

    /// See [`Self::position`].
    pub fn position_mut(&mut self) -> Option<&mut Vec3> {
        match self {
            Self::Point { position, .. }
            | Self::Spot { position, .. }
            | Self::Rect { position, .. }
            | Self::Disk { position, .. } => Some(position),
            Self::Directional { .. } => None,
        }
    }

    /// See [`Self::direction`].
    pub fn direction_mut(&mut self) -> Option<&mut Vec3> {
        match self {
            Self::Spot { direction, .. }
            | Self::Directional { direction, .. }
            | Self::Rect { direction, .. }
            | Self::Disk { direction, .. } => Some(direction),
            Self::Point { .. } => None,
        }
    }

    /// The point that it faces, if it can face one.
    pub fn target_mut(&mut self) -> Option<&mut Option<Vec3>> {
        match self {
            Self::Spot { target, .. } | Self::Rect { target, .. } | Self::Disk { target, .. } => {
                Some(target)
            }
            Self::Point { .. } | Self::Directional { .. } => None,
        }
    }

    /// The direction of its second edge, if it has edges.
    pub fn up_mut(&mut self) -> Option<&mut Vec3> {
        match self {
            Self::Rect { up, .. } => Some(up),
            _ => None,
        }
    }
}

/// `[light.NAME]`. A white surface lit with π lux shows as 1 (white) at exposure 0.
///
/// - `parent`: `name` of an instance, or a `[group.NAME]`, that this hangs on: its position and its
///   directions are then relative to where that is, wherever it moves; sizes and intensities stay.
///   Default: none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightDesc {
    /// `kind = "point" | "spot" | "directional" | "rect" | "disk"` and its keys. Lights with a size are
    /// seen in reflections, not by the camera itself.
    pub kind: LightKind,
    /// Linear color, three numbers 0 or more, or sRGB text `"#rrggbb"`. Default white.
    pub color: Vec3,
    /// How its shadows are found. Default `"map"`; `"ray"` of lights with a size.
    pub shadow: ShadowMode,
    /// Edge of the shadow map in pixels, 16 to 4096; of one face for point lights. More is sharper; a directional light's map spans the whole scene, so large scenes need more, or `shadow = "ray"`. The most that a point light asks for holds for all of them, and so for the others. Default 1024.
    pub shadow_px: u32,
}

impl LightDesc {
    /// Makes a light whose numbers were set consistent: its direction, 0 where there is none, points
    /// at its target, and the lit part of its cone is no wider than the cone.
    pub fn settle(&mut self) {
        let target = self.kind.target_mut().and_then(|target| *target);
        let position = self.kind.position().unwrap_or_default();
        if let (Some(target), Some(direction)) = (target, self.kind.direction_mut()) {
            *direction = target - position;
        }
        if let LightKind::Spot {
            inner_deg,
            outer_deg,
            ..
        } = &mut self.kind
        {
            *inner_deg = inner_deg.min(*outer_deg);
        }
        if let Some(direction) = self.kind.direction_mut() {
            let unit = direction.as_dvec3().try_normalize();
            *direction = unit.map_or(Vec3::ZERO, |unit| unit.as_vec3());
        }
    }
}

/// `[motion.light.NAME]`: only what the light's `kind` has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightMotionDesc {
    /// - `position`: track of where it stands, meters.
    /// - `direction`: track of the direction in which it shines, of any length but 0.
    /// - `target`: track of the point that a spot, rectangle or disk faces, meters; in place of
    ///   `direction`.
    /// - `intensity_cd`: track of the luminous intensity, candela, 0 or more.
    /// - `intensity_lux`: track of the illuminance of a directional light, lux, 0 or more.
    /// - `color`: track of the linear color, 0 or more.
    /// - `inner_deg`: track of the half angle of a spot that is fully lit, degrees, 0 to
    ///   `outer_deg`.
    /// - `outer_deg`: track of the half angle where a spot ends, degrees, above 0 and below 90.
    pub tracks: Tracks,
}

/// A field that some kinds of lights have.
macro_rules! of_lights {
    ($key:ident, $form:ident, $range:expr, $($kind:ident)|+) => {
        Field {
            key: stringify!($key),
            form: Form::$form,
            range: $range,
            get: |light| match light.kind {
                $(LightKind::$kind { $key, .. })|+ => Some($key.lanes()),
                _ => None,
            },
            put: |light, value| match &mut light.kind {
                $(LightKind::$kind { $key, .. })|+ => *$key = Lanes::of(value),
                _ => {}
            },
        }
    };
}

/// What changes of a light. After any of it, [`LightDesc::settle`].
pub static LIGHT: [Field<LightDesc>; 8] = [
    of_lights!(position, Vector, ANY, Point | Spot | Rect | Disk),
    Field {
        key: "direction",
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
    of_lights!(intensity_cd, Number, FROM_0, Point | Spot | Rect | Disk),
    of_lights!(intensity_lux, Number, FROM_0, Directional),
    plain!(color, Color, FROM_0),
    of_lights!(inner_deg, Number, range(0.0, 90.0).below(), Spot),
    of_lights!(outer_deg, Number, range(0.0, 90.0).below().above(), Spot),
];
