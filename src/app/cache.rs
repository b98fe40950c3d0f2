//! `cache`: prints or removes what is kept between runs.

use std::{
    env,
    fmt::Write as _,
    fs,
    io::{self, ErrorKind},
    path::{Path, PathBuf},
};

use clap::Args;

use super::{error::AppError, print_out};
use crate::{
    files::is_hidden_name,
    gpu::{
        driver::{MESA_FOLDER, MESA_FOLDER_ENV, MOST_OF_MESA, PIPELINES},
        kept_pipelines::{EXTENSION, MOST_BYTES_OF_ALL},
    },
    output::stats::mebibytes,
    world::usd::CACHE_FOLDER,
};
use reflet_base::cache::{folder, private_folder};

/// Arguments of `cache`.
#[derive(Clone, Copy, Debug, Args)]
pub struct CacheArgs {
    /// Remove everything that is kept
    #[arg(long)]
    pub clear: bool,
}

/// One kind of cached files.
struct Part {
    name: &'static str,
    folder: PathBuf,
    /// Whether Reflet or the driver gave a file or folder this name.
    is_ours: fn(&str) -> bool,
    limit: String,
}

impl Part {
    fn all() -> Vec<Self> {
        let stages = Self {
            name: "stages",
            folder: folder().join(CACHE_FOLDER),
            is_ours: |name| {
                let mut start = name.chars().take_while(char::is_ascii_hexdigit);
                start.nth(31).is_some() || is_hidden_name(name)
            },
            limit: "converted from USD, without limit".to_owned(),
        };
        let most = mebibytes(MOST_BYTES_OF_ALL + MOST_OF_MESA.1);
        let pipelines = private_folder(PIPELINES).map(|folder| Self {
            name: PIPELINES,
            folder,
            is_ours: |name| {
                let extension = Path::new(name).extension();
                extension.is_some_and(|e| e == EXTENSION)
                    || name.starts_with(MESA_FOLDER)
                    || is_hidden_name(name)
            },
            limit: format!("at most {most}"),
        });
        [Some(stages), pipelines].into_iter().flatten().collect()
    }

    /// Files and folders that are kept.
    fn kept(&self) -> Vec<PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let ours = entries.filter(|entry| entry.file_name().to_str().is_some_and(self.is_ours));
        ours.map(|entry| entry.path()).collect()
    }
}

/// Number of files at a path, and their bytes; links are not followed.
fn size(path: &Path) -> (u64, u64) {
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_dir() => {
            let entries = fs::read_dir(path).into_iter().flatten().flatten();
            sum(entries.map(|entry| size(&entry.path())))
        }
        Ok(found) => (1, found.len()),
        Err(_) => (0, 0),
    }
}

fn sum(sizes: impl Iterator<Item = (u64, u64)>) -> (u64, u64) {
    sizes.fold((0, 0), |all, one| (all.0 + one.0, all.1 + one.1))
}

fn remove(path: &Path) -> io::Result<()> {
    let removed = match fs::symlink_metadata(path)?.is_dir() {
        true => fs::remove_dir_all(path),
        false => fs::remove_file(path),
    };
    match removed {
        // Another run may have replaced it meanwhile.
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

/// Prints what is kept between runs, or removes it.
///
/// # Errors
/// [`AppError::Disk`] for a file that cannot be removed.
pub fn cache(args: CacheArgs) -> Result<(), AppError> {
    let mut out = String::new();
    for part in Part::all() {
        let kept = part.kept();
        let (files, bytes) = sum(kept.iter().map(|path| size(path)));
        let what = match args.clear {
            true => "removed".to_owned(),
            false => part.limit,
        };
        if args.clear {
            for path in &kept {
                remove(path).map_err(|e| AppError::Disk(format!("{}: {e}", path.display())))?;
            }
        }
        let plural = if files == 1 { "" } else { "s" };
        let (name, folder, bytes) = (part.name, part.folder.display(), mebibytes(bytes));
        // Writing to a string cannot fail.
        let _ = writeln!(
            out,
            "{name:<12}{folder}: {bytes} in {files} file{plural}, {what}"
        );
        if name == PIPELINES
            && let Some(other) = env::var_os(MESA_FOLDER_ENV)
            && other != part.folder.as_os_str()
        {
            let other = Path::new(&other).display();
            let _ = writeln!(
                out,
                "{:<12}Mesa's drivers keep theirs in {MESA_FOLDER_ENV}={other}",
                ""
            );
        }
    }
    print_out(&out)
}
