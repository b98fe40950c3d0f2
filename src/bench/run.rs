//! Measures scenes × frames × methods × settings × sizes × repetitions; appends each sample to the table.

mod fill;
mod flicker;
mod frame_series;
mod interleave;
mod judge;

use std::{cell::RefCell, io::Read as _, path::Path};

use flicker::Flicker;

use super::{
    hash::Hash,
    host::Host,
    log::Log,
    parameter::{Parameter, Variant},
};
use reflet_base::{clock::Instant, files::File};
use reflet_gpu::{Gpu, ShaderLibrary};
use reflet_render::{
    Poses, RenderError, RenderOptions,
    decide::decide,
    plan::traces_rays,
    renderer::adopted,
    runtime::{renderer_stage::RendererStage, scene_text::LoadedScene},
};
use reflet_scene::{
    desc::{Accept, Bounces, CameraDesc, Exposure, ImageDesc, Method, ReflectionDesc, Visibility},
    diagnostic::Diagnostic,
};
use reflet_world::{World, bvh::Trees};

pub use frame_series::{FrameSeries, Mover};

/// Bounces of the reference: as many as can be seen.
pub const REFERENCE_BOUNCES: Bounces = Bounces::Auto;

/// A scene to be measured.
#[derive(Clone, Debug)]
pub struct Subject {
    /// Name of the scene in tables.
    pub name: String,
    /// Name of the camera.
    pub camera_name: String,
    /// Camera that the pictures show.
    pub camera: CameraDesc,
    /// Index of the camera, whose view decides what is `auto`.
    pub camera_index: usize,
    /// The loaded scene.
    pub world: World,
    /// The world at the first frame, which decides what is `auto`; `None` where all frames are equal.
    pub first: Option<World>,
    /// Reflection settings of the scene.
    pub reflection: ReflectionDesc,
    /// Picture settings of the scene; the protocol decides the size.
    pub image: ImageDesc,
    /// Hash of the scene text, its overrides, its script and every file it names.
    pub content: u64,
    /// Frame of an animation, 0 for a still scene.
    pub frame: u32,
    /// Whether it is one of several frames of an animation, which share renderers that update moved instances.
    pub motion: bool,
    /// Subject whose picture replaces the reference's; only for still scenes.
    pub truth: Option<Box<Subject>>,
}

impl Subject {
    /// Subject of a loaded scene, seen by one of its cameras.
    ///
    /// # Errors
    /// Message about a file that was removed.
    pub fn new(loaded: LoadedScene, name: String, camera_index: usize) -> Result<Self, String> {
        let chosen = &loaded.world.cameras[camera_index];
        let (camera_name, camera) = (chosen.name.clone(), chosen.value.clone());
        let mut content = Hash::default().with(&loaded.text);
        for setting in &loaded.overrides {
            content = content.with(setting);
        }
        for (name, text) in loaded.scene.scripts().flat_map(|s| &s.texts) {
            let name = Path::new(&name).file_name().unwrap_or_default();
            content = content.with(name.as_encoded_bytes()).with(text);
        }
        for path in &loaded.world.files {
            let mut bytes = Vec::new();
            let read = File::open(path).and_then(|mut file| file.read_to_end(&mut bytes));
            read.map_err(|error| format!("{} cannot be read again: {error}", path.display()))?;
            content = content.with(bytes);
        }
        Ok(Self {
            name,
            camera_name,
            camera,
            camera_index,
            first: (!loaded.scene.is_still()).then(|| loaded.first_frame().into_owned()),
            reflection: loaded.scene.reflection,
            image: loaded.scene.image,
            world: loaded.world,
            content: content.value(),
            frame: 0,
            motion: false,
            truth: None,
        })
    }

    /// Creates a renderer for all settings of one method, with the reference's bounces: its plan leaves
    /// out features that no setting needs.
    ///
    /// # Errors
    /// Errors of the renderer.
    pub fn renderer(
        &self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        reflection: &ReflectionDesc,
        size: [u32; 2],
    ) -> Result<RendererStage, RenderError> {
        let mut options = RenderOptions {
            reflection: ReflectionDesc {
                bounces: REFERENCE_BOUNCES,
                ..*reflection
            },
            image: ImageDesc {
                size,
                // Fixed exposure for all variants and cameras; `auto` counts as 0.
                exposure_ev: Exposure::Ev(self.image.exposure_ev.ev()),
                ..self.image
            },
            camera: Some(self.camera_index),
            ..RenderOptions::default()
        };
        let poses = Poses {
            first: self.first.as_ref().unwrap_or(&self.world),
            shown: &self.world,
        };
        if options.image.visibility == Visibility::Auto {
            options.image.visibility = decided_visibility(gpu, poses.first, &options)?;
        }
        RendererStage::new(gpu, library, poses, &options)
    }
}

/// Measurements that are made of each scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Protocol {
    /// Methods to compare.
    pub methods: Vec<Method>,
    /// Parameter that is varied.
    pub sweep: Sweep,
    /// Picture sizes; the scene's own if empty.
    pub sizes: Vec<[u32; 2]>,
    /// Number of timed frames of each variant, 1 or more.
    pub frames: u32,
    /// Number of untimed frames before them, 1 or more.
    pub warm_up: u32,
    /// Whether the work of passes is counted, in one untimed frame of each variant.
    pub count: bool,
    /// Whether each timed frame is followed by a frame that times traversal apart from shading.
    pub split_trace: bool,
    /// Whether pictures are compared with a reference, which browsers cannot do.
    pub scores: bool,
}

/// Parameter sweep: the parameter that is varied, and its values.
#[derive(Clone, Debug, PartialEq)]
pub enum Sweep {
    /// One parameter for all methods, with its values.
    One(Parameter, Vec<f64>),
    /// Each method's own parameter, see [`Parameter::own`].
    Own,
    /// The rule of acceptance of `hybrid`; all else is the scene's own.
    Rules,
}

/// Observer of a run, which shows progress and may stop it.
pub trait Observer {
    /// Reports the number of steps of the run, before the first begins.
    fn plan(&mut self, steps: usize);
    /// Reports that step `what` begins.
    fn begin(&mut self, what: &str);
    /// Reports that the step that began last is finished.
    fn did(&mut self);
    /// Reports a message for the user.
    fn note(&mut self, text: &str);
    /// Whether to stop after the current step.
    fn is_stopped(&self) -> bool;
}

/// Result of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Number of frames that were measured in this run.
    pub measured: usize,
    /// Number of frames that the table held already.
    pub skipped: usize,
    /// Whether the run was stopped before its end.
    pub interrupted: bool,
}

/// State that all measurements of a run share.
pub struct Bench<'a> {
    /// GPU device that renders.
    pub gpu: &'a Gpu,
    /// Shader library of the renderers.
    pub library: &'a ShaderLibrary,
    /// Machine and program that samples name.
    pub host: &'a Host,
    /// Measurements that are made of each scene.
    pub protocol: &'a Protocol,
    /// Renderers and pictures that the next frame of an animation reuses.
    pub cache: AnimationCache,
}

/// Cache of renderers and previous pictures between the frames of an animation.
#[derive(Debug, Default)]
pub struct AnimationCache {
    renderers: RefCell<Vec<([u32; 2], ReadyRenderer)>>,
    flicker: Flicker,
}

impl AnimationCache {
    /// Empties the cache after the last frame of an animation.
    fn clear(&self) {
        self.renderers.borrow_mut().clear();
        self.flicker.clear();
    }
}

/// A renderer that shows a subject at its present frame.
#[derive(Debug)]
struct ReadyRenderer {
    /// Settings that it was made for.
    reflection: ReflectionDesc,
    renderer: RendererStage,
    /// CPU time to update moved instances, milliseconds; none for a still scene.
    update_ms: Option<f64>,
}

impl ReadyRenderer {
    /// Whether the renderer can change to these settings without being built again.
    fn fits(&self, reflection: &ReflectionDesc) -> bool {
        adopted(&self.reflection, reflection) == *reflection
    }
}

impl Sweep {
    /// Name in tables, by which curves are told apart.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::One(parameter, _) => parameter.name(),
            Self::Own => "own",
            Self::Rules => "rules",
        }
    }
}

impl Protocol {
    /// All variants of a scene, ordered by method.
    pub fn variants(&self, settings: &ReflectionDesc) -> Vec<Variant> {
        // The filter shares light between neighboring pixels, which is no property of a method.
        let settings = &ReflectionDesc {
            filter: false,
            ..*settings
        };
        let of = |&method: &Method| match &self.sweep {
            Sweep::One(parameter, values) => Variant::sweep(method, settings, *parameter, values),
            Sweep::Rules => {
                let by = |accept| ReflectionDesc {
                    accept,
                    ..*settings
                };
                match method {
                    Method::Hybrid => [Accept::Threshold, Accept::Verified]
                        .map(|accept| Variant::fixed(method, &by(accept)))
                        .to_vec(),
                    _ => vec![Variant::fixed(method, settings)],
                }
            }
            Sweep::Own => {
                let own = Parameter::own(method).into_iter();
                let variants = own.map(|p| Variant::sweep(method, settings, p, p.default_values()));
                variants.flatten().collect()
            }
        };
        self.methods.iter().flat_map(of).collect()
    }

    /// Picture sizes for a scene.
    pub fn sizes_of(&self, image: &ImageDesc) -> Vec<[u32; 2]> {
        if self.sizes.is_empty() {
            vec![image.size]
        } else {
            self.sizes.clone()
        }
    }

    /// Settings of the reference: every pixel traced, with the longest rays and most bounces of all variants.
    pub fn reference(&self, settings: &ReflectionDesc) -> ReflectionDesc {
        let lengths = self.variants(settings).into_iter();
        let longest = lengths.map(|v| v.reflection.ray_length_u);
        ReflectionDesc {
            method: Method::Rt,
            bounces: REFERENCE_BOUNCES,
            skip_px: 0.0,
            reuse_light: false,
            layers: 1,
            rate: 1,
            filter: false,
            ray_length_u: longest.fold(settings.ray_length_u, f32::max),
            ..*settings
        }
    }
}

impl Bench<'_> {
    /// Measures every frame of every series into `log`. Frames that the log holds under the same
    /// fingerprint are not measured again.
    ///
    /// # Errors
    /// Errors of the renderer or the disk; samples measured until then are in the log.
    pub fn run(
        &self,
        all_series: &mut [FrameSeries],
        log: &mut Log,
        watch: &mut dyn Observer,
    ) -> Result<Outcome, BenchError> {
        let (mut steps, mut total, mut planned) = (0, 0, 0);
        for series in all_series.iter_mut() {
            for index in 0..series.len() {
                for block in interleave::blocks(self, series.seen(index)) {
                    steps += block.steps(self, log);
                    total += block.missing(self, log);
                    planned += block.variants.len() * self.protocol.frames as usize;
                }
            }
        }
        let mut outcome = Outcome {
            skipped: planned - total,
            ..Outcome::default()
        };
        watch.plan(steps);
        for series in all_series {
            for index in 0..series.len() {
                let subject = series.posed(index).map_err(BenchError::Scene)?;
                for block in interleave::blocks(self, subject) {
                    if !watch.is_stopped() {
                        block.measure(self, log, watch, &mut outcome)?;
                    }
                }
                if watch.is_stopped() {
                    outcome.interrupted = outcome.measured < total;
                    return Ok(outcome);
                }
            }
            self.cache.clear();
        }
        Ok(outcome)
    }

    /// Takes a renderer for this frame from the cache or builds one; it supports every setting of its method.
    fn ready(
        &self,
        subject: &Subject,
        reflection: &ReflectionDesc,
        size: [u32; 2],
    ) -> Result<ReadyRenderer, BenchError> {
        let mut cache = self.cache.renderers.borrow_mut();
        let fits = |(its_size, ready): &([u32; 2], ReadyRenderer)| {
            *its_size == size && ready.fits(reflection)
        };
        let kept = cache.iter().position(fits).map(|i| cache.swap_remove(i).1);
        let mut renderer = match kept {
            Some(ready) => ready.renderer,
            None => subject.renderer(self.gpu, self.library, reflection, size)?,
        };
        let started = Instant::now();
        let mut update_ms = None;
        if subject.motion {
            renderer.update(self.gpu, &subject.world)?;
            update_ms = Some(started.elapsed().as_secs_f64() * 1e3);
        }
        Ok(ReadyRenderer {
            reflection: *reflection,
            renderer,
            update_ms,
        })
    }

    /// Returns renderers to the cache for the next frame of an animation.
    fn put_back(&self, subject: &Subject, size: [u32; 2], ready: Vec<ReadyRenderer>) {
        if subject.motion {
            let mut cache = self.cache.renderers.borrow_mut();
            cache.extend(ready.into_iter().map(|ready| (size, ready)));
        }
    }
}

/// Visibility that `render --method rt` chooses. All methods take it, so that they differ in reflections alone.
fn decided_visibility(
    gpu: &Gpu,
    world: &World,
    options: &RenderOptions,
) -> Result<Visibility, RenderError> {
    let mut traced = *options;
    traced.reflection.method = Method::Rt;
    if !traces_rays(world, &traced) {
        return Ok(Visibility::Raster);
    }
    // Methods that trace rays decide so themselves.
    if options.reflection.method.traces() {
        return Ok(Visibility::Auto);
    }
    let trees = Trees::build(world, u64::MAX).map_err(RenderError::Scene)?;
    let decided = decide(world, &trees, &traced, gpu.is_software());
    Ok(decided.options.image.visibility)
}

/// Reason why a bench cannot go on.
#[derive(Clone, Debug, thiserror::Error)]
pub enum BenchError {
    /// Error of the renderer or the GPU.
    #[error("{0}")]
    Render(RenderError),
    /// A file that cannot be read or written, or has the wrong contents.
    #[error("{}", .0.message)]
    File(Box<Diagnostic>),
    /// A frame that cannot be posed.
    #[error("{}", .0.first().map_or("a frame cannot be posed", |d| d.message.as_str()))]
    Scene(Vec<Diagnostic>),
}

impl<E: Into<RenderError>> From<E> for BenchError {
    fn from(error: E) -> Self {
        Self::Render(error.into())
    }
}
