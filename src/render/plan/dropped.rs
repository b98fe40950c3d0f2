//! What a scene does not use, and why.

use serde::Serialize;

use crate::scene::desc::ReflectionDesc;

use super::Plan;

/// One thing that was left out, and why that changes nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// What.
    pub what: &'static str,
    /// Why.
    pub why: String,
}

impl Plan {
    /// Names everything that the plan leaves out.
    pub(super) fn list_dropped(&mut self, settings: &ReflectionDesc) {
        let mut drop = |unused: bool, what, why: &str| {
            if unused {
                let why = why.to_owned();
                self.dropped.push(Dropped { what, why });
            }
        };
        drop(
            !self.reflections,
            "reflection passes",
            "no material can reflect",
        );
        drop(
            !self.traced,
            "all trees",
            "no ray is followed: for reflections, primary visibility or shadows",
        );
        drop(
            self.traced && !self.static_tree,
            "static tree",
            "nothing stands still",
        );
        drop(
            self.traced && !self.top_level,
            "top level",
            "nothing is dynamic, and copies of static meshes are few enough to bake",
        );
        drop(
            self.reflections && !self.culled_surfaces,
            "depth of culled surfaces",
            "nothing that is marched has a back that the camera culls",
        );
        drop(
            !self.precision.full,
            "32 bits of radiance",
            "16 hold what shines and is lit",
        );
        drop(!self.cutouts, "alpha tests", "no material is cut out");
        drop(!self.textures, "textures", "no material has one");
        drop(
            self.textures && !self.normal_maps,
            "normal maps",
            "no material has one",
        );
        drop(!self.checkers, "checkers", "no material has one");
        drop(!self.shadow_rays, "shadow rays", "no light asks for them");
        drop(
            self.reflections && !self.lends_light,
            "light reuse",
            "no light casts its shadow by rays",
        );
        drop(
            !self.sampled_environment,
            "samples of the environment",
            "it is a gradient that nothing shades",
        );
        drop(
            !self.sized_lights,
            "samples of lights",
            "no light has a size",
        );
        drop(
            self.reflections && !self.rough_reflections,
            "rough reflections",
            "whatever reflects is smooth",
        );
        drop(
            !self.transmission,
            "transmission",
            "no material lets light through",
        );
        drop(!self.coats, "clear coats", "no material has one");
        drop(
            settings.multiple_scattering && !self.multiple_scattering,
            "multiple scattering",
            "no material has a specular lobe",
        );
        drop(
            self.reflections && self.bounces < settings.bounces,
            "bounces after the first",
            "no reflector can see another",
        );
    }
}
