//! Decals of scene text: materials that are projected onto surfaces.

use glam::Vec3;

use super::{At, PlacementDesc};

declared! {
    /// `[decal.NAME]`: a material that is projected onto the surfaces inside a box, such as a poster, a road marking,
    /// rust or a puddle; at most 256, with the decals of placed scenes. It is projected along the box's -Z, with the
    /// image's right along +X and its top along +Y: `rotation_deg = [-90, 0, 0]` projects down onto a floor, no
    /// rotation onto a wall that faces +Z. Where decals overlap, later decals of the text lie above. All methods show
    /// them, also in reflections. A decal takes base color, metalness, roughness, reflectivity, emission and normal map
    /// of its material, with their textures and patterns, and the alpha as its coverage. Its emission is added to the
    /// emission of the surface, and is never sampled as a light. A clear coat lies over decals. Glass passes less light
    /// where a decal covers it, but its shadow stays clear.
    ///
    /// - `parent`: `name` of an instance, or of a `[group.NAME]`: the decal's placement is then relative to it and
    ///   moves with it, and the decal is hidden with it. Default: none.
    #[derive(Clone, Debug, PartialEq)]
    pub struct DecalDesc {
        /// Name of the `[material.NAME]` that is projected.
        pub material: At<String>,
        /// Placement of the middle of the box, relative to its parent if it has one.
        pub placement: PlacementDesc,
        /// Size of the box along X, Y and Z before `scale`, meters, each above 0. Surfaces beyond its depth along Z
        /// show nothing of the decal.
        pub size: Vec3,
        /// Names of the instances and groups onto which it is projected, with all that is attached to them. Default:
        /// all instances.
        pub only: Option<Vec<At<String>>>,
        /// Whether scripts may move it by `ctx.decal` in `frame`. Default false; one with motion may always move.
        pub dynamic: bool,
        /// Factor on its coverage, 0 to 1.
        pub opacity: f32,
        /// Largest angle between a surface's normal and the box's +Z at which the decal is seen, degrees, 0 to 180;
        /// from 90 on it is also seen on surfaces that face away. The nearer to 90, the more it is smeared.
        pub max_angle_deg: f32,
        /// Width of the range of angles below `max_angle_deg` in which it fades out, degrees, 0 to 180. 0 is a hard
        /// border.
        pub fade_deg: f32,
        /// Properties of a surface that it changes, one or a list: `"color"` (base color and emission), `"metallic"`,
        /// `"roughness"` (with reflectivity), `"normal"`. A puddle may change roughness alone. Default: all of them.
        pub changes: DecalChanges,
    }
}

/// Properties of a surface that a decal changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DecalChanges {
    /// Color: base color and emission, and the light that passes through.
    pub color: bool,
    /// Metalness.
    pub metallic: bool,
    /// Roughness and reflectivity.
    pub roughness: bool,
    /// Normal, where the decal's material has a normal map.
    pub normal: bool,
}

impl DecalChanges {
    /// Words of `changes`, in the order of [`DecalChanges::from_flags`].
    pub const WORDS: [&'static str; 4] = ["color", "metallic", "roughness", "normal"];

    /// Changes from one flag for each of [`DecalChanges::WORDS`].
    pub const fn from_flags([color, metallic, roughness, normal]: [bool; 4]) -> Self {
        Self {
            color,
            metallic,
            roughness,
            normal,
        }
    }
}

impl DecalDesc {
    /// Maximum number of decals: as many as one block of uniforms holds with the sets of them that instances show.
    pub const MOST: usize = 256;
}
