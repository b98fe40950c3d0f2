//! Scene opening from command-line arguments: file or built-in atrium, overrides, asset folders.

use std::{
    borrow::Cow,
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
    scene::{
        dependencies::Dependencies,
        diagnostic::Diagnostic,
        parse::{self, ReadOptions, VARIANT},
        stages::Scene,
    },
    world::{
        World,
        load::{self, LoadOptions, foreign_formats},
    },
};

/// Environment variable with asset folders, separated as in `PATH`.
pub const ASSETS_ENV: &str = "REFLET_ASSETS";

/// Built-in scene.
pub const ATRIUM: &str = include_str!("../../scenes/atrium.toml");

/// Text of a scene to open.
#[derive(Debug)]
pub struct SceneText {
    text: String,
    /// Name in messages.
    file: PathBuf,
    read: ReadOptions,
    options: LoadOptions,
}

/// A scene read from disk, without its assets.
#[derive(Debug)]
pub struct OpenedScene {
    /// Scene text, for fingerprints.
    pub text: String,
    /// Variants and overrides applied to it.
    pub overrides: Vec<String>,
    /// Description after overrides and the script's `setup`.
    pub scene: Scene,
    /// Warnings about its text and its script.
    pub warnings: Vec<Diagnostic>,
    /// Options for loading, with the dependencies so far.
    pub options: LoadOptions,
}

/// A loaded scene with its description.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// Name in messages.
    pub name: String,
    /// Description after overrides and the script's `setup`.
    pub scene: Scene,
    /// Loaded scene.
    pub world: World,
    /// Scene text, for fingerprints.
    pub text: String,
    /// Overrides applied to it.
    pub overrides: Vec<String>,
    /// Warnings about its text, its script and its files.
    pub warnings: Vec<Diagnostic>,
}

impl SceneText {
    /// Reads the scene text: of the file, of a model viewer scene, or of the built-in atrium. A
    /// model is read for that and cached for the load.
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
            Some(path) => match foreign_formats::model(path) {
                Some((message, help)) => {
                    let error = Diagnostic::in_file("file-format", path, message);
                    return Err(vec![error.help(help)]);
                }
                None => (parse::read(path)?, path),
            },
            None => (ATRIUM.to_owned(), Path::new("atrium.toml")),
        };
        Ok(Self {
            text,
            file: file.to_owned(),
            read: read_options(from),
            options,
        })
    }

    /// From a text in memory; `file` is its name in messages.
    pub fn new(text: &str, file: &Path, from: &SceneArgs) -> Self {
        Self {
            text: text.to_owned(),
            file: file.to_owned(),
            read: read_options(from),
            options: load_options(from, &Dependencies::default()),
        }
    }

    /// Declared parameters; `None` if the text cannot be parsed.
    pub fn declared(&self) -> Option<DeclaredParameters> {
        let declared = parse::params(&self.text, &self.file, &self.read);
        declared.map(|list| list.into_iter().map(|p| (p.name, p.value)).collect())
    }

    /// Reads the scene and runs its script's `setup`; `more` are overrides after `--set`. Adds
    /// scripts and included files to `texts`, also on errors.
    ///
    /// # Errors
    /// All errors in the scene's texts.
    pub fn open(
        self,
        more: &[String],
        texts: &Dependencies,
    ) -> Result<OpenedScene, Vec<Diagnostic>> {
        let mut options = self.read;
        options.overrides.extend_from_slice(more);
        let read = Scene::from_text_traced(&self.text, &self.file, &options, texts);
        let (scene, warnings) = read?;
        let variants = options
            .variants
            .iter()
            .map(|name| format!("{VARIANT} {name}"));
        Ok(OpenedScene {
            text: self.text,
            overrides: variants.chain(options.overrides).collect(),
            scene,
            warnings,
            options: self.options,
        })
    }
}

impl OpenedScene {
    /// Loads the assets of the scene, and prints the output of `setup` to standard error; `name` is
    /// used in messages.
    ///
    /// # Errors
    /// All errors, after the warnings so far.
    pub fn load(mut self, name: String) -> Result<LoadedScene, Vec<Diagnostic>> {
        for line in self.scene.script.iter().flat_map(|s| &s.setup_log) {
            eprintln!("{line}");
        }
        let world = load::load(&self.scene, &self.options);
        let world =
            world.map_err(|errors| [self.warnings.as_slice(), errors.as_slice()].concat())?;
        self.warnings.extend(world.warnings.iter().cloned());
        Ok(LoadedScene {
            name,
            scene: self.scene,
            world,
            text: self.text,
            overrides: self.overrides,
            warnings: self.warnings,
        })
    }
}

impl LoadedScene {
    /// The world at the first frame, which decides what is `auto` in renders; as loaded where that frame has
    /// errors, which are reported when it is rendered.
    pub fn first_frame(&self) -> Cow<'_, World> {
        if let Ok(Some(state)) = self.scene.pose(self.scene.first_frame()) {
            let mut world = self.world.clone();
            if world.apply(&state).is_ok() {
                return Cow::Owned(world);
            }
        }
        Cow::Borrowed(&self.world)
    }
}

/// Reads and loads a scene, and prints its warnings to standard error; `more` are overrides after
/// `--set`.
///
/// # Errors
/// [`AppError::Scene`] with all errors.
pub fn load_scene(
    path: Option<&Path>,
    from: &SceneArgs,
    more: &[String],
) -> Result<LoadedScene, AppError> {
    let text = SceneText::read(path, from).map_err(AppError::Scene)?;
    let opened = text.open(more, &Dependencies::default());
    let name = path.map(|path| path.display().to_string());
    let name = name.unwrap_or_else(|| "the built-in atrium".to_owned());
    let loaded = opened.and_then(|opened| opened.load(name));
    let loaded = loaded.map_err(AppError::Scene)?;
    print_diagnostics(&loaded.warnings);
    Ok(loaded)
}

/// What scene text is read with.
fn read_options(from: &SceneArgs) -> ReadOptions {
    ReadOptions {
        overrides: from.set.clone(),
        variants: from.variant.clone(),
        assets: asset_folders(&from.assets),
    }
}

/// Load options; searched files are recorded in `dependencies`.
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

/// Index of the named camera; without a name `main`, else the first.
///
/// # Errors
/// [`AppError::Usage`] with the existing names.
pub fn choose_camera(loaded: &LoadedScene, name: Option<&str>) -> Result<usize, AppError> {
    let cameras = &loaded.world.cameras;
    let found = match name {
        Some(name) => cameras.iter().position(|camera| camera.name == name),
        None => (!cameras.is_empty()).then(|| loaded.world.main_camera()),
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
