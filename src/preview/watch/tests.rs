//! Tests of watching with refused watches: system limits and unreadable folders.

use std::sync::{Arc, Mutex, PoisonError};

use notify::{Config, ErrorKind, RecursiveMode, WatcherKind};

use super::*;

/// Error with which folders are refused, if they are.
type Refuses = Arc<Mutex<Option<fn() -> ErrorKind>>>;

/// A backend that can refuse folders.
struct RefusingWatcher {
    system: notify::RecommendedWatcher,
    refuses: Refuses,
}

impl notify::Watcher for RefusingWatcher {
    fn new<F: notify::EventHandler>(_: F, _: Config) -> notify::Result<Self> {
        unreachable!("it is made by hand")
    }

    fn watch(&mut self, path: &Path, mode: RecursiveMode) -> notify::Result<()> {
        match *self.refuses.lock().unwrap_or_else(PoisonError::into_inner) {
            Some(kind) => Err(notify::Error::new(kind()).add_path(path.to_owned())),
            None => self.system.watch(path, mode),
        }
    }

    fn unwatch(&mut self, path: &Path) -> notify::Result<()> {
        self.system.unwatch(path)
    }

    fn kind() -> WatcherKind {
        WatcherKind::NullWatcher
    }
}

/// A watcher over a temporary file, with a backend that refuses folders, or its first start.
struct Case {
    /// Ends before its folder is removed.
    _watcher: Watcher,
    _folder: tempfile::TempDir,
    path: PathBuf,
    refuses: Refuses,
    events: Receiver<WatchEvent>,
}

impl Case {
    fn new(refuses: Option<fn() -> ErrorKind>, refuses_start: u32) -> Self {
        let folder = tempfile::Builder::new().prefix("reflet-refused-").tempdir();
        let folder = folder.expect("a folder");
        let path = folder.path().join("a.toml");
        fs::write(&path, "first").expect("written");
        let refuses: Refuses = Arc::new(Mutex::new(refuses));
        let (shared, mut left) = (refuses.clone(), refuses_start);
        let (sender, received) = mpsc::channel();
        let watcher = Watcher::on(
            move |events| {
                Box::new(move || {
                    if left > 0 {
                        left -= 1;
                        let full = io::Error::from_raw_os_error(24);
                        return Err(notify::Error::io(full));
                    }
                    let events = events.clone();
                    Ok(Box::new(RefusingWatcher {
                        system: notify::recommended_watcher(move |event| {
                            let _ = events.send(Message::Event(event));
                        })?,
                        refuses: shared.clone(),
                    }) as System)
                })
            },
            move |what| {
                let _ = sender.send(what);
            },
        );
        let watcher = watcher.expect("a thread");
        let list = WatchList {
            files: vec![(path.clone(), Change::Scene)],
            shader_folders: Vec::new(),
        };
        watcher.watch(list, SystemTime::now() + Duration::from_secs(60));
        Self {
            _watcher: watcher,
            _folder: folder,
            path,
            refuses,
            events: received,
        }
    }

    fn next(&self) -> WatchEvent {
        let event = self.events.recv_timeout(Duration::from_secs(30));
        event.expect("an event arrives")
    }

    /// The next reported failure; skips other events.
    fn failure(&self) -> Option<String> {
        loop {
            if let WatchEvent::Failure(why) = self.next() {
                return why;
            }
        }
    }

    /// Replaces the file atomically, so that it is never seen empty.
    fn save(&self, text: &str) {
        let beside = self.path.with_extension("next");
        fs::write(&beside, text).expect("written");
        fs::rename(beside, &self.path).expect("renamed");
    }

    fn save_is_seen(&self, text: &str) {
        self.save(text);
        let is_change = |event: &WatchEvent| match event {
            WatchEvent::Changed(changes, _) => changes.contains(&Change::Scene),
            WatchEvent::Failure(_) => false,
        };
        while !is_change(&self.next()) {}
    }
}

#[test]
fn reached_watch_limit_is_reported_and_folders_are_polled_meanwhile() {
    let case = Case::new(Some(|| ErrorKind::MaxFilesWatch), 0);
    let why = case.failure().expect("a failure");
    assert!(
        why.contains("sudo sysctl fs.inotify.max_user_watches="),
        "{why}"
    );
    assert!(why.contains("reflet-refused-"), "{why}");
    for round in 0..5 {
        case.save_is_seen(&format!("round {round}"));
    }
    // The content hash still decides.
    case.save("round 4");
    thread::sleep(3 * POLL_INTERVAL);
    let events: Vec<WatchEvent> = case.events.try_iter().collect();
    let mut changes = events
        .iter()
        .filter(|n| matches!(n, WatchEvent::Changed(..)));
    assert_eq!(changes.next(), None);
    *case.refuses.lock().expect("unharmed") = None;
    assert_eq!(case.failure(), None);
    case.save_is_seen("last");
}

#[test]
fn unlistable_folder_is_reported_with_help() {
    let denied = || ErrorKind::Io(io::ErrorKind::PermissionDenied.into());
    let case = Case::new(Some(denied), 0);
    let why = case.failure().expect("a failure");
    let folder = case.path.parent().expect("a folder").display().to_string();
    assert!(why.contains(&format!("`chmod u+r {folder}`")), "{why}");
    case.save_is_seen("second");
}

#[cfg(target_os = "linux")]
#[test]
fn retries_when_no_watcher_is_available() {
    let case = Case::new(None, 2);
    let why = case.failure().expect("a failure");
    assert!(why.contains("fs.inotify.max_user_instances="), "{why}");
    let (mut is_seen, mut is_over) = (false, false);
    for round in 0.. {
        if is_seen && is_over {
            break;
        }
        case.save(&format!("round {round}"));
        match case.next() {
            WatchEvent::Changed(..) => is_seen = true,
            WatchEvent::Failure(why) => is_over = why.is_none(),
        }
    }
    case.save_is_seen("last");
}
