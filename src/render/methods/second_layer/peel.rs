//! Peel: rasterizes depth and ids of the second depth layer, behind the visible surfaces, for the march.

use std::sync::Arc;

use crate::{
    buffers::frame_uniforms::empty_uniform,
    decide::cull::is_outside,
    pipeline::{
        pass::declared_overrides,
        prelude::*,
        raster::{Kind, depth_of_part, ids_of_part, reversed_depth},
    },
    upload::{
        draw::{Draw, Indexed},
        draw_calls::DrawCalls,
        draw_shape::DrawShape,
    },
};
use reflet_gpu::GroupLayout;

/// See `shaders/methods/second_layer/peel.wgsl`.
pub const PASS: Pass = Pass {
    name: "peel",
    group: PassGroup::March,
    color: [0, 198, 9],
    attachments: &[Target::SecondDepth, Target::SecondIds],
    reads_shared: &[DepthPyramid],
    params: Some(Params::LAYOUT),
    needed: |plan, _| plan.features.second_layer,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the peel shader.
    pub struct Params = "Params" {
        /// Minimum distance of the second depth layer from the first, meters.
        separation_m: f32,
    }
}

/// The peel pass on the device: a pipeline for each kind of draw calls in use.
#[derive(Debug)]
pub struct Peel {
    pipelines: Vec<(Kind, Arc<wgpu::RenderPipeline>)>,
    params: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl FramePass for Peel {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let (gpu, resources) = (builder.gpu, builder.resources);
        let layout = GroupLayout::new(gpu, PASS.name, &[&builder.shader(&PASS)?.info], 2)?;
        let params = empty_uniform(gpu, PASS.name, size_of::<Params>());
        let group = layout.bind_with(gpu, |name| match name {
            "params" => Some(params.as_entire_binding()),
            "lists" => Some(resources.ray_list.lists.as_entire_binding()),
            _ => {
                let view = resources.targets.view(Target::named(name)?)?;
                Some(wgpu::BindingResource::TextureView(view))
            }
        })?;
        let mut kinds: Vec<Kind> = Vec::new();
        for draw in resources.scene.draws.iter().filter(|draw| is_met(draw)) {
            let needed = Kind::for_class(&draw.class);
            if !kinds.contains(&needed) {
                kinds.push(needed);
            }
        }
        let make = |kind: Kind| Ok((kind, pipeline(builder, &layout, kind)?));
        let pipelines = kinds.into_iter().map(make);
        Ok(Self {
            pipelines: pipelines.collect::<Result<_, GpuError>>()?,
            params,
            group,
        })
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        let (scene, targets) = (frame.resources.scene, frame.resources.targets);
        let views = [Target::SecondIds, Target::SecondDepth].map(|target| targets.view(target));
        let [Some(ids), Some(depth)] = views else {
            return;
        };
        let params = Params {
            separation_m: frame.options.reflection.separation_in(frame.unit_m),
        };
        let queue = &frame.recorder.gpu.queue;
        queue.write_buffer(&self.params, 0, bytemuck::bytes_of(&params));
        let calls = self.draw_calls(frame);
        let num_parts = calls.num_parts();
        (frame.recorder).pass_in_parts(PASS.name, num_parts, |part, encoder, recording| {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(PASS.name),
                color_attachments: &[Some(ids_of_part(ids, part))],
                depth_stencil_attachment: Some(depth_of_part(depth, part)),
                timestamp_writes: recording.render(PASS.name),
                ..Default::default()
            });
            pass.set_bind_group(0, &recording.shared.groups[0], &[]);
            pass.set_bind_group(1, &recording.shared.groups[1], &[]);
            pass.set_bind_group(2, &self.group, &[]);
            if let Some(indexed) = scene.indexed() {
                indexed.bind(&mut pass);
            }
            calls.record(part, &mut pass);
        });
    }
}

impl Peel {
    /// Draw calls of instances that reflection rays may meet within the picture.
    fn draw_calls<'a>(&'a self, frame: &SubFrame<'a>) -> DrawCalls<'a> {
        let mut calls = DrawCalls::new(frame.recorder.gpu.is_software());
        let scene = frame.resources.scene;
        // In the order of instances: of coplanar surfaces the first that is drawn stays.
        for draws in scene
            .draws
            .chunk_by(|a, b| Kind::for_class(&a.class) == Kind::for_class(&b.class))
        {
            let kind = Kind::for_class(&draws[0].class);
            let found = self.pipelines.iter().find(|(known, _)| *known == kind);
            let Some((_, pipeline)) = found else {
                continue;
            };
            let is_drawn = |d: &&Draw| is_met(d) && !is_outside(&frame.clip_from_world, &d.bounds);
            let is_indexed = scene.indexed().is_some() && kind.is_indexed();
            calls.add(draws.iter().filter(is_drawn), pipeline, is_indexed);
        }
        calls
    }
}

/// Whether reflection rays meet the instance.
fn is_met(draw: &Draw) -> bool {
    draw.shown.in_reflections
}

fn pipeline(
    builder: &PassBuilder<'_>,
    layout: &GroupLayout,
    kind: Kind,
) -> Result<Arc<wgpu::RenderPipeline>, GpuError> {
    let (gpu, shared, shader) = (builder.gpu, builder.shared, builder.shader(&PASS)?);
    let groups = [&shared.layouts[0], &shared.layouts[1], layout];
    let mut constants = declared_overrides(shader, &builder.overrides(&PASS));
    constants.push(("CUTOUT", f64::from(u8::from(kind.cutout))));
    let is_indexed = kind.is_indexed() && builder.resources.scene.indexed().is_some();
    let (vertex, fragment) = match kind.shape {
        DrawShape::Triangles if is_indexed => ("vertex_indexed", "fragment_peeled"),
        DrawShape::Triangles => ("vertex", "fragment"),
        DrawShape::Spheres | DrawShape::Capsules => ("vertex_capsule", "fragment_capsule_peeled"),
    };
    if kind.shape != DrawShape::Triangles {
        constants.push(kind.shape.constant());
    }
    let state = format!("{kind:?} {is_indexed}");
    shader.render_pipeline(gpu, &state, &groups, &constants, |layout, module| {
        gpu.device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(PASS.name),
                layout: Some(layout),
                vertex: wgpu::VertexState {
                    module,
                    entry_point: Some(vertex),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    buffers: if is_indexed { &Indexed::LAYOUTS } else { &[] },
                },
                // Rays meet front and back faces as the camera sees them.
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: Some(reversed_depth(Target::SecondDepth.format(false))),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module,
                    entry_point: Some(fragment),
                    compilation_options: wgpu::PipelineCompilationOptions::default(),
                    targets: &[Some(Target::SecondIds.format(false).into())],
                }),
                multiview_mask: None,
                cache: gpu.pipeline_cache(),
            })
    })
}
