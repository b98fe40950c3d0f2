//! The frame: which passes run, in which order. Read this first.

use std::time::Instant;

use glam::Vec2;

use crate::{
    gpu::{Gpu, GpuError, GroupLayout, Shader, ShaderLibrary, Timer, pipeline::Checks, readback},
    math::Bounds,
    scene::desc::{CameraDesc, ImageDesc, Method, ReflectionDesc},
    world::{World, bvh::Trees},
};

use super::{
    RenderError,
    lights::{ShadowSizes, lights},
    pass::{ComputePass, Dispatch, Shared},
    passes::{
        blur, compact, compose, light,
        shadow::{self, Shadow, ShadowMaps},
        ssr, surface, tone, trace,
        visibility::{self, Visibility},
    },
    plan::Plan,
    recorder::Recorder,
    scene::GpuScene,
    stats::{FrameStats, Shares},
    targets::{Target, Targets},
    types::{Frame, LightBlock},
    view::{View, jitter},
};

/// What to render with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// How reflections are found.
    pub reflection: ReflectionDesc,
    /// Size, sub-frames, tone.
    pub image: ImageDesc,
    /// Leave nothing out, to compare with the specialised frame.
    pub general: bool,
}

/// The uniform blocks of group 0.
#[derive(Debug)]
struct FrameBuffers {
    frame: wgpu::Buffer,
    lights: wgpu::Buffer,
}

/// Passes that only exist where the scene reflects.
#[derive(Debug)]
struct Reflections {
    ssr: ComputePass,
    compact: ComputePass,
    arguments: ComputePass,
    trace: ComputePass,
    blur: [ComputePass; 2],
    list: compact::RayList,
}

/// A scene ready to be rendered at one size with one set of options.
#[derive(Debug)]
pub struct Renderer {
    options: RenderOptions,
    unit_m: f32,
    plan: Plan,
    trees: Trees,
    tree_ms: f64,
    scene: GpuScene,
    maps: ShadowMaps,
    buffers: FrameBuffers,
    shared: Shared,
    targets: Targets,
    timer: Timer,
    shadow: Shadow,
    visibility: Visibility,
    surface: ComputePass,
    light: ComputePass,
    reflections: Option<Reflections>,
    compose: [ComputePass; 2],
    tone: ComputePass,
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
        let limit = gpu
            .limits
            .max_buffer_size
            .min(gpu.limits.max_storage_buffer_binding_size);
        let trees = Trees::build(world, limit)?;
        let tree_ms = started.elapsed().as_secs_f64() * 1e3;
        let scene = GpuScene::new(gpu, world, &trees, options.reflection.roughness_cutoff)?;
        let plan = if options.general {
            Plan::general(&options.reflection)
        } else {
            Plan::of(world, &trees, &scene.pools.places, &options.reflection)
        };
        let maps = ShadowMaps::new(gpu, ShadowSizes::of(&world.lights))?;
        let buffers = FrameBuffers::new(gpu);
        let shaders = Shaders::new(gpu, library, &plan)?;
        let shared = shaders.shared(gpu, &buffers, &maps, &scene)?;
        let wanted = wanted_targets(&plan, options);
        let targets = Targets::new(gpu, options.image.size, &wanted)?;
        let constants = plan.constants();
        let make = |pass, shader: &Shader| ComputePass::new(gpu, pass, shader, &shared, &constants);
        let bound = |mut pass: ComputePass, aliases: &[(&str, Target)]| {
            pass.bind(gpu, &targets, aliases, &[]).map(|()| pass)
        };
        let compose = |i: usize| {
            bound(
                make(&compose::PASS, &shaders.compose)?,
                &compose::ALIASES[i],
            )
        };
        let last = (options.image.samples as usize + 1) % 2;
        Ok(Self {
            shadow: Shadow::new(
                gpu,
                &shaders.shadow,
                &shared,
                &maps,
                plan.cutouts,
                &constants,
            )?,
            visibility: Visibility::new(
                gpu,
                &shaders.visibility,
                &shared,
                &scene.draws,
                &constants,
            )?,
            surface: bound(make(&surface::PASS, &shaders.surface)?, &[])?,
            light: bound(make(&light::PASS, &shaders.light)?, &[])?,
            compose: [compose(0)?, compose(1)?],
            tone: bound(
                make(&tone::PASS, &shaders.tone)?,
                &compose::ALIASES[last][..1],
            )?,
            reflections: plan
                .reflections
                .then(|| Reflections::new(gpu, &shaders, &shared, &targets, options, &constants))
                .transpose()?,
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

    /// The intermediate textures, for AOVs.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The texture that holds the sum of the sub-frames.
    pub fn color(&self) -> Target {
        compose::ALIASES[(self.options.image.samples as usize + 1) % 2][0].1
    }

    /// Takes over moved instances: their poses and the top level, never the static tree.
    pub fn update(&mut self, gpu: &Gpu, world: &World) {
        if self.plan.top_level {
            self.trees.update_top_level(world);
        }
        self.scene.update(gpu, world, &self.trees);
    }

    /// Renders one picture into the targets. The lights of `world` may have moved since the last
    /// one; their number and shadow modes may not have changed.
    ///
    /// # Errors
    /// A lost device or exhausted memory.
    pub fn render(
        &mut self,
        gpu: &Gpu,
        world: &World,
        camera: &CameraDesc,
    ) -> Result<FrameStats, RenderError> {
        let started = Instant::now();
        let samples = self.options.image.samples;
        let view = View::new(camera, self.options.image.size);
        let mut passes_ms = Vec::new();
        for sample in 0..samples {
            passes_ms.extend(self.sub_frame(gpu, world, &view, sample)?);
        }
        gpu.wait()?;
        let frame_ms = started.elapsed().as_secs_f64() * 1e3;
        Ok(self.stats(gpu, crate::gpu::timer::sum_by_name(passes_ms), frame_ms)?)
    }

    /// One sub-frame, pass by pass; milliseconds of each.
    fn sub_frame(
        &mut self,
        gpu: &Gpu,
        world: &World,
        view: &View,
        sample: u32,
    ) -> Result<Vec<(String, f64)>, GpuError> {
        let jitter = jitter(sample, self.options.image.samples);
        let bounds = self
            .scene
            .draws
            .iter()
            .fold(Bounds::EMPTY, |all, d| all.union(d.bounds));
        let (block, shadow_views) = lights(&world.lights, self.maps.sizes, &bounds);
        self.buffers
            .set(gpu, &self.frame(world, view, jitter), &block);

        let Self {
            targets,
            scene,
            maps,
            ..
        } = self;
        let mut recorder = Recorder::new(gpu, &self.timer, &self.shared, self.options.image.size);
        let r = &mut recorder;
        if sample == 0 {
            self.shadow.record(r, maps, scene, &shadow_views);
        }
        self.visibility
            .record(r, targets, scene, &view.clip_from_world(jitter));
        self.surface.record(r, &Dispatch::PerPixel);
        self.light.record(r, &Dispatch::PerPixel);
        if let Some(reflections) = &self.reflections {
            reflections.record(r, &self.options, self.unit_m);
        }
        let compose = &self.compose[sample as usize % 2];
        compose.set_params(
            gpu,
            &compose::Params {
                sample,
                pad0: 0,
                pad1: 0,
                pad2: 0,
            },
        );
        compose.record(r, &Dispatch::PerPixel);
        if sample + 1 == self.options.image.samples {
            self.tone
                .set_params(gpu, &tone::Params::new(&self.options.image));
            self.tone.record(r, &Dispatch::PerPixel);
        }
        recorder.finish()
    }

    fn frame(&self, world: &World, view: &View, jitter: Vec2) -> Frame {
        let settings = &self.options.reflection;
        let environment = &world.environment;
        Frame {
            clip_from_world: view.clip_from_world(jitter).to_cols_array_2d(),
            eye: view.eye.to_array(),
            near_m: view.near_m,
            forward: view.forward.to_array(),
            pixel_spread: view.pixel_spread(),
            right: view.right.to_array(),
            ray_length_m: settings.ray_length_u * self.unit_m,
            up: view.up.to_array(),
            roughness_cutoff: settings.roughness_cutoff,
            size: view.size.map(|v| v as f32),
            jitter: jitter.to_array(),
            zenith: environment.zenith.to_array(),
            light_count: world.lights.len() as u32,
            horizon: environment.horizon.to_array(),
            bounces: self.plan.bounces,
            ground: environment.ground.to_array(),
            fade: u32::from(settings.fade),
        }
    }

    fn stats(
        &self,
        gpu: &Gpu,
        passes_ms: Vec<(String, f64)>,
        frame_ms: f64,
    ) -> Result<FrameStats, GpuError> {
        let counters: Vec<u32> = match &self.reflections {
            Some(r) => readback::read_buffer(gpu, &r.list.counters)?,
            None => vec![0; 16],
        };
        let mut bytes: Vec<(String, u64)> = Vec::new();
        let named = |(name, size): (&str, u64)| (name.to_owned(), size);
        bytes.extend(self.scene.report().into_iter().map(named));
        bytes.push(("shadow_maps".to_owned(), self.maps.bytes));
        bytes.extend(
            self.targets
                .report()
                .into_iter()
                .map(|(n, b)| (format!("target_{n}"), b)),
        );
        if let Some(r) = &self.reflections {
            bytes.push(("ray_list".to_owned(), r.list.rays.size()));
        }
        Ok(FrameStats {
            size: self.options.image.size,
            samples: self.options.image.samples,
            method: self.options.reflection.method,
            unit_m: self.unit_m,
            tree_ms: self.tree_ms,
            shares: Shares::new(&counters, self.options.image.size),
            rays: counters[compact::RAY_COUNTER],
            passes_ms,
            frame_ms,
            bytes,
        })
    }
}

impl Reflections {
    fn new(
        gpu: &Gpu,
        shaders: &Shaders,
        shared: &Shared,
        targets: &Targets,
        options: &RenderOptions,
        constants: &[(&'static str, f64)],
    ) -> Result<Self, GpuError> {
        let list = compact::RayList::new(gpu, options.image.size)?;
        let mut constants = constants.to_vec();
        let march = options.reflection.method != Method::Rt;
        constants.push(("MARCH", f64::from(u8::from(march))));
        let make = |pass, shader: &Shader, aliases: &[(&str, Target)]| {
            let mut pass = ComputePass::new(gpu, pass, shader, shared, &constants)?;
            pass.bind(gpu, targets, aliases, &list.named())
                .map(|()| pass)
        };
        Ok(Self {
            ssr: make(&ssr::PASS, &shaders.ssr, &[])?,
            compact: make(&compact::PASS, &shaders.compact, &[])?,
            arguments: make(&compact::ARGUMENTS, &shaders.arguments, &[])?,
            trace: make(&trace::PASS, &shaders.trace, &[])?,
            blur: [
                make(&blur::PASS, &shaders.blur, &blur::ALIASES[0])?,
                make(&blur::PASS, &shaders.blur, &blur::ALIASES[1])?,
            ],
            list,
        })
    }

    fn record(&self, r: &mut Recorder<'_>, options: &RenderOptions, unit_m: f32) {
        let settings = &options.reflection;
        r.encoder().clear_buffer(&self.list.counters, 0, None);
        self.ssr
            .set_params(r.gpu, &ssr::Params::new(settings, unit_m));
        self.ssr.record(r, &Dispatch::PerPixel);
        self.compact.record(r, &Dispatch::PerPixel);
        if settings.method != Method::Ssr {
            self.arguments.record(r, &Dispatch::Once);
            self.trace
                .record(r, &Dispatch::Indirect(&self.list.arguments));
        }
        if settings.blur_px > 0.0 {
            for (pass, direction) in self.blur.iter().zip([[1, 0], [0, 1]]) {
                let sigma_px = settings.blur_px;
                pass.set_params(
                    r.gpu,
                    &blur::Params {
                        direction,
                        sigma_px,
                        pad: 0,
                    },
                );
                pass.record(r, &Dispatch::PerPixel);
            }
        }
    }
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

    fn set(&self, gpu: &Gpu, frame: &Frame, lights: &LightBlock) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        gpu.queue
            .write_buffer(&self.lights, 0, bytemuck::bytes_of(lights));
    }
}

/// The targets that a plan's passes touch.
pub fn wanted_targets(plan: &Plan, options: &RenderOptions) -> Vec<Target> {
    let reflects = [Target::Reflection, Target::Cause, Target::Hit];
    // Compose binds them by name even where they stay empty.
    let _ = plan;
    let mut wanted: Vec<Target> = Target::ALL.to_vec();
    wanted.retain(|t| {
        *t != Target::Blurred || (plan.reflections && options.reflection.blur_px >= 0.0)
    });
    debug_assert!(reflects.iter().all(|t| wanted.contains(t)));
    wanted
}

/// Every shader of the frame.
struct Shaders {
    shadow: Shader,
    visibility: Shader,
    surface: Shader,
    light: Shader,
    ssr: Shader,
    compact: Shader,
    arguments: Shader,
    trace: Shader,
    blur: Shader,
    compose: Shader,
    tone: Shader,
}

impl Shaders {
    fn new(gpu: &Gpu, library: &ShaderLibrary, _plan: &Plan) -> Result<Self, GpuError> {
        let checked = |name| Shader::new(gpu, library, name, Checks::All);
        Ok(Self {
            shadow: checked(shadow::PASS.name)?,
            visibility: checked(visibility::PASS.name)?,
            surface: checked(surface::PASS.name)?,
            light: checked(light::PASS.name)?,
            ssr: checked(ssr::PASS.name)?,
            compact: checked(compact::PASS.name)?,
            arguments: checked(compact::ARGUMENTS.name)?,
            // `check_world` and `Trees::build` validated every index that it reads.
            trace: Shader::new(gpu, library, trace::PASS.name, Checks::NoneIfEmbedded)?,
            blur: checked(blur::PASS.name)?,
            compose: checked(compose::PASS.name)?,
            tone: checked(tone::PASS.name)?,
        })
    }

    fn shared(
        &self,
        gpu: &Gpu,
        buffers: &FrameBuffers,
        maps: &ShadowMaps,
        scene: &GpuScene,
    ) -> Result<Shared, GpuError> {
        let infos = [
            &self.shadow,
            &self.visibility,
            &self.surface,
            &self.light,
            &self.ssr,
            &self.trace,
            &self.blur,
            &self.compose,
        ]
        .map(|s| &s.info);
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
