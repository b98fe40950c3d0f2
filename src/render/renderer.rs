//! A scene made ready for frames: what is uploaded, built and bound, once.

use std::time::Instant;

use crate::{
    gpu::{Gpu, GpuError, GroupLayout, Shader, ShaderLibrary, Timer, pipeline::Checks},
    scene::desc::{ImageDesc, Method, ReflectionDesc},
    world::{World, bvh::Trees},
};

use super::{
    RenderError,
    lights::ShadowSizes,
    pass::{ComputePass, Pass, Shared},
    passes::{
        self, blur, compact, compose, light,
        shadow::{self, Shadow, ShadowMaps},
        ssr, surface, tone, trace,
        visibility::{self, Visibility},
    },
    plan::Plan,
    scene::GpuScene,
    targets::{Target, Targets},
    types::{Frame, LightBlock},
};

/// What to render with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// How reflections are found.
    pub reflection: ReflectionDesc,
    /// Size, sub-frames, tone.
    pub image: ImageDesc,
    /// Leave nothing out, to compare with the specialized frame.
    pub general: bool,
}

/// A scene ready to be rendered at one size with one set of options.
#[derive(Debug)]
pub struct Renderer {
    pub(super) options: RenderOptions,
    pub(super) unit_m: f32,
    pub(super) plan: Plan,
    pub(super) trees: Trees,
    pub(super) tree_ms: f64,
    pub(super) scene: GpuScene,
    pub(super) maps: ShadowMaps,
    pub(super) buffers: FrameBuffers,
    pub(super) shared: Shared,
    pub(super) targets: Targets,
    pub(super) timer: Timer,
    pub(super) shadow: Shadow,
    pub(super) visibility: Visibility,
    pub(super) surface: ComputePass,
    pub(super) light: ComputePass,
    pub(super) reflections: Option<Reflections>,
    pub(super) compose: [ComputePass; 2],
    pub(super) tone: ComputePass,
}

/// Passes that only exist where the scene reflects.
#[derive(Debug)]
pub(super) struct Reflections {
    pub(super) ssr: ComputePass,
    pub(super) compact: ComputePass,
    pub(super) trace: Option<Trace>,
    pub(super) blur: Option<[ComputePass; 2]>,
    pub(super) list: compact::RayList,
}

/// Passes that only exist where something is traced.
#[derive(Debug)]
pub(super) struct Trace {
    pub(super) arguments: ComputePass,
    pub(super) trace: ComputePass,
}

impl Renderer {
    /// Uploads the world and builds every pipeline that its plan needs.
    ///
    /// # Errors
    /// Geometry or pictures past the adapter's limits, a shader that does not build.
    pub fn new(
        gpu: &Gpu,
        library: &ShaderLibrary,
        world: &World,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        super::check_world(world)?;
        let started = Instant::now();
        let trees = Trees::build(world, gpu.largest_storage_buffer())?;
        let tree_ms = started.elapsed().as_secs_f64() * 1e3;
        let scene = GpuScene::new(gpu, world, &trees)?;
        let plan = if options.general {
            Plan::general(&options.reflection)
        } else {
            Plan::of(world, &trees, &scene.pools.places, &options.reflection)
        };
        let maps = ShadowMaps::new(gpu, ShadowSizes::of(&world.lights))?;
        let buffers = FrameBuffers::new(gpu);
        let shaders = Shaders::new(gpu, library, &needed_passes(&plan, options))?;
        let shared = shaders.shared(gpu, &buffers, &maps, &scene)?;
        let targets = Targets::new(gpu, options.image.size, |t| needs(&plan, options, t))?;
        let constants = plan.constants();
        let build = Build {
            gpu,
            shaders: &shaders,
            shared: &shared,
            targets: &targets,
            constants: &constants,
        };
        let compose = |i: usize| build.pass(&compose::PASS, &compose::ALIASES[i], &[]);
        let color = &compose::ALIASES[last_sub_frame(options)][..1];
        Ok(Self {
            shadow: Shadow::new(
                gpu,
                shaders.get(&shadow::PASS)?,
                &shared,
                &maps,
                plan.cutouts,
                &constants,
            )?,
            visibility: Visibility::new(
                gpu,
                shaders.get(&visibility::PASS)?,
                &shared,
                &scene.draws,
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
            unit_m: options.reflection.unit_m.unwrap_or_else(|| world.unit_m()),
            options: *options,
            timer: Timer::new(gpu)?,
            plan,
            trees,
            tree_ms,
            scene,
            maps,
            buffers,
            shared,
            targets,
        })
    }

    /// What the scene needs and what was left out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The length U in metres.
    pub fn unit_m(&self) -> f32 {
        self.unit_m
    }

    /// How reflections are found.
    pub fn method(&self) -> Method {
        self.options.reflection.method
    }

    /// The intermediate textures, for AOVs.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The texture that holds the sum of the sub-frames.
    pub fn color(&self) -> Target {
        compose::ALIASES[last_sub_frame(&self.options)][0].1
    }

    /// Takes over the settings that need no rebuilding: threshold, steps, ray length, bounces. The
    /// others stay as the renderer was made; so does what its plan left out.
    pub fn retune(&mut self, settings: &ReflectionDesc) {
        let lone = self.plan.bounces < self.options.reflection.bounces;
        if !lone {
            self.plan.bounces = settings.bounces;
            self.options.reflection.bounces = settings.bounces;
        }
        self.options.reflection.threshold_u = settings.threshold_u;
        self.options.reflection.steps = settings.steps;
        self.options.reflection.ray_length_u = settings.ray_length_u;
    }

    /// Takes over a world whose instances and materials were posed anew: poses, the top level and
    /// the numbers of materials, never the static tree or a picture.
    pub fn update(&mut self, gpu: &Gpu, world: &World) {
        if self.plan.top_level {
            self.trees.update_top_level(world);
        }
        self.scene.update(gpu, world, &self.trees);
        self.scene.update_materials(gpu, world);
    }
}

/// Parity of the last sub-frame.
fn last_sub_frame(options: &RenderOptions) -> usize {
    (options.image.samples as usize + 1) % 2
}

/// The passes that this plan and these options record.
fn needed_passes(plan: &Plan, options: &RenderOptions) -> Vec<&'static Pass> {
    let is_needed = |pass: &&Pass| match pass.name {
        "ssr" | "compact" => plan.reflections,
        "arguments" | "trace" => plan.reflections && options.reflection.method != Method::Ssr,
        "blur" => plan.reflections && options.reflection.blur_px > 0.0,
        _ => true,
    };
    passes::ALL.into_iter().filter(is_needed).collect()
}

/// Whether a target is written by this plan.
fn needs(plan: &Plan, options: &RenderOptions, target: Target) -> bool {
    match target {
        Target::Reflection | Target::Cause | Target::Hit => plan.reflections,
        Target::Blurred => plan.reflections && options.reflection.blur_px > 0.0,
        Target::ColorOdd => options.image.samples > 1,
        _ => true,
    }
}

/// What building a compute pass takes.
struct Build<'a> {
    gpu: &'a Gpu,
    shaders: &'a Shaders,
    shared: &'a Shared,
    targets: &'a Targets,
    constants: &'a [(&'static str, f64)],
}

impl Build<'_> {
    fn pass(
        &self,
        pass: &'static Pass,
        aliases: &[(&str, Target)],
        extra: &[(&str, &wgpu::Buffer)],
    ) -> Result<ComputePass, GpuError> {
        let shader = self.shaders.get(pass)?;
        let mut built = ComputePass::new(self.gpu, pass, shader, self.shared, self.constants)?;
        built.bind(self.gpu, self.targets, aliases, extra)?;
        Ok(built)
    }
}

impl Reflections {
    fn new(build: &Build<'_>, options: &RenderOptions) -> Result<Self, GpuError> {
        let settings = &options.reflection;
        let list = compact::RayList::new(build.gpu, options.image.size)?;
        let mut constants = build.constants.to_vec();
        let march = settings.method != Method::Rt;
        constants.push(("MARCH", f64::from(u8::from(march))));
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
            trace: (settings.method != Method::Ssr).then(trace).transpose()?,
            blur: if settings.blur_px > 0.0 {
                Some([blur(0)?, blur(1)?])
            } else {
                None
            },
            list,
        })
    }
}

/// The uniform blocks of group 0.
#[derive(Debug)]
pub(super) struct FrameBuffers {
    frame: wgpu::Buffer,
    lights: wgpu::Buffer,
}

impl FrameBuffers {
    fn new(gpu: &Gpu) -> Self {
        let make = |label, size: usize| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self {
            frame: make("frame", size_of::<Frame>()),
            lights: make("lights", size_of::<LightBlock>()),
        }
    }

    /// Uploads both blocks.
    pub(super) fn set(&self, gpu: &Gpu, frame: &Frame, lights: &LightBlock) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        gpu.queue
            .write_buffer(&self.lights, 0, bytemuck::bytes_of(lights));
    }
}

/// The shaders of the frame by the name of their pass.
struct Shaders(Vec<(&'static str, Shader)>);

impl Shaders {
    fn new(gpu: &Gpu, library: &ShaderLibrary, needed: &[&'static Pass]) -> Result<Self, GpuError> {
        let load = |pass: &&'static Pass| {
            // `check_world` and `Trees::build` validated every index that tracing follows.
            let is_trace = pass.name == trace::PASS.name;
            let checks = if is_trace {
                Checks::NoneIfEmbedded
            } else {
                Checks::All
            };
            Ok((pass.name, Shader::new(gpu, library, pass.name, checks)?))
        };
        Ok(Self(
            needed.iter().map(load).collect::<Result<_, GpuError>>()?,
        ))
    }

    fn get(&self, pass: &Pass) -> Result<&Shader, GpuError> {
        let found = self.0.iter().find(|(name, _)| *name == pass.name);
        let missing = || GpuError::Binding(format!("pass `{}` was not planned", pass.name));
        found.map(|(_, shader)| shader).ok_or_else(missing)
    }

    /// Groups 0 and 1 with everything that any of these shaders uses of them.
    fn shared(
        &self,
        gpu: &Gpu,
        buffers: &FrameBuffers,
        maps: &ShadowMaps,
        scene: &GpuScene,
    ) -> Result<Shared, GpuError> {
        let infos: Vec<_> = self.0.iter().map(|(_, shader)| &shader.info).collect();
        let frame = GroupLayout::new(gpu, "frame", &infos, 0)?;
        let world = GroupLayout::new(gpu, "scene", &infos, 1)?;
        let empty = GroupLayout::new(gpu, "empty", &[], 0)?;
        let frame_group = frame.bind_with(gpu, |name| match name {
            "frame" => Some(buffers.frame.as_entire_binding()),
            "lights" => Some(buffers.lights.as_entire_binding()),
            "shadow_cubes" => Some(wgpu::BindingResource::TextureView(&maps.cubes)),
            "shadow_maps" => Some(wgpu::BindingResource::TextureView(&maps.maps)),
            "shadow_sampler" => Some(wgpu::BindingResource::Sampler(&maps.sampler)),
            _ => None,
        })?;
        let scene_group = world.bind_with(gpu, |name| scene.resource(name))?;
        let empty_group = empty.bind(gpu, &[])?;
        Ok(Shared {
            layouts: [frame, world],
            groups: [frame_group, scene_group],
            empty: (empty, empty_group),
        })
    }
}
