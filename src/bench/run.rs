//! Scenes × frames × methods × settings × sizes × repetitions → samples, appended to the table as they come.

use std::{cell::RefCell, time::Instant};

use super::{
    host::Host,
    log::Log,
    parameter::{Parameter, Variant},
};
use crate::{
    gpu::{Gpu, ShaderLibrary},
    render::{RenderError, RenderOptions, Renderer},
    scene::{
        desc::{Accept, CameraDesc, Exposure, ImageDesc, Method, ReflectionDesc, Visibility},
        range::BOUNCES,
    },
    world::World,
};

mod error;
mod fill;
mod flicker;
mod frame_series;
mod interleave;
mod judge;
mod work;

pub use error::BenchError;
pub use frame_series::{FrameSeries, Mover};
pub use work::{Steps, Task, Work};

use flicker::Flicker;

/// Bounces of the reference: the most that a scene may ask for.
pub const REFERENCE_BOUNCES: u32 = BOUNCES.max as u32;

/// A scene to be measured.
#[derive(Clone, Debug)]
pub struct Subject {
    /// What tables call it.
    pub name: String,
    /// Name of the camera.
    pub camera_name: String,
    /// Its view.
    pub camera: CameraDesc,
    /// The loaded scene.
    pub world: World,
    /// Its reflection settings.
    pub reflection: ReflectionDesc,
    /// Its picture settings; the size is the protocol's.
    pub image: ImageDesc,
    /// Hash of the scene text, its overrides, its script and every file it names.
    pub content: u64,
    /// Frame of an animation, 0 for a still scene.
    pub frame: u32,
    /// Whether it is one frame of several, which share renderers: they take over moved instances.
    pub motion: bool,
    /// What it should look like, rendered by `rt` in place of the reference; of a still scene.
    pub truth: Option<Box<Subject>>,
}

impl Subject {
    /// A renderer for every setting of a method, and for the reference's bounces: the plan leaves
    /// out what a setting does not need.
    ///
    /// # Errors
    /// What the renderer refuses.
    pub fn renderer(
        &self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        reflection: &ReflectionDesc,
        size: [u32; 2],
    ) -> Result<Renderer, RenderError> {
        // The same for all methods, so that they differ in reflections alone.
        let visibility = match self.image.visibility {
            Visibility::Auto => Visibility::Raster,
            visibility => visibility,
        };
        let options = RenderOptions {
            reflection: ReflectionDesc {
                bounces: REFERENCE_BOUNCES,
                ..*reflection
            },
            image: ImageDesc {
                size,
                visibility,
                // One number for all variants and cameras; what is `auto` counts as 0.
                exposure_ev: Exposure::Ev(self.image.exposure_ev.ev()),
                ..self.image
            },
            ..RenderOptions::default()
        };
        Renderer::new(gpu, library, &self.world, &options)
    }
}

/// What is measured of each scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Protocol {
    /// Methods to compare.
    pub methods: Vec<Method>,
    /// What is turned.
    pub turn: Turn,
    /// Sizes; none takes the scene's own.
    pub sizes: Vec<[u32; 2]>,
    /// Timed frames of each variant, 1 or more.
    pub frames: u32,
    /// Untimed frames before them, 1 or more.
    pub warm_up: u32,
    /// Whether what passes do is counted, in one untimed frame of each variant.
    pub count: bool,
    /// Whether each timed frame is followed by one that times traversal apart from shading.
    pub split_trace: bool,
}

/// What is turned, and to which values.
#[derive(Clone, Debug, PartialEq)]
pub enum Turn {
    /// Nothing: the scene's own settings.
    Nothing,
    /// One parameter for all methods.
    One(Parameter, Vec<f64>),
    /// Each method's own parameter, see [`Parameter::own`].
    Own,
    /// The rule of acceptance of `hybrid`; all else is the scene's own.
    Rules,
}

/// Who watches the run, and may stop it.
pub trait Watch {
    /// What there is to do, before anything is begun.
    fn plan(&mut self, work: Work);
    /// `what` is next.
    fn begin(&mut self, what: &str);
    /// What was begun last is done: one step, whose picture has this size.
    fn did(&mut self, task: Task, size: [u32; 2]);
    /// Something worth telling.
    fn note(&mut self, text: &str);
    /// Whether to stop after the current step.
    fn is_stopped(&self) -> bool;
}

/// What a run did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outcome {
    /// Frames that were measured now.
    pub measured: usize,
    /// Frames that the table held already.
    pub skipped: usize,
    /// Whether it was stopped before its end.
    pub interrupted: bool,
}

/// What every measurement of a run shares.
pub struct Bench<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// The shaders.
    pub library: &'a ShaderLibrary,
    /// What samples say about the machine.
    pub host: &'a Host,
    /// What is measured.
    pub protocol: &'a Protocol,
    /// What the next frame of an animation takes over.
    pub stock: Stock,
}

/// Renderers and pictures kept between the frames of an animation.
#[derive(Debug, Default)]
pub struct Stock {
    renderers: RefCell<Vec<([u32; 2], Ready)>>,
    flicker: Flicker,
}

impl Stock {
    /// Forgets an animation after its last frame.
    fn clear(&self) {
        self.renderers.borrow_mut().clear();
        self.flicker.clear();
    }
}

/// A renderer that shows its subject.
#[derive(Debug)]
struct Ready {
    method: Method,
    verifies: bool,
    renderer: Renderer,
    /// Taking over moved instances, milliseconds on the CPU; none for a still scene.
    update_ms: Option<f64>,
}

impl Ready {
    /// Whether it can be turned to these settings without being built again.
    fn fits(&self, reflection: &ReflectionDesc) -> bool {
        (self.method, self.verifies) == (reflection.method, reflection.verifies())
    }
}

impl Turn {
    /// Name in tables, by which curves are told apart.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::One(parameter, _) => parameter.name(),
            Self::Own => "own",
            Self::Rules => "rules",
        }
    }
}

impl Protocol {
    /// All variants of a scene, methods in order.
    pub fn variants(&self, settings: &ReflectionDesc) -> Vec<Variant> {
        // What neighbors lend is no property of a method.
        let settings = &ReflectionDesc {
            filter: false,
            ..*settings
        };
        let of = |&method: &Method| match &self.turn {
            Turn::Nothing => vec![Variant::fixed(method, settings)],
            Turn::One(parameter, values) => Variant::turned(method, settings, *parameter, values),
            Turn::Rules => {
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
            Turn::Own => {
                let own = Parameter::own(method).iter();
                let turned = own.map(|p| Variant::turned(method, settings, *p, p.default_values()));
                turned.flatten().collect()
            }
        };
        self.methods.iter().flat_map(of).collect()
    }

    /// The sizes for a scene.
    pub fn sizes_of(&self, image: &ImageDesc) -> Vec<[u32; 2]> {
        if self.sizes.is_empty() {
            vec![image.size]
        } else {
            self.sizes.clone()
        }
    }

    /// The reference's settings: every pixel traced, as far and as often as any variant.
    pub fn reference(&self, settings: &ReflectionDesc) -> ReflectionDesc {
        let lengths = self.variants(settings).into_iter();
        let longest = lengths.map(|v| v.reflection.ray_length_u);
        ReflectionDesc {
            method: Method::Rt,
            bounces: REFERENCE_BOUNCES,
            reuse_light: false,
            filter: false,
            ray_length_u: longest.fold(settings.ray_length_u, f32::max),
            ..*settings
        }
    }
}

impl Bench<'_> {
    /// Measures every frame of every reel into `log`. Frames that the log holds under the same
    /// fingerprint are not measured again.
    ///
    /// # Errors
    /// What the renderer or the disk refuses; samples taken until then are in the log.
    pub fn run(
        &self,
        reels: &mut [FrameSeries],
        log: &mut Log,
        watch: &mut dyn Watch,
    ) -> Result<Outcome, BenchError> {
        let (mut work, mut total, mut planned) = (Work::default(), 0, 0);
        for reel in reels.iter_mut() {
            for index in 0..reel.len() {
                for block in interleave::blocks(self, reel.seen(index)) {
                    block.plan(self, log, &mut work);
                    total += block.missing(self, log);
                    planned += block.variants.len() * self.protocol.frames as usize;
                }
            }
        }
        let mut outcome = Outcome {
            skipped: planned - total,
            ..Outcome::default()
        };
        watch.plan(work);
        for reel in reels {
            for index in 0..reel.len() {
                let subject = reel.posed(index).map_err(BenchError::Scene)?;
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
            self.stock.clear();
        }
        Ok(outcome)
    }

    /// A renderer of this frame that can be retuned to any of the protocol's settings.
    fn ready(
        &self,
        subject: &Subject,
        reflection: &ReflectionDesc,
        size: [u32; 2],
    ) -> Result<Ready, BenchError> {
        let mut stock = self.stock.renderers.borrow_mut();
        let fits =
            |(its_size, ready): &([u32; 2], Ready)| *its_size == size && ready.fits(reflection);
        let kept = stock.iter().position(fits).map(|i| stock.swap_remove(i).1);
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
        Ok(Ready {
            method: reflection.method,
            verifies: reflection.verifies(),
            renderer,
            update_ms,
        })
    }

    /// Keeps renderers for the next frame, if there may be one.
    fn put_back(&self, subject: &Subject, size: [u32; 2], ready: Vec<Ready>) {
        if subject.motion {
            let mut stock = self.stock.renderers.borrow_mut();
            stock.extend(ready.into_iter().map(|ready| (size, ready)));
        }
    }
}
