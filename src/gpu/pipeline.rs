//! Shader modules and pipelines, created in error scopes.

use std::{
    borrow::Cow,
    sync::{Arc, Mutex, atomic::Ordering},
};

use naga::valid::Capabilities;

use super::{
    bind::{GroupLayout, over_limits},
    context::Gpu,
    error::GpuError,
    reflect::{self, Binding},
    shader::{ShaderError, ShaderLibrary, ShaderSource},
    shader_cache::{Checks, PipelineKey, Recent, Shader, find, get_or_make},
    specialize::{pruned, specialized},
    used_textures::UsedTextures,
};

/// A pipeline of a shader.
struct Wanted<'a> {
    /// The compute entry point; `None` for a render pipeline.
    compute: Option<&'a str>,
    /// Entry points and fixed-function state.
    state: &'a str,
    groups: &'a [&'a GroupLayout],
    constants: &'a [(&'a str, f64)],
}

fn binding_key(groups: &[&GroupLayout]) -> String {
    let of = |b: &Binding| (b.group, b.binding, b.ty, b.visibility);
    let bindings = groups.iter().map(|group| group.bindings.iter().map(of));
    let bindings: Vec<Vec<_>> = bindings.map(Iterator::collect).collect();
    format!("{bindings:?}")
}

impl Gpu {
    /// The shader of an assembled text, of which these values of boolean overrides leave a part, or the cached shader
    /// of the same text and values. Values of other and of undeclared overrides change nothing.
    ///
    /// # Errors
    /// Same errors as [`Shader::new`].
    pub fn shader(
        &self,
        source: ShaderSource,
        checks: Checks,
        constants: &[(&str, f64)],
    ) -> Result<Shader, GpuError> {
        let parsed = (self.shaders).parsed(&source, |source| self.parsed(source))?;
        let is_flag = |(_, known): &(_, &naga::Override)| {
            parsed.types[known.ty].inner == naga::TypeInner::Scalar(naga::Scalar::BOOL)
        };
        let flags = parsed.overrides.iter().filter(is_flag);
        let given = flags.filter_map(|(_, known)| {
            let name = known.name.clone()?;
            let (_, value) = constants.iter().find(|(key, _)| *key == name)?;
            Some((name, *value != 0.0))
        });
        let given: Vec<(String, bool)> = given.collect();
        let make = |source: &ShaderSource| {
            let capabilities: Capabilities = reflect::capabilities(self.features);
            let module = pruned(&parsed, constants);
            let (info, validated) = reflect::declared(source, &module, capabilities)?;
            Ok(Shader {
                info,
                textures: Arc::new(UsedTextures::new(&parsed, &module)),
                module: Arc::new((module, validated)),
                trusted: checks == Checks::TrustedBuiltin && source.embedded,
                keys: Arc::default(),
            })
        };
        self.shaders.get_or_make(source, checks, given, make)
    }

    /// Parses a text. A text of this program was validated by its tests, so that only parts of it are validated again.
    fn parsed(&self, source: &ShaderSource) -> Result<naga::Module, GpuError> {
        let module = reflect::parse(source)?;
        if !source.embedded {
            reflect::declared(source, &module, reflect::capabilities(self.features))?;
        }
        self.compile_stats.shaders.fetch_add(1, Ordering::Relaxed);
        Ok(module)
    }

    /// Notes that renderers have taken other shader texts: pipelines of older texts are dropped from the caches;
    /// software drivers hold several MB for each.
    pub fn shader_texts_changed(&self) {
        self.shaders.texts_changed();
    }
}

/// Takes the names of entry points from arguments and variables. Browsers get modules as text, in which naga names
/// functions' own things first, and calls an entry point whose name is taken otherwise.
fn free_entry_names(module: &mut naga::Module) {
    let entries: Vec<_> = module.entry_points.iter().map(|e| e.name.clone()).collect();
    let functions = module.functions.iter_mut().map(|(_, function)| function);
    for function in functions.chain(module.entry_points.iter_mut().map(|e| &mut e.function)) {
        let arguments = function.arguments.iter_mut().map(|a| &mut a.name);
        let locals = function
            .local_variables
            .iter_mut()
            .map(|(_, l)| &mut l.name);
        for name in arguments.chain(locals) {
            name.take_if(|name| entries.contains(name));
        }
    }
}

impl Shader {
    /// Loads and validates the shader `name`.
    ///
    /// # Errors
    /// [`GpuError::Shader`] at the line in its source file, or a wgpu error.
    pub fn new(gpu: &Gpu, library: &ShaderLibrary, name: &str) -> Result<Self, GpuError> {
        gpu.shader(library.source(name)?, Checks::All, &[])
    }

    /// The module for one compute entry point or all entry points, with values for its overrides.
    fn specialized(
        &self,
        compute: Option<&str>,
        constants: &[(&str, f64)],
    ) -> Result<naga::Module, GpuError> {
        let (module, validated) = &*self.module;
        specialized(module, validated, compute, constants)
            .map_err(|error| ShaderError::new(&self.info.file, error.to_string()).into())
    }

    /// The cached pipeline of these groups, constants and `state`, or a new one from `make`, with the layout of the
    /// groups and the module on the device. Another text that specializes to the same module shares its pipeline.
    fn pipeline<P: Clone, const MOST: usize>(
        &self,
        gpu: &Gpu,
        cache: &Mutex<Recent<PipelineKey, P, MOST>>,
        wanted: &Wanted<'_>,
        make: impl FnOnce(&wgpu::PipelineLayout, &wgpu::ShaderModule) -> P,
    ) -> Result<P, GpuError> {
        self.check_constants(wanted.constants)?;
        let bindings = binding_key(wanted.groups);
        let name = format!("{} {:?} {bindings}", wanted.state, wanted.constants);
        if let Some(known) = find(&self.keys, &name).and_then(|key| find(cache, &key)) {
            return Ok(known);
        }
        let module = self.specialized(wanted.compute, wanted.constants)?;
        let key = get_or_make(&self.keys, name, |_| {
            let rest = format!("{} {} {bindings}", wanted.state, self.trusted);
            Ok(PipelineKey::new(&module, &rest))
        })?;
        get_or_make(cache, key, |_| {
            let layout = self.pipeline_layout(gpu, wanted.groups)?;
            let module = self.on_device(gpu, module)?;
            gpu.scoped(&format!("pipeline {}", self.info.name), || {
                gpu.compile_stats.pipeline(|| make(&layout, &module))
            })
        })
    }

    fn on_device(
        &self,
        gpu: &Gpu,
        mut module: naga::Module,
    ) -> Result<wgpu::ShaderModule, GpuError> {
        if cfg!(target_arch = "wasm32") {
            free_entry_names(&mut module);
        }
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
    ) -> Result<Arc<wgpu::ComputePipeline>, GpuError> {
        let compute = self.info.entry_point(entry);
        if compute.is_none_or(|found| found.stage != wgpu::ShaderStages::COMPUTE) {
            let message = format!("has no compute entry point `{entry}`");
            return Err(ShaderError::new(&self.info.file, message).into());
        }
        let wanted = Wanted {
            compute: Some(entry),
            state: entry,
            groups,
            constants,
        };
        self.pipeline(gpu, &gpu.shaders.computes, &wanted, |layout, module| {
            let label = format!("{}.{entry}", self.info.name);
            let pipeline = (gpu.device).create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(&label),
                layout: Some(layout),
                module,
                entry_point: Some(entry),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                cache: gpu.pipeline_cache(),
            });
            Arc::new(pipeline)
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
    ) -> Result<Arc<wgpu::RenderPipeline>, GpuError> {
        let wanted = Wanted {
            compute: None,
            state,
            groups,
            constants,
        };
        self.pipeline(gpu, &gpu.shaders.renders, &wanted, |layout, module| {
            Arc::new(make(layout, module))
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
