//! Features that a scene does not use, and why.

use serde::Serialize;

use crate::scene::desc::ReflectionDesc;

use super::Plan;

/// A feature that was left out, and the reason why that changes nothing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Dropped {
    /// Name of the feature.
    pub what: &'static str,
    /// Reason that it is unused.
    pub why: &'static str,
}

/// Whether a feature is unused, its name, and the reason.
type Candidate = (bool, &'static str, &'static str);

impl Plan {
    /// Lists all features that the plan leaves out.
    pub(super) fn list_dropped(&mut self, settings: &ReflectionDesc) {
        let candidates = self
            .passes_and_trees()
            .into_iter()
            .chain(self.surfaces_and_light(settings));
        let unused = candidates.filter(|(is_unused, ..)| *is_unused);
        self.dropped = unused.map(|(_, what, why)| Dropped { what, why }).collect();
    }

    fn passes_and_trees(&self) -> [Candidate; 6] {
        [
            (
                !self.reflections,
                "reflection passes",
                "no material can reflect",
            ),
            (
                !self.traced,
                "all trees",
                "no ray is followed: for reflections, primary visibility or shadows",
            ),
            (
                self.traced && !self.static_tree,
                "static tree",
                "no geometry is static",
            ),
            (
                self.traced && !self.top_level,
                "top level",
                "nothing is dynamic, and copies of static meshes are few enough to bake",
            ),
            (
                self.reflections && !self.culled_surfaces,
                "depth of culled surfaces",
                "no surface that reflection rays may hit is culled by the camera",
            ),
            (
                !self.precision.full,
                "32 bits of radiance",
                "16 bits hold the brightest light of the scene",
            ),
        ]
    }

    fn surfaces_and_light(&self, settings: &ReflectionDesc) -> [Candidate; 21] {
        [
            (!self.cutouts, "alpha tests", "no material is cut out"),
            (!self.textures, "textures", "no material has one"),
            (
                self.textures && !self.normal_maps,
                "normal maps",
                "no material has one",
            ),
            (!self.checkers, "checkers", "no material has one"),
            (
                !self.shadow_rays,
                "shadow rays",
                "no light casts its shadow by rays",
            ),
            (
                self.reflections && !self.lends_light,
                "light reuse",
                "no light without a size casts its shadow by rays",
            ),
            (
                !self.sampled_environment,
                "samples of the environment",
                "the environment is a gradient and casts no shadows",
            ),
            (
                !self.sized_lights,
                "samples of lights",
                "no light has a size",
            ),
            (
                !self.emitters,
                "samples of emitting surfaces",
                "no material has `light = true`",
            ),
            (
                self.reflections && !self.rough_reflections,
                "rough reflections",
                "all reflective materials are smooth",
            ),
            (!self.indirect, "indirect light", "`diffuse_bounces` is 0"),
            (
                !self.surfaces.transmission,
                "transmission",
                "no material lets light through",
            ),
            (!self.surfaces.coats, "clear coats", "no material has one"),
            (
                self.surfaces.coats && !self.surfaces.coat_normals,
                "normals of clear coats",
                "all have the normals of the layer below",
            ),
            (
                !self.surfaces.tints,
                "strength and color of specular lobes",
                "no material sets them",
            ),
            (!self.surfaces.sheen, "sheen", "no material has one"),
            (
                !self.surfaces.iridescence,
                "iridescence",
                "no material has a thin film",
            ),
            (
                !self.surfaces.anisotropy,
                "anisotropy",
                "no material is anisotropic",
            ),
            (
                self.surfaces.transmission && !self.surfaces.dispersion,
                "dispersion",
                "no solid has dispersion",
            ),
            (
                settings.multiple_scattering && !self.multiple_scattering,
                "multiple scattering",
                "no material has a specular lobe",
            ),
            (
                self.reflections && self.bounces < settings.bounces,
                "bounces after the first",
                "no reflector can see another",
            ),
        ]
    }
}
