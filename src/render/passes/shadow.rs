//! Shadow: depth cube maps for point lights, flat maps for spot and directional ones.

use crate::{
    gpu::{Gpu, GpuError, GroupLayout, Shader},
    render::{
        cull::is_outside,
        lights::{ShadowSizes, ShadowView},
        pass::{Pass, Shared, declared_overrides},
        passes::visibility::{cleared_depth, reversed_depth},
        recorder::Recorder,
        scene::GpuScene,
        types::{GpuVertex, gpu_struct},
    },
};

/// See `shaders/shadow.wgsl`.
pub const PASS: Pass = Pass {
    name: "shadow",
    reads: &[],
    writes: &[],
    params: Some(Params::LAYOUT),
};

gpu_struct! {
    /// Of one map.
    pub struct Params = "Params" {
        /// World to the map's clip space.
        clip_from_world: [[f32; 4]; 4],
    }
}

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Most bytes of all cube maps, and of all flat maps.
const MAX_MAP_BYTES: u64 = 4 << 30;
/// Uniform offsets are multiples of this everywhere.
const SLOT_BYTES: u64 = 256;

/// The maps of a scene's lights; they exist (one texel large) even without any.
#[derive(Clone, Debug)]
pub struct ShadowMaps {
    /// What they were made for.
    pub sizes: ShadowSizes,
    /// All cube maps, as the shaders sample them.
    pub cubes: wgpu::TextureView,
    /// All flat maps.
    pub maps: wgpu::TextureView,
    /// Compares reversed depth: lit where the receiver is not farther.
    pub sampler: wgpu::Sampler,
    /// Bytes of all maps.
    pub bytes: u64,
    cube_layers: Vec<wgpu::TextureView>,
    map_layers: Vec<wgpu::TextureView>,
}

impl ShadowMaps {
    /// Makes the maps.
    ///
    /// # Errors
    /// More or larger maps than the adapter allows.
    pub fn new(gpu: &Gpu, sizes: ShadowSizes) -> Result<Self, GpuError> {
        let (cube_texture, cubes, cube_bytes) = array(
            gpu,
            sizes.cube_px,
            6 * sizes.cubes,
            wgpu::TextureViewDimension::CubeArray,
        )?;
        let (map_texture, maps, map_bytes) = array(
            gpu,
            sizes.map_px,
            sizes.maps,
            wgpu::TextureViewDimension::D2Array,
        )?;
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow sampler"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        Ok(Self {
            sizes,
            cubes,
            maps,
            sampler,
            bytes: cube_bytes + map_bytes,
            cube_layers: layers(&cube_texture, 6 * sizes.cubes),
            map_layers: layers(&map_texture, sizes.maps),
        })
    }
}

fn array(
    gpu: &Gpu,
    px: u32,
    layers: u32,
    dimension: wgpu::TextureViewDimension,
) -> Result<(wgpu::Texture, wgpu::TextureView, u64), GpuError> {
    let limit = gpu.limits.max_texture_array_layers;
    if layers > limit {
        return Err(GpuError::Limit {
            what: "shadow = \"map\" (a point light takes six; use \"ray\" for some)".to_owned(),
            wanted: layers.into(),
            limit: limit.into(),
            unit: "shadow maps",
        });
    }
    let least = if dimension == wgpu::TextureViewDimension::CubeArray {
        6
    } else {
        1
    };
    let (px, count) = (px.max(1), layers.max(least));
    gpu.check_texture_size("a shadow map", px, px)?;
    let bytes = 4 * u64::from(px) * u64::from(px) * u64::from(count);
    if bytes > MAX_MAP_BYTES {
        return Err(GpuError::Limit {
            what: format!(
                "{layers} shadow maps of {px}x{px} (lower shadow_px, or use shadow = \"ray\")"
            ),
            wanted: bytes,
            limit: MAX_MAP_BYTES,
            unit: "bytes",
        });
    }
    let made = gpu.scoped("shadow maps", || {
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d {
                width: px,
                height: px,
                depth_or_array_layers: count,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                | wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            ..Default::default()
        });
        (texture, view)
    })?;
    Ok((made.0, made.1, bytes))
}

fn layers(texture: &wgpu::Texture, count: u32) -> Vec<wgpu::TextureView> {
    let layer = |base_array_layer| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer,
            array_layer_count: Some(1),
            ..Default::default()
        })
    };
    (0..count).map(layer).collect()
}

/// The pass.
#[derive(Debug)]
pub struct Shadow {
    opaque: wgpu::RenderPipeline,
    cutout: Option<wgpu::RenderPipeline>,
    slots: wgpu::Buffer,
    groups: Vec<wgpu::BindGroup>,
}

impl Shadow {
    /// Builds pipelines and a uniform slot for each map.
    ///
    /// # Errors
    /// What the shader or wgpu refuses.
    pub fn new(
        gpu: &Gpu,
        shader: &Shader,
        shared: &Shared,
        maps: &ShadowMaps,
        has_cutouts: bool,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, GpuError> {
        let layout = GroupLayout::new(gpu, PASS.name, &[&shader.info], 2)?;
        let count = (maps.cube_layers.len() + maps.map_layers.len()).max(1) as u64;
        let slots = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("shadow params"),
            size: SLOT_BYTES * count,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let slot = |i| {
            let binding = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &slots,
                offset: SLOT_BYTES * i,
                size: wgpu::BufferSize::new(size_of::<Params>() as u64),
            });
            layout.bind(gpu, &[("params", binding)])
        };
        let groups = (0..count).map(slot).collect::<Result<_, _>>()?;
        let make = |cutout| pipeline(gpu, shader, shared, &layout, cutout, constants);
        Ok(Self {
            opaque: make(false)?,
            cutout: has_cutouts.then(|| make(true)).transpose()?,
            groups,
            slots,
        })
    }

    /// Records one render pass per map.
    pub fn record(
        &self,
        recorder: &mut Recorder<'_>,
        maps: &ShadowMaps,
        scene: &GpuScene,
        views: &[ShadowView],
    ) {
        for ((view, group), slot) in views.iter().zip(&self.groups).zip(0u64..) {
            let clip_from_world = view.clip_from_world.to_cols_array_2d();
            let params = Params { clip_from_world };
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
            recorder.pass(PASS.name, |encoder, recording| {
                let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                    label: Some(PASS.name),
                    depth_stencil_attachment: Some(cleared_depth(target)),
                    timestamp_writes: recording.render(PASS.name),
                    ..Default::default()
                });
                pass.set_bind_group(0, &recording.shared.empty.1, &[]);
                pass.set_bind_group(1, &recording.shared.groups[1], &[]);
                pass.set_bind_group(2, group, &[]);
                self.draw(&mut pass, scene, view);
            });
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, scene: &GpuScene, view: &ShadowView) {
        let visible = || {
            let draws = scene.draws.iter();
            draws.filter(|d| !is_outside(&view.clip_from_world, &d.bounds))
        };
        pass.set_pipeline(&self.opaque);
        pass.set_vertex_buffer(0, scene.vertices.slice(..));
        pass.set_index_buffer(scene.mesh_data.slice(..), wgpu::IndexFormat::Uint32);
        for draw in visible().filter(|d| !d.class.cutout) {
            pass.draw_indexed(
                draw.indices.clone(),
                draw.vertex_base,
                draw.instance..draw.instance + 1,
            );
        }
        let Some(cutout) = &self.cutout else { return };
        pass.set_pipeline(cutout);
        for draw in visible().filter(|d| d.class.cutout) {
            pass.draw(
                0..draw.indices.len() as u32,
                draw.instance..draw.instance + 1,
            );
        }
    }
}

fn pipeline(
    gpu: &Gpu,
    shader: &Shader,
    shared: &Shared,
    layout: &GroupLayout,
    cutout: bool,
    constants: &[(&'static str, f64)],
) -> Result<wgpu::RenderPipeline, GpuError> {
    let groups = [&shared.empty.0, &shared.layouts[1], layout];
    let constants = declared_overrides(shader, constants);
    let compilation_options = wgpu::PipelineCompilationOptions {
        constants: &constants,
        ..Default::default()
    };
    let attributes = wgpu::vertex_attr_array![0 => Float32x3];
    let vertices = [Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<GpuVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    })];
    let state = if cutout { "cutout" } else { "opaque" };
    shader.render_pipeline(gpu, state, &groups, &constants, |layout| {
        gpu.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(PASS.name),
                layout: Some(layout),
                vertex: wgpu::VertexState {
                    module: &shader.module,
                    entry_point: Some(if cutout { "vertex" } else { "vertex_opaque" }),
                    compilation_options: compilation_options.clone(),
                    buffers: if cutout { &[] } else { &vertices },
                },
                // Both sides cast, as both block shadow rays.
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(reversed_depth(FORMAT)),
                multisample: wgpu::MultisampleState::default(),
                fragment: cutout.then_some(wgpu::FragmentState {
                    module: &shader.module,
                    entry_point: Some("fragment"),
                    compilation_options,
                    targets: &[],
                }),
                multiview_mask: None,
                cache: None,
            })
    })
}
