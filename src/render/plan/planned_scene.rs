//! A scene as the table of features asks about it.

use reflet_scene::desc::ShownDesc;
use reflet_world::{Material, World, bvh::Trees};

use super::{mutual_reflections::reflectors_see_each_other, scatters, uses::passes_light};
use crate::{
    lighting::lights::{LightNeeds, ShadowSizes},
    settings::{options::RenderOptions, precision::Precision},
};

/// A scene for which features are chosen.
pub struct PlannedScene<'a> {
    /// World with its files loaded.
    pub world: &'a World,
    /// Materials of its instances.
    pub materials: Vec<&'a Material>,
    /// BVHs of the world.
    pub trees: &'a Trees,
    /// Render options, settled.
    pub options: &'a RenderOptions,
    /// Precision of stored light.
    pub precision: Precision,
}

impl PlannedScene<'_> {
    /// Whether the frame keeps all features whose absence changes no picture: the general frame, which the planned
    /// one is compared with. Lights and their sampling stay as in the scene, since samples differ from closed forms
    /// until they converge.
    pub(super) fn is_general(&self) -> bool {
        self.options.general
    }

    /// Whether some material has a feature.
    pub(super) fn has(&self, feature: fn(&Material) -> bool) -> bool {
        self.materials.iter().copied().any(feature)
    }

    /// Whether some material or decal has a feature.
    pub(super) fn paints(&self, feature: fn(&Material) -> bool) -> bool {
        let mut decals = self.world.decals.list.iter();
        self.has(feature) || decals.any(|d| feature(&self.world.materials[d.material]))
    }

    /// Whether light may be reflected, transmitted or scattered more than once.
    pub(super) fn may_bounce(&self) -> bool {
        passes_light(self.world)
            || scatters(self.options)
            || reflectors_see_each_other(self.world, self.cutoff())
    }

    /// Whether the camera does not see some instance, one of its sides, or parts that are cut away.
    pub(super) fn culls_some(&self) -> bool {
        let mut instances = self.world.instances.iter();
        self.has(|m| m.alpha_cutoff.is_some())
            || instances.any(|instance| self.world.hides_from_camera(instance))
    }

    /// Whether some instance is hidden from a kind of ray, or may be.
    pub(super) fn hides_some(&self) -> bool {
        let skips = self.options.reflection.skip_px > 0.0;
        let mut instances = self.world.instances.iter();
        skips || instances.any(|i| i.shown != ShownDesc::default())
    }

    /// Roughness below which materials reflect.
    pub(super) fn cutoff(&self) -> f32 {
        self.options.reflection.reflects_below()
    }

    pub(super) fn lights(&self) -> LightNeeds {
        LightNeeds::for_lights(&self.world.lights, self.options)
    }

    pub(super) fn shadows(&self) -> ShadowSizes {
        ShadowSizes::for_lights(&self.world.lights, self.options)
    }
}
