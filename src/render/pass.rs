//! A compute pass: bound by name, sized by its shader, timed under its own name.

use crate::gpu::{Gpu, GpuError, GroupLayout, Shader};

/// Where the shader of a pass starts.
pub const MAIN: &str = "main";
/// Where it starts to do the same and to write down how much that was.
pub const COUNTED: &str = "counted";

use super::recorder::Recorder;
use super::targets::{Target, Targets};
use super::types::StructSpec;

/// What a pass is: its shader, what it reads and what it writes.
#[derive(Clone, Copy, Debug)]
pub struct Pass {
    /// Also the shader file, the timer label and the preview entry.
    pub name: &'static str,
    /// Targets that it samples.
    pub reads: &'static [Target],
    /// Targets that it writes.
    pub writes: &'static [Target],
    /// Layout of its `Params`, where it has them.
    pub params: Option<StructSpec>,
}

/// A resource with its name in the shaders.
pub type Named<'a> = (&'static str, wgpu::BindingResource<'a>);

/// The groups that all passes share.
#[derive(Debug)]
pub struct Shared {
    /// Layouts of groups 0 and 1.
    pub layouts: [GroupLayout; 2],
    /// The groups themselves.
    pub groups: [wgpu::BindGroup; 2],
    /// For passes that use neither.
    pub empty: (GroupLayout, wgpu::BindGroup),
}

impl Shared {
    /// The layout of group 0 or 1 for a shader: the shared one if it uses it, else the empty one.
    pub fn layout_for(&self, shader: &Shader, group: usize) -> &GroupLayout {
        if uses(shader, group) {
            &self.layouts[group]
        } else {
            &self.empty.0
        }
    }

    /// The group that goes with [`Self::layout_for`].
    pub fn group_for(&self, used: bool, group: usize) -> &wgpu::BindGroup {
        if used {
            &self.groups[group]
        } else {
            &self.empty.1
        }
    }
}

/// Whether any entry point of a shader uses this group.
pub fn uses(shader: &Shader, group: usize) -> bool {
    shader
        .info
        .bindings
        .iter()
        .any(|b| b.group as usize == group)
}

/// How many workgroups a pass runs.
pub enum Dispatch<'a> {
    /// One invocation a pixel.
    PerPixel,
    /// As many as the GPU wrote here.
    Indirect(&'a wgpu::Buffer),
    /// One workgroup.
    Once,
}

/// A pass on the device.
#[derive(Debug)]
pub struct ComputePass {
    pass: &'static Pass,
    pipeline: wgpu::ComputePipeline,
    layout: GroupLayout,
    used: [bool; 2],
    tile: [u32; 2],
    params: Option<wgpu::Buffer>,
    bound: Option<wgpu::BindGroup>,
}

impl ComputePass {
    /// Builds the pipeline from one entry point; `constants` may hold more than this shader
    /// overrides.
    ///
    /// # Errors
    /// What the shader or wgpu refuses, by file and name.
    pub fn new(
        gpu: &Gpu,
        pass: &'static Pass,
        shader: &Shader,
        entry: &str,
        shared: &Shared,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, GpuError> {
        let layout = GroupLayout::of_entry(gpu, &shader.info, entry, 2)?;
        let groups = [
            shared.layout_for(shader, 0),
            shared.layout_for(shader, 1),
            &layout,
        ];
        let constants = declared_overrides(shader, constants);
        let pipeline = shader.compute_pipeline(gpu, entry, &groups, &constants)?;
        let tile = shader
            .info
            .entry_point(entry)
            .map_or([1, 1], |e| [e.workgroup_size[0], e.workgroup_size[1]]);
        let params = pass
            .params
            .map(|spec| params_buffer(gpu, pass.name, spec.size));
        Ok(Self {
            pass,
            pipeline,
            used: [uses(shader, 0), uses(shader, 1)],
            layout,
            tile,
            params,
            bound: None,
        })
    }

    /// Name of the pass.
    pub fn name(&self) -> &'static str {
        self.pass.name
    }

    /// Binds targets, `params` and `extra` by name. `aliases` give a target another name here.
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
            let declared = self.pass.reads.iter().chain(self.pass.writes);
            let target = alias.or_else(|| declared.copied().find(|t| t.name() == name))?;
            targets.view(target).map(wgpu::BindingResource::TextureView)
        };
        self.bound = Some(self.layout.bind_with(gpu, lookup)?);
        Ok(())
    }

    /// Sets the pass's `Params`.
    pub fn set_params<T: bytemuck::Pod>(&self, gpu: &Gpu, params: &T) {
        if let Some(buffer) = &self.params {
            gpu.queue
                .write_buffer(buffer, 0, bytemuck::bytes_of(params));
        }
    }

    /// Records the pass; one that was never bound records nothing.
    pub fn record(&self, recorder: &mut Recorder<'_>, dispatch: &Dispatch<'_>) {
        let Some(bound) = &self.bound else { return };
        let size = recorder.size;
        recorder.pass(self.pass.name, |encoder, recording| {
            let shared = recording.shared;
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(self.pass.name),
                timestamp_writes: recording.compute(self.pass.name),
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, shared.group_for(self.used[0], 0), &[]);
            pass.set_bind_group(1, shared.group_for(self.used[1], 1), &[]);
            pass.set_bind_group(2, bound, &[]);
            match dispatch {
                Dispatch::PerPixel => pass.dispatch_workgroups(
                    size[0].div_ceil(self.tile[0]),
                    size[1].div_ceil(self.tile[1]),
                    1,
                ),
                Dispatch::Indirect(arguments) => pass.dispatch_workgroups_indirect(arguments, 0),
                Dispatch::Once => pass.dispatch_workgroups(1, 1, 1),
            }
        });
    }
}

/// Those of `constants` that the shader overrides.
pub fn declared_overrides<'a>(
    shader: &Shader,
    constants: &[(&'a str, f64)],
) -> Vec<(&'a str, f64)> {
    let overrides = &shader.info.overrides;
    let is_known = |(name, _): &&(&str, f64)| overrides.iter().any(|o| o.name == *name);
    constants.iter().filter(is_known).copied().collect()
}

fn params_buffer(gpu: &Gpu, name: &str, size: usize) -> wgpu::Buffer {
    gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(name),
        size: size as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}
