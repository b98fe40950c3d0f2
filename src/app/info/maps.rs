//! Probes, the box and the maps of methods that capture what is around.

use serde::Serialize;

use crate::{
    render::{
        RenderOptions, box_faces::FacesKey, far_maps::FarKey, passes::capture, plan::Plan,
        probe_boxes::probe_boxes, probe_maps::ProbeKey,
    },
    scene::desc::ReflectionDesc,
    world::World,
};

/// Number and size of a scene's probes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ProbesInfo {
    /// Number of probes.
    pub count: usize,
    /// Width of the faces of their maps, pixels.
    pub face_px: u32,
    /// Size of all maps, bytes.
    pub bytes: u64,
}

/// Box and buffers of method `ssr+box`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoxInfo {
    /// Least corner of the box, meters.
    pub box_min: [f32; 3],
    /// Greatest corner of the box, meters.
    pub box_max: [f32; 3],
    /// Width of the faces, pixels.
    pub face_px: u32,
    /// Size of all faces, bytes.
    pub bytes: u64,
}

/// Box and maps of method `near-far`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NearFarInfo {
    /// Half the size of the box, meters.
    pub half_size_m: f32,
    /// Width of the faces of its maps, pixels.
    pub face_px: u32,
    /// Size of all maps, bytes.
    pub bytes: u64,
}

/// Probes of a frame with this plan; `None` where it has none, or too many.
pub fn probes(world: &World, plan: &Plan, options: &RenderOptions) -> Option<ProbesInfo> {
    let settings = &options.reflection.probes;
    let boxes = (plan.features.probes).then(|| probe_boxes(world, settings).ok());
    let key = ProbeKey::new(
        boxes.flatten()?,
        settings,
        capture::has_levels(plan),
        plan.features.probe_panes,
    );
    Some(ProbesInfo {
        count: key.boxes.len(),
        face_px: key.face_px,
        bytes: key.bytes(),
    })
}

/// Box and buffers of a frame with this plan; `None` where it has none.
pub fn box_faces(world: &World, settings: &ReflectionDesc, plan: &Plan) -> Option<BoxInfo> {
    let key = FacesKey::of(world, plan, settings)?;
    Some(BoxInfo {
        box_min: key.low.to_array(),
        box_max: (key.low + key.size).to_array(),
        face_px: key.face_px,
        bytes: key.bytes(),
    })
}

/// Box and maps of a frame with this plan; `None` where it has none.
pub fn near_far(settings: &ReflectionDesc, unit_m: f32, plan: &Plan) -> Option<NearFarInfo> {
    let key = FarKey::new(settings);
    (plan.features.near_far).then(|| NearFarInfo {
        half_size_m: settings.near_far.half_size_in(unit_m),
        face_px: key.face_px,
        bytes: key.bytes(),
    })
}
