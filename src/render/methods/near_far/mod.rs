//! Method `near-far`: rays near the camera, and a march through maps of the scene beyond.

use std::sync::Arc;

use reflet_scene::desc::{Method, ReflectionDesc};
use reflet_world::Material;

use super::{
    Maps, MethodRow, Place,
    face_maps::{CaptureFaces, FaceKey},
};
use crate::{
    maps::method_maps::{CaptureInputs, MapFacts, Number},
    pipeline::{frame_pass::FrameRow, prelude::*},
    upload::world_key::{PoseKey, changing_cut_outs},
};

/// Entry of the method.
pub(super) const ROW: MethodRow = MethodRow {
    maps: Some(Maps {
        methods: &[Method::NearFar],
        key: |_, options, _| Ok(Arc::new(FarKey::new(&options.reflection))),
        of_static: None,
    }),
    adopt: |own, asked| own.near_far.half_size_m = asked.near_far.half_size_m,
    passes: &[(Place::Capture, FrameRow::new::<CaptureFaces<FarKey>>(&PASS))],
};

/// Captures what the camera sees behind the box, in all directions, before every sub-frame for which the camera or the
/// scene has moved; see `shaders/methods/near_far/far.wgsl`.
pub const PASS: Pass = Pass {
    name: "far",
    group: PassGroup::Capture,
    color: [0, 0, 0],
    writes_shared: &[MethodMaps],
    structs: &[FarBox::LAYOUT],
    needed: |plan, _| plan.maps == Some(Method::NearFar),
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// The box of method `near-far`; see `shaders/methods/near_far/lib/far_box.wgsl`.
    pub struct FarBox = "FarBox" {
        /// Middle of the box, from which the maps are captured, meters.
        eye: [f32; 3],
        /// Half the size of the box, meters, above 0.
        half_size_m: f32,
        /// Number of maps.
        layers: u32,
        /// Maximum number of steps of a march through the maps.
        steps: u32,
        /// Minimum distance between the surfaces of successive maps along a ray, meters.
        separation_m: f32,
    }
}

/// Values for which maps are made; where they differ, maps are made anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct FarKey {
    face_px: u32,
    /// Number of maps, 1 to 2: the nearest surfaces behind the box, and the surfaces behind them.
    layers: u32,
}

impl FarKey {
    fn new(settings: &ReflectionDesc) -> Self {
        Self {
            face_px: settings.near_far.face_px,
            layers: settings.layers,
        }
    }
}

impl FaceKey for FarKey {
    const PASS: &'static Pass = &PASS;
    const NAMES: [&'static str; 3] = ["far_box", "cube_hits", "far_hits"];
    const FACE: &'static str = "a face of the far map";
    const OF_A_VIEW: bool = true;
    const TABLE: &'static str = "near_far";
    const WORK: [&'static str; 2] = [
        "six faces",
        "for each picture in which the camera or a thing moves",
    ];
    type Block = FarBox;
    /// Place, box, pose and cut-outs.
    type Content = ([u32; 5], PoseKey, Vec<Material>);

    fn face_px(&self) -> u32 {
        self.face_px
    }

    fn cubes(&self) -> u32 {
        self.layers
    }

    fn block(&self, inputs: &CaptureInputs<'_>) -> FarBox {
        let (settings, unit_m) = (inputs.settings, inputs.unit_m);
        FarBox {
            eye: inputs.eye.to_array(),
            half_size_m: settings.near_far.half_size_in(unit_m),
            layers: self.layers,
            steps: settings.steps,
            separation_m: settings.separation_in(unit_m),
        }
    }

    fn content(inputs: &CaptureInputs<'_>, far_box: &FarBox) -> Self::Content {
        let ([x, y, z], world) = (far_box.eye, inputs.world);
        let place = [x, y, z, far_box.half_size_m, far_box.separation_m].map(f32::to_bits);
        (place, PoseKey::from_world(world), changing_cut_outs(world))
    }

    fn face_facts(&self, settings: &ReflectionDesc, unit_m: f32, meters: f32) -> MapFacts {
        let (px, near_m) = (
            self.face_px,
            settings.near_far.half_size_in(unit_m) * meters,
        );
        let layers = if self.layers > 1 { ", 2 layers" } else { "" };
        let box_and_faces = vec![
            ("half_size_m", Number::Length(near_m)),
            ("face_px", Number::Count(px.into())),
        ];
        let layered = [("layers", Number::Count(self.layers.into()))];
        MapFacts {
            label: "near-far",
            keys: ["far", "near_far"],
            texts: [
                format!(
                    "rays up to {near_m} m from the camera along each axis; map with faces of {px} px{layers}"
                ),
                format!("box of ±{near_m} m, map with faces of {px} px"),
            ],
            numbers: [[&box_and_faces[..], &layered].concat(), box_and_faces],
            bytes: self.bytes(),
        }
    }
}
