//! Attachments, depth test and kinds of draw calls of passes that rasterize.

use crate::upload::{draw::DrawClass, draw_shape::DrawShape};

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

/// Color attachment of the ids, cleared to "sky" in the first part of a pass.
pub fn ids_of_part(view: &wgpu::TextureView, part: usize) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: load_of_part(NO_IDS, part),
            store: wgpu::StoreOp::Store,
        },
    }
}

/// A reversed depth attachment, cleared to infinitely far in the first part of a pass.
pub fn depth_of_part(
    view: &wgpu::TextureView,
    part: usize,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations {
            load: load_of_part(0.0, part),
            store: wgpu::StoreOp::Store,
        }),
        stencil_ops: None,
    }
}

/// Clears before the first part of a pass; later parts add to it.
fn load_of_part<T: Default>(cleared: T, part: usize) -> wgpu::LoadOp<T> {
    match part {
        0 => wgpu::LoadOp::Clear(cleared),
        _ => wgpu::LoadOp::Load,
    }
}

/// Depth test with reversed depth: the nearer (larger) value wins.
pub fn reversed_depth(format: wgpu::TextureFormat) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format,
        depth_write_enabled: Some(true),
        depth_compare: Some(wgpu::CompareFunction::Greater),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

/// Clear value for "sky": all bits set in both ids.
const NO_IDS: wgpu::Color = wgpu::Color {
    r: u32::MAX as f64,
    g: u32::MAX as f64,
    b: 0.0,
    a: 0.0,
};
