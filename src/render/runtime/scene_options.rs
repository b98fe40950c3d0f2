//! Options for opening a scene, and the folders that they let it read.

use std::{env, path::PathBuf};

use reflet_base::files::metadata;
use reflet_scene::{
    diagnostic::Diagnostic,
    parse::ReadOptions,
    project::{Project, ProjectChoice},
    reach::{Border, UnsavedTexts},
};
use reflet_world::load::LoadOptions;

/// Environment variable with asset folders, separated as in `PATH`.
pub const ASSETS_ENV: &str = "REFLET_ASSETS";

/// Changes to a scene, and folders to search for its files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SceneOptions {
    /// Values to change, written as for `--set`, such as `image.size=[320, 180]`.
    pub set: Vec<String>,
    /// Variants of the scene to apply, in this order, before `set`; empty names are none, and keep the project's away.
    pub variant: Vec<String>,
    /// Folders to search for models and textures after the scene's own, before folders of [`ASSETS_ENV`].
    pub assets: Vec<PathBuf>,
    /// Whether to load glTF files without references to nodes and meshes that they lack: see [`LoadOptions::lenient`].
    pub lenient: bool,
    /// Whether wrong parts of models that could be left out are errors: see [`LoadOptions::strict`], and every warning
    /// of [`FORGIVEN`](reflet_world::gltf::FORGIVEN).
    pub strict: bool,
    /// Project of the scene.
    pub project: ProjectChoice,
    /// Scene texts and scripts that are open in an editor, for the files of which they stand.
    pub unsaved: UnsavedTexts,
}

/// Options for reading scene text.
pub(super) fn read_options(from: &SceneOptions, project: Option<&Project>) -> ReadOptions {
    let named = from.variant.iter().filter(|name| !name.is_empty());
    ReadOptions {
        overrides: from.set.clone(),
        variants: named.cloned().collect(),
        only_chosen: false,
        border: Border {
            unsaved: from.unsaved.clone(),
            ..border(&from.assets, project)
        },
    }
}

/// Folders that a scene may read besides its own: from the command line, then its project, then [`ASSETS_ENV`].
pub fn border(given: &[PathBuf], project: Option<&Project>) -> Border {
    let mut border = Border {
        assets: given.to_vec(),
        ..Border::default()
    };
    project
        .iter()
        .for_each(|project| project.extend(&mut border));
    border.assets.extend(asset_folders(&[]));
    border
}

/// The same options for a scene of no project.
pub(super) fn without_project(from: &SceneOptions) -> SceneOptions {
    SceneOptions {
        project: ProjectChoice::None,
        ..from.clone()
    }
}

/// Options for loading assets.
pub fn load_options(from: &SceneOptions, project: Option<&Project>) -> LoadOptions {
    let border = border(&from.assets, project);
    LoadOptions {
        assets: border.assets,
        project: border.project,
        lenient: from.lenient,
        strict: from.strict,
        ..LoadOptions::default()
    }
}

/// Warnings about given asset folders that do not exist; folders of [`ASSETS_ENV`] are not checked, as they may be
/// meant for other scenes.
pub(super) fn missing_folders(given: &[PathBuf]) -> Vec<Diagnostic> {
    let missing = given
        .iter()
        .filter(|folder| !metadata(folder).is_ok_and(|it| it.is_dir()));
    let warning = |folder: &PathBuf| {
        let message = "there is no such folder, so nothing is found in it";
        let help = "check the path of `--assets`";
        Diagnostic::in_file("no-folder", folder, message).help(help)
    };
    missing.map(warning).map(Diagnostic::warning).collect()
}

/// The given asset folders, then folders of [`ASSETS_ENV`].
pub fn asset_folders(given: &[PathBuf]) -> Vec<PathBuf> {
    let listed = env::var_os(ASSETS_ENV);
    let listed = listed.iter().flat_map(env::split_paths);
    let listed = listed.filter(|folder| !folder.as_os_str().is_empty());
    given.iter().cloned().chain(listed).collect()
}
