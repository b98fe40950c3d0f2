//! Probes: passes that take the place of others to measure them. What they do is counted, rays are
//! followed without being shaded, or the march takes every crossing.

use serde::Serialize;

use crate::gpu::{Gpu, GpuError, readback};

use super::pass::ComputePass;

/// What is different in a frame that is rendered to be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Probe {
    /// Passes count what they do.
    Count,
    /// After the trace pass its rays are followed once more, without shading.
    Traverse,
    /// The march takes every crossing, whatever it would refuse.
    AcceptAll,
}

/// What a pass did over all pixels. It depends on the scene and its settings, not on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Depth buffer reads: steps of the march and of the bisection after it.
    pub march_steps: u64,
    /// Walks through the trees from their root: one for each ray, bounces and shadow rays
    /// included, and one more for each cut-out that a ray passes.
    pub traversals: u64,
    /// Nodes of all trees that were read.
    pub visited_nodes: u64,
    /// Triangles that a ray was tested against.
    pub tested_triangles: u64,
}

impl Counts {
    /// Their names with their values, in the order in which shaders write them.
    pub fn named(&self) -> [(&'static str, u64); 4] {
        [
            ("march_steps", self.march_steps),
            ("traversals", self.traversals),
            ("visited_nodes", self.visited_nodes),
            ("tested_triangles", self.tested_triangles),
        ]
    }

    /// Both together.
    pub fn plus(self, other: Self) -> Self {
        Self {
            march_steps: self.march_steps + other.march_steps,
            traversals: self.traversals + other.traversals,
            visited_nodes: self.visited_nodes + other.visited_nodes,
            tested_triangles: self.tested_triangles + other.tested_triangles,
        }
    }

    /// Of the pixels of a counting pass.
    fn of(pixels: &[[u32; 4]]) -> Self {
        let of_pixel = |&[steps, traversals, nodes, triangles]: &[u32; 4]| Self {
            march_steps: steps.into(),
            traversals: traversals.into(),
            visited_nodes: nodes.into(),
            tested_triangles: triangles.into(),
        };
        pixels
            .iter()
            .map(of_pixel)
            .fold(Self::default(), Self::plus)
    }
}

/// What one pass did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PassCounts {
    /// Name of the pass.
    pub pass: &'static str,
    /// What it did.
    #[serde(flatten)]
    pub counts: Counts,
}

/// Passes that exist only once a probe was asked for.
#[derive(Debug, Default)]
pub struct Probes {
    /// Which count.
    pub counted: Vec<Counted>,
    /// Follows the rays without shading.
    pub traverse: Option<ComputePass>,
    /// Marches and takes every crossing.
    pub accept_all: Option<ComputePass>,
}

/// A pass that counts, and where each pixel's counts are.
#[derive(Debug)]
pub struct Counted {
    pass: ComputePass,
    counts: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Counted {
    /// `make` builds the pass over the view that is named `counts` in its shader.
    ///
    /// # Errors
    /// What wgpu says about the texture, and the errors of `make`.
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        make: impl FnOnce(&wgpu::TextureView) -> Result<ComputePass, GpuError>,
    ) -> Result<Self, GpuError> {
        let counts = gpu.scoped("counts", || {
            gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: Some("counts"),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba32Uint,
                usage: wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        })?;
        let view = counts.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self {
            pass: make(&view)?,
            counts,
            view,
        })
    }

    /// Zeros: the trace pass writes no pixel that is not in its list.
    fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("clear counts"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
    }

    /// Sums over all pixels.
    ///
    /// # Errors
    /// What reading back says.
    pub fn read(&self, gpu: &Gpu) -> Result<PassCounts, GpuError> {
        let pixels = readback::read_texture(gpu, &self.counts)?;
        Ok(PassCounts {
            pass: self.pass.name(),
            counts: Counts::of(&bytemuck::pod_collect_to_vec::<u8, [u32; 4]>(&pixels)),
        })
    }
}

impl Probes {
    /// The pass that this probe puts in the place of `pass`, or `pass` itself.
    pub fn replacement_for<'a>(
        &'a self,
        pass: &'a ComputePass,
        probe: Option<Probe>,
    ) -> &'a ComputePass {
        let other = match probe {
            Some(Probe::Count) => {
                let counted = self.counted.iter().map(|counted| &counted.pass);
                counted.into_iter().find(|c| c.name() == pass.name())
            }
            Some(Probe::AcceptAll) => self.accept_all.as_ref().filter(|c| c.name() == pass.name()),
            Some(Probe::Traverse) | None => None,
        };
        other.unwrap_or(pass)
    }

    /// The pass that follows the rays of the trace pass once more, where this probe wants it.
    pub fn traverse(&self, probe: Option<Probe>) -> Option<&ComputePass> {
        self.traverse
            .as_ref()
            .filter(|_| probe == Some(Probe::Traverse))
    }

    /// Makes every pixel of every count 0.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        self.counted
            .iter()
            .for_each(|counted| counted.clear(encoder));
    }
}
