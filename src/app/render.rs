//! `render`: a scene becomes pictures or a film.

use std::{
    path::Path,
    sync::Arc,
    time::{Instant, SystemTime},
};

use super::{
    cli::{RenderArgs, StatsForm},
    error::AppError,
    output::Output,
    print_json, print_out,
    scene::{LoadedScene, load_scene},
    sequence,
    stats::{Report, ReportContext},
};
use crate::{
    files::sweep,
    gpu::{Gpu, GpuError, GpuOptions, ShaderLibrary},
    render::{
        PendingPicture, Picture, PictureRequest, RenderError, RenderOptions, Renderer, aov::Aov,
        probe::PassCounts,
    },
    scene::{desc::Method, motion::Motion},
};

/// Everything that pictures of one scene are made with.
pub struct RenderSession {
    /// The device, which the encoders of a film share.
    pub gpu: Arc<Gpu>,
    /// The scene, posed for the next picture.
    pub loaded: LoadedScene,
    /// Further pictures of every frame.
    pub aovs: Vec<Aov>,
    /// When the first of its files was opened, or before.
    pub opened: SystemTime,
    /// Whether the shaders come from the user.
    pub own_shaders: bool,
    renderer: Renderer,
    camera: usize,
}

impl RenderSession {
    fn new(
        args: &RenderArgs,
        loaded: LoadedScene,
        camera: usize,
        aovs: Vec<Aov>,
        library: &ShaderLibrary,
        opened: SystemTime,
    ) -> Result<Self, AppError> {
        let gpu = Gpu::new(&GpuOptions {
            adapter_filter: args.adapter.clone(),
        })?;
        let options = RenderOptions {
            reflection: loaded.desc.reflection,
            image: loaded.desc.image,
            general: false,
        };
        let own_shaders = args.shaders.is_some();
        let renderer = Renderer::new(&gpu, library, &loaded.world, &options)
            .map_err(|error| explain(error, own_shaders))?;
        Ok(Self {
            gpu: Arc::new(gpu),
            loaded,
            aovs,
            opened,
            own_shaders,
            renderer,
            camera,
        })
    }

    /// Renders the scene as it is posed.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn picture(&mut self) -> Result<Picture, RenderError> {
        let world = &self.loaded.world;
        self.renderer.update(&self.gpu, world);
        let camera = &world.cameras[self.camera].value;
        self.renderer.picture(&self.gpu, world, camera, &self.aovs)
    }

    /// Starts a picture of the scene as it is posed, with linear color or without.
    ///
    /// # Errors
    /// As [`Renderer::begin`].
    pub fn begin(&mut self, color: bool) -> Result<PendingPicture, RenderError> {
        let world = &self.loaded.world;
        self.renderer.update(&self.gpu, world);
        let camera = &world.cameras[self.camera].value;
        let aovs = &self.aovs;
        self.renderer
            .begin_picture(&self.gpu, world, camera, PictureRequest { color, aovs })
    }

    /// Counts what the passes do, in a frame that is rendered for it.
    fn counts(&mut self) -> Result<Vec<PassCounts>, RenderError> {
        let world = &self.loaded.world;
        let camera = &world.cameras[self.camera].value;
        self.renderer.counts(&self.gpu, world, camera)
    }
}

/// Renders one picture, or the frames of a film.
///
/// # Errors
/// Whatever stops it; no file is left half written.
pub fn render(args: &RenderArgs) -> Result<(), AppError> {
    let (started, opened) = (Instant::now(), SystemTime::now());
    // Cheap checks first: a typo must not cost a minute of rendering.
    let many = sequence::is_wanted(args)?;
    let output = if many {
        None
    } else {
        if args.resume || args.shard.is_some() {
            let text = "--resume and --shard go with --frames";
            return Err(AppError::Usage(text.to_owned()));
        }
        Some(Output::new(&args.output)?)
    };
    let aovs = choose_aovs(&args.aov)?;
    let library = shader_library(args.shaders.as_deref())?;
    let load_started = Instant::now();
    let loaded = load_scene(args.scene.as_deref(), &args.from, &overrides(args))?;
    let load_ms = load_started.elapsed().as_secs_f64() * 1e3;
    let camera = choose_camera(&loaded, args.camera.as_deref())?;
    let Some(output) = output else {
        let frames = sequence::choose(args, loaded.desc.timeline.as_ref())?;
        sequence::check_output(args, &frames)?;
        let studio = RenderSession::new(args, loaded, camera, aovs, &library, opened)?;
        return sequence::render(args, studio, &frames);
    };
    output.check_beside(&aovs)?;
    let mut studio = RenderSession::new(args, loaded, camera, aovs, &library, opened)?;
    sweep(&output.files(&studio.aovs.iter().map(|aov| aov.name()).collect::<Vec<_>>()));
    let motion = Motion::new(&studio.loaded.desc);
    if !motion.is_still() {
        let state = motion.pose(motion.first_frame()).map_err(AppError::Scene)?;
        for line in &state.log {
            eprintln!("{line}");
        }
        studio.loaded.world.apply(&state).map_err(AppError::Scene)?;
    }
    let picture = studio
        .picture()
        .map_err(|error| explain(error, studio.own_shaders))?;
    let around = ReportContext {
        load_ms,
        first_picture_ms: started.elapsed().as_secs_f64() * 1e3,
    };

    for path in output.write(&picture)? {
        eprintln!("wrote {}", path.display());
    }
    let mut report = Report::new(&studio.gpu, picture.stats, around);
    if args.counters {
        report.counts = Some(
            studio
                .counts()
                .map_err(|error| explain(error, studio.own_shaders))?,
        );
    }
    match args.stats {
        Some(StatsForm::Text) => print_out(&report.table()),
        Some(StatsForm::Json) => print_json(&report),
        None => Ok(()),
    }
}

/// What the user sees of a picture that cannot be rendered.
pub fn explain(error: RenderError, own_shaders: bool) -> AppError {
    match error {
        RenderError::Gpu(GpuError::Shader(error)) if own_shaders => {
            AppError::from_user_shader(&error)
        }
        RenderError::Gpu(error) => AppError::Gpu(error),
        RenderError::Scene(diagnostic) => AppError::Scene(vec![*diagnostic]),
    }
}

/// The AOVs of a comma-separated list.
fn choose_aovs(names: &[String]) -> Result<Vec<Aov>, AppError> {
    let find = |name: &String| {
        Aov::from_name(name.trim()).ok_or_else(|| {
            let known: Vec<&str> = Aov::ALL.iter().map(|aov| aov.name()).collect();
            AppError::Usage(format!(
                "--aov {name}: there is no such picture; choose from {}",
                known.join(", ")
            ))
        })
    };
    let mut aovs = Vec::new();
    for aov in names.iter().map(find) {
        let aov = aov?;
        if !aovs.contains(&aov) {
            aovs.push(aov);
        }
    }
    Ok(aovs)
}

/// The flags that are scene values, as overrides: one mechanism, and they win over `--set`.
fn overrides(args: &RenderArgs) -> Vec<String> {
    let size = args.size.map(|[w, h]| format!("image.size=[{w}, {h}]"));
    let samples = args
        .samples
        .map(|samples| format!("image.samples={samples}"));
    let method = args.method.map(|method| {
        let word = match method.into() {
            Method::Ssr => "ssr",
            Method::Rt => "rt",
            Method::Hybrid => "hybrid",
        };
        format!("reflection.method=\"{word}\"")
    });
    [size, samples, method].into_iter().flatten().collect()
}

fn shader_library(folder: Option<&Path>) -> Result<ShaderLibrary, AppError> {
    match folder {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => {
            ShaderLibrary::from_dir(folder).map_err(|error| AppError::from_user_shader(&error))
        }
    }
}

/// Which camera is named; without a name `main`, else the first.
///
/// # Errors
/// [`AppError::Usage`] with the names that exist.
pub fn choose_camera(loaded: &LoadedScene, name: Option<&str>) -> Result<usize, AppError> {
    let cameras = &loaded.world.cameras;
    let named = |name: &str| cameras.iter().position(|camera| camera.name == name);
    let found = match name {
        Some(name) => named(name),
        None => named("main").or((!cameras.is_empty()).then_some(0)),
    };
    found.ok_or_else(|| {
        let names: Vec<&str> = cameras.iter().map(|camera| camera.name.as_str()).collect();
        AppError::Usage(format!(
            "--camera {}: {} has no such camera; it has: {}",
            name.unwrap_or_default(),
            loaded.name,
            names.join(", ")
        ))
    })
}
