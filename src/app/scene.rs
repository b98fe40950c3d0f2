//! From the command line to a loaded scene: the file or the built-in atrium, overrides, assets.

use std::{
    env,
    path::{Path, PathBuf},
};

use super::{
    args::SceneArgs,
    error::{AppError, print_diagnostics},
    model_viewer_scene::{is_model, model_viewer_scene},
    params::DeclaredParameters,
};
use crate::{
    scene::{dependencies::Dependencies, diagnostic::Diagnostic, parse, stages::Scene},
    world::{
        World,
        load::{self, LoadOptions},
    },
};

/// Environment variable with asset folders, separated as in `PATH`.
pub const ASSETS_ENV: &str = "REFLET_ASSETS";

/// The scene that is built into the binary.
pub const ATRIUM: &str = include_str!("../../scenes/atrium.toml");

/// The text of a scene that is to be opened.
#[derive(Debug)]
pub struct SceneText {
    text: String,
    /// What messages call it.
    file: PathBuf,
    /// Of `--set`.
    set: Vec<String>,
    options: LoadOptions,
}

/// A scene as it is on disk; nothing is loaded yet.
#[derive(Debug)]
pub struct OpenedScene {
    /// Its text, for fingerprints.
    pub text: String,
    /// What was laid over it.
    pub overrides: Vec<String>,
    /// As written, after overrides and its script's `setup`.
    pub scene: Scene,
    /// About its text and its script.
    pub warnings: Vec<Diagnostic>,
    /// For loading: what was read and looked for already.
    pub options: LoadOptions,
}

/// A scene as written and as loaded.
#[derive(Debug)]
pub struct LoadedScene {
    /// What messages call it.
    pub name: String,
    /// As written, after overrides and its script's `setup`.
    pub scene: Scene,
    /// As loaded.
    pub world: World,
    /// The scene's text, for fingerprints.
    pub text: String,
    /// What was laid over it.
    pub overrides: Vec<String>,
    /// How many warnings were printed.
    pub num_warnings: usize,
}

impl SceneText {
    /// Reads a scene's text: the file's, one around a model, or the built-in atrium's. A model is
    /// read for that, and kept for the load.
    ///
    /// # Errors
    /// As [`parse::read`], and a stage that cannot be converted.
    pub fn read(path: Option<&Path>, from: &SceneArgs) -> Result<Self, Vec<Diagnostic>> {
        let options = load_options(from, &Dependencies::default());
        let (text, file) = match path {
            Some(path) if is_model(path) => {
                let text = model_viewer_scene(path, &options, &from.set);
                (text.map_err(|error| vec![*error])?, path)
            }
            Some(path) => (parse::read(path)?, path),
            None => (ATRIUM.to_owned(), Path::new("atrium.toml")),
        };
        Ok(Self {
            text,
            file: file.to_owned(),
            set: from.set.clone(),
            options,
        })
    }

    /// A text that is at hand; `file` is what messages call it.
    pub fn new(text: &str, file: &Path, from: &SceneArgs) -> Self {
        Self {
            text: text.to_owned(),
            file: file.to_owned(),
            set: from.set.clone(),
            options: load_options(from, &Dependencies::default()),
        }
    }

    /// The parameters that it declares; `None` where that cannot be told.
    pub fn declared(&self) -> Option<DeclaredParameters> {
        let declared = parse::params(&self.text, &self.file, &self.set);
        declared.map(|list| list.into_iter().map(|p| (p.name, p.value)).collect())
    }

    /// Reads the scene and runs its script's `setup`; `more` is laid over it after `--set`. Scripts
    /// and included files that are looked for are added to `texts`, also when it fails.
    ///
    /// # Errors
    /// All mistakes of the scene's texts.
    pub fn open(
        self,
        more: &[String],
        texts: &Dependencies,
    ) -> Result<OpenedScene, Vec<Diagnostic>> {
        let overrides = [self.set.as_slice(), more].concat();
        let read = Scene::from_text_traced(&self.text, &self.file, &overrides, texts);
        let (scene, warnings) = read?;
        Ok(OpenedScene {
            text: self.text,
            overrides,
            scene,
            warnings,
            options: self.options,
        })
    }
}

impl OpenedScene {
    /// Loads what the scene refers to, prints what its `setup` printed and all warnings to standard
    /// error; `name` is what messages call it.
    ///
    /// # Errors
    /// [`AppError::Scene`] with every error that was found.
    pub fn load(mut self, name: String) -> Result<LoadedScene, AppError> {
        for line in self.scene.script.iter().flat_map(|s| &s.setup_log) {
            eprintln!("{line}");
        }
        let world = load::load(&self.scene, &self.options);
        let world = world.map_err(|errors| {
            AppError::Scene(self.warnings.iter().cloned().chain(errors).collect())
        })?;
        self.warnings.extend(world.warnings.iter().cloned());
        print_diagnostics(&self.warnings);
        Ok(LoadedScene {
            name,
            scene: self.scene,
            world,
            text: self.text,
            overrides: self.overrides,
            num_warnings: self.warnings.len(),
        })
    }
}

/// Reads and loads a scene, and prints its warnings to standard error; `more` is laid over it after
/// `--set`.
///
/// # Errors
/// [`AppError::Scene`] with every error that was found.
pub fn load_scene(
    path: Option<&Path>,
    from: &SceneArgs,
    more: &[String],
) -> Result<LoadedScene, AppError> {
    let text = SceneText::read(path, from).map_err(AppError::Scene)?;
    let opened = text.open(more, &Dependencies::default());
    let name = path.map(|path| path.display().to_string());
    let name = name.unwrap_or_else(|| "the built-in atrium".to_owned());
    opened.map_err(AppError::Scene)?.load(name)
}

/// How files are loaded; what is looked for is noted in `dependencies`.
pub fn load_options(from: &SceneArgs, dependencies: &Dependencies) -> LoadOptions {
    LoadOptions {
        assets: asset_folders(&from.assets),
        dependencies: dependencies.clone(),
        ..LoadOptions::default()
    }
}

/// The folders of `--assets`, then those of the environment.
pub fn asset_folders(given: &[PathBuf]) -> Vec<PathBuf> {
    let listed = env::var_os(ASSETS_ENV).unwrap_or_default();
    let listed = env::split_paths(&listed).filter(|folder| !folder.as_os_str().is_empty());
    given.iter().cloned().chain(listed).collect()
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
