//! Shaders and pipelines of a frame: which passes a plan records, and what binds them.

use std::collections::HashMap;

use crate::{
    gpu::{
        Gpu, GpuError, GroupLayout, Shader, ShaderLibrary, pipeline::Checks, shader::ShaderSource,
    },
    scene::desc::Method,
};

use super::{
    constants::with_constants,
    options::RenderOptions,
    pass::{ComputePass, MAIN, Named, Pass, Shared},
    passes::{
        self, blur, compact, compose, light,
        shadow::{self, Shadow, ShadowMaps},
        ssr, surface, tone, trace,
        visibility::{self, Visibility},
    },
    plan::Plan,
    probe::Probes,
    ray_list::RayList,
    renderer::FrameBuffers,
    scene::GpuScene,
    targets::{Target, Targets},
};

/// What a frame records.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) shared: Shared,
    pub(super) shadow: Shadow,
    pub(super) visibility: Visibility,
    pub(super) surface: ComputePass,
    pub(super) light: ComputePass,
    pub(super) reflections: Option<Reflections>,
    pub(super) compose: [ComputePass; 2],
    pub(super) tone: ComputePass,
    /// Built when they are first asked for.
    pub(super) probes: Probes,
}

/// Passes that only exist where the scene reflects.
#[derive(Debug)]
pub(super) struct Reflections {
    pub(super) ssr: ComputePass,
    pub(super) compact: ComputePass,
    pub(super) trace: Option<Trace>,
    pub(super) blur: Option<[ComputePass; 2]>,
    pub(super) list: RayList,
}

/// Passes that only exist where something is traced.
#[derive(Debug)]
pub(super) struct Trace {
    pub(super) arguments: ComputePass,
    pub(super) trace: ComputePass,
}

/// What passes are bound to.
#[derive(Clone, Copy)]
pub(super) struct Bound<'a> {
    pub(super) scene: &'a GpuScene,
    pub(super) maps: &'a ShadowMaps,
    pub(super) buffers: &'a FrameBuffers,
    pub(super) targets: &'a Targets,
}

impl Passes {
    /// Builds every pipeline that the plan needs and binds it.
    ///
    /// # Errors
    /// What a shader or wgpu refuses.
    pub(super) fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        plan: &Plan,
        options: &RenderOptions,
        to: Bound<'_>,
    ) -> Result<Self, GpuError> {
        let shared = shaders.shared(gpu, &needed_passes(plan, options), to)?;
        let constants = plan.constants();
        let build = Build {
            gpu,
            shaders,
            shared: &shared,
            targets: to.targets,
            constants: &constants,
        };
        let compose = |i: usize| build.pass(&compose::PASS, &compose::ALIASES[i], &[]);
        let color = &compose::ALIASES[last_sub_frame(options)][..1];
        Ok(Self {
            shadow: Shadow::new(
                gpu,
                shaders.get(&shadow::PASS)?,
                &shared,
                to.maps,
                plan.cutouts,
                &constants,
            )?,
            visibility: Visibility::new(
                gpu,
                shaders.get(&visibility::PASS)?,
                &shared,
                &to.scene.draws,
                &constants,
            )?,
            surface: build.pass(&surface::PASS, &[], &[])?,
            light: build.pass(&light::PASS, &[], &[])?,
            reflections: plan
                .reflections
                .then(|| Reflections::new(&build, options))
                .transpose()?,
            compose: [compose(0)?, compose(1)?],
            tone: build.pass(&tone::PASS, color, &[])?,
            probes: Probes::default(),
            shared,
        })
    }
}

/// Parity of the last sub-frame.
pub(super) fn last_sub_frame(options: &RenderOptions) -> usize {
    (options.image.samples as usize + 1) % 2
}

/// The passes that this plan and these options record.
pub(super) fn needed_passes(plan: &Plan, options: &RenderOptions) -> Vec<&'static Pass> {
    let is_needed = |pass: &&Pass| match pass.name {
        "ssr" | "compact" => plan.reflections,
        "arguments" | "trace" => plan.reflections && options.reflection.method != Method::Ssr,
        "blur" => plan.reflections && options.reflection.blur_px > 0.0,
        _ => true,
    };
    passes::ALL.into_iter().filter(is_needed).collect()
}

/// Whether a target is written by this plan.
pub(super) fn needs(plan: &Plan, options: &RenderOptions, target: Target) -> bool {
    match target {
        Target::Reflection | Target::Cause | Target::Hit => plan.reflections,
        Target::Blurred => plan.reflections && options.reflection.blur_px > 0.0,
        Target::ColorOdd => options.image.samples > 1,
        _ => true,
    }
}

/// What building a compute pass takes.
pub(super) struct Build<'a> {
    pub(super) gpu: &'a Gpu,
    pub(super) shaders: &'a Shaders,
    pub(super) shared: &'a Shared,
    pub(super) targets: &'a Targets,
    pub(super) constants: &'a [(&'static str, f64)],
}

impl Build<'_> {
    fn pass(
        &self,
        pass: &'static Pass,
        aliases: &[(&str, Target)],
        extra: &[Named<'_>],
    ) -> Result<ComputePass, GpuError> {
        let shader = self.shaders.get(pass)?;
        self.entry(pass, shader, MAIN, aliases, extra)
    }

    /// A pass that starts at `entry` of any shader.
    pub(super) fn entry(
        &self,
        pass: &'static Pass,
        shader: &Shader,
        entry: &str,
        aliases: &[(&str, Target)],
        extra: &[Named<'_>],
    ) -> Result<ComputePass, GpuError> {
        let (shared, constants) = (self.shared, self.constants);
        let mut built = ComputePass::new(self.gpu, pass, shader, entry, shared, constants)?;
        built.bind(self.gpu, self.targets, aliases, extra)?;
        Ok(built)
    }
}

/// Whether the march is part of the pipeline.
pub(super) fn march_constant(method: Method) -> (&'static str, f64) {
    ("MARCH", f64::from(u8::from(method != Method::Rt)))
}

impl Reflections {
    fn new(build: &Build<'_>, options: &RenderOptions) -> Result<Self, GpuError> {
        let settings = &options.reflection;
        let traced = settings.method != Method::Ssr;
        let list = RayList::new(build.gpu, options.image.size, traced)?;
        let mut constants = build.constants.to_vec();
        constants.push(march_constant(settings.method));
        constants.push(("TRACE", f64::from(u8::from(traced))));
        let build = Build {
            constants: &constants,
            ..*build
        };
        let named = list.named();
        let blur = |i: usize| build.pass(&blur::PASS, &blur::ALIASES[i], &[]);
        let trace = || {
            Ok::<_, GpuError>(Trace {
                arguments: build.pass(&compact::ARGUMENTS, &[], &named)?,
                trace: build.pass(&trace::PASS, &[], &named)?,
            })
        };
        Ok(Self {
            ssr: build.pass(&ssr::PASS, &[], &[])?,
            compact: build.pass(&compact::PASS, &[], &named)?,
            trace: traced.then(trace).transpose()?,
            blur: if settings.blur_px > 0.0 {
                Some([blur(0)?, blur(1)?])
            } else {
                None
            },
            list,
        })
    }
}

/// Checked shaders by the name of their pass, each with the text it was made from. Those that are
/// not needed now stay, with their pipelines, for when they are needed again.
#[derive(Clone, Debug, Default)]
pub(super) struct Shaders(HashMap<&'static str, (ShaderSource, Shader)>);

impl Shaders {
    /// These shaders with those of `library` that are needed; one whose text is the same stays.
    ///
    /// # Errors
    /// The first that does not assemble or validate, at the author's line.
    pub(super) fn with(
        &self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        needed: &[&'static Pass],
    ) -> Result<Self, GpuError> {
        let library = with_constants(library)?;
        let mut shaders = self.clone();
        for pass in needed {
            let source = library.source(pass.name)?;
            let is_same = |(old, _): &(ShaderSource, Shader)| {
                old.text == source.text && old.embedded == source.embedded
            };
            if shaders.0.get(pass.name).is_some_and(is_same) {
                continue;
            }
            // `check_world` and `Trees::build` validated every index that tracing follows.
            let is_trace = pass.name == trace::PASS.name;
            let checks = if is_trace {
                Checks::TrustedBuiltin
            } else {
                Checks::All
            };
            let shader = Shader::from_source(gpu, &source, checks)?;
            shaders.0.insert(pass.name, (source, shader));
        }
        Ok(shaders)
    }

    /// Whether these passes have the same shaders in both.
    pub(super) fn same(&self, other: &Self, passes: &[&'static Pass]) -> bool {
        let text = |shaders: &Self, pass: &Pass| {
            let found = shaders.0.get(pass.name);
            found.map(|(source, _)| (source.text.clone(), source.embedded))
        };
        let same = |pass: &&'static Pass| text(self, pass) == text(other, pass);
        passes.iter().all(same)
    }

    pub(super) fn get(&self, pass: &Pass) -> Result<&Shader, GpuError> {
        let missing = || GpuError::Binding(format!("pass `{}` was not planned", pass.name));
        let found = self.0.get(pass.name);
        found.map(|(_, shader)| shader).ok_or_else(missing)
    }

    /// Groups 0 and 1 with everything that any of these shaders uses of them.
    fn shared(
        &self,
        gpu: &Gpu,
        needed: &[&'static Pass],
        to: Bound<'_>,
    ) -> Result<Shared, GpuError> {
        let infos = needed.iter().map(|pass| Ok(&self.get(pass)?.info));
        let infos: Vec<_> = infos.collect::<Result<_, GpuError>>()?;
        let frame = GroupLayout::new(gpu, "frame", &infos, 0)?;
        let world = GroupLayout::new(gpu, "scene", &infos, 1)?;
        let empty = GroupLayout::new(gpu, "empty", &[], 0)?;
        let frame_group = frame.bind_with(gpu, |name| match name {
            "frame" => Some(to.buffers.frame.as_entire_binding()),
            "lights" => Some(to.buffers.lights.as_entire_binding()),
            "shadow_cubes" => Some(wgpu::BindingResource::TextureView(&to.maps.cubes)),
            "shadow_maps" => Some(wgpu::BindingResource::TextureView(&to.maps.maps)),
            "shadow_sampler" => Some(wgpu::BindingResource::Sampler(&to.maps.sampler)),
            _ => None,
        })?;
        let scene_group = world.bind_with(gpu, |name| to.scene.resource(name))?;
        let empty_group = empty.bind(gpu, &[])?;
        Ok(Shared {
            layouts: [frame, world],
            groups: [frame_group, scene_group],
            empty: (empty, empty_group),
        })
    }
}
