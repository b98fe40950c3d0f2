//! Bind groups by name: layouts are reflected from shaders, and resources are found by the variable's name.

use std::collections::BTreeMap;

use super::{
    context::Gpu,
    error::GpuError,
    reflect::{Binding, ShaderModuleInfo},
};

/// A resource with its name in the shaders.
pub type Named<'a> = (&'static str, wgpu::BindingResource<'a>);

/// A bind group layout with the variable names of its bindings.
#[derive(Clone, Debug)]
pub struct GroupLayout {
    /// Shader or group name, for labels and messages.
    pub label: String,
    /// Bindings by number.
    pub bindings: Vec<Binding>,
    /// The layout on the device.
    pub layout: wgpu::BindGroupLayout,
}

impl GroupLayout {
    /// The layout of `@group(group)` over all `modules` that share it.
    ///
    /// # Errors
    /// [`GpuError::Binding`] when two modules disagree about a binding.
    pub fn new(
        gpu: &Gpu,
        label: &str,
        modules: &[&ShaderModuleInfo],
        group: u32,
    ) -> Result<Self, GpuError> {
        let bindings = merged_bindings(modules, group).map_err(GpuError::Binding)?;
        let entries: Vec<_> = bindings
            .iter()
            .map(|binding| wgpu::BindGroupLayoutEntry {
                binding: binding.binding,
                visibility: binding.visibility,
                ty: binding.ty,
                count: None,
            })
            .collect();
        let layout = gpu.scoped(&format!("bind group layout {label}"), || {
            gpu.device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries: &entries,
                })
        })?;
        Ok(Self {
            label: label.to_owned(),
            bindings,
            layout,
        })
    }

    /// The layout of the bindings that one entry point uses of `@group(group)`.
    ///
    /// # Errors
    /// Same errors as [`GroupLayout::new`].
    pub fn of_entry(
        gpu: &Gpu,
        module: &ShaderModuleInfo,
        entry: &str,
        group: u32,
    ) -> Result<Self, GpuError> {
        let mut used = module.clone();
        used.bindings
            .retain(|binding| binding.entry_points.iter().any(|name| name == entry));
        Self::new(gpu, &module.name, &[&used], group)
    }

    /// A bind group whose resources `lookup` returns by variable name.
    ///
    /// # Errors
    /// [`GpuError::Binding`] naming the shader and the variable where `lookup` returns nothing; wgpu's error for
    /// resources that do not match the layout.
    pub fn bind_with<'a>(
        &self,
        gpu: &Gpu,
        lookup: impl Fn(&str) -> Option<wgpu::BindingResource<'a>>,
    ) -> Result<wgpu::BindGroup, GpuError> {
        let mut entries = Vec::with_capacity(self.bindings.len());
        for binding in &self.bindings {
            let resource = lookup(&binding.name).ok_or_else(|| {
                GpuError::Binding(format!(
                    "{}: `{}` (@group({}) @binding({})) is declared, but nothing of that name \
                     is bound to {}",
                    binding.declared_at, binding.name, binding.group, binding.binding, self.label
                ))
            })?;
            entries.push(wgpu::BindGroupEntry {
                binding: binding.binding,
                resource,
            });
        }
        gpu.scoped(&format!("bind group {}", self.label), || {
            gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&self.label),
                layout: &self.layout,
                entries: &entries,
            })
        })
    }

    /// A bind group of exactly these named resources.
    ///
    /// # Errors
    /// Same errors as [`GroupLayout::bind_with`], and [`GpuError::Binding`] for a name that the shader does not use.
    pub fn bind(
        &self,
        gpu: &Gpu,
        resources: &[(&str, wgpu::BindingResource<'_>)],
    ) -> Result<wgpu::BindGroup, GpuError> {
        let names: Vec<&str> = resources.iter().map(|(name, _)| *name).collect();
        self.check_names(&names)?;
        self.bind_with(gpu, |wanted| {
            let found = resources.iter().find(|(name, _)| *name == wanted);
            found.map(|(_, resource)| resource.clone())
        })
    }

    /// Whether the group's names are exactly `names`, in any order.
    ///
    /// # Errors
    /// [`GpuError::Binding`] naming the first name that is missing on either side.
    pub fn check_names(&self, names: &[&str]) -> Result<(), GpuError> {
        if let Some(extra) = names
            .iter()
            .find(|name| self.bindings.iter().all(|binding| binding.name != **name))
        {
            let used: Vec<&str> = self.bindings.iter().map(|b| b.name.as_str()).collect();
            return Err(GpuError::Binding(format!(
                "{}: `{extra}` is bound, but the shader does not use it; it uses: {}",
                self.label,
                used.join(", ")
            )));
        }
        match self
            .bindings
            .iter()
            .find(|binding| !names.contains(&binding.name.as_str()))
        {
            Some(missing) => Err(GpuError::Binding(format!(
                "{}: `{}` (@group({}) @binding({})) is declared, but {} does not bind it",
                missing.declared_at, missing.name, missing.group, missing.binding, self.label
            ))),
            None => Ok(()),
        }
    }
}

/// The bindings of one group over all modules that share it, by number; stages are joined.
///
/// # Errors
/// A message with both declarations if one number has two names or types, or one name two numbers.
pub fn merged_bindings(modules: &[&ShaderModuleInfo], group: u32) -> Result<Vec<Binding>, String> {
    let mut merged: Vec<Binding> = Vec::new();
    let all = modules.iter().flat_map(|module| &module.bindings);
    for new in all.filter(|binding| binding.group == group) {
        let same_slot = |old: &&mut Binding| old.binding == new.binding || old.name == new.name;
        let Some(old) = merged.iter_mut().find(same_slot) else {
            merged.push(new.clone());
            continue;
        };
        let ty = joined_type(old.ty, new.ty);
        match ty.filter(|_| old.binding == new.binding && old.name == new.name) {
            Some(ty) => {
                old.ty = ty;
                old.visibility |= new.visibility;
            }
            None => {
                return Err(format!(
                    "{} and {} disagree: `{}` is @group({group}) @binding({}) {:?}, \
                     `{}` is @group({group}) @binding({}) {:?}",
                    old.declared_at,
                    new.declared_at,
                    old.name,
                    old.binding,
                    old.ty,
                    new.name,
                    new.binding,
                    new.ty
                ));
            }
        }
    }
    merged.sort_by_key(|binding| binding.binding);
    Ok(merged)
}

/// Binding type compatible with both, if any: a texture that one shader samples and another only loads is
/// filterable; a buffer has the larger minimum size.
fn joined_type(a: wgpu::BindingType, b: wgpu::BindingType) -> Option<wgpu::BindingType> {
    use wgpu::{BindingType as B, TextureSampleType as T};
    match (a, b) {
        (
            B::Texture {
                sample_type: T::Float { filterable: fa },
                view_dimension,
                multisampled,
            },
            B::Texture {
                sample_type: T::Float { filterable: fb },
                view_dimension: vb,
                multisampled: mb,
            },
        ) if view_dimension == vb && multisampled == mb => Some(B::Texture {
            sample_type: T::Float {
                filterable: fa || fb,
            },
            view_dimension,
            multisampled,
        }),
        (
            B::Buffer {
                ty,
                has_dynamic_offset,
                min_binding_size: sa,
            },
            B::Buffer {
                ty: tb,
                min_binding_size: sb,
                ..
            },
        ) if ty == tb => Some(B::Buffer {
            ty,
            has_dynamic_offset,
            min_binding_size: sa.max(sb),
        }),
        (a, b) => (a == b).then_some(a),
    }
}

/// Violations of `limits` by a pipeline with these groups, one message each. Pure, so that tests can
/// enforce `Limits::default()` on any adapter.
pub fn over_limits(groups: &[&[Binding]], limits: &wgpu::Limits) -> Vec<String> {
    let mut problems = Vec::new();
    let last_used = groups.iter().rposition(|group| !group.is_empty());
    let num_groups = last_used.map_or(0, |last| last as u32 + 1);
    if num_groups > limits.max_bind_groups {
        let allowed = limits.max_bind_groups;
        problems.push(format!("{num_groups} bind groups, {allowed} allowed"));
    }
    for (stage, stage_name) in [
        (wgpu::ShaderStages::VERTEX, "vertex"),
        (wgpu::ShaderStages::FRAGMENT, "fragment"),
        (wgpu::ShaderStages::COMPUTE, "compute"),
    ] {
        let mut names_by_kind: BTreeMap<(&str, u32), Vec<&str>> = BTreeMap::new();
        let bindings = groups.iter().flat_map(|group| group.iter());
        for binding in bindings.filter(|binding| binding.visibility.contains(stage)) {
            let names = names_by_kind.entry(limit_of(&binding.ty, limits));
            names.or_default().push(&binding.name);
        }
        for ((kind, allowed), names) in names_by_kind {
            if names.len() > allowed as usize {
                problems.push(format!(
                    "{} {kind} in the {stage_name} stage, {allowed} allowed: {}",
                    names.len(),
                    names.join(", ")
                ));
            }
        }
    }
    problems
}

/// Limit category of a binding, and its limit per stage.
fn limit_of(ty: &wgpu::BindingType, limits: &wgpu::Limits) -> (&'static str, u32) {
    use wgpu::{BindingType as B, BufferBindingType as Buffer};
    match ty {
        B::Buffer {
            ty: Buffer::Uniform,
            ..
        } => (
            "uniform buffers",
            limits.max_uniform_buffers_per_shader_stage,
        ),
        B::Buffer { .. } => (
            "storage buffers",
            limits.max_storage_buffers_per_shader_stage,
        ),
        B::StorageTexture { .. } => (
            "storage textures",
            limits.max_storage_textures_per_shader_stage,
        ),
        B::AccelerationStructure { .. } => (
            "acceleration structures",
            limits.max_acceleration_structures_per_shader_stage,
        ),
        B::Sampler(_) => ("samplers", limits.max_samplers_per_shader_stage),
        _ => (
            "sampled textures",
            limits.max_sampled_textures_per_shader_stage,
        ),
    }
}
