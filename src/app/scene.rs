//! From the command line to a loaded scene: the file or the built-in atrium, overrides, assets.

use std::{
    env,
    path::{Path, PathBuf},
};

use super::{
    args::SceneArgs,
    error::{AppError, print_diagnostics},
    model_viewer_scene::{is_model, model_viewer_scene},
};
use crate::{
    scene::{dependencies::Dependencies, desc::SceneDesc, diagnostic::Diagnostic, parse},
    world::{
        World,
        load::{self, LoadOptions},
    },
};

/// Environment variable with asset folders, separated as in `PATH`.
pub const ASSETS_ENV: &str = "REFLET_ASSETS";

/// The scene that is built into the binary.
pub const ATRIUM: &str = include_str!("../../scenes/atrium.toml");

/// A scene as written and as loaded.
#[derive(Debug)]
pub struct LoadedScene {
    /// What messages call it.
    pub name: String,
    /// As written, after overrides.
    pub desc: SceneDesc,
    /// As loaded.
    pub world: World,
    /// The scene's text, for fingerprints.
    pub text: String,
    /// What was laid over it.
    pub overrides: Vec<String>,
    /// How many warnings were printed.
    pub num_warnings: usize,
}

/// Reads and loads a scene, and prints its warnings to standard error.
///
/// # Errors
/// [`AppError::Scene`] with every error that was found.
pub fn load_scene(
    path: Option<&Path>,
    from: &SceneArgs,
    overrides: &[String],
) -> Result<LoadedScene, AppError> {
    let overrides = [from.set.as_slice(), overrides].concat();
    let options = load_options(from, &Dependencies::default());
    let (text, file) = source(path, &options, &overrides).map_err(AppError::Scene)?;
    let read = parse::parse(&text, &file, &overrides).map_err(AppError::Scene)?;
    let name = path.map_or_else(
        || "the built-in atrium".to_owned(),
        |path| path.display().to_string(),
    );
    load_desc(name, text, overrides, read, &options)
}

/// Loads a scene whose text is at hand; `file` is what messages call it.
///
/// # Errors
/// As [`load_scene`].
pub fn load_text(text: &str, file: &Path, from: &SceneArgs) -> Result<LoadedScene, AppError> {
    let read = parse::parse(text, file, &from.set).map_err(AppError::Scene)?;
    let name = file.display().to_string();
    let options = load_options(from, &Dependencies::default());
    load_desc(name, text.to_owned(), from.set.clone(), read, &options)
}

fn load_desc(
    name: String,
    text: String,
    overrides: Vec<String>,
    (desc, mut warnings): (SceneDesc, Vec<Diagnostic>),
    options: &LoadOptions,
) -> Result<LoadedScene, AppError> {
    for line in desc.script.iter().flat_map(|s| s.setup_log()) {
        eprintln!("{line}");
    }
    let world = load::load(&desc, options)
        .map_err(|errors| AppError::Scene(warnings.iter().cloned().chain(errors).collect()))?;
    warnings.extend(world.warnings.iter().cloned());
    print_diagnostics(&warnings);
    Ok(LoadedScene {
        name,
        desc,
        world,
        text,
        overrides,
        num_warnings: warnings.len(),
    })
}

/// The scene's text, and what messages call it: the file's, one around a model, or the built-in
/// atrium's. A model is read for that, and `options` keep it for the load.
///
/// # Errors
/// As [`parse::read`], and a stage that cannot be converted.
pub fn source(
    path: Option<&Path>,
    options: &LoadOptions,
    overrides: &[String],
) -> Result<(String, PathBuf), Vec<Diagnostic>> {
    match path {
        Some(path) if is_model(path) => {
            let text = model_viewer_scene(path, options, overrides);
            Ok((text.map_err(|error| vec![*error])?, path.to_owned()))
        }
        Some(path) => Ok((parse::read(path)?, path.to_owned())),
        None => Ok((ATRIUM.to_owned(), PathBuf::from("atrium.toml"))),
    }
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
