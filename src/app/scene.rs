//! From the command line to a loaded scene: the file or the built-in atrium, overrides, assets.

use std::{
    borrow::Cow,
    env, fs,
    path::{Path, PathBuf},
};

use super::{
    around::{is_model, scene_around},
    cli::SceneArgs,
    error::{AppError, print_diagnostics},
};
use crate::{
    scene::{
        desc::SceneDesc,
        diagnostic::Diagnostic,
        parse::{self, Parsed},
    },
    world::{
        World,
        gltf::Trail,
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
    let own = own_text(path, from, &overrides).map_err(AppError::Scene)?;
    let read = parse_text(path, own.as_deref(), &overrides).map_err(AppError::Scene)?;
    let name = path.map_or_else(
        || "the built-in atrium".to_owned(),
        |path| path.display().to_string(),
    );
    let text = match (own, path) {
        (Some(own), _) => own.into_owned(),
        // Read a second time, for its fingerprint; what cannot be read was an error before.
        (None, path) => {
            let path = path.unwrap_or(Path::new(""));
            fs::read_to_string(path)
                .map_err(|error| AppError::Usage(format!("{}: {error}", path.display())))?
        }
    };
    load_desc(name, text, overrides, read, from)
}

/// Loads a scene whose text is at hand; `file` is what messages call it.
///
/// # Errors
/// As [`load_scene`].
pub fn load_text(text: &str, file: &Path, from: &SceneArgs) -> Result<LoadedScene, AppError> {
    let read = parse::parse(text, file, &from.set).map_err(AppError::Scene)?;
    let name = file.display().to_string();
    load_desc(name, text.to_owned(), from.set.clone(), read, from)
}

fn load_desc(
    name: String,
    text: String,
    overrides: Vec<String>,
    (desc, mut warnings): (SceneDesc, Vec<Diagnostic>),
    from: &SceneArgs,
) -> Result<LoadedScene, AppError> {
    for line in desc.script.iter().flat_map(|s| s.setup_log()) {
        eprintln!("{line}");
    }
    let world = load::load(&desc, &load_options(from, &Trail::default()))
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

/// Reads scene text: the file, a scene around a model, or the built-in atrium; with overrides.
///
/// # Errors
/// All mistakes of the text.
pub fn read_text(path: Option<&Path>, from: &SceneArgs, overrides: &[String]) -> Parsed {
    let overrides = [from.set.as_slice(), overrides].concat();
    let own = own_text(path, from, &overrides)?;
    parse_text(path, own.as_deref(), &overrides)
}

/// The text of a scene that is no file of its own.
fn own_text(
    path: Option<&Path>,
    from: &SceneArgs,
    overrides: &[String],
) -> Result<Option<Cow<'static, str>>, Vec<Diagnostic>> {
    match path {
        None => Ok(Some(Cow::Borrowed(ATRIUM))),
        Some(path) if is_model(path) => {
            let text = scene_around(path, &load_options(from, &Trail::default()), overrides);
            text.map(|text| Some(Cow::Owned(text)))
                .map_err(|error| vec![*error])
        }
        Some(_) => Ok(None),
    }
}

fn parse_text(path: Option<&Path>, own: Option<&str>, overrides: &[String]) -> Parsed {
    let path = path.unwrap_or(Path::new("atrium.toml"));
    match own {
        Some(text) => parse::parse(text, path, overrides),
        None => parse::load(path, overrides),
    }
}

/// How files are loaded; what is looked for is noted in `trail`.
pub fn load_options(from: &SceneArgs, trail: &Trail) -> LoadOptions {
    LoadOptions {
        assets: asset_folders(&from.assets),
        trail: trail.clone(),
        ..LoadOptions::default()
    }
}

/// The folders of `--assets`, then those of the environment.
pub fn asset_folders(given: &[PathBuf]) -> Vec<PathBuf> {
    let listed = env::var_os(ASSETS_ENV).unwrap_or_default();
    let listed = env::split_paths(&listed).filter(|folder| !folder.as_os_str().is_empty());
    given.iter().cloned().chain(listed).collect()
}
