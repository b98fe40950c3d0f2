//! Maps that a frame captures: of probes, of far things and of the faces of a box.

use reflet_scene::diagnostic::Diagnostic;
use reflet_world::World;

use super::{box_faces::FacesKey, far_maps::FarKey, probe_boxes::probe_boxes, probe_key::ProbeKey};
use crate::{
    plan::{has_box, has_far_maps, has_probes, passes_light, reflects_roughly},
    settings::options::RenderOptions,
};

/// Keys of the maps of a frame; `None` where it has none of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct MapKeys {
    /// Maps of probes.
    pub probes: Option<ProbeKey>,
    /// Maps of method `near-far`.
    pub far: Option<FarKey>,
    /// Faces of the box.
    pub faces: Option<FacesKey>,
}

impl MapKeys {
    /// Keys of a world in these options; a length of one is `meters` of the scene.
    ///
    /// # Errors
    /// Too many probes, or maps that are too large.
    pub fn for_world(
        world: &World,
        options: &RenderOptions,
        meters: f32,
    ) -> Result<Self, Box<Diagnostic>> {
        let settings = &options.reflection;
        let probes = || {
            let is_rough = reflects_roughly(world, settings.reflects_below());
            let boxes = probe_boxes(world, &settings.probes, meters)?;
            ProbeKey::new(boxes, &settings.probes, is_rough, passes_light(world)).checked()
        };
        let faces = || FacesKey::new(world, &settings.box_faces).checked();
        Ok(Self {
            probes: has_probes(world, options).then(probes).transpose()?,
            far: has_far_maps(world, options).then(|| FarKey::new(settings)),
            faces: has_box(world, options).then(faces).transpose()?,
        })
    }
}
