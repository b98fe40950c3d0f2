//! Probes, the box and the maps of methods that capture what is around.

use serde::Serialize;

use crate::{
    render::{RenderOptions, maps::map_keys::MapKeys},
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

/// Maps that a frame captures; `None` where it has none of a kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MapsInfo {
    /// Probes.
    pub probes: Option<ProbesInfo>,
    /// Box and buffers on its faces.
    pub box_faces: Option<BoxInfo>,
    /// Box and maps of method `near-far`.
    pub near_far: Option<NearFarInfo>,
}

impl MapsInfo {
    /// Maps of a world of this unit in these options; none where they are refused.
    pub fn for_world(world: &World, options: &RenderOptions, unit_m: f32) -> Self {
        let Ok(MapKeys { probes, far, faces }) = MapKeys::for_world(world, options, 1.0) else {
            return Self::default();
        };
        let near_far = options.reflection.near_far;
        Self {
            probes: probes.map(|key| ProbesInfo {
                count: key.boxes.len(),
                face_px: key.face_px,
                bytes: key.bytes(),
            }),
            box_faces: faces.map(|key| BoxInfo {
                box_min: key.low.to_array(),
                box_max: (key.low + key.size).to_array(),
                face_px: key.face_px,
                bytes: key.bytes(),
            }),
            near_far: far.map(|key| NearFarInfo {
                half_size_m: near_far.half_size_in(unit_m),
                face_px: key.face_px,
                bytes: key.bytes(),
            }),
        }
    }
}
