//! File watcher: reports which kinds of a scene's files have new content.
//!
//! Folders are watched, not files: editors save by renaming a new file over the old one, which ends
//! a watch on the file. An event only triggers a check; the content hash decides. Files are hashed
//! before they are read again, so a save during the read is another change.
//!
//! If the system refuses to watch a folder, that is reported and the files are polled instead.

mod folders;

use std::{
    collections::{BTreeSet, HashMap},
    fs, io,
    path::{Path, PathBuf},
    sync::mpsc::{self, Receiver, RecvTimeoutError, Sender},
    thread,
    time::{Duration, Instant, SystemTime},
};

use notify::EventKind;

use self::folders::{Folders, Start, System, canonical, resolved_paths};
use reflet_base::files::{Stamp, content_hash, written_since};
use reflet_gpu::shader_folders::shader_folders;

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

/// Debounce: delay after the last event.
const QUIET: Duration = Duration::from_millis(10);
/// Debounce: maximum delay after the first event.
const MOST_WAIT: Duration = Duration::from_millis(30);
/// Poll interval for missing folders, and for files without events.
const POLL_INTERVAL: Duration = Duration::from_millis(250);

/// Event of the file watcher.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum WatchEvent {
    /// Files with new content, and the time of the first system event.
    Changed(Changes, Instant),
    /// Watcher failure: why and where files are polled instead, and what to do; `None` once it is over.
    Failure(Option<String>),
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
    pub fn new(report: impl Fn(WatchEvent) + Send + 'static) -> Result<Self, String> {
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

    /// Starts with a custom backend, created from the event sender.
    fn on(
        start: impl FnOnce(Sender<Message>) -> Start,
        report: impl Fn(WatchEvent) + Send + 'static,
    ) -> Result<Self, String> {
        let (messages, inbox) = mpsc::channel();
        let watching = Watching {
            folders: Folders::new(start(messages.clone())),
            shader_folders: Vec::new(),
            files: HashMap::new(),
            reported: None,
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
    /// All paths whose changes affect the file: its own and the paths of links to it.
    resolved_paths: Vec<PathBuf>,
}

/// State of the watching thread.
struct Watching {
    folders: Folders,
    /// Paths of the shader folders as given, with their resolved paths.
    shader_folders: Vec<(PathBuf, PathBuf)>,
    files: HashMap<PathBuf, Watched>,
    /// Failure that was reported last.
    reported: Option<String>,
}

impl Watching {
    fn run(mut self, inbox: &Receiver<Message>, report: &impl Fn(WatchEvent)) {
        let mut last_poll = Instant::now();
        loop {
            let failure = self.folders.failure();
            if failure != self.reported {
                self.reported.clone_from(&failure);
                report(WatchEvent::Failure(failure));
            }
            let first = if self.folders.is_incomplete() {
                // Polls also during continuous events of other folders.
                if last_poll.elapsed() >= POLL_INTERVAL {
                    let started = Instant::now();
                    send(report, self.poll_files(), started);
                    last_poll = Instant::now();
                    continue;
                }
                inbox.recv_timeout(POLL_INTERVAL.saturating_sub(last_poll.elapsed()))
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
            send(report, self.check_touched(&touched), started);
        }
    }

    /// Polls the files in folders without events.
    fn poll_files(&mut self) -> Changes {
        if self.watch_folders() {
            return self.scan_for_changes(None);
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
        self.scan_for_changes(Some(&touched))
    }

    /// Checks the files that the events name.
    fn check_touched(&mut self, touched: &Touched) -> Changes {
        let is_folder = |path: &PathBuf| self.folders.contains(path);
        if touched.everything || touched.paths.iter().any(is_folder) {
            self.folders.forget();
            self.watch_folders();
            return self.scan_for_changes(None);
        }
        self.scan_for_changes(Some(&touched.paths))
    }

    /// Hashes the files affected by the paths, or all files; returns the kinds of changed ones.
    fn scan_for_changes(&mut self, paths: Option<&BTreeSet<PathBuf>>) -> Changes {
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
                file.stamp = Stamp::read(name);
                let hash = content_hash(name).map_err(|error| error.kind());
                if hash != file.hash {
                    file.hash = hash;
                    changes.insert(file.change);
                }
            }
        }
        if self.watch_folders() && paths.is_some() {
            // Files added to a folder before its watch have no events.
            changes.extend(self.scan_for_changes(None));
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
                file.stamp = Stamp::read(&name);
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
        for folder in folders.flat_map(|(named, _)| shader_folders(named)) {
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
            wanted.insert(resolved.clone());
            wanted.extend(shader_folders(named).iter().map(|folder| canonical(folder)));
        }
        self.folders.watch(&wanted)
    }
}

/// Paths of received events.
#[derive(Default)]
struct Touched {
    paths: BTreeSet<PathBuf>,
    /// Whether events were lost, so that all files must be checked.
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

fn send(report: &impl Fn(WatchEvent), changes: Changes, since: Instant) {
    if !changes.is_empty() {
        report(WatchEvent::Changed(changes, since));
    }
}

#[cfg(test)]
mod tests;
