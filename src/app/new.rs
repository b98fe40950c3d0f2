//! `new`: a project with a scene that renders, materials and a studio of lights.

use std::{
    fs,
    path::{Path, PathBuf},
};

use clap::Args;

use super::{error::AppError, pack::unfinished::Unfinished, shutdown};
use crate::{
    files::{Goal, folder_of, sweep},
    scene::{project::FILE, toml_text::toml_text},
};
use reflet_base::shell::shell_word;

/// Arguments of `new`.
#[derive(Clone, Debug, Args)]
pub struct NewArgs {
    /// Folder to create, which must not exist yet; the project gets its name
    #[arg(value_name = "NAME")]
    pub folder: PathBuf,
}

/// Scene that is rendered first.
const SCENE: &str = "scenes/main.toml";

/// Files of a new project but for its own, each with its text.
const FILES: [(&str, &str); 4] = [
    (SCENE, include_str!("new/scenes/main.toml")),
    ("lib/materials.toml", include_str!("new/lib/materials.toml")),
    ("lib/studio.toml", include_str!("new/lib/studio.toml")),
    (".gitignore", "/renders/\n"),
];

/// Writes a project into a new folder.
///
/// # Errors
/// [`AppError::Usage`] if the folder exists or has no name; a folder that cannot be written, of which nothing is left.
pub fn new(args: &NewArgs) -> Result<(), AppError> {
    let folder = &args.folder;
    let shown = folder.display();
    let Some(name) = folder.file_name().and_then(|name| name.to_str()) else {
        return Err(AppError::Usage(format!("{shown}: name a new folder")));
    };
    if name.contains(char::is_control) {
        let text = format!("{name:?}: name a folder without control characters");
        return Err(AppError::Usage(text));
    }
    shutdown::listen();
    sweep(&[Goal::typed(folder.to_path_buf())]);
    if fs::symlink_metadata(folder).is_ok() {
        let text = format!("{shown}: it exists; name a new folder");
        return Err(AppError::Usage(text));
    }
    if !Path::new(".").join(folder_of(folder)).is_dir() {
        let above = folder_of(folder).display();
        return Err(AppError::Usage(format!(
            "{shown}: there is no folder {above}"
        )));
    }
    let own = include_str!("new/reflet.toml").replace("NAME", &toml_text(name));
    let failed = |error| AppError::unwritten(folder, &error);
    let made = Unfinished::create(folder).map_err(failed)?;
    for (name, text) in FILES.into_iter().chain([(FILE, own.as_str())]) {
        let path = made.path().join(name);
        fs::create_dir_all(folder_of(&path)).map_err(failed)?;
        fs::write(&path, text).map_err(failed)?;
    }
    made.persist().map_err(failed)?;
    // A name that begins with a hyphen would be an option.
    let is_option = name.starts_with('-') && folder.components().count() == 1;
    let before = if is_option { "." } else { "" };
    let scene = Path::new(before).join(folder).join(SCENE);
    let scene = scene.display().to_string();
    let scene = shell_word(&scene);
    reflet_base::error_line!("wrote {shown}: {FILE}, {SCENE}, lib/materials.toml, lib/studio.toml");
    reflet_base::error_line!(
        "`reflet render {scene} --size draft` renders it, `reflet preview {scene}` shows it"
    );
    Ok(())
}
