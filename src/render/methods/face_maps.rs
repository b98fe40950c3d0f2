//! Maps of hits on the faces of cubes, captured by one ray for each pixel.

use std::{any::Any, fmt::Debug, marker::PhantomData, sync::Arc};

use bytemuck::Pod;

use reflet_gpu::{Gpu, GpuError, Named};
use reflet_scene::desc::ReflectionDesc;

use crate::{
    buffers::frame_uniforms::empty_uniform,
    maps::{
        captured::{Captured, Upkeep},
        cube::{FACES, HIT_BYTES, HITS, level_view, texels, texture, whole},
        method_maps::{CaptureInputs, CaptureWork, MapFacts, MapKey, MethodMaps, is_equal},
    },
    pipeline::{
        frame_pass::FramePass,
        pass::{ComputePass, Pass},
        pass_builder::PassBuilder,
        sub_frame::SubFrame,
    },
};

/// Values that such maps depend on.
pub trait FaceKey: Any + Debug + Send + Sync + Clone + PartialEq {
    /// Pass that captures them.
    const PASS: &'static Pass;
    /// Names in shaders of the uniforms, and of the hits, to read and to write.
    const NAMES: [&'static str; 3];
    /// Name of a face, for errors.
    const FACE: &'static str;
    /// Whether the maps are captured for a view.
    const OF_A_VIEW: bool = false;
    /// Table of their settings.
    const TABLE: &'static str;
    /// Their faces in words, and when they are captured.
    const WORK: [&'static str; 2];
    /// Uniforms.
    type Block: Pod;
    /// Values that the content follows from.
    type Content: Debug + PartialEq + Send + 'static;

    /// Width of the faces, pixels.
    fn face_px(&self) -> u32;

    /// Number of cubes.
    fn cubes(&self) -> u32 {
        1
    }

    /// Uniforms of a sub-frame.
    fn block(&self, inputs: &CaptureInputs<'_>) -> Self::Block;

    /// Values that the content follows from in a sub-frame with these uniforms.
    fn content(inputs: &CaptureInputs<'_>, block: &Self::Block) -> Self::Content;

    /// The maps of a scene of this unit, m, for users; a length of the renderer is `meters` of the scene.
    fn face_facts(&self, settings: &ReflectionDesc, unit_m: f32, meters: f32) -> MapFacts;

    /// Number of pixels of all faces, each of which a capture follows a ray for.
    fn pixels(&self) -> u64 {
        texels(FACES * self.cubes(), self.face_px())
    }

    /// Size of all maps, bytes.
    fn bytes(&self) -> u64 {
        HIT_BYTES * self.pixels()
    }
}

impl<K: FaceKey> MapKey for K {
    fn make(&self, gpu: &Gpu) -> Result<Arc<dyn MethodMaps>, GpuError> {
        Ok(Arc::new(FaceMaps::new(gpu, self)?))
    }

    fn is_same(&self, other: &dyn MapKey) -> bool {
        is_equal(self, other)
    }

    fn facts(&self, settings: &ReflectionDesc, unit_m: f32, meters: f32) -> MapFacts {
        self.face_facts(settings, unit_m, meters)
    }

    fn work(&self) -> CaptureWork {
        let [faces, when] = K::WORK;
        CaptureWork {
            maps: format!("{faces} of {0} × {0} pixels", self.face_px()),
            paths: self.pixels(),
            face_px: self.face_px(),
            serves_samples: !K::OF_A_VIEW,
            table: K::TABLE,
            sized_by: &["face_px"],
            or: "",
            when,
        }
    }
}

/// The maps of a frame.
#[derive(Debug)]
pub struct FaceMaps<K: FaceKey> {
    key: K,
    uniform: wgpu::Buffer,
    read: wgpu::TextureView,
    written: wgpu::TextureView,
    captured_for: Captured<K::Content>,
}

impl<K: FaceKey> FaceMaps<K> {
    /// Creates empty maps.
    ///
    /// # Errors
    /// Faces past the adapter's limits, or exhausted memory.
    pub fn new(gpu: &Gpu, key: &K) -> Result<Self, GpuError> {
        let px = key.face_px();
        gpu.check_texture_size(K::FACE, px, px)?;
        let hits = texture(gpu, K::FACE, HITS, (px, FACES * key.cubes()), 1)?;
        Ok(Self {
            key: key.clone(),
            uniform: empty_uniform(gpu, K::NAMES[0], size_of::<K::Block>()),
            read: whole(&hits, wgpu::TextureViewDimension::D2Array),
            written: level_view(&hits, 0),
            captured_for: Captured::default(),
        })
    }
}

impl<K: FaceKey> MethodMaps for FaceMaps<K> {
    fn named(&self) -> Vec<Named<'_>> {
        let read = wgpu::BindingResource::TextureView(&self.read);
        let [uniform, hits, _] = K::NAMES;
        vec![(uniform, self.uniform.as_entire_binding()), (hits, read)]
    }

    fn prepare(&self, gpu: &Gpu, inputs: &CaptureInputs<'_>) -> bool {
        let block = self.key.block(inputs);
        (gpu.queue).write_buffer(&self.uniform, 0, bytemuck::bytes_of(&block));
        self.captured_for.replace(K::content(inputs, &block))
    }

    fn are_of_a_view(&self) -> bool {
        K::OF_A_VIEW
    }

    fn upkeep(&self) -> &dyn Upkeep {
        &self.captured_for
    }
}

/// Capture of the maps on the device.
#[derive(Debug)]
pub struct CaptureFaces<K> {
    pass: ComputePass,
    face_px: u32,
    key: PhantomData<K>,
}

impl<K: FaceKey> FramePass for CaptureFaces<K> {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let maps: &FaceMaps<K> = builder.maps()?;
        let written = wgpu::BindingResource::TextureView(&maps.written);
        Ok(Self {
            pass: builder.with_resources(K::PASS, "main", &[(K::NAMES[2], written)])?,
            face_px: maps.key.face_px(),
            key: PhantomData,
        })
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        if !frame.captures {
            return;
        }
        let groups = self.face_px.div_ceil(self.pass.tile()[0]);
        frame.recorder.pass(K::PASS.name, |encoder, recording| {
            let shared = recording.shared;
            self.pass
                .encode(encoder, recording, shared, [groups, groups, FACES]);
        });
    }
}
