//! Buffers on the faces of the box of method `ssr+box`, and their content.

use glam::Vec3;
use serde::Serialize;

use reflet_gpu::{Gpu, GpuError, Named};
use reflet_scene::{
    desc::{BoxFacesDesc, ReflectionDesc},
    diagnostic::{Diagnostic, Span},
};
use reflet_world::{Material, World};

use super::{
    captured::Captured,
    map_size::{FACES, HIT_BYTES, MAX_MAP_BYTES, texels},
    probe_boxes::still_bounds,
    probe_maps::{HITS, level_view, texture, whole},
};
use crate::{
    buffers::frame_uniforms::empty_uniform, layout::types::FaceBox,
    upload::world_key::changing_cut_outs,
};

/// Size of the default box along an axis in which the static scene has none, over its diagonal.
const LEAST_SHARE: f32 = 1e-3;
/// Size of the box of a scene without extent, in the renderer's lengths.
const LEAST_SIZE_M: f32 = 1e-3;

/// Values for which buffers are made; where they differ, buffers are made and captured anew.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacesKey {
    /// Least corner of the box, meters.
    pub low: Vec3,
    /// Size of the box along each axis, meters, above 0.
    pub size: Vec3,
    /// Width of the faces, pixels.
    pub face_px: u32,
}

impl FacesKey {
    /// Key of the buffers of a world in these settings.
    pub fn new(world: &World, settings: &BoxFacesDesc) -> Self {
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

    /// Size of all faces, bytes.
    pub fn bytes(&self) -> u64 {
        HIT_BYTES * self.pixels()
    }

    /// Number of pixels of all faces, each of which a capture follows a ray for.
    pub fn pixels(&self) -> u64 {
        texels(FACES, self.face_px)
    }

    /// The key itself, if its faces are not too large.
    ///
    /// # Errors
    /// More than [`MAX_MAP_BYTES`], with the largest width that has no more.
    pub fn checked(self) -> Result<Self, Box<Diagnostic>> {
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

/// Size of the buffers of a scene, and the time that they took.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FacesStats {
    /// Size of the box along each axis, meters.
    pub size_m: [f32; 3],
    /// Width of the faces, pixels.
    pub face_px: u32,
    /// Size of all faces, bytes.
    pub bytes: u64,
    /// Time of the last capture, milliseconds: processor time where it is known. It is not part of the times of the
    /// frame's passes.
    pub capture_ms: f64,
    /// The same, where this picture captured the faces; 0 where it took the faces of an earlier one.
    pub update_ms: f64,
}

/// The buffers on the faces.
#[derive(Debug)]
pub struct BoxFaces {
    /// Values for which they were made.
    pub key: FacesKey,
    uniform: wgpu::Buffer,
    hits: wgpu::TextureView,
    written: wgpu::TextureView,
    /// Cut-outs that may change; nothing else that is on them does.
    pub captured_for: Captured<Vec<Material>>,
}

impl BoxFaces {
    /// Creates empty buffers.
    ///
    /// # Errors
    /// Faces past the adapter's limits, or exhausted memory.
    pub fn new(gpu: &Gpu, key: FacesKey) -> Result<Self, GpuError> {
        let px = key.face_px;
        gpu.check_texture_size("a face of the box", px, px)?;
        let hits = texture(gpu, "box faces", HITS, (px, FACES), 1)?;
        Ok(Self {
            uniform: empty_uniform(gpu, "face box", size_of::<FaceBox>()),
            hits: whole(&hits, wgpu::TextureViewDimension::D2Array),
            written: level_view(&hits, 0),
            captured_for: Captured::default(),
            key,
        })
    }

    /// The resources that passes may read, by their names in the shaders.
    pub fn named(&self) -> [Named<'_>; 2] {
        [
            ("face_box", self.uniform.as_entire_binding()),
            ("face_hits", wgpu::BindingResource::TextureView(&self.hits)),
        ]
    }

    /// View of the buffers, to write.
    pub fn written(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(&self.written)
    }

    /// Statistics, with meters of the scene in a length of one, after a picture that captured for this time.
    pub fn stats(&self, meters: f32, update_ms: f64) -> FacesStats {
        FacesStats {
            size_m: (self.key.size * meters).to_array(),
            face_px: self.key.face_px,
            bytes: self.key.bytes(),
            capture_ms: self.captured_for.ms(),
            update_ms,
        }
    }

    /// Uploads the box, and says whether the faces must be captured: once, as nothing on them moves, and where a cut-out
    /// is not as in the last capture.
    pub fn prepare(&self, gpu: &Gpu, world: &World, settings: &ReflectionDesc) -> bool {
        let face_box = FaceBox {
            low: self.key.low.to_array(),
            steps: settings.steps,
            size: self.key.size.to_array(),
        };
        gpu.queue
            .write_buffer(&self.uniform, 0, bytemuck::bytes_of(&face_box));
        self.captured_for.replace(changing_cut_outs(world))
    }
}
