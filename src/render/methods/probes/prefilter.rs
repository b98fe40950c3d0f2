//! Prefilter: levels of the maps of probes for rough reflections, after a capture.

use wgpu::BindingResource;

use crate::pipeline::prelude::*;

use super::{capture, key::ProbeKey, maps::ProbeMaps};

/// See `shaders/methods/probes/prefilter.wgsl`.
pub const PASS: Pass = Pass {
    name: "prefilter",
    group: PassGroup::Capture,
    color: [11, 6, 154],
    params: Some(Params::LAYOUT),
    reads_shared: &[MethodMaps],
    writes_shared: &[MethodMaps],
    needed: |plan, _| capture::has_levels(plan),
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the prefilter for one level.
    pub struct Params = "Params" {
        /// Width of the faces of the level, pixels.
        face_px: u32,
        /// Width of the captured faces, pixels.
        sharp_px: u32,
        /// GGX alpha of the level.
        alpha: f32,
    }
}

impl Params {
    /// Uniforms of a level; roughness grows evenly from 0 at the first to 1 at the last.
    fn new(key: &ProbeKey, level: u32) -> Self {
        let roughness = level as f32 / (key.levels() - 1).max(1) as f32;
        Self {
            face_px: key.level_px(level),
            sharp_px: key.face_px,
            alpha: roughness * roughness,
        }
    }
}

/// The prefilter on the device: for each level after the first a pass that averages pixels of the level before, then
/// for each a pass that averages over a lobe.
#[derive(Debug)]
pub struct Prefilter([Vec<ComputePass>; 2]);

impl FramePass for Prefilter {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let maps = builder.maps::<ProbeMaps>()?;
        let shrink = |level: u32| {
            let (finer, written) = (maps.captured_level(level - 1), maps.captured_level(level));
            let extra = [
                ("finer", BindingResource::TextureView(&finer)),
                ("level", BindingResource::TextureView(&written)),
            ];
            builder.with_resources(&PASS, "shrink", &extra)
        };
        let filter = |level: u32| {
            let written = maps.filtered_level(level);
            let [whole, sampler] = maps.whole();
            let extra = [
                whole,
                sampler,
                ("level", BindingResource::TextureView(&written)),
            ];
            builder.with_resources(&PASS, "main", &extra)
        };
        let levels = 1..maps.key.levels();
        Ok(Self([
            levels.clone().map(shrink).collect::<Result<_, _>>()?,
            levels.map(filter).collect::<Result<_, _>>()?,
        ]))
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let maps = frame.resources.maps::<ProbeMaps>();
        let Some(maps) = maps.filter(|_| frame.captures) else {
            return;
        };
        let (gpu, key) = (frame.recorder.gpu, &maps.key);
        maps.copy_sharp(frame.recorder.encoder());
        for passes in &self.0 {
            for (level, pass) in (1..).zip(passes) {
                let params = Params::new(key, level);
                pass.set_params(gpu, &params);
                let groups = params.face_px.div_ceil(pass.tile()[0]);
                frame.recorder.pass(PASS.name, |encoder, recording| {
                    let groups = [groups, groups, key.layers()];
                    pass.encode(encoder, recording, recording.shared, groups);
                });
            }
        }
    }
}
