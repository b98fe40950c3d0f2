//! Folder watches: active, missing and refused ones. Refused watches are retried with exponential
//! backoff.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs, io,
    path::{Component, Path, PathBuf},
    time::{Duration, Instant},
};

use notify::{ErrorKind, RecursiveMode};

/// Backend of system events.
pub type System = Box<dyn notify::Watcher + Send>;
/// Creates a backend.
pub type Start = Box<dyn FnMut() -> notify::Result<System> + Send>;

/// First delay before a refused watch is retried.
const FIRST_PAUSE: Duration = Duration::from_millis(250);
/// Maximum delay; it doubles with each retry.
const MOST_PAUSE: Duration = Duration::from_secs(8);

/// A refused watch.
#[derive(Debug)]
struct Refusal {
    why: String,
    pause: Duration,
    again: Instant,
}

impl Refusal {
    fn new(why: String, before: Option<&Self>) -> Self {
        let pause = before.map_or(FIRST_PAUSE, |old| (2 * old.pause).min(MOST_PAUSE));
        Self {
            why,
            pause,
            again: Instant::now() + pause,
        }
    }

    fn is_due(&self) -> bool {
        Instant::now() >= self.again
    }
}

#[derive(Debug)]
enum Folder {
    Watched,
    /// The folder does not exist.
    Missing,
    Refused(Refusal),
}

/// Watched folders by path.
pub struct Folders {
    start: Start,
    system: Result<System, Refusal>,
    folders: BTreeMap<PathBuf, Folder>,
}

impl Folders {
    /// Creates the backend; no folder is watched yet.
    pub fn new(mut start: Start) -> Self {
        let system = start().map_err(|error| Refusal::new(no_system(&error), None));
        Self {
            start,
            system,
            folders: BTreeMap::new(),
        }
    }

    /// Watches exactly these folders, as far as the system allows; returns whether any was added.
    pub fn watch(&mut self, wanted: &BTreeSet<PathBuf>) -> bool {
        if let Err(refusal) = &self.system
            && refusal.is_due()
        {
            let again = (self.start)();
            self.system = again.map_err(|error| Refusal::new(no_system(&error), Some(refusal)));
        }
        let (kept, gone) = std::mem::take(&mut self.folders)
            .into_iter()
            .partition::<BTreeMap<_, _>, _>(|(folder, _)| wanted.contains(folder));
        self.folders = kept;
        let Ok(system) = &mut self.system else {
            return false;
        };
        for (folder, state) in gone {
            if matches!(state, Folder::Watched) {
                let _ = system.unwatch(&folder);
            }
        }
        let mut added = false;
        for folder in wanted {
            let before = match self.folders.get(folder) {
                Some(Folder::Watched) => continue,
                Some(Folder::Refused(refusal)) if !refusal.is_due() => continue,
                Some(Folder::Refused(refusal)) => Some(refusal),
                Some(Folder::Missing) | None => None,
            };
            let state = match system.watch(folder, RecursiveMode::NonRecursive) {
                Ok(()) => Folder::Watched,
                Err(_) if !folder.is_dir() => Folder::Missing,
                Err(error) => Folder::Refused(Refusal::new(not_watched(&error, folder), before)),
            };
            added |= matches!(state, Folder::Watched);
            self.folders.insert(folder.clone(), state);
        }
        added
    }

    /// Drops all watches: a removed folder loses its watch, also when another takes its name.
    pub fn forget(&mut self) {
        let Ok(system) = &mut self.system else { return };
        for (folder, state) in &mut self.folders {
            if matches!(state, Folder::Watched) {
                let _ = system.unwatch(folder);
                *state = Folder::Missing;
            }
        }
    }

    /// Whether this folder is in the list.
    pub fn contains(&self, folder: &Path) -> bool {
        self.folders.contains_key(folder)
    }

    /// Whether some folders have no events.
    pub fn is_incomplete(&self) -> bool {
        let is_watched = |state: &Folder| matches!(state, Folder::Watched);
        self.system.is_err() || !self.folders.values().all(is_watched)
    }

    /// Whether files in this folder must be polled.
    pub fn is_silent(&self, folder: &Path) -> bool {
        self.system.is_err() || matches!(self.folders.get(folder), Some(Folder::Refused(_)))
    }

    /// Description of the refused watches, and what to do; `None` if there are none.
    pub fn failure(&self) -> Option<String> {
        const MEANWHILE: &str = "meanwhile they are polled four times a second";
        if let Err(refusal) = &self.system {
            return Some(format!("{}; {MEANWHILE}", refusal.why));
        }
        let mut refused = self.folders.values().filter_map(|state| match state {
            Folder::Refused(refusal) => Some(refusal),
            _ => None,
        });
        let first = refused.next()?;
        let others = match refused.count() {
            0 => String::new(),
            1 => " (and of another folder)".to_owned(),
            more => format!(" (and of {more} other folders)"),
        };
        Some(format!("{}{others}; {MEANWHILE}", first.why))
    }
}

/// Message about a missing backend, and what to do.
fn no_system(error: &notify::Error) -> String {
    let (why, what) = match &error.kind {
        // EMFILE: the user has too many watchers, or the process too many open files.
        ErrorKind::Io(error) if cfg!(target_os = "linux") && error.raw_os_error() == Some(24) => (
            "too many programs watch files already".to_owned(),
            "close some, or raise the limit: `sudo sysctl fs.inotify.max_user_instances=1024`",
        ),
        _ => (cause(error), "see the system log"),
    };
    format!("the system does not report saved files: {why}; {what}")
}

/// Message about a folder that cannot be watched, and what to do.
fn not_watched(error: &notify::Error, folder: &Path) -> String {
    let folder = folder.display();
    let (why, what) = match &error.kind {
        ErrorKind::MaxFilesWatch => (
            "its limit of watched folders is reached".to_owned(),
            "raise it: `sudo sysctl fs.inotify.max_user_watches=1048576`".to_owned(),
        ),
        ErrorKind::Io(error) if error.kind() == io::ErrorKind::PermissionDenied => (
            "the folder may not be listed".to_owned(),
            format!("allow it: `chmod u+r {folder}`"),
        ),
        _ => (
            cause(error),
            "if this persists, move the scene to a disk of this machine".to_owned(),
        ),
    };
    format!("the system does not report files saved in {folder}: {why}; {what}")
}

/// Text of the error without its paths.
fn cause(error: &notify::Error) -> String {
    match &error.kind {
        ErrorKind::Io(error) => error.to_string(),
        ErrorKind::Generic(text) => text.clone(),
        _ => error.to_string(),
    }
}

/// Maximum number of chained links; as in Linux.
const MOST_LINKS: u32 = 40;

/// The path without links, or at least absolute.
pub fn canonical(path: &Path) -> PathBuf {
    path.canonicalize()
        .or_else(|_| std::path::absolute(path))
        .unwrap_or_else(|_| path.to_owned())
}

/// The file's own path and the paths of links to it, each in a folder without links.
pub fn resolved_paths(name: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut rest = std::path::absolute(name).unwrap_or_else(|_| name.to_owned());
    for _ in 0..MOST_LINKS {
        let Some((link, after)) = first_link(&rest) else {
            found.push(rest);
            return found;
        };
        let target = fs::read_link(&link).unwrap_or_default();
        let folder = link.parent().unwrap_or(Path::new("/"));
        rest = folder.join(target).join(after);
        found.push(link);
    }
    found
}

/// The first link of an absolute path, and the rest of the path.
fn first_link(path: &Path) -> Option<(PathBuf, PathBuf)> {
    let mut before = PathBuf::new();
    let mut parts = path.components();
    while let Some(part) = parts.next() {
        match part {
            Component::ParentDir => {
                before.pop();
            }
            Component::CurDir => {}
            part => before.push(part),
        }
        if before.is_symlink() {
            return Some((before, parts.as_path().to_owned()));
        }
    }
    None
}
