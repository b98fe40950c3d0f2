//! A scene to render, with the settings of its command.

use std::{ops::RangeInclusive, sync::Arc, time::Instant};

use reflet_base::standard_error::show_work;
use xxhash_rust::xxh3::Xxh3Default;

use super::{args::RenderArgs, error::AppError};
use crate::{
    gpu::{Gpu, ShaderLibrary, driver::open_gpu},
    output::denoise::{Denoiser, reproject::FramePose},
    render::{
        Crop, ErrorEstimate, PendingPicture, Picture, PictureRequest, RenderError,
        picture::{aov::Aov, so_far::EachSample},
        renderer::stats::FrameStats,
        settings::view::View,
    },
    runtime::{SceneSource, Session, ViewOverrides, empty_view, scene_text::LoadedScene},
    scene::{desc::Samples, diagnostic::Diagnostic},
};

/// State for rendering the pictures of one command.
pub struct RenderSession {
    /// The scene with its device and renderer.
    pub scene: Session,
    /// AOVs of every frame.
    pub aovs: Vec<Aov>,
    /// Denoiser of the pictures, if requested.
    pub denoiser: Option<Arc<Denoiser>>,
    /// Number of frames before and after each frame that are denoised with it; 0: each alone.
    pub window: u32,
    /// Part of the pictures that is written.
    pub crop: Option<Crop>,
    /// Hash of the shaders, if they come from the user.
    pub own_shaders: Option<u128>,
    /// Whether passes are timed, for statistics.
    timed: bool,
    /// Whether a picture was checked for showing nothing.
    is_checked: bool,
    /// Time of sub-frames that a software driver needed to compile pipelines before passes were timed, milliseconds.
    pub warm_up_ms: f64,
    /// Number of pipelines that existed when the passes last ran.
    warm_pipelines: u32,
}

impl RenderSession {
    /// Opens the device and builds the renderer. `camera` is the index of a chosen camera.
    ///
    /// # Errors
    /// No usable adapter, a scene past its limits, a shader error.
    pub fn new(
        args: &RenderArgs,
        loaded: LoadedScene,
        camera: Option<usize>,
        aovs: Vec<Aov>,
        library: &ShaderLibrary,
    ) -> Result<Self, AppError> {
        show_work(format_args!("compiling shaders"));
        checked_crop(args, &loaded)?; // before the device, which may be missing
        let may_query = loaded.scene.reflection.may_query();
        let gpu = Arc::new(open_gpu(args.picture.adapter.as_deref(), may_query)?);
        Self::with_gpu(&gpu, args, loaded, camera, aovs, library)
    }

    /// Builds the renderer on a device that is open, whose pipelines it shares. `camera` is the index of a chosen camera.
    ///
    /// # Errors
    /// A scene past the device's limits, a shader error.
    pub fn with_gpu(
        gpu: &Arc<Gpu>,
        args: &RenderArgs,
        loaded: LoadedScene,
        camera: Option<usize>,
        aovs: Vec<Aov>,
        library: &ShaderLibrary,
    ) -> Result<Self, AppError> {
        let denoiser = (args.picture.denoise)
            .then(|| Denoiser::new(&aovs).map(Arc::new))
            .transpose()?;
        let crop = checked_crop(args, &loaded)?;
        // Denoising, statistics and error bounds look at the whole picture.
        let needs_whole = denoiser.is_some()
            || args.stats.is_some()
            || matches!(loaded.scene.image.samples, Samples::UntilError(_));
        let own_shaders = args.picture.shaders.is_some().then(|| hash_of(library));
        let view = ViewOverrides {
            audit: args.stats.is_some(),
            crop: crop.filter(|_| !needs_whole),
            guides: denoiser.is_some(),
            camera: camera.map(|index| loaded.world.cameras[index].name.clone()),
            ..ViewOverrides::default()
        };
        let source = SceneSource {
            path: args.scene.clone(),
            options: args.picture.from.options(),
            shaders: args.picture.shaders.clone(),
            text: None,
        };
        let scene = Session::of_loaded(Arc::clone(gpu), source, view, library.clone(), loaded)
            .map_err(|error| AppError::from_render(error, own_shaders.is_some()))?;
        Ok(Self {
            scene,
            aovs,
            denoiser,
            window: 0,
            crop,
            own_shaders,
            timed: args.stats.is_some(),
            is_checked: false,
            warm_up_ms: 0.0,
            warm_pipelines: 0,
        })
    }

    /// Number of pictures to render: its own, and one for the AOV of each light group.
    pub fn pictures(&self) -> u32 {
        let lights = self.aovs.iter().filter(|aov| matches!(aov, Aov::Light(_)));
        1 + lights.count() as u32
    }

    /// Warning about the posed scene where it is the first and its picture shows nothing.
    pub fn warn_of_empty(&mut self) -> Vec<Diagnostic> {
        if std::mem::replace(&mut self.is_checked, true) {
            return Vec::new();
        }
        let loaded = self.scene.scene();
        let found = empty_view::warning(&loaded.scene, &loaded.world, self.scene.camera());
        found.map(Diagnostic::warning).into_iter().collect()
    }

    /// Starts a picture of the posed scene, with or without linear color; timed if statistics are requested.
    /// `each_sample` is called after each sub-frame.
    ///
    /// # Errors
    /// Same errors as [`Session::begin`].
    pub fn begin(
        &mut self,
        color: bool,
        each_sample: Option<EachSample<'_>>,
    ) -> Result<PendingPicture, RenderError> {
        let aovs = &self.read_aovs();
        if self.timed {
            self.warm_up()?;
        }
        self.scene.begin(PictureRequest {
            color: color || self.denoiser.is_some(),
            aovs,
            timed: self.timed,
            estimates_error: false,
            each_sample,
        })
    }

    /// The finished picture of a frame, posed, denoised and cropped as asked; `each_sample` is called after each sub-frame.
    ///
    /// # Errors
    /// Errors of the scene at the frame, and of rendering.
    pub fn picture(
        &mut self,
        frame: u32,
        each_sample: Option<EachSample<'_>>,
    ) -> Result<Picture, AppError> {
        let is_own = self.own_shaders.is_some();
        let posed = self.scene.pose(frame);
        posed.map_err(|error| AppError::from_session(error, is_own))?;
        let pending = self.begin(false, each_sample);
        let picture = pending.and_then(|pending| pending.take(self.scene.gpu()));
        let mut picture = picture.map_err(|error| AppError::from_render(error, is_own))?;
        if let Some(denoiser) = &self.denoiser {
            denoiser.apply(&mut picture)?;
        }
        Ok(match self.crop {
            Some(crop) => picture.cropped(crop),
            None => picture,
        })
    }

    /// Has frames denoised with as many before and after each, if they are denoised at all.
    pub fn denoise_over(&mut self, window: u32) {
        self.window = self.denoiser.as_ref().map_or(0, |_| window);
    }

    /// Frames that are denoised with a frame: its neighbors on the timeline of the same camera, up to a cut.
    pub fn window_of(&self, frame: u32) -> RangeInclusive<u32> {
        let camera = |frame| self.scene.camera_of(frame);
        let timeline = self.scene.scene().scene.timeline.as_ref();
        let (start, end) = timeline.map_or((frame, frame), |t| (t.start, t.end));
        let first = (frame.saturating_sub(self.window).max(start)..frame).rev();
        let last = frame + 1..=frame.saturating_add(self.window).min(end);
        let is_of_shot = |other: &u32| camera(*other) == camera(frame);
        let first = first.take_while(is_of_shot).last().unwrap_or(frame);
        first..=last.take_while(is_of_shot).last().unwrap_or(frame)
    }

    /// Camera and surfaces of the frame that was begun last.
    pub fn frame_pose(&self) -> FramePose {
        let loaded = self.scene.scene();
        let camera = &loaded.world.cameras[self.scene.camera()].value;
        let unit_m = self.scene.renderer().unit_m();
        let view = View::new(camera, loaded.scene.image.size, unit_m);
        FramePose::new(&loaded.world, view)
    }

    /// Sentence about the number of sub-frames that an error bound took, or `None` where the scene has no bound; and
    /// whether the bound is met.
    pub fn samples_taken(&self, stats: &FrameStats) -> Option<(String, bool)> {
        let Samples::UntilError(bound) = self.scene.scene().scene.image.samples else {
            return None;
        };
        let (found, samples) = (stats.error?, stats.samples);
        let ErrorEstimate {
            error,
            tile,
            specks,
        } = found;
        let is_met = error <= bound.error;
        let left = match specks {
            0 => String::new(),
            1 => ", and one pixel is a speck".to_owned(),
            _ => format!(", and {specks} single pixels are specks"),
        };
        let is_clean = is_met && specks == 0 || self.denoiser.is_some();
        let advice = match is_clean {
            true => "",
            false => "; `--denoise` smooths what is left",
        };
        let bound = bound.error;
        let sentence = if is_met {
            format!("{samples} samples, error {error:.4} (`error = {bound}`){left}{advice}")
        } else {
            let [x, y] = tile;
            format!(
                "warning: {samples} samples leave an error of {error:.4} in the tile at pixel {x}, {y}, above \
                 `error = {bound}`{left}: raise `at_most`, or `error`{advice}"
            )
        };
        Some((sentence, is_met))
    }

    /// Has a software driver compile new pipelines before passes are timed.
    fn warm_up(&mut self) -> Result<(), RenderError> {
        let gpu = Arc::clone(self.scene.gpu());
        if gpu.is_software() && self.warm_pipelines != gpu.compile_stats.pipelines() {
            let started = Instant::now();
            self.scene.warm_up()?;
            self.warm_up_ms += started.elapsed().as_secs_f64() * 1e3;
            self.warm_pipelines = gpu.compile_stats.pipelines();
        }
        Ok(())
    }

    /// AOVs to read back for a picture.
    fn read_aovs(&self) -> Vec<Aov> {
        match self.denoiser {
            Some(_) => Denoiser::aovs(&self.aovs, self.window > 0),
            None => self.aovs.clone(),
        }
    }
}

/// Part of the pictures to write, which must lie in them.
fn checked_crop(args: &RenderArgs, loaded: &LoadedScene) -> Result<Option<Crop>, AppError> {
    let size = loaded.scene.image.size;
    match args.picture.crop {
        Some(crop) if !crop.is_in(size) => {
            let [width, height] = size;
            Err(AppError::Usage(format!(
                "--crop {crop}: it is not inside of the picture, which has {width} x {height} pixels"
            )))
        }
        crop => Ok(crop),
    }
}

/// Hash of the names and texts of all shaders.
fn hash_of(library: &ShaderLibrary) -> u128 {
    let mut hash = Xxh3Default::new();
    for part in library.texts().flat_map(|(name, text)| [name, text]) {
        hash.update(&(part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    hash.digest128()
}
