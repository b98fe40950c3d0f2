//! The frame: its sub-frames, recorded and submitted. `passes/mod.rs` lists the passes in their order.

use std::sync::Arc;

use reflet_base::{clock::Instant, math::Bounds};
use reflet_gpu::{Gpu, GpuError, readback};
use reflet_scene::desc::{CameraDesc, Method};
use reflet_world::{World, solid_around};

use super::stats::{FrameStats, Shares};
use crate::{
    buffers::frame_uniforms::FrameSettings,
    decide::edge_on::has_edge_on_surfaces,
    error::RenderError,
    layout::{
        fog::GpuFog,
        types::{Frame, Sampling},
    },
    lighting::lights::{LightBlock, ShadowView, lights, map_near_m},
    maps::method_maps::{CaptureInputs, MapStats},
    passes::named,
    pipeline::{
        instrument::Instrument,
        pass::PassGroup,
        recorder::{PassTimes, Recorder, Timing},
        sub_frame::SubFrame,
    },
    renderer::Renderer,
    settings::{
        offsets::jitter,
        pixel_share::{MOMENTS, PixelShare, needs_moments},
        view::View,
    },
};

/// Poses of the moments of one picture.
pub trait Moments {
    /// The world at a moment within the time that the shutter is open, -0.5 to 0.5; 0 is the frame's own.
    ///
    /// # Errors
    /// A script error at that moment.
    fn pose(&mut self, moment: f64) -> Result<&World, RenderError>;
}

/// Subject of a picture.
pub enum Shot<'a> {
    /// The shown world, seen by this camera.
    Still(&'a CameraDesc),
    /// Moments of an open shutter, each seen by the camera at its moment; each sub-frame shows other ones.
    Moments(&'a mut dyn Moments, &'a dyn Fn(&World) -> CameraDesc),
}

impl<'a> From<&'a CameraDesc> for Shot<'a> {
    fn from(camera: &'a CameraDesc) -> Self {
        Self::Still(camera)
    }
}

/// Function that is called after each sub-frame with the number of submitted ones; its error ends the picture.
pub(crate) type AfterSample<'a> = &'a dyn Fn(&Renderer, u32) -> Result<(), RenderError>;

/// Manner in which the sub-frames of a picture are recorded.
#[derive(Clone, Copy, Default)]
pub(crate) struct Work<'a> {
    /// Passes whose time is measured.
    pub(crate) timing: Timing,
    /// Measurement that is added.
    pub(crate) instrument: Option<Instrument>,
    /// Function that is called after each sub-frame.
    pub(crate) each_sample: Option<AfterSample<'a>>,
}

impl Renderer {
    /// Renders one picture into the targets.
    ///
    /// # Errors
    /// A lost device or exhausted memory; errors of the poses of moments, and of [`Renderer::update`].
    pub fn render<'a>(
        &mut self,
        gpu: &Gpu,
        shot: impl Into<Shot<'a>>,
    ) -> Result<FrameStats, RenderError> {
        Ok(self.shoot(gpu, shot.into(), true, None)?.0)
    }

    /// Renders one picture, and returns the camera at the frame's own moment. Without timing or counting, at most two
    /// of its sub-frames wait for the GPU at a time.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`], and errors of `each_sample`.
    pub(crate) fn shoot(
        &mut self,
        gpu: &Gpu,
        shot: Shot<'_>,
        timed: bool,
        each_sample: Option<AfterSample<'_>>,
    ) -> Result<(FrameStats, CameraDesc), RenderError> {
        let started = Instant::now();
        let (mut times, mut before) = (PassTimes::default(), None);
        let timing = if timed { Timing::Passes } else { Timing::None };
        let work = Work {
            timing,
            each_sample,
            ..Work::default()
        };
        let camera = self.each_share(gpu, shot, work, |renderer, recorder| {
            if timed {
                times.extend(renderer.submitted(recorder.finish())?);
                return Ok(());
            }
            let submission = renderer.submitted(recorder.submit())?;
            if let Some(before) = before.replace(submission) {
                gpu.wait_for(&before)?;
            }
            Ok(())
        })?;
        if !timed {
            return Ok((self.stats(PassTimes::default(), 0.0), camera));
        }
        gpu.wait()?;
        let frame_ms = started.elapsed().as_secs_f64() * 1e3;
        let mut stats = self.stats(times.summed(), frame_ms);
        let counters = self.bindings.ray_list.counted();
        stats.set_counters(&readback::read_buffer(gpu, counters)?);
        Ok((stats, camera))
    }

    /// Records every share of every sub-frame of a picture, with its pose and camera, and gives it to `submit`; returns
    /// the last camera, which belongs to the frame's own moment.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`], and errors of `submit`.
    pub(crate) fn each_share(
        &mut self,
        gpu: &Gpu,
        mut shot: Shot<'_>,
        work: Work<'_>,
        mut submit: impl FnMut(&Self, Recorder<'_>) -> Result<(), RenderError>,
    ) -> Result<CameraDesc, RenderError> {
        let samples = self.options.image.samples.count();
        let has_moments = self.plan.features.moments && needs_moments(samples);
        let (mut seen, moments_each) = match &shot {
            Shot::Still(camera) => (Some((self.view(gpu, camera), (*camera).clone())), 1),
            Shot::Moments(..) => (None, if has_moments { MOMENTS } else { 1 }),
        };
        for sample in 0..samples {
            for share in PixelShare::of_sub_frame(sample, moments_each) {
                if let Shot::Moments(moments, camera) = &mut shot {
                    let world = moments.pose(share.moment_of(samples))?;
                    self.update(gpu, world)?;
                    let camera = camera(world);
                    seen = Some((self.view(gpu, &camera), camera));
                }
                if let Some((view, _)) = &seen {
                    let recorder = self.sub_frame(gpu, view, share, work.timing, work.instrument);
                    submit(self, recorder)?;
                }
            }
            if work.instrument.is_none() {
                self.end_of_sub_frame(gpu, sample)?;
            }
            if let Some(each_sample) = work.each_sample {
                each_sample(self, sample + 1)?;
            }
        }
        Ok(seen.map(|(_, camera)| camera).unwrap_or_default())
    }

    /// The view of a camera, given in scene coordinates, in the renderer's coordinates; reflection rays skip what this
    /// view allows from now on.
    pub(crate) fn view(&mut self, gpu: &Gpu, camera: &CameraDesc) -> View {
        let drawn = self.drawn_bounds();
        let world = &self.world;
        let (camera, _) = self.coordinates.view(camera, &drawn, self.unit_m);
        let mut view = View::new(&camera, self.options.image.size, self.unit_m);
        // Method `ssr` and the paper's rule assume that the picture shows all surfaces, so they need no such check.
        let verifies = self.plan.features.reflections && self.options.reflection.verifies();
        view.has_edge_on = verifies && has_edge_on_surfaces(world, &view);
        let skipped = self.skip.skipped(world, &view, &self.options.reflection);
        let (trees, scene) = (
            Arc::make_mut(&mut self.trees),
            Arc::make_mut(&mut self.scene),
        );
        if trees.skip(world, &skipped) {
            scene.write_reflected(gpu, trees);
        }
        scene.set_skipped(gpu, world, trees, &skipped);
        view
    }

    /// Makes the next picture draw all shadow maps, also where neither light nor casters have moved.
    pub fn redraw_shadows(&self) {
        self.bindings.passes.forget();
    }

    /// Makes the next picture capture the maps of its method, also where nothing that they see has changed.
    pub fn recapture_maps(&self) {
        if let Some(maps) = &self.bindings.captured {
            maps.upkeep().forget();
        }
    }

    /// Result of a submission; after an error all shadow maps and probes count as outdated.
    pub(crate) fn submitted<T>(&self, result: Result<T, GpuError>) -> Result<T, GpuError> {
        result.inspect_err(|_| {
            self.redraw_shadows();
            self.recapture_maps();
        })
    }

    /// Whether a share of a sub-frame resolves the surfaces of all pixels: for the march, which meets surrounding
    /// pixels, and for AOVs, which show the frame's own moment.
    fn resolves_all(&self, share: PixelShare) -> bool {
        let marches = self.plan.features.reflections && self.method().marches();
        marches || (share.is_last() && share.sample + 1 == self.options.image.samples.count())
    }

    /// Records the share of one sub-frame, pass by pass; an instrument adds a measurement.
    pub(crate) fn sub_frame<'a>(
        &'a self,
        gpu: &'a Gpu,
        view: &View,
        share: PixelShare,
        timing: Timing,
        instrument: Option<Instrument>,
    ) -> Recorder<'a> {
        let (sample, samples) = (share.sample, self.options.image.samples.count());
        let whole_surfaces = self.resolves_all(share);
        let eye = view.eye;
        let (view, shift) = &view.through_lens(sample, samples);
        let view = &view.reaching(&self.drawn_bounds());
        let jitter = jitter(sample, samples) + *shift;
        let (mut block, shadow_views) = self.lights();
        let (world, settings) = (&self.world, &self.options.reflection);
        let mut frame = Frame::new(
            world,
            view,
            jitter,
            &FrameSettings {
                reflection: settings,
                exposure_ev: self.options.image.exposure_ev.ev(),
                unit_m: self.unit_m,
                bounces: self.plan.bounces,
                crop: self.options.lit_edges(),
                share,
                samples,
                whole_surfaces,
                around: solid_around(world, &self.trees, eye),
            },
        );
        let mut sampling =
            Sampling::new(world, &self.options.image, self.scene.light_tree(), sample);
        (self.scene.shown_light).leave(world, &mut frame, &mut sampling, &mut block);
        self.uniforms.set(gpu, &frame, &block, &sampling);
        if let Some(fog) = GpuFog::from_world(world) {
            self.uniforms.set_fog(gpu, &fog);
        }
        let inputs = CaptureInputs {
            world,
            frame: &frame,
            lights: &block,
            sampling: &sampling,
            eye,
            settings,
            unit_m: self.unit_m,
        };
        let maps = self.bindings.captured.as_ref();
        let captures = maps.is_some_and(|maps| maps.prepare(gpu, &inputs));
        let size = self.options.image.size;
        let mut frame = SubFrame {
            recorder: Recorder::new(gpu, &self.timer, timing, &self.bindings.shared, size)
                .over(share.squares(size)),
            options: &self.options,
            unit_m: self.unit_m,
            share,
            whole_surfaces,
            clip_from_world: view.clip_from_world(jitter),
            shadow_views,
            resources: self.resources(),
            instruments: &self.bindings.instruments,
            captures,
            instrument,
        };
        self.bindings.passes.record(&mut frame);
        frame.recorder
    }

    /// Uniform block of the lights, and the views of the shadow maps in the order of the lights.
    pub(crate) fn lights(&self) -> (LightBlock, Vec<ShadowView>) {
        lights(
            &self.world.lights,
            self.bindings.maps.sizes,
            &self.drawn_bounds(),
            map_near_m(self.coordinates.meters()),
            &self.options,
        )
    }

    /// Bounding box of everything that is drawn.
    pub(crate) fn drawn_bounds(&self) -> Bounds {
        let draws = self.scene.draws.iter();
        draws.fold(Bounds::EMPTY, |all, draw| all.union(draw.bounds))
    }

    /// Statistics of a frame whose counters are not read back.
    pub(crate) fn stats(&self, times: PassTimes, frame_ms: f64) -> FrameStats {
        let (times, captured) = without_capture(times);
        let maps = self.map_stats(captured.cost_ms);
        let mut bytes: Vec<(String, u64)> = Vec::new();
        let named = |(name, size): (&str, u64)| (name.to_owned(), size);
        bytes.extend(self.scene.report().into_iter().map(named));
        bytes.push(("shadow_maps".to_owned(), self.bindings.maps.bytes));
        bytes.extend(
            self.bindings
                .targets
                .report()
                .into_iter()
                .map(|(n, b)| (format!("target_{n}"), b)),
        );
        let named_maps = self.plan.maps.and_then(Method::maps).zip(maps.as_ref());
        bytes.extend(named_maps.map(|(name, maps)| (name.to_owned(), maps.facts.bytes)));
        if self.plan.features.lists {
            bytes.push(("lists".to_owned(), self.bindings.ray_list.lists.size()));
        }
        let (size, method) = (self.options.image.size, self.method());
        FrameStats {
            size,
            samples: self.options.image.samples.count(),
            method,
            unit_m: self.unit_m(),
            tree_ms: self.tree_ms,
            structures_ms: self.scene.structures.as_ref().map_or(0.0, |s| s.build_ms),
            structures_update_ms: self.scene.structures.as_ref().map_or(0.0, |s| s.update_ms),
            shares: Shares::new(&[], size, method),
            decisions: self.decisions.clone(),
            passes_ms: times.passes_ms,
            processor_ms: times.processor_ms,
            frame_ms: frame_ms - captured.passes_ms,
            maps,
            bytes,
            ..FrameStats::default()
        }
    }

    /// Statistics of the maps of the frame's method, which were captured in this time; 0 where they were kept.
    fn map_stats(&self, update_ms: f64) -> Option<MapStats> {
        let maps = self.bindings.captured.as_ref()?;
        if update_ms > 0.0 {
            maps.upkeep().set_ms(update_ms);
        }
        let (settings, meters) = (&self.options.reflection, self.coordinates.meters());
        let key = self.bindings.key.maps.as_ref()?;
        Some(MapStats {
            facts: key.facts(settings, self.unit_m, meters),
            capture_ms: maps.upkeep().ms(),
            update_ms,
        })
    }
}

/// Times of the capture of probes, milliseconds.
#[derive(Clone, Copy, Debug, Default)]
struct CaptureTimes {
    /// GPU time, or wall time of passes that were waited for.
    passes_ms: f64,
    /// CPU time where it is known, else the same.
    cost_ms: f64,
}

/// Splits the times of a frame into its own and the times of its capture.
fn without_capture(times: PassTimes) -> (PassTimes, CaptureTimes) {
    let is_capture = |name: &str| named(name).is_some_and(|p| p.group == PassGroup::Capture);
    let split = |times: Vec<(String, f64)>| {
        let (capture, frame): (Vec<_>, Vec<_>) =
            times.into_iter().partition(|(name, _)| is_capture(name));
        (frame, capture.iter().map(|(_, ms)| ms).sum::<f64>())
    };
    let has_processor = !times.processor_ms.is_empty();
    let (passes_ms, passes) = split(times.passes_ms);
    let (processor_ms, processor) = split(times.processor_ms);
    let captured = CaptureTimes {
        passes_ms: passes,
        cost_ms: if has_processor { processor } else { passes },
    };
    let frame = PassTimes {
        passes_ms,
        processor_ms,
    };
    (frame, captured)
}
