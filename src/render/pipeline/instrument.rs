//! Instruments: variants of passes for measurement. They count work, trace rays without shading, or
//! accept every crossing of the march.

use std::sync::OnceLock;

use serde::Serialize;

use reflet_gpu::{Gpu, GpuError, readback};

use super::{pass::ComputePass, recorder::clear_texture};

/// Measurement that a frame makes beside the time of its passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instrument {
    /// Passes count their work.
    Count,
    /// After the trace pass its rays are traced once more, without shading.
    Traverse,
    /// The march accepts every crossing.
    AcceptAll,
    /// Pipelines run once, for a driver that compiles them then: maps get one draw call of each.
    WarmUp,
}

/// Work of a pass over all pixels. It depends on the scene and its settings, not on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Number of cells of the depth pyramid that the march reads.
    pub march_steps: u64,
    /// Number of traversals from the root: one for each ray, including bounces and shadow rays, and one more for
    /// each cut-out that a ray passes.
    pub traversals: u64,
    /// Number of nodes read, of all BVHs.
    pub visited_nodes: u64,
    /// Number of triangles that rays were tested against.
    pub tested_triangles: u64,
}

impl Counts {
    /// Names and values, in the order of the channels that shaders write.
    pub fn named(&self) -> [(&'static str, u64); 4] {
        [
            ("march_steps", self.march_steps),
            ("traversals", self.traversals),
            ("visited_nodes", self.visited_nodes),
            ("tested_triangles", self.tested_triangles),
        ]
    }

    /// Sums of the counts of both.
    pub fn plus(self, other: Self) -> Self {
        Self {
            march_steps: self.march_steps + other.march_steps,
            traversals: self.traversals + other.traversals,
            visited_nodes: self.visited_nodes + other.visited_nodes,
            tested_triangles: self.tested_triangles + other.tested_triangles,
        }
    }

    /// Sum over the pixels of a counting pass.
    fn sum(pixels: &[[u32; 4]]) -> Self {
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

/// Work of one pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct PassCounts {
    /// Name of the pass.
    pub pass: &'static str,
    /// Work of the pass.
    #[serde(flatten)]
    pub counts: Counts,
}

/// Passes of instruments, built on demand.
#[derive(Debug, Default)]
pub struct Instruments {
    /// Counting passes.
    pub counted: OnceLock<Vec<Counted>>,
    /// Pass that traces the rays without shading.
    pub traverse: OnceLock<ComputePass>,
    /// Pass that marches and accepts every crossing.
    pub accept_all: OnceLock<ComputePass>,
}

/// A counting pass, with its texture of counts.
#[derive(Debug)]
pub struct Counted {
    pass: ComputePass,
    counts: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Counted {
    /// Creates the texture of counts; `make` builds the pass with a view of it, which is named `counts` in the
    /// shader.
    ///
    /// # Errors
    /// A wgpu error of the texture, and the errors of `make`.
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        make: impl FnOnce(&wgpu::TextureView) -> Result<ComputePass, GpuError>,
    ) -> Result<Self, GpuError> {
        let usage = wgpu::TextureUsages::STORAGE_BINDING
            | wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::COPY_SRC;
        let ([width, height], format) = (size, wgpu::TextureFormat::Rgba32Uint);
        let counts = gpu.scoped("counts", || {
            gpu.texture("counts", [width, height, 1], format, usage)
        })?;
        let view = counts.create_view(&wgpu::TextureViewDescriptor::default());
        Ok(Self {
            pass: make(&view)?,
            counts,
            view,
        })
    }

    /// Clears the counts to zero: the trace pass writes only the pixels of its list.
    fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let zero = wgpu::Color::TRANSPARENT;
        clear_texture(encoder, "clear counts", &self.view, zero);
    }

    /// Reads the counts back and sums them over all pixels.
    ///
    /// # Errors
    /// A readback error.
    pub fn read(&self, gpu: &Gpu) -> Result<PassCounts, GpuError> {
        let pixels = readback::read_texture(gpu, &self.counts)?;
        Ok(PassCounts {
            pass: self.pass.name(),
            counts: Counts::sum(&bytemuck::pod_collect_to_vec::<u8, [u32; 4]>(&pixels)),
        })
    }
}

impl Instruments {
    /// The variant of `pass` for this instrument, or `pass` itself.
    pub fn replacement_for<'a>(
        &'a self,
        pass: &'a ComputePass,
        instrument: Option<Instrument>,
    ) -> &'a ComputePass {
        let other = match instrument {
            Some(Instrument::Count) => {
                let mut counted = self.counted.get().into_iter().flatten();
                let counted = counted.find(|c| c.pass.name() == pass.name());
                counted.map(|counted| &counted.pass)
            }
            Some(Instrument::AcceptAll) => {
                self.accept_all.get().filter(|c| c.name() == pass.name())
            }
            Some(Instrument::Traverse | Instrument::WarmUp) | None => None,
        };
        other.unwrap_or(pass)
    }

    /// The pass that traces the rays once more, if this instrument uses it.
    pub fn traverse(&self, instrument: Option<Instrument>) -> Option<&ComputePass> {
        self.traverse
            .get()
            .filter(|_| instrument == Some(Instrument::Traverse))
    }

    /// Clears all counts.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        let counted = self.counted.get().into_iter().flatten();
        counted.for_each(|counted| counted.clear(encoder));
    }
}
