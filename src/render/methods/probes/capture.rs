//! Capture: the static scene, seen from every probe. It runs before the first frame, and again where its light or a
//! material has changed.

use crate::{
    pipeline::{prelude::*, resources::Resources, shared_groups::SharedGroups},
    plan::Plan,
};
use reflet_scene::desc::Method;

use super::{boxes::ProbeBox, maps::ProbeMaps};

/// See `shaders/methods/probes/capture.wgsl`.
pub const PASS: Pass = Pass {
    name: "capture",
    group: PassGroup::Capture,
    color: [252, 10, 251],
    params: Some(Params::LAYOUT),
    // Bound, as the code of light names them, but left unread by the overrides.
    reads_shared: &[ShadowMaps],
    writes_shared: &[MethodMaps],
    structs: &[ProbeBox::LAYOUT],
    needed: |plan, _| plan.maps.is_some_and(Method::looks_up),
    // Things that move are left out, and so are shadow maps, on which they may be.
    overrides: |_| {
        vec![
            ("STATIC_ONLY", 1.0),
            ("HAS_SHADOW_RAYS", 1.0),
            ("HAS_HARD_SHADOW_RAYS", 1.0),
            ("HAS_CUBE_MAPS", 0.0),
            ("HAS_FLAT_MAPS", 0.0),
        ]
    },
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of a part of the capture.
    pub struct Params = "Params" {
        /// First layer of the part, of six for each probe.
        first_layer: u32,
        /// Width of the faces, pixels.
        face_px: u32,
        /// Number of samples per pixel.
        samples: u32,
        /// First column of the part.
        first_x: u32,
        /// First row of the part.
        first_y: u32,
    }
}

/// Maximum number of paths of a dispatch, where a tile has no more: systems reset a device that is busy for seconds.
const MOST_PATHS: u64 = 1 << 22;

/// Dispatches of a capture: all faces of a probe, or where these are too many paths, a square of one face.
struct Parts {
    /// Width of the faces, pixels.
    face_px: u32,
    /// Faces of a part: six or one.
    faces: u32,
    /// Width of a part, pixels: a multiple of a tile's.
    side_px: u32,
    /// Number of squares along a face.
    squares: u32,
}

impl Parts {
    fn new(face_px: u32, samples: u32, tile_px: u32) -> Self {
        let whole_px = face_px.next_multiple_of(tile_px);
        let paths = |side_px: u32, faces: u32| {
            u64::from(side_px).pow(2) * u64::from(faces) * u64::from(samples)
        };
        let faces = if paths(face_px, 6) <= MOST_PATHS {
            6
        } else {
            1
        };
        let mut side_px = whole_px;
        while side_px > tile_px && paths(side_px.min(face_px), faces) > MOST_PATHS {
            side_px = (side_px / 2).next_multiple_of(tile_px);
        }
        Self {
            face_px,
            faces,
            side_px,
            squares: face_px.div_ceil(side_px),
        }
    }

    /// Number of parts of each probe.
    fn of_probe(&self) -> usize {
        (6 / self.faces * self.squares * self.squares) as usize
    }

    /// First layer, column and row of a part, counted over all probes.
    fn start(&self, part: usize) -> (u32, [u32; 2]) {
        let (probe, part) = (part / self.of_probe(), (part % self.of_probe()) as u32);
        let (face, square) = (part / self.squares.pow(2), part % self.squares.pow(2));
        let first = [square % self.squares, square / self.squares].map(|k| k * self.side_px);
        (6 * probe as u32 + face, first)
    }

    /// Number of workgroups of a part along its axes.
    fn groups(&self, tile_px: u32) -> [u32; 3] {
        let side = self.side_px.min(self.face_px).div_ceil(tile_px);
        [side, side, self.faces]
    }
}

/// The capture on the device.
#[derive(Debug)]
pub struct Capture {
    pass: ComputePass,
    /// Groups 0 and 1 with the blocks of the capture.
    shared: SharedGroups,
}

impl FramePass for Capture {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let maps = builder.maps::<ProbeMaps>()?;
        let resources = Resources {
            uniforms: &maps.uniforms,
            ..builder.resources
        };
        let infos = [&builder.shader(&PASS)?.info];
        let shared = SharedGroups::new(builder.gpu, &infos, resources)?;
        let inner = PassBuilder {
            shared: &shared,
            ..*builder
        };
        let (radiance, hits) = (maps.captured_level(0), maps.hits_level());
        let view = wgpu::BindingResource::TextureView;
        let panes = maps.panes_level();
        let mut extra = vec![
            ("captured", view(&radiance)),
            ("captured_hits", view(&hits)),
        ];
        extra.extend(panes.iter().map(|panes| ("captured_panes", view(panes))));
        let pass = inner.with_resources(&PASS, "main", &extra)?;
        Ok(Self { pass, shared })
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let maps = frame.resources.maps::<ProbeMaps>();
        let Some(maps) = maps.filter(|_| frame.captures) else {
            return;
        };
        let (gpu, key) = (frame.recorder.gpu, &maps.key);
        let tile_px = self.pass.tile()[0];
        let parts = Parts::new(key.face_px, key.samples, tile_px);
        let count = key.boxes.len() * parts.of_probe();
        frame
            .recorder
            .pass_in_parts(PASS.name, count, |part, encoder, recording| {
                let (first_layer, [first_x, first_y]) = parts.start(part);
                let params = Params {
                    first_layer,
                    face_px: key.face_px,
                    samples: key.samples,
                    first_x,
                    first_y,
                };
                self.pass.set_params(gpu, &params);
                let groups = parts.groups(tile_px);
                self.pass.encode(encoder, recording, &self.shared, groups);
            });
    }
}

/// Whether a frame with this plan has maps with levels for rough reflections.
pub fn has_levels(plan: &Plan) -> bool {
    plan.maps.is_some_and(Method::looks_up) && plan.features.rough_reflections
}

#[cfg(test)]
mod tests {
    use super::{MOST_PATHS, Parts};

    /// Parts of a capture: each pixel of each face once, and no more paths in a dispatch than are allowed.
    #[test]
    fn parts_cover_all_faces_once_with_few_paths() {
        let tile_px = 8;
        for (face_px, samples, of_probe) in [
            (128, 16, 1),
            (8, 1024, 1),
            (100, 1024, 24),
            (1000, 64, 96),
            (4096, 1, 24),
            (4096, 1024, 24_576),
        ] {
            let parts = Parts::new(face_px, samples, tile_px);
            assert_eq!(parts.of_probe(), of_probe, "{face_px} {samples}");
            let [wide, high, deep] = parts.groups(tile_px);
            let paths = u64::from(wide * high * tile_px * tile_px) * u64::from(deep * samples);
            assert!(paths <= MOST_PATHS, "{face_px} {samples}: {paths}");
            let mut area = vec![0_u64; 12];
            let mut starts = Vec::new();
            for part in 0..2 * of_probe {
                let (layer, [x, y]) = parts.start(part);
                let size = |from: u32| u64::from(parts.side_px.min(face_px - from));
                for face in layer..layer + deep {
                    area[face as usize] += size(x) * size(y);
                }
                starts.push((layer, x, y));
            }
            assert_eq!(area, [u64::from(face_px).pow(2); 12]);
            starts.sort_unstable();
            starts.dedup();
            assert_eq!(starts.len(), 2 * of_probe);
        }
    }
}
