//! Watches the files that a scene was read from and says which kind of them has new content.
//!
//! Folders are watched, not files: editors save by renaming another file over the old one, and a
//! watch on a file would die with it. An event only says where to look; the hash of the content
//! decides. A file's hash is taken before anybody reads the file again, so a save that comes while
//! it is read is seen as another change.
//!
//! Where the system refuses a watch, which is told, the files are looked at now and then instead.

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

/// What has new content.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Change {
    /// A shader, or its folder gained or lost one.
    Shader,
    /// A model, buffer, image or stage.
    Asset,
    /// The scene text.
    Scene,
    /// The scene's script, or what that imports.
    Script,
}

/// The kinds of files that changed together.
pub type Changes = BTreeSet<Change>;

/// What to watch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WatchList {
    /// Files that were read or looked for, as they were named; they need not exist.
    pub files: Vec<(PathBuf, Change)>,
    /// Folders of shaders.
    pub shader_folders: Vec<PathBuf>,
}

/// An event is acted on after this long without another…
const QUIET: Duration = Duration::from_millis(10);
/// …but never later than this after the first.
const MOST_WAIT: Duration = Duration::from_millis(30);
/// How often folders that do not exist are looked for, and files that no event tells of.
const LOOK: Duration = Duration::from_millis(250);

/// What a watcher has to say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum News {
    /// What changed and when the first word of it came.
    Changed(Changes, Instant),
    /// Why and where saves are seen only now and then, and what to do; `None` when that is over.
    Trouble(Option<String>),
}

enum Message {
    Event(notify::Result<notify::Event>),
    Watch(WatchList, SystemTime),
    Stop,
}

/// A thread that watches until it is dropped.
#[derive(Debug)]
pub struct Watcher {
    messages: Sender<Message>,
    thread: Option<thread::JoinHandle<()>>,
}

impl Watcher {
    /// Starts watching nothing; `report` is called from the watching thread.
    ///
    /// # Errors
    /// When the system has no thread for it.
    pub fn new(report: impl Fn(News) + Send + 'static) -> Result<Self, String> {
        Self::on(
            |events| {
                Box::new(move || {
                    let events = events.clone();
                    let system = notify::recommended_watcher(move |event| {
                        // Nobody listens any more while the program ends.
                        let _ = events.send(Message::Event(event));
                    })?;
                    Ok(Box::new(system) as System)
                })
            },
            report,
        )
    }

    /// On a system that is asked by what is made of where its events go.
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
            .map_err(|error| format!("saved files are not followed: {error}; start again"))?;
        Ok(Self {
            messages,
            thread: Some(thread),
        })
    }

    /// Watches these from now on in place of those before. `read_since` is when reading them
    /// began: a file that is new here and was written since then counts as changed.
    pub fn watch(&self, list: WatchList, read_since: SystemTime) {
        // A thread that ended has nothing left to watch for.
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
    /// Of its content, or why that cannot be read.
    hash: Result<Hash, io::ErrorKind>,
    /// Of when it was last looked at.
    stamp: Option<Stamp>,
    /// Every place whose change may change what the name means: itself and the links on its way.
    resolved_paths: Vec<PathBuf>,
}

/// The state of the watching thread.
struct Watching {
    folders: Folders,
    /// As named, and resolved.
    shader_folders: Vec<(PathBuf, PathBuf)>,
    files: HashMap<PathBuf, Watched>,
    /// The trouble that was told last.
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
                // Also while events of other folders come all the time.
                if looked.elapsed() >= LOOK {
                    let started = Instant::now();
                    send(report, self.look_around(), started);
                    looked = Instant::now();
                    continue;
                }
                inbox.recv_timeout(LOOK.saturating_sub(looked.elapsed()))
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

    /// Looks at what no event tells of.
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

    /// Looks at what the events were about.
    fn settle(&mut self, touched: &Touched) -> Changes {
        let is_folder = |path: &PathBuf| self.folders.contains(path);
        if touched.everything || touched.paths.iter().any(is_folder) {
            self.folders.forget();
            self.watch_folders();
            return self.look_at(None);
        }
        self.look_at(Some(&touched.paths))
    }

    /// Hashes the files that the paths may mean, or all; the kinds of those that differ.
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
                // Before the content: a save in between is looked at again.
                file.stamp = Stamp::of(name);
                let hash = content_hash(name).map_err(|error| error.kind());
                if hash != file.hash {
                    file.hash = hash;
                    changes.insert(file.change);
                }
            }
        }
        if self.watch_folders() && paths.is_some() {
            // What came into a folder before it was watched was told by nobody.
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
        // Watch first, hash second: what is saved in between is told by an event.
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

    /// Takes in shaders that are new in their folders; which ones.
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

    /// Asks the system to watch what it should and does not; whether anything was added.
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

/// Where something happened.
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
            // Reading a file is no change; and it is what a reload does.
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
