//! Files of a folder that a command takes one by one: models, panoramas and scenes.

use std::{
    fmt::Display,
    path::{Path, PathBuf},
};

use walkdir::{DirEntry, WalkDir};

use super::error::AppError;
use crate::{
    files::{open_regular, read_at_most},
    scene::{
        desc::is_bare,
        diagnostic::Source,
        parse::{
            MOST_BYTES,
            tables::{self, is_project},
        },
    },
};

/// Models, panoramas and scenes of a folder and the folders below, in order of their paths, without hidden files and
/// folders behind links; `refuse` is called with each path that cannot be read.
///
/// # Errors
/// [`AppError::Usage`] for a folder that cannot be read, or has no such file.
pub fn files_of(
    folder: &Path,
    refuse: &mut dyn FnMut(&Path, &dyn Display),
) -> Result<Vec<PathBuf>, AppError> {
    let is_visible = |entry: &DirEntry| {
        entry.depth() == 0 || !entry.file_name().to_string_lossy().starts_with('.')
    };
    let walk = WalkDir::new(folder).sort_by_file_name();
    let (mut files, mut has_refused) = (Vec::new(), false);
    for entry in walk.into_iter().filter_entry(is_visible) {
        let entry = match entry {
            Ok(entry) => entry,
            Err(error) if error.depth() == 0 => {
                let why = error
                    .io_error()
                    .map_or("it cannot be read".to_owned(), ToString::to_string);
                return Err(AppError::Usage(format!("{}: {why}", folder.display())));
            }
            Err(error) => {
                refuse(error.path().unwrap_or(folder), &error);
                has_refused = true;
                continue;
            }
        };
        let file = entry.path();
        if entry.path_is_symlink() && !file.exists() && (is_bare(file) || is_toml(file)) {
            refuse(file, &"it is a link to a file that is not there");
            has_refused = true;
        }
        if file.is_file() && (is_bare(file) || is_scene(file)) {
            files.push(file.to_owned());
        }
    }
    if files.is_empty() && !has_refused {
        let folder = folder.display();
        let text = format!("{folder} has no models, panoramas (.hdr, .exr) or scenes");
        return Err(AppError::Usage(text));
    }
    Ok(files)
}

/// Whether a file is a scene's text, or none at all: empty, or not UTF-8.
fn is_scene(file: &Path) -> bool {
    if !is_toml(file) || is_project(file) {
        return false;
    }
    let bytes = open_regular(file, false).and_then(|file| read_at_most(&file, MOST_BYTES));
    let text = bytes.map_or(String::new(), |b| String::from_utf8(b).unwrap_or_default());
    text.trim().is_empty() || tables::is_scene(&Source::new(file, text))
}

fn is_toml(file: &Path) -> bool {
    file.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("toml"))
}
