//! Method `ssr+box`: a march through the picture, then through views of the static scene from the faces of a box.

use std::sync::Arc;

use glam::Vec3;

use reflet_scene::{
    desc::{Method, ReflectionDesc, reflection::BoxFacesDesc},
    diagnostic::{Diagnostic, Span},
};
use reflet_world::{Material, World};

use super::{
    Maps, MethodRow, Place,
    face_maps::{CaptureFaces, FaceKey},
};
use crate::{
    maps::{
        cube::{FACES, HIT_BYTES, MAX_MAP_BYTES, still_bounds},
        method_maps::{CaptureInputs, MapFacts, Number},
    },
    pipeline::{frame_pass::FrameRow, prelude::*},
    upload::world_key::changing_cut_outs,
};

/// Entry of the method.
pub(super) const ROW: MethodRow = MethodRow {
    maps: Some(Maps {
        methods: &[Method::SsrBox],
        key: |world, options, _| {
            let key = FacesKey::new(world, &options.reflection.box_faces);
            Ok(Arc::new(key.checked()?))
        },
        of_static: Some([
            "the faces of the box see",
            "reflections that the screen loses show the environment",
        ]),
    }),
    passes: &[(
        Place::Capture,
        FrameRow::new::<CaptureFaces<FacesKey>>(&PASS),
    )],
    ..MethodRow::NONE
};

/// Captures what is static in the box, as its faces see it, before the first frame; see
/// `shaders/methods/box_faces/box_faces.wgsl`.
pub const PASS: Pass = Pass {
    name: "box_faces",
    group: PassGroup::Capture,
    color: [0, 0, 250],
    writes_shared: &[MethodMaps],
    structs: &[FaceBox::LAYOUT],
    needed: |plan, _| plan.maps == Some(Method::SsrBox),
    overrides: |_| vec![("STATIC_ONLY", 1.0)],
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// The box of method `ssr+box`; see `shaders/methods/box_faces/lib/face_box.wgsl`.
    pub struct FaceBox = "FaceBox" {
        /// Least corner, meters.
        low: [f32; 3],
        /// Maximum number of steps of a march through the box.
        steps: u32,
        /// Size along each axis, meters, above 0.
        size: [f32; 3],
    }
}

/// Size of the default box along an axis in which the static scene has none, over its diagonal.
const LEAST_SHARE: f32 = 1e-3;
/// Size of the box of a scene without extent, in the renderer's lengths.
const LEAST_SIZE_M: f32 = 1e-3;

/// Values for which buffers are made; where they differ, buffers are made and captured anew.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FacesKey {
    /// Least corner of the box, meters.
    low: Vec3,
    /// Size of the box along each axis, meters, above 0.
    size: Vec3,
    face_px: u32,
}

impl FacesKey {
    /// Key of the buffers of a world in these settings.
    fn new(world: &World, settings: &BoxFacesDesc) -> Self {
        let face_px = settings.face_px;
        if let (Some(low), Some(high)) = (settings.box_min, settings.box_max) {
            let size = high - low;
            return Self { low, size, face_px };
        }
        let still = still_bounds(world);
        let least = (LEAST_SHARE * still.diagonal()).max(LEAST_SIZE_M);
        let size = (still.max - still.min).max(Vec3::splat(least));
        Self {
            low: still.center() - 0.5 * size,
            size,
            face_px,
        }
    }

    /// The key itself, if its faces are not too large.
    ///
    /// # Errors
    /// More than [`MAX_MAP_BYTES`], with the largest width that has no more.
    fn checked(self) -> Result<Self, Box<Diagnostic>> {
        let (px, bytes) = (self.face_px, self.bytes());
        if bytes <= MAX_MAP_BYTES {
            return Ok(self);
        }
        let most_px = (MAX_MAP_BYTES / (HIT_BYTES * u64::from(FACES))).isqrt();
        let message = format!(
            "a box with faces of {px} pixels takes {} MiB; there is room for {} MiB",
            bytes >> 20,
            MAX_MAP_BYTES >> 20
        );
        let error = Diagnostic::new("box-faces-too-large", Span::default(), message);
        Err(Box::new(error.help(format!(
            "write a `face_px` of {most_px} or less in `[box_faces]`"
        ))))
    }
}

impl FaceKey for FacesKey {
    const PASS: &'static Pass = &PASS;
    const NAMES: [&'static str; 3] = ["face_box", "face_hits", "written_faces"];
    const FACE: &'static str = "a face of the box";
    const TABLE: &'static str = "box_faces";
    const WORK: [&'static str; 2] = ["the six faces", "before the first picture"];
    type Block = FaceBox;
    /// Cut-outs that may change; nothing else that is on the faces does.
    type Content = Vec<Material>;

    fn face_px(&self) -> u32 {
        self.face_px
    }

    fn block(&self, inputs: &CaptureInputs<'_>) -> FaceBox {
        FaceBox {
            low: self.low.to_array(),
            steps: inputs.settings.steps,
            size: self.size.to_array(),
        }
    }

    fn content(inputs: &CaptureInputs<'_>, _: &FaceBox) -> Vec<Material> {
        changing_cut_outs(inputs.world)
    }

    fn face_facts(&self, _: &ReflectionDesc, _: f32, meters: f32) -> MapFacts {
        let px = self.face_px;
        let corners = [self.size, self.low, self.low + self.size];
        let [size, low, high] = corners.map(|point| (point * meters).to_array());
        let ([x, y, z], [x0, y0, z0], [x1, y1, z1]) = (size, low, high);
        let (faces, point) = (("face_px", Number::Count(px.into())), Number::Point);
        MapFacts {
            label: "box",
            keys: ["box_faces"; 2],
            texts: [
                format!("{x} × {y} × {z} m with faces of {px} px"),
                format!("({x0}, {y0}, {z0}) to ({x1}, {y1}, {z1}) m, faces of {px} px"),
            ],
            numbers: [
                vec![("size_m", point(size)), faces],
                vec![("box_min", point(low)), ("box_max", point(high)), faces],
            ],
            bytes: self.bytes(),
        }
    }
}
