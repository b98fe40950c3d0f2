//! Peel: rasterizes depth and ids of the second depth layer, behind the visible surfaces, for the march.

use std::sync::Arc;

use crate::{
    buffers::frame_uniforms::empty_uniform,
    decide::cull::is_outside,
    pipeline::{
        pass::declared_overrides,
        prelude::*,
        raster::{Kind, Pipelines, RasterState, pipelines, record},
    },
    upload::{draw::Draw, draw_calls::DrawCalls, draw_shape::DrawShape},
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
    pipelines: Pipelines<Kind>,
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
        let met = resources.scene.draws.iter().filter(|draw| is_met(draw));
        let kinds = met.map(|draw| Kind::for_class(&draw.class));
        Ok(Self {
            pipelines: pipelines(kinds, |kind| pipeline(builder, &layout, kind))?,
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
        let (recorder, own) = (&mut frame.recorder, Some(&self.group));
        record(recorder, PASS.name, scene, &calls, Some(ids), depth, own);
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
    let state = RasterState {
        vertex,
        fragment: Some(fragment),
        is_indexed,
        // Rays meet front and back faces as the camera sees them.
        primitive: wgpu::PrimitiveState::default(),
        ids: Some(Target::SecondIds.format(false).into()),
        depth: Target::SecondDepth.format(false),
    };
    let key = format!("{kind:?} {is_indexed}");
    state.pipeline(gpu, shader, PASS.name, &key, &groups, &constants)
}
