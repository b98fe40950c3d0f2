//! Maps of the surroundings beyond the box of method `near-far`, and their content.

use glam::Vec3;
use serde::Serialize;

use reflet_gpu::{Gpu, GpuError, Named};
use reflet_scene::desc::ReflectionDesc;
use reflet_world::{Material, World};

use super::{
    captured::Captured,
    map_size::{FACES, HIT_BYTES, texels},
    probe_maps::{HITS, level_view, texture, whole},
};
use crate::{
    buffers::frame_uniforms::empty_uniform,
    layout::types::FarBox,
    upload::world_key::{PoseKey, changing_cut_outs},
};

/// Values for which maps are made; where they differ, maps are made anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FarKey {
    /// Width of the faces, pixels.
    pub face_px: u32,
    /// Number of maps, 1 to 2: the nearest surfaces behind the box, and the surfaces behind them.
    pub layers: u32,
}

impl FarKey {
    /// Key of the maps in these settings.
    pub fn new(settings: &ReflectionDesc) -> Self {
        Self {
            face_px: settings.near_far.face_px,
            layers: settings.layers,
        }
    }

    /// Size of all maps, bytes.
    pub fn bytes(&self) -> u64 {
        HIT_BYTES * self.pixels()
    }

    /// Number of pixels of all maps, each of which a capture follows a ray for.
    pub fn pixels(&self) -> u64 {
        texels(FACES * self.layers, self.face_px)
    }
}

/// Size of the maps of a frame, and the time that they took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FarStats {
    /// Half the size of the box in which rays are traced, meters.
    pub half_size_m: f32,
    /// Width of the faces, pixels.
    pub face_px: u32,
    /// Number of maps.
    pub layers: u32,
    /// Size of all maps, bytes.
    pub bytes: u64,
    /// Time of the last capture of the maps, milliseconds: processor time where it is known. It is not part of the
    /// times of the frame's passes.
    pub capture_ms: f64,
    /// The same, where this picture captured the maps; 0 where neither the camera nor the scene had moved since the
    /// last one.
    pub update_ms: f64,
}

/// The maps of a frame.
#[derive(Debug)]
pub struct FarMaps {
    /// Values for which they were made.
    pub key: FarKey,
    uniform: wgpu::Buffer,
    hits: wgpu::TextureView,
    written: wgpu::TextureView,
    /// Place, box, pose and cut-outs that the maps show.
    pub captured_for: Captured<([u32; 5], PoseKey, Vec<Material>)>,
}

impl FarMaps {
    /// Creates empty maps.
    ///
    /// # Errors
    /// Faces past the adapter's limits, or exhausted memory.
    pub fn new(gpu: &Gpu, key: FarKey) -> Result<Self, GpuError> {
        gpu.check_texture_size("a face of the far map", key.face_px, key.face_px)?;
        let hits = texture(gpu, "far hits", HITS, (key.face_px, FACES * key.layers), 1)?;
        Ok(Self {
            uniform: empty_uniform(gpu, "far box", size_of::<FarBox>()),
            hits: whole(&hits, wgpu::TextureViewDimension::D2Array),
            written: level_view(&hits, 0),
            captured_for: Captured::default(),
            key,
        })
    }

    /// The resources that passes may read, by their names in the shaders.
    pub fn named(&self) -> [Named<'_>; 2] {
        [
            ("far_box", self.uniform.as_entire_binding()),
            ("cube_hits", wgpu::BindingResource::TextureView(&self.hits)),
        ]
    }

    /// View of the hits, to write.
    pub fn written(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.written)
    }

    /// Statistics, with half the size of the box in meters, after a picture that captured for this time.
    pub fn stats(&self, half_size_m: f32, update_ms: f64) -> FarStats {
        FarStats {
            half_size_m,
            face_px: self.key.face_px,
            layers: self.key.layers,
            bytes: self.key.bytes(),
            capture_ms: self.captured_for.ms(),
            update_ms,
        }
    }

    /// Uploads the box around an eye, and says whether the maps must be captured: where the eye, the box, an instance,
    /// a deformed mesh or a cut-out is not as in the last capture.
    pub fn prepare(
        &self,
        gpu: &Gpu,
        world: &World,
        eye: Vec3,
        settings: &ReflectionDesc,
        unit_m: f32,
    ) -> bool {
        let far_box = FarBox {
            eye: eye.to_array(),
            half_size_m: settings.near_far.half_size_in(unit_m),
            layers: self.key.layers,
            steps: settings.steps,
            separation_m: settings.separation_in(unit_m),
        };
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&far_box));
        let [x, y, z] = far_box.eye;
        let place = [x, y, z, far_box.half_size_m, far_box.separation_m].map(f32::to_bits);
        (self.captured_for).replace((place, PoseKey::from_world(world), changing_cut_outs(world)))
    }
}
