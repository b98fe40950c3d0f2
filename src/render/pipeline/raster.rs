//! Pipelines, attachments and kinds of draw calls of passes that rasterize.

use std::sync::Arc;

use super::recorder::Recorder;
use crate::upload::{
    draw::{DrawClass, Indexed},
    draw_calls::DrawCalls,
    draw_shape::DrawShape,
    scene::GpuScene,
};
use reflet_gpu::{Gpu, GpuError, GroupLayout, Shader};

/// Properties of a draw call that need a pipeline of their own: both faces of all shapes are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Whether alpha is tested.
    pub cutout: bool,
    /// Shape that is drawn.
    pub shape: DrawShape,
}

impl Kind {
    /// Kind of a class of draw calls.
    pub fn for_class(class: &DrawClass) -> Self {
        Self {
            cutout: class.cutout,
            shape: class.shape,
        }
    }

    /// Whether it is drawn by indices where the device allows it.
    pub fn is_indexed(self) -> bool {
        !self.cutout && self.shape == DrawShape::Triangles
    }
}

/// A pipeline of each kind among some draws.
pub type Pipelines<K> = Vec<(K, Arc<wgpu::RenderPipeline>)>;

/// Makes a pipeline for each of these kinds.
///
/// # Errors
/// The first error of `make`.
pub fn pipelines<K: Copy + PartialEq>(
    kinds: impl IntoIterator<Item = K>,
    make: impl Fn(K) -> Result<Arc<wgpu::RenderPipeline>, GpuError>,
) -> Result<Pipelines<K>, GpuError> {
    let mut made: Pipelines<K> = Vec::new();
    for kind in kinds {
        if made.iter().all(|(known, _)| *known != kind) {
            made.push((kind, make(kind)?));
        }
    }
    Ok(made)
}

/// State of a raster pipeline, beside its groups and constants.
pub struct RasterState<'a> {
    /// Entry point of the vertex shader.
    pub vertex: &'a str,
    /// Entry point of the fragment shader; `None` where only depth is drawn.
    pub fragment: Option<&'a str>,
    /// Whether vertices are drawn by indices, from vertex buffers.
    pub is_indexed: bool,
    /// Faces that are drawn.
    pub primitive: wgpu::PrimitiveState,
    /// Target of the ids, where they are drawn.
    pub ids: Option<wgpu::ColorTargetState>,
    /// Format of the depth texture, in which the nearer (larger) value wins.
    pub depth: wgpu::TextureFormat,
}

impl RasterState<'_> {
    /// Makes the pipeline of a pass, whose name is `label`; `key` names this state among the pipelines of its shader.
    ///
    /// # Errors
    /// Errors of the shader and the device.
    pub fn pipeline(
        self,
        gpu: &Gpu,
        shader: &Shader,
        label: &str,
        key: &str,
        groups: &[&GroupLayout],
        constants: &[(&str, f64)],
    ) -> Result<Arc<wgpu::RenderPipeline>, GpuError> {
        let targets = self.ids.map(Some);
        shader.render_pipeline(gpu, key, groups, constants, |layout, module| {
            gpu.device
                .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                    label: Some(label),
                    layout: Some(layout),
                    vertex: wgpu::VertexState {
                        module,
                        entry_point: Some(self.vertex),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        buffers: if self.is_indexed {
                            &Indexed::LAYOUTS
                        } else {
                            &[]
                        },
                    },
                    primitive: self.primitive,
                    depth_stencil: Some(wgpu::DepthStencilState {
                        format: self.depth,
                        depth_write_enabled: Some(true),
                        depth_compare: Some(wgpu::CompareFunction::Greater),
                        stencil: wgpu::StencilState::default(),
                        bias: wgpu::DepthBiasState::default(),
                    }),
                    multisample: wgpu::MultisampleState::default(),
                    fragment: self.fragment.map(|entry| wgpu::FragmentState {
                        module,
                        entry_point: Some(entry),
                        compilation_options: wgpu::PipelineCompilationOptions::default(),
                        targets: targets.as_slice(),
                    }),
                    multiview_mask: None,
                    cache: gpu.pipeline_cache(),
                })
        })
    }
}

/// Records draw calls into `depth`, which is cleared to infinitely far, and into `ids`, which are cleared to "sky". A
/// pass without ids has no uniforms of the frame; `own` is its third group.
pub fn record(
    recorder: &mut Recorder<'_>,
    name: &str,
    scene: &GpuScene,
    calls: &DrawCalls<'_>,
    ids: Option<&wgpu::TextureView>,
    depth: &wgpu::TextureView,
    own: Option<&wgpu::BindGroup>,
) {
    recorder.pass_in_parts(name, calls.num_parts(), |part, encoder, recording| {
        let ids = ids.map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: operations(NO_IDS, part),
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: ids.as_slice(),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(operations(0.0, part)),
                stencil_ops: None,
            }),
            timestamp_writes: recording.render(name),
            ..Default::default()
        });
        let shared = recording.shared;
        pass.set_bind_group(0, shared.group_for(ids.is_some(), 0), &[]);
        pass.set_bind_group(1, &shared.groups[1], &[]);
        if let Some(own) = own {
            pass.set_bind_group(2, own, &[]);
        }
        if let Some(indexed) = scene.indexed() {
            indexed.bind(&mut pass);
        }
        calls.record(part, &mut pass);
    });
}

/// Clears before the first part of a pass; later parts add to it.
fn operations<T: Default>(cleared: T, part: usize) -> wgpu::Operations<T> {
    wgpu::Operations {
        load: match part {
            0 => wgpu::LoadOp::Clear(cleared),
            _ => wgpu::LoadOp::Load,
        },
        store: wgpu::StoreOp::Store,
    }
}

/// Clear value for "sky": all bits set in both ids.
const NO_IDS: wgpu::Color = wgpu::Color {
    r: u32::MAX as f64,
    g: u32::MAX as f64,
    b: 0.0,
    a: 0.0,
};
