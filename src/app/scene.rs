//! Scene opening from command-line arguments, with the messages on the way.

use std::path::Path;

use reflet_base::standard_error::{end_work, show_work};

use super::{args::SceneArgs, error::AppError};
use crate::{
    files::Goal,
    output::writable::{check_replaceable, inputs},
    runtime::scene_text::{LoadedScene, OpenedScene, SceneText},
    scene::{dependencies::Dependencies, diagnostic::print_diagnostics, suggest},
};

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
    load_followed(path, from, more, &Dependencies::default())
}

/// Reads and loads a scene as [`load_scene`] does, and adds all files that it looked for to `files`, also on errors.
///
/// # Errors
/// Same errors as [`load_scene`].
pub fn load_followed(
    path: Option<&Path>,
    from: &SceneArgs,
    more: &[String],
    files: &Dependencies,
) -> Result<LoadedScene, AppError> {
    let text = SceneText::read(path, &from.options()).map_err(AppError::Scene)?;
    let name = text.name();
    let opened = text.open(more, files).map_err(AppError::Scene)?;
    let searched = opened.options.dependencies.clone();
    let loaded = load(opened, name);
    files.extend(&searched);
    loaded
}

/// Refuses a scene that reads one of the files that will be written to a folder.
///
/// # Errors
/// [`AppError::Usage`] that names the file.
pub fn check_reports(
    folder: &Path,
    names: &[&str],
    scene: Option<&Path>,
    loaded: &LoadedScene,
) -> Result<(), AppError> {
    let inputs = inputs(scene, loaded);
    let mut paths = names.iter().map(|name| Goal::in_folder(folder.join(name)));
    Ok(paths.try_for_each(|path| check_replaceable(&path, &inputs))?)
}

/// Loads the assets of a scene, and prints the output of `setup` and all warnings to standard error;
/// `name` is used in messages.
///
/// # Errors
/// [`AppError::Scene`] with all errors.
pub fn load(opened: OpenedScene, name: String) -> Result<LoadedScene, AppError> {
    for line in opened.scene.scripts().flat_map(|s| &s.setup_log) {
        reflet_base::error_line!("{line}");
    }
    show_work(format_args!("reading {name}"));
    let loaded = opened.load(name);
    end_work();
    let loaded = loaded.map_err(AppError::Scene)?;
    print_diagnostics(&loaded.warnings);
    Ok(loaded)
}

/// Index of the named camera; without a name the camera of the first frame.
///
/// # Errors
/// [`AppError::Usage`] with the existing names.
pub fn choose_camera(loaded: &LoadedScene, name: Option<&str>) -> Result<usize, AppError> {
    loaded.camera(name).ok_or_else(|| {
        let (name, names) = (name.unwrap_or_default(), loaded.camera_names());
        let meant = suggest::nearest(name, names.iter().copied());
        let meant = meant.map(|meant| format!("; did you mean `--camera {meant}`?"));
        AppError::Usage(format!(
            "--camera {name}: {} has no such camera; it has: {}{}",
            loaded.name,
            names.join(", "),
            meant.unwrap_or_default()
        ))
    })
}
