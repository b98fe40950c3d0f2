//! Probes: the frame rendered again with passes that measure it. What they do is counted, rays are
//! followed without being shaded, or the march takes every crossing. No probe makes a picture, and
//! none is part of a frame that is timed.

use serde::Serialize;

use crate::{
    gpu::{Gpu, GpuError, readback},
    scene::desc::CameraDesc,
    world::World,
};

use super::{
    Plane, Renderer,
    aov::Aov,
    build::{Build, Passes, march_constant},
    error::RenderError,
    pass::{COUNTED, ComputePass, MAIN, Pass},
    passes::{light, ssr, trace},
    ray_list::RayList,
    recorder::Timing,
    view::View,
};

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
    /// Looks at the depth buffer: steps of the march and halvings of the last one.
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

/// The passes that count, in the order of the frame: all that march or trace.
pub const COUNTED_PASSES: [&Pass; 3] = [&light::PASS, &ssr::PASS, &trace::PASS];

/// Passes that exist only once a probe was asked for.
#[derive(Debug, Default)]
pub(super) struct Probes {
    counted: Vec<Counted>,
    traverse: Option<ComputePass>,
    accept_all: Option<ComputePass>,
}

/// A pass that counts, and where each pixel's counts are.
#[derive(Debug)]
struct Counted {
    pass: ComputePass,
    counts: wgpu::Texture,
    view: wgpu::TextureView,
}

impl Counted {
    /// `make` builds the pass over the view that is named `counts` in its shader.
    fn new(
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

    fn read(&self, gpu: &Gpu) -> Result<PassCounts, GpuError> {
        let pixels = readback::read_texture(gpu, &self.counts)?;
        Ok(PassCounts {
            pass: self.pass.name(),
            counts: Counts::of(&bytemuck::pod_collect_to_vec::<u8, [u32; 4]>(&pixels)),
        })
    }
}

impl Probes {
    /// The pass that this probe puts in the place of `pass`, or `pass` itself.
    pub(super) fn replacement_for<'a>(
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
    pub(super) fn traverse(&self, probe: Option<Probe>) -> Option<&ComputePass> {
        self.traverse
            .as_ref()
            .filter(|_| probe == Some(Probe::Traverse))
    }

    /// Makes every pixel of every count 0.
    pub(super) fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        self.counted
            .iter()
            .for_each(|counted| counted.clear(encoder));
    }
}

impl Renderer {
    /// Renders the frame once more and counts what its passes do; a pass that did not run is not
    /// listed. Sums over all sub-frames.
    ///
    /// # Errors
    /// As [`Renderer::render`], and shaders of one's own without the entry point `counted`.
    pub fn counts(
        &mut self,
        gpu: &Gpu,
        world: &World,
        camera: &CameraDesc,
    ) -> Result<Vec<PassCounts>, RenderError> {
        self.build_probe(gpu, Probe::Count)?;
        let view = View::new(camera, self.options.image.size);
        let mut sums: Vec<PassCounts> = Vec::new();
        for sample in 0..self.options.image.samples {
            let probe = Some(Probe::Count);
            self.sub_frame(gpu, world, &view, sample, Timing::None, probe)
                .submit()?;
            for counted in &self.passes.probes.counted {
                let new = counted.read(gpu)?;
                match sums.iter_mut().find(|sum| sum.pass == new.pass) {
                    Some(sum) => sum.counts = sum.counts.plus(new.counts),
                    None => sums.push(new),
                }
            }
        }
        Ok(sums)
    }

    /// Milliseconds that the rays of the trace pass take without shading: the same rays, their
    /// hits written; surfaces are looked up only where a path may go on. Measured right after the
    /// trace pass, in a frame of its own. None where nothing is traced or nothing is timed.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn traversal_ms(
        &mut self,
        gpu: &Gpu,
        world: &World,
        camera: &CameraDesc,
    ) -> Result<Option<f64>, RenderError> {
        self.build_probe(gpu, Probe::Traverse)?;
        if self.passes.probes.traverse.is_none() {
            return Ok(None);
        }
        let view = View::new(camera, self.options.image.size);
        let mut sum_ms = None;
        for sample in 0..self.options.image.samples {
            let probe = Some(Probe::Traverse);
            let recorder = self.sub_frame(gpu, world, &view, sample, Timing::Passes, probe);
            let times = recorder.finish()?;
            let of = |(name, ms): &(String, f64)| (name == trace::TRAVERSE.name).then_some(*ms);
            if let Some(ms) = times.iter().find_map(of) {
                sum_ms = Some(sum_ms.unwrap_or(0.0) + ms);
            }
        }
        Ok(sum_ms)
    }

    /// Marches without refusing anything, and gives planes of that: at every pixel whose cause is
    /// `hit` the march crossed something, whether or not its rules take it.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn crossings(
        &mut self,
        gpu: &Gpu,
        world: &World,
        camera: &CameraDesc,
        aovs: &[Aov],
    ) -> Result<Vec<Plane>, RenderError> {
        self.build_probe(gpu, Probe::AcceptAll)?;
        let view = View::new(camera, self.options.image.size);
        for sample in 0..self.options.image.samples {
            let probe = Some(Probe::AcceptAll);
            self.sub_frame(gpu, world, &view, sample, Timing::None, probe)
                .submit()?;
        }
        let planes = aovs.iter().map(|aov| aov.plane(gpu, self, camera));
        Ok(planes.collect::<Result<_, _>>()?)
    }

    /// Builds what a probe needs, the first time; it lasts until the passes are built again.
    fn build_probe(&mut self, gpu: &Gpu, probe: Probe) -> Result<(), GpuError> {
        let probes = &self.passes.probes;
        let is_ready = match probe {
            Probe::Count => !probes.counted.is_empty(),
            Probe::Traverse => probes.traverse.is_some(),
            Probe::AcceptAll => probes.accept_all.is_some(),
        };
        if is_ready {
            return Ok(());
        }
        let mut constants = self.plan.constants();
        constants.push(march_constant(self.options.reflection.method));
        constants.push(match probe {
            Probe::Count => ("COUNT", 1.0),
            Probe::Traverse => ("SHADE", 0.0),
            Probe::AcceptAll => ("REFUSE", 0.0),
        });
        let build = Build {
            gpu,
            shaders: &self.shaders,
            shared: &self.passes.shared,
            targets: &self.targets,
            constants: &constants,
        };
        match probe {
            Probe::Count => self.passes.probes.counted = counted(&build, &self.passes)?,
            Probe::Traverse => self.passes.probes.traverse = traverse(&build, &self.passes)?,
            Probe::AcceptAll if self.passes.reflections.is_some() => {
                let shader = self.shaders.get(&ssr::PASS)?;
                let accept_all = build.entry(&ssr::PASS, shader, MAIN, &[], &[])?;
                self.passes.probes.accept_all = Some(accept_all);
            }
            Probe::AcceptAll => {}
        }
        Ok(())
    }
}

/// The counting twins of the passes that the frame records.
fn counted(build: &Build<'_>, passes: &Passes) -> Result<Vec<Counted>, GpuError> {
    let reflections = passes.reflections.as_ref();
    let list = reflections.map(|r| r.list.named());
    let runs = |pass: &Pass| match pass.name {
        name if name == ssr::PASS.name => reflections.is_some(),
        name if name == trace::PASS.name => reflections.is_some_and(|r| r.trace.is_some()),
        _ => true,
    };
    let make = |pass: &'static Pass| {
        Counted::new(build.gpu, build.targets.size, |view| {
            let mut extra = list.iter().flatten().cloned().collect::<Vec<_>>();
            extra.push(("counts", wgpu::BindingResource::TextureView(view)));
            build.entry(pass, build.shaders.get(pass)?, COUNTED, &[], &extra)
        })
    };
    let running = COUNTED_PASSES.into_iter().filter(|pass| runs(pass));
    running.map(make).collect()
}

/// The trace pass without shading, where there is one.
fn traverse(build: &Build<'_>, passes: &Passes) -> Result<Option<ComputePass>, GpuError> {
    let traced = passes.reflections.as_ref().filter(|r| r.trace.is_some());
    let make = |list: &RayList| {
        let shader = build.shaders.get(&trace::PASS)?;
        build.entry(&trace::TRAVERSE, shader, MAIN, &[], &list.named())
    };
    traced.map(|r| make(&r.list)).transpose()
}
