//! Replaces the content of a file that other programs may save at the same time.

use std::{
    fs::{File, Metadata, OpenOptions},
    io::{self, Read as _, Seek as _, Write as _},
    path::Path,
};

use super::{Goal, Temporary, follow_no_link, open_regular};

/// Replaces the content `before` of a file by `after`, and returns whether it did: a file with another content is
/// left as it is. The new content is on the disk before the old one is compared for the last time, so that nothing
/// slow lies between that comparison and the replacement. `on_synced` is called in between.
///
/// The path is canonical, so a link that takes its place meanwhile is not followed. The file keeps its mode and owner.
/// Where a renamed file could not keep them, or the file has other names (hard links), it is rewritten in place.
///
/// # Errors
/// A file that must not or cannot be written; it is as before then.
pub fn replace_content(
    path: &Path,
    before: &[u8],
    after: &[u8],
    on_synced: impl FnOnce(),
) -> io::Result<bool> {
    let goal = Goal::in_folder(path);
    goal.check()?;
    if !has_content(path, before)? {
        return Ok(false);
    }
    let mut temporary = Temporary::create_private(&goal)?;
    temporary.file.write_all(after)?;
    let can_rename = keep_identity(&temporary.file, &path.metadata()?)?;
    temporary.file.sync_all()?;
    on_synced();
    if !can_rename {
        // The temporary file holds the new content until the file does, in case the system stops meanwhile.
        return rewrite(path, before, after);
    }
    let is_same = has_content(path, before)?;
    if is_same {
        temporary.persist()?;
    }
    Ok(is_same)
}

/// Whether a file has this content; false for a file that is gone, as in the middle of a save.
fn has_content(path: &Path, content: &[u8]) -> io::Result<bool> {
    match open_regular(path, false) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        opened => holds(&opened?, content),
    }
}

/// Whether the rest of an open file is this content.
fn holds(file: &File, content: &[u8]) -> io::Result<bool> {
    let mut found = Vec::with_capacity(content.len() + 1);
    file.take(content.len() as u64 + 1)
        .read_to_end(&mut found)?;
    Ok(found == content)
}

/// Gives a new file the owner and the mode of another, and returns whether it can take its place: not where the owner
/// cannot be given or the other file has several names.
#[cfg(unix)]
fn keep_identity(file: &File, other: &Metadata) -> io::Result<bool> {
    use std::os::unix::fs::{MetadataExt as _, fchown};
    if other.nlink() > 1 {
        return Ok(false);
    }
    let own = file.metadata()?;
    let is_same = (own.uid(), own.gid()) == (other.uid(), other.gid());
    if !is_same && fchown(file, Some(other.uid()), Some(other.gid())).is_err() {
        return Ok(false);
    }
    // After the owner: a change of owner clears some bits of the mode.
    file.set_permissions(other.permissions())?;
    Ok(true)
}

#[cfg(not(unix))]
fn keep_identity(file: &File, other: &Metadata) -> io::Result<bool> {
    file.set_permissions(other.permissions())?;
    Ok(true)
}

/// Overwrites a file in place and returns whether it did: not where it no longer holds `before`, which is compared
/// through the handle that writes. A full disk brings the content `before` back.
fn rewrite(path: &Path, before: &[u8], after: &[u8]) -> io::Result<bool> {
    let mut options = OpenOptions::new();
    follow_no_link(&mut options);
    let mut file = match options.read(true).write(true).open(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(false),
        opened => opened?,
    };
    if !file.metadata()?.is_file() || !holds(&file, before)? {
        return Ok(false);
    }
    let mut write = |content: &[u8]| {
        file.rewind()?;
        file.write_all(content)?;
        file.set_len(content.len() as u64)?;
        file.sync_all()
    };
    write(after).inspect_err(|_| {
        let _ = write(before); // its space is still reserved; the first error is reported
    })?;
    Ok(true)
}

#[cfg(test)]
mod tests {
    use std::{fs, path::PathBuf};

    use super::*;

    fn hidden(folder: &Path) -> Option<PathBuf> {
        let entries = fs::read_dir(folder).expect("readable").flatten();
        let mut paths = entries.map(|entry| entry.path());
        let is_hidden = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with(".reflet-");
        paths.find(|path| path.file_name().is_some_and(is_hidden))
    }

    #[test]
    fn a_save_while_the_new_content_is_synced_stays() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let path = folder.join("scene.toml");
        let in_place = || fs::write(&path, "by an editor").expect("saved");
        let by_renaming = || {
            fs::write(folder.join("new"), "by an editor").expect("saved");
            fs::rename(folder.join("new"), &path).expect("renamed");
        };
        let saves: [&dyn Fn(); 2] = [&in_place, &by_renaming];
        for save in saves {
            fs::write(&path, "before").expect("written");
            let done = replace_content(&path, b"before", b"after", save);
            assert!(!done.expect("no error"), "the race is lost");
            assert_eq!(fs::read(&path).expect("there"), b"by an editor");
            assert_eq!(hidden(folder), None);
        }
        fs::remove_file(&path).expect("removed");
        fs::write(&path, "before").expect("written");
        let remove = || fs::remove_file(&path).expect("removed");
        let done = replace_content(&path, b"before", b"after", remove);
        assert!(!done.expect("no error") && !path.exists());
    }

    #[test]
    fn the_new_content_is_whole_before_the_old_one_goes() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let path = folder.join("scene.toml");
        fs::write(&path, "before").expect("written");
        let done = replace_content(&path, b"before", b"after", || {
            let hidden = hidden(folder).expect("the new file");
            assert_eq!(fs::read(hidden).expect("there"), b"after");
            assert_eq!(fs::read(&path).expect("there"), b"before");
        });
        assert!(done.expect("no error"));
        assert_eq!(fs::read(&path).expect("there"), b"after");
    }

    #[cfg(unix)]
    #[test]
    fn mode_and_owner_stay_and_a_private_file_is_never_readable() {
        use std::os::unix::fs::{MetadataExt as _, PermissionsExt as _, chown};
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let path = folder.join("scene.toml");
        for mode in [0o600, 0o640, 0o755] {
            fs::write(&path, "before").expect("written");
            fs::set_permissions(&path, fs::Permissions::from_mode(mode)).expect("settable");
            // Root may give files away; others keep their own.
            let _ = chown(&path, Some(4321), Some(4321));
            let was = path.metadata().expect("there");
            let seen = |path: &Path| path.metadata().expect("there").mode() & 0o7777;
            let done = replace_content(&path, b"before", b"after", || {
                let hidden = hidden(folder).expect("the new file");
                assert_eq!(seen(&hidden), mode);
            });
            assert!(done.expect("no error"));
            let is = path.metadata().expect("there");
            assert_eq!(seen(&path), mode);
            assert_eq!((is.uid(), is.gid()), (was.uid(), was.gid()));
        }
        let private = Temporary::create_private(&Goal::typed(path)).expect("creatable");
        let mode = private.file.metadata().expect("open").mode();
        assert_eq!(mode & 0o7777, 0o600, "before the first byte is written");
        drop(private);
    }

    #[cfg(unix)]
    #[test]
    fn hard_links_stay_one_file() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let [path, other] = ["scene.toml", "other.toml"].map(|name| folder.join(name));
        fs::write(&path, "before, and longer").expect("written");
        fs::hard_link(&path, &other).expect("a hard link");
        let done = replace_content(&path, b"before, and longer", b"after", || {});
        assert!(done.expect("no error"));
        for path in [&path, &other] {
            assert_eq!(fs::read(path).expect("there"), b"after");
        }
        assert_eq!(hidden(folder), None);
        let save = || fs::write(&other, "by an editor").expect("saved");
        let done = replace_content(&path, b"after", b"before", save);
        assert!(!done.expect("no error"), "the race is lost");
        assert_eq!(fs::read(&path).expect("there"), b"by an editor");
    }
}
