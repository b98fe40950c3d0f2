//! The cube maps of probes, and their content.

use std::sync::Arc;

use reflet_gpu::{Gpu, GpuError, Named};
use reflet_scene::desc::{MOST_CLIP_PLANES, ProbesDesc, ReflectionDesc};

use super::{
    key::ProbeKey,
    light::{by_rays, hash_of_light},
};
use crate::{
    buffers::frame_uniforms::{FrameUniforms, uniform},
    layout::{
        fog::GpuFog,
        types::{Frame, Sampling},
    },
    maps::{
        captured::{Captured, Upkeep},
        cube::{HITS, level_view, texture, whole},
        method_maps::{CaptureInputs, CaptureWork, MapFacts, MapKey, MethodMaps, Number, is_equal},
    },
    settings::view::CUTS_NOTHING,
};

/// Format of the maps' radiance.
const RADIANCE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Maximum length of the rays of a capture, in the renderer's lengths.
const REACH_M: f32 = 1e12;

/// The maps of all probes.
#[derive(Debug)]
pub struct ProbeMaps {
    /// Values for which they were made.
    pub key: ProbeKey,
    /// Uniform blocks of the capture, which do not depend on the camera.
    pub uniforms: FrameUniforms,
    boxes: wgpu::Buffer,
    sampler: wgpu::Sampler,
    /// Captured radiance, and its means over ever larger pixels.
    captured: wgpu::Texture,
    /// Radiance by roughness; the captured one where there is only one level.
    filtered: wgpu::Texture,
    hits: wgpu::Texture,
    /// Hits behind panes, with the share of light that these let pass; `None` where nothing transmits light.
    panes: Option<wgpu::Texture>,
    whole: wgpu::TextureView,
    radiance: wgpu::TextureView,
    hits_view: wgpu::TextureView,
    panes_view: Option<wgpu::TextureView>,
    /// Hash of everything that the maps depend on.
    captured_for: Captured<u64>,
}

impl ProbeMaps {
    /// Creates empty maps.
    ///
    /// # Errors
    /// Maps past the adapter's limits, or exhausted memory.
    pub fn new(gpu: &Gpu, key: ProbeKey) -> Result<Self, GpuError> {
        let (px, levels) = (key.face_px, key.levels());
        gpu.check_texture_size("a face of a probe", px, px)?;
        let mut boxes = key.boxes.clone();
        boxes.resize(ProbesDesc::MOST, bytemuck::Zeroable::zeroed());
        let faces = (px, key.layers());
        let make = |label, format, levels| texture(gpu, label, format, faces, levels);
        let captured = make("probe radiance", RADIANCE, levels)?;
        let filtered = match key.has_levels {
            true => make("probe radiance by roughness", RADIANCE, levels)?,
            false => captured.clone(),
        };
        let hits = make("probe hits", HITS, 1)?;
        let panes = (key
            .has_panes
            .then(|| make("probe hits behind panes", HITS, 1)))
        .transpose()?;
        Ok(Self {
            uniforms: FrameUniforms::new(gpu),
            boxes: uniform(gpu, "probes", bytemuck::cast_slice(&boxes)),
            sampler: gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("probe sampler"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                ..Default::default()
            }),
            whole: whole(&captured, wgpu::TextureViewDimension::CubeArray),
            radiance: whole(&filtered, wgpu::TextureViewDimension::CubeArray),
            hits_view: whole(&hits, wgpu::TextureViewDimension::D2Array),
            panes_view: (panes.as_ref()).map(|p| whole(p, wgpu::TextureViewDimension::D2Array)),
            captured,
            filtered,
            hits,
            panes,
            captured_for: Captured::default(),
            key,
        })
    }

    /// The captured radiance with all of its levels, and its sampler.
    pub fn whole(&self) -> [Named<'_>; 2] {
        [
            ("whole", wgpu::BindingResource::TextureView(&self.whole)),
            (
                "whole_sampler",
                wgpu::BindingResource::Sampler(&self.sampler),
            ),
        ]
    }

    /// View of a level of the captured radiance, to read or to write.
    pub fn captured_level(&self, level: u32) -> wgpu::TextureView {
        level_view(&self.captured, level)
    }

    /// View of a level of the radiance by roughness, to write.
    pub fn filtered_level(&self, level: u32) -> wgpu::TextureView {
        level_view(&self.filtered, level)
    }

    /// View of the hits, to write.
    pub fn hits_level(&self) -> wgpu::TextureView {
        level_view(&self.hits, 0)
    }

    /// View of the hits behind panes, to write.
    pub fn panes_level(&self) -> Option<wgpu::TextureView> {
        (self.panes.as_ref()).map(|panes| level_view(panes, 0))
    }

    /// Copies the captured radiance into the first level of that by roughness.
    pub fn copy_sharp(&self, encoder: &mut wgpu::CommandEncoder) {
        let [from, to] = [&self.captured, &self.filtered].map(wgpu::Texture::as_image_copy);
        let size = wgpu::Extent3d {
            width: self.key.face_px,
            height: self.key.face_px,
            depth_or_array_layers: self.key.layers(),
        };
        encoder.copy_texture_to_texture(from, to, size);
    }

    /// The frame's block without anything that depends on its camera, or on the share of a sub-frame.
    fn frame(&self, frame: &Frame) -> Frame {
        let px = self.key.face_px as f32;
        let spread = std::f32::consts::FRAC_PI_2 / px;
        Frame {
            clip_from_world: glam::Mat4::IDENTITY.to_cols_array_2d(),
            eye: self.key.boxes.first().map_or([0.0; 3], |b| {
                let [x, y, z, _] = b.position;
                [x, y, z]
            }),
            near_m: 1e-4,
            forward: [0.0, 0.0, -1.0],
            pixel_spread: spread,
            right: [1.0, 0.0, 0.0],
            ray_length_m: REACH_M,
            up: [0.0, 1.0, 0.0],
            size: [px, px],
            jitter: [0.0; 2],
            // Mirrors that a probe sees reflect, whether or not the scene's mirrors see each other.
            bounces: frame.bounces + 1,
            fade: 0,
            reuse_light: 0,
            pixel_m: 0.0,
            far_m: 0.0,
            has_edge_on: 0,
            moments: 1,
            moment: 0,
            whole_surfaces: 0,
            sub_frames: 1.0,
            eye_extinction: [0.0; 3],
            eye_scattering: [0.0; 3],
            eye_lit_share: 0.0,
            eye_solids: 0,
            crop: [0.0; 4],
            clip_planes: [CUTS_NOTHING; MOST_CLIP_PLANES],
            ..*frame
        }
    }
}

impl MethodMaps for ProbeMaps {
    fn named(&self) -> Vec<Named<'_>> {
        let view = wgpu::BindingResource::TextureView;
        let mut named = vec![
            ("probes", self.boxes.as_entire_binding()),
            ("probe_radiance", view(&self.radiance)),
            ("cube_hits", view(&self.hits_view)),
            (
                "probe_sampler",
                wgpu::BindingResource::Sampler(&self.sampler),
            ),
        ];
        named.extend((self.panes_view.iter()).map(|panes| ("pane_hits", view(panes))));
        named
    }

    /// The maps are captured where the light, the environment or a material is another than in the last capture.
    fn prepare(&self, gpu: &Gpu, inputs: &CaptureInputs<'_>) -> bool {
        if inputs.sampling.sample > 0 {
            return false;
        }
        let (world, frame, lights) = (
            inputs.world,
            self.frame(inputs.frame),
            by_rays(inputs.lights),
        );
        let sampling = Sampling {
            first: 0,
            sample: 0,
            samples: self.key.samples,
            ..*inputs.sampling
        };
        let fog = GpuFog::from_world(world);
        let hash = hash_of_light(world, &frame, &lights, &sampling, fog.as_ref());
        if !self.captured_for.replace(hash) {
            return false;
        }
        self.uniforms.set(gpu, &frame, &lights, &sampling);
        if let Some(fog) = &fog {
            self.uniforms.set_fog(gpu, fog);
        }
        true
    }

    fn upkeep(&self) -> &dyn Upkeep {
        &self.captured_for
    }
}

impl MapKey for ProbeKey {
    fn make(&self, gpu: &Gpu) -> Result<Arc<dyn MethodMaps>, GpuError> {
        Ok(Arc::new(ProbeMaps::new(gpu, self.clone())?))
    }

    fn is_same(&self, other: &dyn MapKey) -> bool {
        is_equal(self, other)
    }

    fn facts(&self, _: &ReflectionDesc, _: f32, _: f32) -> MapFacts {
        let (count, px) = (self.boxes.len() as u64, self.face_px);
        let text = format!("{count} with faces of {px} px");
        let counts = |name| [(name, count), ("face_px", px.into())];
        let numbers = |name| {
            counts(name)
                .map(|(name, n)| (name, Number::Count(n)))
                .to_vec()
        };
        MapFacts {
            label: "probes",
            keys: ["probes"; 2],
            texts: [text.clone(), text],
            numbers: ["probes", "count"].map(numbers),
            bytes: self.bytes(),
        }
    }

    fn work(&self) -> CaptureWork {
        let (count, px, samples) = (self.boxes.len(), self.face_px, self.samples);
        CaptureWork {
            maps: format!(
                "{count} probes, six faces of {px} × {px} pixels with {samples} samples each"
            ),
            paths: self.paths(),
            face_px: px,
            serves_samples: true,
            table: "probes",
            sized_by: &["face_px", "samples", "spacing_m"],
            or: ", fewer `samples`, or fewer probes",
            when: "before the first picture, and again where light or a material changes",
        }
    }
}
