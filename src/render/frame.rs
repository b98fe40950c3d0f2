//! The frame: which passes run, in which order. Read this first.

use std::time::Instant;

use glam::Vec2;

use crate::{
    gpu::{Gpu, readback, timer::sum_by_name},
    math::Bounds,
    scene::desc::CameraDesc,
    world::World,
};

use super::{
    Renderer,
    build::Reflections,
    error::RenderError,
    lights::{ShadowView, lights},
    options::RenderOptions,
    pass::Dispatch,
    passes::{blur, compose, ssr, tone},
    probe::{Probe, Probes},
    recorder::{Recorder, Timing},
    stats::{FrameStats, Shares},
    types::{Frame, LightBlock},
    view::{View, jitter},
};

impl Renderer {
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
            let recorder = self.sub_frame(gpu, world, &view, sample, Timing::Passes, None);
            passes_ms.extend(recorder.finish()?);
        }
        gpu.wait()?;
        let frame_ms = started.elapsed().as_secs_f64() * 1e3;
        let mut stats = self.stats(sum_by_name(passes_ms), frame_ms);
        if let Some(r) = &self.passes.reflections {
            stats.set_counters(&readback::read_buffer(gpu, &r.list.counters)?);
        }
        Ok(stats)
    }

    /// Submits one picture; at most two of its sub-frames are ever waiting for the GPU. Nothing is
    /// timed or counted.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub(super) fn submit(
        &mut self,
        gpu: &Gpu,
        world: &World,
        camera: &CameraDesc,
    ) -> Result<FrameStats, RenderError> {
        let view = View::new(camera, self.options.image.size);
        let mut before = None;
        for sample in 0..self.options.image.samples {
            let recorder = self.sub_frame(gpu, world, &view, sample, Timing::None, None);
            let submission = recorder.submit()?;
            if let Some(before) = before.replace(submission) {
                gpu.wait_for(&before)?;
            }
        }
        Ok(self.stats(Vec::new(), 0.0))
    }

    /// One sub-frame, pass by pass; a probe measures what a picture does not need.
    pub(super) fn sub_frame<'a>(
        &'a mut self,
        gpu: &'a Gpu,
        world: &World,
        view: &View,
        sample: u32,
        timing: Timing,
        probe: Option<Probe>,
    ) -> Recorder<'a> {
        let jitter = jitter(sample, self.options.image.samples);
        let (block, shadow_views) = self.lights(world);
        self.buffers
            .set(gpu, &self.frame(world, view, jitter), &block);

        let Self {
            targets,
            scene,
            maps,
            passes,
            ..
        } = self;
        let size = self.options.image.size;
        let mut recorder = Recorder::new(gpu, &self.timer, timing, &passes.shared, size);
        let r = &mut recorder;
        if probe == Some(Probe::Count) {
            passes.probes.clear(r.encoder());
        }
        if sample == 0 {
            passes.shadow.record(r, maps, scene, &shadow_views);
        }
        passes
            .visibility
            .record(r, targets, scene, &view.clip_from_world(jitter));
        passes.surface.record(r, &Dispatch::PerPixel);
        let light = passes.probes.replacement_for(&passes.light, probe);
        light.record(r, &Dispatch::PerPixel);
        if let Some(reflections) = &passes.reflections {
            let replacements = (&passes.probes, probe);
            reflections.record(r, &self.options, self.unit_m, replacements);
        }
        let compose = &passes.compose[sample as usize % 2];
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
            passes
                .tone
                .set_params(gpu, &tone::Params::new(&self.options.image));
            passes.tone.record(r, &Dispatch::PerPixel);
        }
        recorder
    }

    /// The lights' uniform block, and the views of the shadow maps in the order of the lights.
    pub(super) fn lights(&self, world: &World) -> (LightBlock, Vec<ShadowView>) {
        let draws = self.scene.draws.iter();
        let bounds = draws.fold(Bounds::EMPTY, |all, d| all.union(d.bounds));
        lights(&world.lights, self.maps.sizes, &bounds)
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

    /// The stats of a frame whose counters nobody has read.
    fn stats(&self, passes_ms: Vec<(String, f64)>, frame_ms: f64) -> FrameStats {
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
        if let Some(r) = &self.passes.reflections
            && r.trace.is_some()
        {
            bytes.push(("ray_list".to_owned(), r.list.rays.size()));
        }
        let (size, method) = (self.options.image.size, self.method());
        FrameStats {
            size,
            samples: self.options.image.samples,
            method,
            unit_m: self.unit_m,
            tree_ms: self.tree_ms,
            shares: Shares::new(&[], size, method),
            rays: 0,
            passes_ms,
            frame_ms,
            bytes,
        }
    }
}

impl Reflections {
    /// The reflections of one sub-frame.
    fn record(
        &self,
        r: &mut Recorder<'_>,
        options: &RenderOptions,
        unit_m: f32,
        (probes, probe): (&Probes, Option<Probe>),
    ) {
        let settings = &options.reflection;
        r.encoder().clear_buffer(&self.list.counters, 0, None);
        let ssr = probes.replacement_for(&self.ssr, probe);
        ssr.set_params(r.gpu, &ssr::Params::new(settings, unit_m));
        ssr.record(r, &Dispatch::PerPixel);
        self.compact.record(r, &Dispatch::PerPixel);
        if let Some(traced) = &self.trace {
            traced.arguments.record(r, &Dispatch::Once);
            let rays = Dispatch::Indirect(&self.list.arguments);
            probes
                .replacement_for(&traced.trace, probe)
                .record(r, &rays);
            if let Some(traverse) = probes.traverse(probe) {
                traverse.record(r, &rays);
            }
        }
        if let Some(blur) = &self.blur {
            for (pass, direction) in blur.iter().zip([[1, 0], [0, 1]]) {
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
