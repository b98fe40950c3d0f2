//! Opens a live scene.

use std::{path::Path, sync::Arc, time::SystemTime};

use super::{
    Live, Problems, SceneSource, ViewOverrides, coarse,
    parameter_trial::TrialState,
    reload::{options_of, read_library},
    reload_job::{self, Read, pose_of},
};
use crate::{
    app::{error::AppError, params::ParameterOverrides, write_back::History},
    gpu::Gpu,
    render::Renderer,
    scene::{dependencies::Dependencies, desc::Method, diagnostic::Diagnostic},
    session::scene_text::{SceneOptions, SceneText},
    world::load,
};

/// Scene text shown while no valid scene exists.
const EMPTY_SCENE: &str = "version = 1\n[camera.main]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n";

/// Features that are built before the first picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InitialBuild {
    /// All features that the scene needs.
    Whole,
    /// Surfaces and shadow maps, without reflections and glass; [`Live::complete`] builds the rest.
    Coarse,
}

impl Live {
    /// Reads and builds everything for the first time, at the first frame.
    ///
    /// # Errors
    /// Same errors as the command `render`: there is no last good scene yet.
    pub fn open(
        gpu: Arc<Gpu>,
        source: SceneSource,
        overrides: ViewOverrides,
        initial: InitialBuild,
    ) -> Result<Self, AppError> {
        let read_since = SystemTime::now();
        let texts = Dependencies::default();
        let read = reload_job::read(&source, &ParameterOverrides::default(), &texts, 0);
        let read = read.map_err(AppError::Scene)?;
        Self::build(gpu, source, (overrides, initial), texts, read, read_since)
    }

    /// Shows an empty scene in place of one with errors, until a reload succeeds.
    ///
    /// # Errors
    /// Same errors as [`Live::open`], except scene errors.
    pub fn open_empty(
        gpu: Arc<Gpu>,
        source: SceneSource,
        overrides: ViewOverrides,
        mistakes: Vec<Diagnostic>,
    ) -> Result<Self, AppError> {
        let empty = empty_scene(&source).map_err(AppError::Scene)?;
        let (texts, now) = (Dependencies::default(), SystemTime::now());
        let overrides = (overrides, InitialBuild::Whole);
        let mut live = Self::build(gpu, source, overrides, texts, empty, now)?;
        (live.warnings, live.problems.scene) = (Vec::new(), mistakes);
        Ok(live)
    }

    /// Loads a scene that was read and builds its renderer.
    fn build(
        gpu: Arc<Gpu>,
        source: SceneSource,
        (overrides, initial): (ViewOverrides, InitialBuild),
        texts: Dependencies,
        read: Read,
        read_since: SystemTime,
    ) -> Result<Self, AppError> {
        let library = read_library(&source).map_err(|e| AppError::from_user_shader(&e))?;
        let state = pose_of(&read.scene, read.frame).map_err(AppError::Scene)?;
        let loaded = load::load_with_cache(&read.scene, &read.options);
        let (mut world, asset_cache) = loaded.map_err(AppError::Scene)?;
        if let Some(state) = &state {
            world.apply(state).map_err(AppError::Scene)?;
        }
        let mut warnings = read.warnings;
        warnings.extend(world.warnings.iter().cloned());
        let options = options_of(&read.scene, overrides);
        let coarse = (initial == InitialBuild::Coarse).then(|| coarse::world(&world));
        let renderer = match &coarse {
            Some(coarse) => Renderer::new(&gpu, &library, coarse, &coarse::options(options)),
            None => Renderer::new(&gpu, &library, &world, &options),
        };
        let renderer = renderer.map_err(|error| AppError::from_render(error, true))?;
        let auto_method = match coarse {
            Some(_) => Method::Hybrid, // not decided yet
            None => renderer.method(),
        };
        Ok(Self {
            gpu,
            source,
            library,
            log: state.map_or_else(Vec::new, |state| state.log),
            scene: read.scene,
            world,
            asset_cache,
            auto_method,
            renderer,
            coarse,
            overrides,
            dependencies: read.options.dependencies,
            texts,
            pending_texts: Dependencies::default(),
            read_since,
            declared: read.declared,
            parameters: read.parameters,
            trial: TrialState::default(),
            edits: Vec::new(),
            history: History::default(),
            undragged: None,
            frame: read.frame,
            posed: read.frame,
            pending: None,
            warnings,
            problems: Problems::default(),
        })
    }
}

/// The scene of [`EMPTY_SCENE`].
fn empty_scene(source: &SceneSource) -> Result<Read, Vec<Diagnostic>> {
    let from = SceneOptions {
        assets: source.args.assets.clone(),
        ..SceneOptions::default()
    };
    let text = SceneText::new(EMPTY_SCENE, Path::new("nothing"), &from);
    let opened = text.open(&[], &Dependencies::default())?;
    Ok(Read::new(opened, <_>::default(), <_>::default(), 0))
}
