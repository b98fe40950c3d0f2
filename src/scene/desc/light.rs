//! Lights as people write them.

use glam::Vec3;

/// How a light's shadows are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ShadowMode {
    /// `"map"`: depth maps (cube maps for point lights), filtered.
    #[default]
    Map,
    /// `"ray"`: one shadow ray through the same trees as reflections; exact, hard edged.
    Ray,
    /// `"none"`: shines through everything.
    None,
}

/// `kind` of a light with what only that kind has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// `"point"`: shines everywhere from `position`.
    Point {
        /// Where it stands, meters.
        position: Vec3,
        /// Luminous intensity, candela, 0 or more.
        intensity_cd: f32,
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
    },
    /// `"directional"`: parallel light, like the sun.
    Directional {
        /// Direction in which the light travels, of any length but 0.
        direction: Vec3,
        /// Illuminance on a surface that faces it, lux, 0 or more.
        intensity_lux: f32,
    },
}

/// `[light.NAME]`. A white surface lit with π lux shows as 1 (white) at exposure 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightDesc {
    /// `kind = "point" | "spot" | "directional"` and its keys.
    pub kind: LightKind,
    /// Linear color, three numbers 0 or more. Default white.
    pub color: Vec3,
    /// How its shadows are found. Default `"map"`.
    pub shadow: ShadowMode,
    /// Edge of the shadow map in pixels, 16 to 4096; of one face for point lights. More is sharper; a directional light's map spans the whole scene, so large scenes need more, or `shadow = "ray"`. The most that a point light asks for holds for all of them, and so for the others. Default 1024.
    pub shadow_px: u32,
}
