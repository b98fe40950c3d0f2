//! Shader modules and pipelines, created in error scopes.

use std::{
    borrow::Cow,
    sync::{Arc, atomic::Ordering},
};

use naga::valid::Capabilities;

use super::{
    bind::{GroupLayout, over_limits},
    context::Gpu,
    error::GpuError,
    reflect::{self, Binding},
    shader::{ShaderError, ShaderLibrary, ShaderSource},
    shader_cache::{Checks, PipelineCache, Shader, get_or_make},
    specialize::specialized,
};

fn cache_key(what: &str, groups: &[&GroupLayout], constants: &[(&str, f64)]) -> String {
    let of = |b: &Binding| (b.group, b.binding, b.ty, b.visibility);
    let bindings = groups.iter().map(|group| group.bindings.iter().map(of));
    let bindings: Vec<Vec<_>> = bindings.map(Iterator::collect).collect();
    format!("{what} {constants:?} {bindings:?}")
}

impl Gpu {
    /// Validates the assembled text and creates its shader, or returns the cached shader of the same text.
    ///
    /// # Errors
    /// Same errors as [`Shader::new`].
    pub fn shader(&self, source: ShaderSource, checks: Checks) -> Result<Shader, GpuError> {
        (self.shaders).get_or_make(source, checks, |s| Shader::from_source(self, s, checks))
    }
}

impl Shader {
    /// Loads and validates the shader `name`.
    ///
    /// # Errors
    /// [`GpuError::Shader`] at the line in its source file, or a wgpu error.
    pub fn new(gpu: &Gpu, library: &ShaderLibrary, name: &str) -> Result<Self, GpuError> {
        gpu.shader(library.source(name)?, Checks::All)
    }

    /// Validates assembled text and reflects its declarations.
    fn from_source(gpu: &Gpu, source: &ShaderSource, checks: Checks) -> Result<Self, GpuError> {
        let capabilities: Capabilities = reflect::capabilities(gpu.features);
        let (info, module, validated) = reflect::checked(source, capabilities)?;
        gpu.compile_stats.shaders.fetch_add(1, Ordering::Relaxed);
        Ok(Self {
            info,
            module: Arc::new((module, validated)),
            trusted: checks == Checks::TrustedBuiltin && source.embedded,
            computes: PipelineCache::default(),
            renders: PipelineCache::default(),
        })
    }

    /// The module on the device, for one compute entry point or all entry points, with values for its overrides.
    fn specialized(
        &self,
        gpu: &Gpu,
        compute: Option<&str>,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ShaderModule, GpuError> {
        let (module, validated) = &*self.module;
        let module = specialized(module, validated, compute, constants)
            .map_err(|error| ShaderError::new(&self.info.file, error.to_string()))?;
        let descriptor = wgpu::ShaderModuleDescriptor {
            label: Some(&self.info.name),
            source: wgpu::ShaderSource::Naga(Cow::Owned(module)),
        };
        gpu.scoped(&format!("shader {}", self.info.file), || {
            if !self.trusted {
                return gpu.device.create_shader_module(descriptor);
            }
            let unbounded = wgpu::ShaderRuntimeChecks {
                bounds_checks: false,
                force_loop_bounding: false,
                ..wgpu::ShaderRuntimeChecks::checked()
            };
            #[expect(
                unsafe_code,
                reason = "bounds checks and loop bounds cost a quarter of the tracing speed; the text is \
                          ours, and the caller validated every index"
            )]
            // SAFETY: `trusted` says that the text was compiled into this program, and that the caller has validated
            // all indices in the buffers that the shader reads.
            unsafe {
                gpu.device
                    .create_shader_module_trusted(descriptor, unbounded)
            }
        })
    }

    /// Pipeline layout with these bind groups; a group's number is its position.
    ///
    /// # Errors
    /// [`GpuError::Shader`] when the shader or the groups exceed the limits of the device.
    pub fn pipeline_layout(
        &self,
        gpu: &Gpu,
        groups: &[&GroupLayout],
    ) -> Result<wgpu::PipelineLayout, GpuError> {
        let bindings: Vec<&[Binding]> = groups.iter().map(|g| g.bindings.as_slice()).collect();
        let problems = over_limits(&bindings, &gpu.limits);
        if !problems.is_empty() {
            return Err(ShaderError::new(&self.info.file, problems.join("; ")).into());
        }
        let layouts: Vec<_> = groups.iter().map(|group| Some(&group.layout)).collect();
        gpu.scoped(&format!("pipeline layout of {}", self.info.name), || {
            gpu.device
                .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                    label: Some(&self.info.name),
                    bind_group_layouts: &layouts,
                    immediate_size: 0,
                })
        })
    }

    /// Compute pipeline of the entry point `entry`, with `constants` as values of its overrides.
    ///
    /// # Errors
    /// [`GpuError::Shader`] for an unknown entry point or override or exceeded limits, or a wgpu error.
    pub fn compute_pipeline(
        &self,
        gpu: &Gpu,
        entry: &str,
        groups: &[&GroupLayout],
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let compute = self.info.entry_point(entry);
        if compute.is_none_or(|found| found.stage != wgpu::ShaderStages::COMPUTE) {
            let message = format!("has no compute entry point `{entry}`");
            return Err(ShaderError::new(&self.info.file, message).into());
        }
        self.check_constants(constants)?;
        get_or_make(&self.computes, cache_key(entry, groups, constants), |_| {
            let layout = self.pipeline_layout(gpu, groups)?;
            let module = self.specialized(gpu, Some(entry), constants)?;
            let label = format!("{}.{entry}", self.info.name);
            let descriptor = wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(&layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: None,
            };
            gpu.scoped(&format!("pipeline {label}"), || {
                (gpu.compile_stats).pipeline(|| gpu.device.create_compute_pipeline(&descriptor))
            })
        })
    }

    /// A cached render pipeline, created by `make` with the layout of these groups and a module that has all entry
    /// points and no overrides left; `state` is the rest of its cache key.
    ///
    /// # Errors
    /// [`GpuError::Shader`] for an unknown override or exceeded limits, or a wgpu error.
    pub fn render_pipeline(
        &self,
        gpu: &Gpu,
        state: &str,
        groups: &[&GroupLayout],
        constants: &[(&str, f64)],
        make: impl FnOnce(&wgpu::PipelineLayout, &wgpu::ShaderModule) -> wgpu::RenderPipeline,
    ) -> Result<wgpu::RenderPipeline, GpuError> {
        self.check_constants(constants)?;
        get_or_make(&self.renders, cache_key(state, groups, constants), |_| {
            let layout = self.pipeline_layout(gpu, groups)?;
            let module = self.specialized(gpu, None, constants)?;
            gpu.scoped(&format!("pipeline {}", self.info.name), || {
                gpu.compile_stats.pipeline(|| make(&layout, &module))
            })
        })
    }

    /// Checks that every constant is an override of this shader and that all required ones are set.
    ///
    /// # Errors
    /// [`GpuError::Shader`] naming the first unknown or missing override.
    pub fn check_constants(&self, constants: &[(&str, f64)]) -> Result<(), GpuError> {
        let overrides = &self.info.overrides;
        let refuse = |message| Err(ShaderError::new(&self.info.file, message).into());
        for (key, _) in constants {
            if overrides.iter().all(|known| known.key != *key) {
                let known: Vec<&str> = overrides.iter().map(|o| o.key.as_str()).collect();
                return refuse(format!(
                    "has no override `{key}`; it has: {}",
                    known.join(", ")
                ));
            }
        }
        let is_set = |key: &str| constants.iter().any(|(given, _)| *given == key);
        match overrides.iter().find(|o| !o.optional && !is_set(&o.key)) {
            Some(missing) => refuse(format!(
                "override `{}` has no default and got no value",
                missing.name
            )),
            None => Ok(()),
        }
    }
}
