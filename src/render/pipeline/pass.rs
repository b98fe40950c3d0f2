//! A compute pass: bound by name, dispatched by its shader's workgroup size, timed under its own name.

use std::sync::Arc;

use serde::Serialize;

use reflet_gpu::{Checks, Gpu, GpuError, GroupLayout, Named, Shader};
use reflet_scene::words;

use super::{
    ray_list::{List, RAYS_PER_GROUP, RayList},
    recorder::{Recorder, Recording},
    shared_data::SharedData,
    shared_groups::{SharedGroups, is_used},
    targets::{Target, Targets},
};
use crate::{
    buffers::frame_uniforms::empty_uniform,
    layout::gpu_struct::{StructSpec, gpu_struct},
    plan::Plan,
    settings::options::RenderOptions,
};

/// Override with which a shader writes the work of each pixel to `counts`.
pub const COUNT: &str = "COUNT";

/// Name of a pipeline override, and its value.
pub type Override = (&'static str, f64);

words! {
    /// Part of a frame that passes belong to, for sums of their times.
    #[derive(Serialize)]
    #[serde(rename_all = "lowercase")]
    pub enum PassGroup {
        /// Surfaces that the pixels show.
        Surfaces = "surfaces",
        /// Light at these surfaces, with shadows and transmission.
        Light = "light",
        /// The march through the picture.
        March = "march",
        /// Reflections apart from the march: traced rays, shading of hits, smoothing.
        Reflection = "reflection",
        /// The picture from all parts.
        Picture = "picture",
        /// Statistics of the frame.
        Measurement = "measurement",
        /// Maps of probes, captured apart from the frame.
        Capture = "capture",
    }
}

impl PassGroup {
    /// Whether the passes find reflections, so that their time counts as `reflection_ms`.
    pub const fn finds_reflections(self) -> bool {
        matches!(self, Self::March | Self::Reflection)
    }
}

/// Description of a pass: its shader, its inputs and its outputs.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Name of the pass, its shader file, its timer label and its preview entry.
    pub name: &'static str,
    /// Shader file of a pass that shares it with other passes; empty: named like the pass.
    pub shader: &'static str,
    /// Part of the frame.
    pub group: PassGroup,
    /// Color in charts, sRGB; a test asks for a distance between any two.
    pub color: [u8; 3],
    /// Targets that the pass rasterizes into; its shader says which others it reads and writes.
    pub attachments: &'static [Target],
    /// Names in the shader of a pass that swaps targets, with the targets of each in the order of its pipelines.
    pub aliases: &'static [(&'static str, &'static [Target])],
    /// Targets that a shared shader reads or writes for other passes alone.
    pub leaves: &'static [Target],
    /// Data beside the targets that the pass reads.
    pub reads_shared: &'static [SharedData],
    /// Data beside the targets that the pass writes.
    pub writes_shared: &'static [SharedData],
    /// Layout of the shader's `Params`, where it has them.
    pub params: Option<StructSpec>,
    /// Further structs that it shares with shaders, by `#import SHADER_structs`.
    pub structs: &'static [StructSpec],
    /// Whether a frame with this plan and these options records the pass.
    pub needed: fn(&Plan, &RenderOptions) -> bool,
    /// Whether one of the targets that the pass stores to is written with these options.
    pub is_written: fn(&RenderOptions, Target) -> bool,
    /// Values for overrides that only this pass's shader declares.
    pub overrides: fn(&RenderOptions) -> Vec<Override>,
    /// Run-time checks of the shader: none of indices from a pass or a ray that `check_world` and `Trees::build` have
    /// validated.
    pub(crate) checks: Checks,
    /// Whether the shader has the override [`COUNT`], with which it also counts its work.
    pub counted: bool,
}

impl Pass {
    /// A pass that is always recorded and touches no target.
    pub const DEFAULT: Self = Self {
        name: "",
        shader: "",
        group: PassGroup::Picture,
        color: [0; 3],
        attachments: &[],
        aliases: &[],
        leaves: &[],
        reads_shared: &[],
        writes_shared: &[],
        params: None,
        structs: &[],
        needed: |_, _| true,
        is_written: |_, _| true,
        overrides: |_| Vec::new(),
        checks: Checks::All,
        counted: false,
    };

    /// Name of the shader file.
    pub const fn shader(&self) -> &'static str {
        if self.shader.is_empty() {
            self.name
        } else {
            self.shader
        }
    }

    /// Values for the overrides of the pass in a frame that is not measured, its own in place of the plan's; its shader
    /// may declare fewer.
    pub fn constants(&self, plan: &Plan, options: &RenderOptions) -> Vec<Override> {
        let own = (self.overrides)(options);
        let mut all = plan.overrides();
        all.retain(|(name, _)| own.iter().all(|(other, _)| other != name));
        all.extend(own);
        all.push((COUNT, 0.0));
        all
    }

    /// Names and targets of one pipeline of a pass that swaps targets.
    pub fn swapped(&self, pipeline: usize) -> Vec<(&'static str, Target)> {
        let one = |&(name, targets): &(&'static str, &[Target])| {
            (name, targets[pipeline % targets.len()])
        };
        self.aliases.iter().map(one).collect()
    }
}

gpu_struct! {
    /// Uniforms of a pass that sums over the sub-frames.
    pub struct Sample = "Params" {
        /// Index of the sub-frame.
        sample: u32,
    }
}

/// Number of workgroups of a pass.
#[derive(Clone, Copy, Debug)]
pub enum Dispatch {
    /// One invocation per pixel that shows the moment.
    PerPixel,
    /// One invocation per pixel of the picture.
    WholePicture,
    /// One invocation per pixel whose surface is resolved: of the picture, where others look at its surfaces.
    Surfaces,
    /// Workgroups for a list of pixels, whose number the GPU wrote.
    Listed(List),
    /// One workgroup for each square tile with this side, pixels.
    Tiles(u32),
    /// This number of workgroups.
    Groups(u32),
}

/// A pass on the device.
#[derive(Debug)]
pub struct ComputePass {
    pass: &'static Pass,
    pipeline: Arc<wgpu::ComputePipeline>,
    layout: GroupLayout,
    used: [bool; 2],
    tile: [u32; 2],
    params: Option<wgpu::Buffer>,
    bound: Option<wgpu::BindGroup>,
}

/// Width and height of the workgroups of passes over all pixels.
pub const GROUP_PX: u32 = 8;

// Passes that follow paths run over squares of pixels and over lists by workgroups of the same size.
const _: () = assert!(GROUP_PX * GROUP_PX == RAYS_PER_GROUP);

impl ComputePass {
    /// Builds the pipeline of one entry point; overrides that its shader does not declare are ignored.
    ///
    /// # Errors
    /// A shader or wgpu error, by file and name.
    pub fn new(
        gpu: &Gpu,
        pass: &'static Pass,
        shader: &Shader,
        entry: &str,
        shared: &SharedGroups,
        overrides: &[Override],
    ) -> Result<Self, GpuError> {
        let layout = GroupLayout::of_entry(gpu, &shader.info, entry, 2)?;
        let groups = [
            shared.layout_for(shader, 0),
            shared.layout_for(shader, 1),
            &layout,
        ];
        let overrides = declared_overrides(shader, overrides);
        let pipeline = shader.compute_pipeline(gpu, entry, &groups, &overrides)?;
        let tile = shader
            .info
            .entry_point(entry)
            .map_or([1, 1], |e| [e.workgroup_size[0], e.workgroup_size[1]]);
        let params = pass
            .params
            .map(|spec| empty_uniform(gpu, pass.name, spec.size));
        Ok(Self {
            pass,
            pipeline,
            used: [is_used(shader, 0), is_used(shader, 1)],
            layout,
            tile,
            params,
            bound: None,
        })
    }

    /// Begins the pass with its pipeline and groups.
    fn begin<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        recording: &Recording<'_>,
        shared: &SharedGroups,
        bound: &wgpu::BindGroup,
    ) -> wgpu::ComputePass<'e> {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(self.pass.name),
            timestamp_writes: recording.compute(self.pass.name),
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, shared.group_for(self.used[0], 0), &[]);
        pass.set_bind_group(1, shared.group_for(self.used[1], 1), &[]);
        pass.set_bind_group(2, bound, &[]);
        pass
    }

    /// Encodes the pass with groups 0 and 1 of its own and this number of workgroups; nothing if it was never bound.
    pub fn encode(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        recording: &Recording<'_>,
        shared: &SharedGroups,
        [x, y, z]: [u32; 3],
    ) {
        if let Some(bound) = &self.bound {
            let mut pass = self.begin(encoder, recording, shared, bound);
            pass.dispatch_workgroups(x, y, z);
        }
    }

    /// Width and height of the pass's workgroups.
    pub fn tile(&self) -> [u32; 2] {
        self.tile
    }

    /// Name of the pass.
    pub fn name(&self) -> &'static str {
        self.pass.name
    }

    /// Binds targets, `params` and `extra` by name. `aliases` give targets other names in this shader.
    ///
    /// # Errors
    /// A name that is missing on either side, with the shader's file.
    pub fn bind(
        &mut self,
        gpu: &Gpu,
        targets: &Targets,
        aliases: &[(&str, Target)],
        extra: &[Named<'_>],
    ) -> Result<(), GpuError> {
        let lookup = |name: &str| {
            if name == "params" {
                return self.params.as_ref().map(wgpu::Buffer::as_entire_binding);
            }
            if let Some((_, resource)) = extra.iter().find(|(n, _)| *n == name) {
                return Some(resource.clone());
            }
            let alias = aliases.iter().find(|(n, _)| *n == name).map(|(_, t)| *t);
            let target = alias.or_else(|| Target::named(name))?;
            targets.view(target).map(wgpu::BindingResource::TextureView)
        };
        self.bound = Some(self.layout.bind_with(gpu, lookup)?);
        Ok(())
    }

    /// Writes the pass's `Params`.
    pub fn set_params<T: bytemuck::Pod>(&self, gpu: &Gpu, params: &T) {
        if let Some(buffer) = &self.params {
            gpu.queue
                .write_buffer(buffer, 0, bytemuck::bytes_of(params));
        }
    }

    /// Records the pass; nothing if it was never bound.
    pub fn record(&self, recorder: &mut Recorder<'_>, lists: &RayList, dispatch: Dispatch) {
        let Some(bound) = &self.bound else { return };
        let (size, invoked) = (recorder.size, recorder.invoked);
        recorder.pass(self.pass.name, |encoder, recording| {
            let mut pass = self.begin(encoder, recording, recording.shared, bound);
            let ([width, height], [x, y]) = match dispatch {
                Dispatch::PerPixel => (invoked, self.tile),
                Dispatch::WholePicture | Dispatch::Surfaces => (size, self.tile),
                Dispatch::Tiles(side) => (size, [side; 2]),
                Dispatch::Groups(groups) => ([groups, 1], [1; 2]),
                Dispatch::Listed(list) => {
                    let offset = list.arguments_offset();
                    return pass.dispatch_workgroups_indirect(&lists.arguments, offset);
                }
            };
            pass.dispatch_workgroups(width.div_ceil(x), height.div_ceil(y), 1);
        });
    }
}

/// The overrides among `overrides` that the shader declares.
pub fn declared_overrides(shader: &Shader, overrides: &[Override]) -> Vec<Override> {
    let declared = &shader.info.overrides;
    let is_declared = |(name, _): &&Override| declared.iter().any(|o| o.name == *name);
    overrides.iter().filter(is_declared).copied().collect()
}
