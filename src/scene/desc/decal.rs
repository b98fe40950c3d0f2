//! Decals of scene text: materials that are projected onto surfaces.

use glam::Vec3;

use super::{At, PlacementDesc, hierarchy::placed_in_parent};
use crate::{
    range::{ABOVE_0, ANY, UNIT, range},
    suggest,
    table::{Table, value::Names},
};

declared! {
    /// `[decal.NAME]`: a material that is projected onto the surfaces inside a box, such as a poster, a road marking,
    /// rust or a puddle; at most 256, with the decals of placed scenes. It is projected along the box's -Z, with the
    /// image's right along +X and its top along +Y: `rotation_deg = [-90, 0, 0]` projects down onto a floor, no
    /// rotation onto a wall that faces +Z. Where decals overlap, later decals of the text lie above. All methods show
    /// them, also in reflections. A decal takes base color, metalness, roughness, reflectivity, emission and normal map
    /// of its material, with their textures and patterns, and the alpha as its coverage. Its emission is added to the
    /// emission of the surface, and is never sampled as a light. A clear coat lies over decals. Glass and paper pass less
    /// light where a decal covers them, but the shadow of glass stays clear. A relief (`bump`) of the decal's material is
    /// left out.
    ///
    /// - `parent`: `name` of an instance, or of a `[group.NAME]`: the decal's placement is then relative to it and
    ///   moves with it, and the decal is hidden with it. Default: none.
    #[derive(Clone, Debug, PartialEq)]
    #[table(
        "[decal.NAME]", also(PlacementDesc), refers(material: "material", only: "instance" | "group"),
        check(Self::check)
    )]
    pub struct DecalDesc {
        /// Name of the `[material.NAME]` that is projected.
        pub material: At<String>,
        /// Placement of the middle of the box, relative to its parent if it has one.
        #[by(placed_in_parent)]
        pub placement: PlacementDesc,
        /// Names of the instances and groups onto which it is projected, with all that is attached to them. Default:
        /// all instances.
        #[by(|t| Some(t.find("only", ANY).map(|Names(names)| names)))]
        pub only: Option<Vec<At<String>>>,
        /// Size of the box along X, Y and Z before `scale`, meters, each above 0. Surfaces beyond its depth along Z
        /// show nothing of the decal.
        pub size: Vec3 [ABOVE_0] = Vec3::ONE,
        /// Whether scripts may move it by `ctx.decal` in `frame`. Default false; one with motion may always move.
        pub dynamic: bool = false,
        /// Factor on its coverage, 0 to 1.
        pub opacity: f32 [UNIT] = 1.0,
        /// Largest angle between a surface's normal and the box's +Z at which the decal is seen, degrees, 0 to 180;
        /// from 90 on it is also seen on surfaces that face away. The nearer to 90, the more it is smeared.
        pub max_angle_deg: f32 [range(0.0, 180.0)] = 75.0,
        /// Width of the range of angles below `max_angle_deg` in which it fades out, degrees, 0 to 180. 0 is a hard
        /// border.
        pub fade_deg: f32 [range(0.0, 180.0)] = 15.0,
        /// Properties of a surface that it changes, one or a list: `"color"` (base color and emission), `"metallic"`,
        /// `"roughness"` (with reflectivity), `"normal"`. A puddle may change roughness alone. Default: all of them.
        #[by(DecalChanges::read)]
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

    fn read(t: &mut Table) -> Option<Self> {
        let words = Self::WORDS;
        let Some(Names(names)) = t.find("changes", ANY) else {
            return Some(Self::from_flags([true; 4]));
        };
        let unknown = names
            .iter()
            .find(|name| !words.contains(&name.value.as_str()));
        if let Some(unknown) = unknown {
            let name = suggest::text(&unknown.value);
            let message = format!(
                "a decal changes \"color\", \"metallic\", \"roughness\" or \"normal\", not {name}"
            );
            let help = suggest::hint(&unknown.value, &words, suggest::text, "the words are");
            t.refuse("unknown-word", "changes", &message, &help);
        }
        if names.is_empty() {
            let message = "`changes` is empty, so the decal would not be seen";
            let help = "write `changes = [\"color\"]`, or leave it out for all";
            t.refuse("empty-list", "changes", message, help);
        }
        Some(Self::from_flags(
            words.map(|word| names.iter().any(|name| name.value == word)),
        ))
    }
}

impl DecalDesc {
    /// Maximum number of decals: as many as one block of uniforms holds with the sets of them that instances show.
    pub const MOST: usize = 256;

    fn check(&self, t: &mut Table) {
        if self.only.as_ref().is_some_and(Vec::is_empty) {
            let message = "`only` names nothing, so the decal is projected onto nothing";
            let help = "name instances or groups, or leave `only` out for all instances";
            t.refuse("empty-list", "only", message, help);
        }
    }
}
