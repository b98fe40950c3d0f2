//! File watcher: reports which kinds of a scene's files have new content.
//!
//! Folders are watched, not files: editors save by renaming a new file over the old one, which ends
//! a watch on the file. An event only triggers a check; the content hash decides. Files are hashed
//! before they are read again, so a save during the read is another change.
//!
//! Where the system refuses a watch, this is reported and the files are polled instead.

mod folders;
mod resolved_paths;

use std::{
    collections::{BTreeSet, HashMap},
    fs, io,
    path::{Path, PathBuf},
    sync::mpsc::{self, Receiver, RecvTimeoutError, Sender},
    thread,
    time::{Duration, Instant, SystemTime},
};

use notify::EventKind;

use self::{
    folders::{Folders, Start, System},
    resolved_paths::{canonical, resolved_paths},
};
use crate::files::{Stamp, content_hash, written_since};

/// Kind of file with new content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// A shader was changed, added or removed.
    Shader,
    /// A model, buffer, image or stage.
    Asset,
    /// The scene text.
    Scene,
    /// The scene's script, or an import of it.
    Script,
}

/// The kinds of files that changed together.
pub type Changes = BTreeSet<Change>;

/// Files and folders to watch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WatchList {
    /// Files by their unresolved names; they need not exist.
    pub files: Vec<(PathBuf, Change)>,
    /// Folders of shaders.
    pub shader_folders: Vec<PathBuf>,
}

/// Debounce: delay after the last event…
const QUIET: Duration = Duration::from_millis(10);
/// …and maximum delay after the first.
const MOST_WAIT: Duration = Duration::from_millis(30);
/// Poll interval for missing folders, and for files without events.
const POLL_INTERVAL: Duration = Duration::from_millis(250);

/// Report of a watcher.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum News {
    /// Changes, with the time of the first event.
    Changed(Changes, Instant),
    /// Why and where files are polled, and what to do; `None` once events work again.
    Trouble(Option<String>),
}

enum Message {
    Event(notify::Result<notify::Event>),
    Watch(WatchList, SystemTime),
    Stop,
}

/// A watching thread, which ends when this is dropped.
#[derive(Debug)]
pub struct Watcher {
    messages: Sender<Message>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Watcher {
    /// Starts with an empty list; `report` is called on the watching thread.
    ///
    /// # Errors
    /// The system cannot start a thread.
    pub fn new(report: impl Fn(News) + Send + 'static) -> Result<Self, String> {
        Self::on(
            |events| {
                Box::new(move || {
                    let events = events.clone();
                    let system = notify::recommended_watcher(move |event| {
                        // The receiver may be gone at shutdown.
                        let _ = events.send(Message::Event(event));
                    })?;
                    Ok(Box::new(system) as System)
                })
            },
            report,
        )
    }

    /// With a custom backend, created from the event sender.
    fn on(
        start: impl FnOnce(Sender<Message>) -> Start,
        report: impl Fn(News) + Send + 'static,
    ) -> Result<Self, String> {
        let (messages, inbox) = mpsc::channel();
        let watching = Watching {
            folders: Folders::new(start(messages.clone())),
            shader_folders: Vec::new(),
            files: HashMap::new(),
            told: None,
        };
        let thread = thread::Builder::new()
            .name("watch".into())
            .spawn(move || watching.run(&inbox, &report))
            .map_err(|error| format!("files cannot be watched: {error}; start again"))?;
        Ok(Self {
            messages,
            thread: Some(thread),
        })
    }

    /// Replaces the watch list. `read_since` is the start of their read: a file that is new in the
    /// list and was written since then counts as changed.
    pub fn watch(&self, list: WatchList, read_since: SystemTime) {
        // Sending fails once the thread has ended.
        let _ = self.messages.send(Message::Watch(list, read_since));
    }
}

impl Drop for Watcher {
    fn drop(&mut self) {
        let _ = self.messages.send(Message::Stop);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

type Hash = [u8; 32];

struct Watched {
    change: Change,
    /// Hash of its content, or the read error.
    hash: Result<Hash, io::ErrorKind>,
    /// Metadata at the last check.
    stamp: Option<Stamp>,
    /// All paths that affect it: its own and the links to it.
    resolved_paths: Vec<PathBuf>,
}

/// State of the watching thread.
struct Watching {
    folders: Folders,
    /// By name, with resolved paths.
    shader_folders: Vec<(PathBuf, PathBuf)>,
    files: HashMap<PathBuf, Watched>,
    /// Last reported limitation.
    told: Option<String>,
}

impl Watching {
    fn run(mut self, inbox: &Receiver<Message>, report: &impl Fn(News)) {
        let mut looked = Instant::now();
        loop {
            let trouble = self.folders.trouble();
            if trouble != self.told {
                self.told.clone_from(&trouble);
                report(News::Trouble(trouble));
            }
            let first = if self.folders.is_incomplete() {
                // Also during continuous events of other folders.
                if looked.elapsed() >= POLL_INTERVAL {
                    let started = Instant::now();
                    send(report, self.look_around(), started);
                    looked = Instant::now();
                    continue;
                }
                inbox.recv_timeout(POLL_INTERVAL.saturating_sub(looked.elapsed()))
            } else {
                inbox.recv().map_err(|_| RecvTimeoutError::Disconnected)
            };
            let first = match first {
                Ok(message) => message,
                Err(RecvTimeoutError::Timeout) => continue,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let mut touched = Touched::default();
            let mut next = Some(first);
            let started = Instant::now();
            let deadline = started + MOST_WAIT;
            while let Some(message) = next {
                match message {
                    Message::Stop => return,
                    Message::Event(event) => touched.add(event),
                    Message::Watch(list, since) => {
                        send(report, self.replace(&list, since), started)
                    }
                }
                let left = deadline.saturating_duration_since(Instant::now());
                next = inbox.recv_timeout(QUIET.min(left)).ok();
            }
            send(report, self.settle(&touched), started);
        }
    }

    /// Polls files without events.
    fn look_around(&mut self) -> Changes {
        if self.watch_folders() {
            return self.look_at(None);
        }
        let folders = &self.folders;
        let is_silent = |place: &PathBuf| {
            place
                .parent()
                .is_some_and(|folder| folders.is_silent(folder))
        };
        let silent =
            (self.files.iter()).filter(|(_, file)| file.resolved_paths.iter().any(is_silent));
        let touched = silent
            .filter(|(name, file)| Stamp::may_differ(file.stamp.as_ref(), name))
            .flat_map(|(_, file)| file.resolved_paths.iter().cloned());
        let touched = touched.collect();
        self.look_at(Some(&touched))
    }

    /// Checks the files of the events.
    fn settle(&mut self, touched: &Touched) -> Changes {
        let is_folder = |path: &PathBuf| self.folders.contains(path);
        if touched.everything || touched.paths.iter().any(is_folder) {
            self.folders.forget();
            self.watch_folders();
            return self.look_at(None);
        }
        self.look_at(Some(&touched.paths))
    }

    /// Hashes the files affected by the paths, or all files; returns the kinds of changed ones.
    fn look_at(&mut self, paths: Option<&BTreeSet<PathBuf>>) -> Changes {
        let mut changes = Changes::new();
        if !self.find_shaders().is_empty() {
            changes.insert(Change::Shader);
        }
        for (name, file) in &mut self.files {
            let is_meant =
                |paths: &BTreeSet<PathBuf>| file.resolved_paths.iter().any(|p| paths.contains(p));
            if paths.is_none_or(is_meant) {
                file.resolved_paths = resolved_paths(name);
                // Metadata before content, so that a save in between is checked again.
                file.stamp = Stamp::of(name);
                let hash = content_hash(name).map_err(|error| error.kind());
                if hash != file.hash {
                    file.hash = hash;
                    changes.insert(file.change);
                }
            }
        }
        if self.watch_folders() && paths.is_some() {
            // Files added to a folder before its watch have no events.
            changes.extend(self.look_at(None));
        }
        changes
    }

    fn replace(&mut self, list: &WatchList, since: SystemTime) -> Changes {
        let named = |folder: &PathBuf| (folder.clone(), canonical(folder));
        self.shader_folders = list.shader_folders.iter().map(named).collect();
        let is_kept = |name: &PathBuf| list.files.iter().any(|(kept, _)| kept == name);
        self.files
            .retain(|name, file| file.change == Change::Shader || is_kept(name));
        let mut fresh = self.find_shaders();
        for (name, change) in &list.files {
            if !self.files.contains_key(name) {
                self.add(name, *change);
                fresh.push(name.clone());
            }
        }
        // Watch first, hash second, so that a save in between has an event.
        self.watch_folders();
        let mut changes = Changes::new();
        for name in fresh {
            if let Some(file) = self.files.get_mut(&name) {
                file.stamp = Stamp::of(&name);
                file.hash = content_hash(&name).map_err(|error| error.kind());
                if written_since(&name, since) {
                    changes.insert(file.change);
                }
            }
        }
        changes
    }

    fn add(&mut self, name: &Path, change: Change) {
        let file = Watched {
            change,
            hash: Err(io::ErrorKind::NotFound),
            stamp: None,
            resolved_paths: resolved_paths(name),
        };
        self.files.insert(name.to_owned(), file);
    }

    /// Adds new shaders in the watched folders; returns them.
    fn find_shaders(&mut self) -> Vec<PathBuf> {
        let mut found = Vec::new();
        let folders = self.shader_folders.iter();
        for folder in folders.flat_map(|(named, _)| [named.clone(), named.join("lib")]) {
            for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
                let path = entry.path();
                let is_shader = path.extension().is_some_and(|e| e == "wgsl");
                if is_shader && !self.files.contains_key(&path) {
                    found.push(path);
                }
            }
        }
        for path in &found {
            self.add(path, Change::Shader);
        }
        found
    }

    /// Adds missing watches; returns whether any was added.
    fn watch_folders(&mut self) -> bool {
        let parents = self.files.values().flat_map(|file| &file.resolved_paths);
        let mut wanted: BTreeSet<PathBuf> = parents
            .filter_map(|place| place.parent().map(Path::to_owned))
            .collect();
        for (named, resolved) in &self.shader_folders {
            wanted.extend([resolved.clone(), canonical(&named.join("lib"))]);
        }
        self.folders.watch(&wanted)
    }
}

/// An event's paths.
#[derive(Default)]
struct Touched {
    paths: BTreeSet<PathBuf>,
    /// Events were lost.
    everything: bool,
}

impl Touched {
    fn add(&mut self, event: notify::Result<notify::Event>) {
        match event {
            Ok(event) if event.need_rescan() => self.everything = true,
            // Ignores reads, which reloads cause themselves.
            Ok(event) if matches!(event.kind, EventKind::Access(_)) => {}
            Ok(event) => self.paths.extend(event.paths),
            Err(_) => self.everything = true,
        }
    }
}

fn send(report: &impl Fn(News), changes: Changes, since: Instant) {
    if !changes.is_empty() {
        report(News::Changed(changes, since));
    }
}

#[cfg(test)]
mod tests;
