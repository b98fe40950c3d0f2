//! Shadow: depth cube maps for point lights, flat maps for spot and directional ones. A map whose light and casters
//! have not moved is not drawn again.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use xxhash_rust::xxh3::Xxh3Default;

use crate::{
    decide::cull::is_outside,
    lighting::lights::ShadowView,
    maps::shadow_maps::FORMAT,
    pipeline::{
        instrument::Instrument,
        pass::declared_overrides,
        prelude::*,
        raster::{Kind, Pipelines, RasterState, pipelines, record},
    },
    upload::{draw::Draw, draw_calls::DrawCalls, draw_shape::DrawShape, scene::GpuScene},
};
use reflet_gpu::GroupLayout;

/// See `shaders/shadow.wgsl`.
pub const PASS: Pass = Pass {
    name: "shadow",
    group: PassGroup::Light,
    color: [111, 93, 21],
    params: Some(Params::LAYOUT),
    needed: |plan, _| plan.features.cube_maps || plan.features.flat_maps,
    writes_shared: &[ShadowMaps],
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the shadow shader for one map.
    pub struct Params = "Params" {
        /// Transform from the world to the map's clip space.
        clip_from_world: [[f32; 4]; 4],
        /// Its inverse.
        world_from_clip: [[f32; 4]; 4],
    }
}

/// Distance between the uniforms of two maps, bytes: a multiple of every device's offset alignment.
const SLOT_BYTES: u64 = 256;

/// The shadow pass on the device.
#[derive(Debug)]
pub struct Shadow {
    /// A pipeline for each kind of draw calls in use.
    pipelines: Pipelines<Kind>,
    slots: wgpu::Buffer,
    groups: Vec<wgpu::BindGroup>,
    /// Hash of the content of each map; `None` where the map must be drawn.
    drawn: Mutex<Vec<Option<u64>>>,
}

impl FramePass for Shadow {
    /// Creates two pipelines, and a uniform slot for each map.
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let (gpu, maps) = (builder.gpu, builder.resources.maps);
        let layout = GroupLayout::new(gpu, PASS.name, &[&builder.shader(&PASS)?.info], 2)?;
        let count = (maps.cube_layers.len() + maps.map_layers.len()).max(1) as u64;
        let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
        let slots = gpu.buffer("shadow params", SLOT_BYTES * count, usage);
        let slot = |i| {
            let binding = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &slots,
                offset: SLOT_BYTES * i,
                size: wgpu::BufferSize::new(size_of::<Params>() as u64),
            });
            layout.bind(gpu, &[("params", binding)])
        };
        let groups = (0..count).map(slot).collect::<Result<Vec<_>, _>>()?;
        let draws = builder.resources.scene.draws.iter();
        let kinds = draws.map(|draw| Kind::for_class(&draw.class));
        Ok(Self {
            pipelines: pipelines(kinds, |kind| pipeline(builder, &layout, kind))?,
            drawn: Mutex::new(vec![None; groups.len()]),
            groups,
            slots,
        })
    }

    /// Records one render pass for each outdated map: in the first sub-frame, and while a shutter is open in all, which
    /// show other moments.
    fn record(&self, frame: &mut SubFrame<'_>) {
        if frame.share.sample > 0 && frame.options.image.shutter <= 0.0 {
            return;
        }
        let (scene, maps) = (frame.resources.scene, frame.resources.maps);
        let recorder = &mut frame.recorder;
        let mut drawn = self.drawn();
        let most = match frame.instrument {
            Some(Instrument::WarmUp) => 1,
            _ => usize::MAX,
        };
        let views = frame.shadow_views.iter().zip(&self.groups).zip(0u64..);
        for (((view, group), slot), drawn) in views.zip(drawn.iter_mut()) {
            let content = content(scene, view);
            if content.is_some() && content == *drawn {
                continue;
            }
            *drawn = content;
            let params = Params {
                clip_from_world: view.clip_from_world.to_cols_array_2d(),
                world_from_clip: view.clip_from_world.inverse().to_cols_array_2d(),
            };
            let offset = SLOT_BYTES * slot;
            recorder
                .gpu
                .queue
                .write_buffer(&self.slots, offset, bytemuck::bytes_of(&params));
            let of = if view.cube {
                &maps.cube_layers
            } else {
                &maps.map_layers
            };
            let Some(target) = of.get(view.layer as usize) else {
                continue;
            };
            let calls = self.draw_calls(scene, view, recorder.gpu.is_software(), most);
            record(
                recorder,
                PASS.name,
                scene,
                &calls,
                None,
                target,
                Some(group),
            );
        }
    }

    fn forget(&self) {
        self.drawn().fill(None);
    }
}

impl Shadow {
    fn drawn(&self) -> MutexGuard<'_, Vec<Option<u64>>> {
        self.drawn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draw calls of instances that may appear in a map, at `most` so many by each pipeline.
    fn draw_calls<'a>(
        &'a self,
        scene: &'a GpuScene,
        view: &'a ShadowView,
        is_software: bool,
        most: usize,
    ) -> DrawCalls<'a> {
        let mut calls = DrawCalls::new(is_software);
        for (kind, pipeline) in &self.pipelines {
            let draws = casters(scene, view).filter(|d| Kind::for_class(&d.class) == *kind);
            calls.add(
                draws.take(most),
                pipeline,
                scene.indexed().is_some() && kind.is_indexed(),
            );
        }
        calls
    }
}

/// Draw calls that may appear in a map.
fn casters<'a>(scene: &'a GpuScene, view: &'a ShadowView) -> impl Iterator<Item = &'a Draw> {
    let draws = scene.draws.iter();
    draws.filter(|d| d.casts_shadow && !is_outside(&view.clip_from_world, &d.bounds))
}

/// Hash of everything that a map shows; `None` where cut-outs may change from frame to frame.
fn content(scene: &GpuScene, view: &ShadowView) -> Option<u64> {
    let mut hash = Xxh3Default::new();
    hash.update(bytemuck::bytes_of(&view.clip_from_world.to_cols_array()));
    for draw in casters(scene, view) {
        if draw.class.cutout && scene.has_moving_cutouts {
            return None;
        }
        hash.update(&draw.instance.to_le_bytes());
        hash.update(&draw.pose.to_le_bytes());
    }
    Some(hash.digest())
}

fn pipeline(
    builder: &PassBuilder<'_>,
    layout: &GroupLayout,
    kind: Kind,
) -> Result<Arc<wgpu::RenderPipeline>, GpuError> {
    let (gpu, shared, shader) = (builder.gpu, builder.shared, builder.shader(&PASS)?);
    let groups = [&shared.empty.0, &shared.layouts[1], layout];
    let mut constants = declared_overrides(shader, &builder.overrides(&PASS));
    let is_pulled = !kind.is_indexed() || builder.resources.scene.indexed().is_none();
    let (vertex, fragment) = match kind.shape {
        DrawShape::Triangles if is_pulled => ("vertex", kind.cutout.then_some("fragment")),
        DrawShape::Triangles => ("vertex_opaque", None),
        DrawShape::Spheres if !kind.cutout => ("vertex_disk", Some("fragment_disk")),
        DrawShape::Spheres | DrawShape::Capsules => ("vertex_capsule", Some("fragment_capsule")),
    };
    if kind.shape != DrawShape::Triangles {
        constants.push(kind.shape.constant());
    }
    let state = RasterState {
        vertex,
        fragment,
        is_indexed: !is_pulled,
        // Front and back faces cast shadows, as both block shadow rays.
        primitive: wgpu::PrimitiveState::default(),
        ids: None,
        depth: FORMAT,
    };
    let key = format!("{kind:?} {is_pulled}");
    state.pipeline(gpu, shader, PASS.name, &key, &groups, &constants)
}
