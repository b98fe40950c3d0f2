//! Folder of files that Reflet keeps between runs for one user: converted stages and compiled pipelines.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

/// Environment variable with the folder.
pub const CACHE_ENV: &str = "REFLET_CACHE";

/// The user's cache folder, which need not exist; where the environment names none, a folder of this user among
/// the temporary files.
pub fn folder() -> PathBuf {
    let set = |name: &str| {
        env::var_os(name)
            .filter(|value| !value.is_empty())
            .map(PathBuf::from)
    };
    set(CACHE_ENV)
        .or_else(|| set("XDG_CACHE_HOME").map(|folder| folder.join("reflet")))
        .or_else(|| set("HOME").map(|home| home.join(".cache/reflet")))
        .or_else(|| set("LOCALAPPDATA").map(|folder| folder.join("reflet")))
        .unwrap_or_else(temporary_folder)
}

/// Creates the folder `name` below [`folder`], or below a temporary one where that cannot be written, and returns
/// its absolute path. Nobody but this user can write to it. `None` where there is no such place.
pub fn private_folder(name: &str) -> Option<PathBuf> {
    let below = |parent: &Path| {
        fs::create_dir_all(parent).ok()?;
        private(&parent.join(name)).ok()
    };
    let in_temporary = || below(&private(&temporary_folder()).ok()?);
    let found = below(&folder()).or_else(in_temporary)?;
    std::path::absolute(found).ok()
}

fn temporary_folder() -> PathBuf {
    #[cfg(unix)]
    let name = format!("reflet-{}", rustix::process::geteuid().as_raw());
    #[cfg(not(unix))]
    let name = "reflet"; // temporary folders are private there
    env::temp_dir().join(name)
}

/// The path, if it is a folder that this user alone may write to; a missing one is created.
fn private(path: &Path) -> io::Result<PathBuf> {
    #[cfg_attr(not(unix), expect(unused_mut, reason = "its mode is Unix's"))]
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    match builder.create(path) {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => return Err(error),
        _ => {}
    }
    // A link may be another user's, who can change where it leads.
    let found = fs::symlink_metadata(path)?;
    if !found.is_dir() || !is_private(&found) {
        return Err(io::ErrorKind::PermissionDenied.into());
    }
    #[cfg(unix)]
    rustix::fs::access(path, rustix::fs::Access::WRITE_OK)?;
    Ok(path.to_owned())
}

/// Whether a file or folder belongs to this user, and others may not write to it.
pub fn is_private(found: &fs::Metadata) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt as _;
        found.uid() == rustix::process::geteuid().as_raw() && found.mode() & 0o022 == 0
    }
    #[cfg(not(unix))]
    {
        let _ = found; // folders of users are private there
        true
    }
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{PermissionsExt as _, symlink};

    use super::*;

    #[test]
    fn folders_that_others_can_change_are_refused() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let inside = |name: &str| folder.join(name);
        assert!(private(&inside("new")).is_ok(), "it is created");
        assert!(private(&inside("new")).is_ok(), "it is found");
        let mode = |name: &str| {
            let found = fs::metadata(inside(name)).expect("it exists");
            found.permissions().mode() & 0o777
        };
        assert_eq!(mode("new"), 0o700);
        symlink(inside("new"), inside("link")).expect("a link");
        fs::write(inside("file"), "").expect("a file");
        fs::create_dir(inside("open")).expect("a folder");
        fs::set_permissions(inside("open"), fs::Permissions::from_mode(0o777)).expect("its mode");
        for refused in ["link", "file", "open", "missing/parent"] {
            assert!(private(&inside(refused)).is_err(), "{refused}");
        }
    }
}
