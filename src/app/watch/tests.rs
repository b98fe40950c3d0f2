//! Tests of watching with refused watches: system limits and unreadable folders.

use std::sync::{
    Arc, Mutex, PoisonError,
    atomic::{AtomicU32, Ordering},
};

use notify::{Config, ErrorKind, RecursiveMode, WatcherKind};

use super::*;

/// Refusal of a folder, if any.
type Refuses = Arc<Mutex<Option<fn() -> ErrorKind>>>;

/// A backend that can refuse folders.
struct Moody {
    system: notify::RecommendedWatcher,
    refuses: Refuses,
}

impl notify::Watcher for Moody {
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
    path: PathBuf,
    refuses: Refuses,
    news: Receiver<News>,
    watcher: Option<Watcher>,
}

impl Case {
    fn new(refuses: Option<fn() -> ErrorKind>, refuses_start: u32) -> Self {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("reflet-refused-{}-{number}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join("a.toml");
        fs::write(&path, "first").expect("written");
        let refuses: Refuses = Arc::new(Mutex::new(refuses));
        let (shared, mut left) = (refuses.clone(), refuses_start);
        let (sender, news) = mpsc::channel();
        let watcher = Watcher::on(
            move |events| {
                Box::new(move || {
                    if left > 0 {
                        left -= 1;
                        let full = io::Error::from_raw_os_error(24);
                        return Err(notify::Error::io(full));
                    }
                    let events = events.clone();
                    Ok(Box::new(Moody {
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
            path,
            refuses,
            news,
            watcher: Some(watcher),
        }
    }

    fn next(&self) -> News {
        let news = self.news.recv_timeout(Duration::from_secs(30));
        news.expect("something is told")
    }

    /// The next reported limitation; skips other reports.
    fn trouble(&self) -> Option<String> {
        loop {
            if let News::Trouble(why) = self.next() {
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
        let is_change =
            |news: &News| matches!(news, News::Changed(of, _) if of.contains(&Change::Scene));
        while !is_change(&self.next()) {}
    }
}

impl Drop for Case {
    fn drop(&mut self) {
        self.watcher = None;
        let _ = fs::remove_dir_all(self.path.parent().expect("a folder"));
    }
}

#[test]
fn reached_watch_limit_is_reported_and_folders_are_polled_meanwhile() {
    let case = Case::new(Some(|| ErrorKind::MaxFilesWatch), 0);
    let why = case.trouble().expect("trouble");
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
    let told: Vec<News> = case.news.try_iter().collect();
    let mut changes = told.iter().filter(|n| matches!(n, News::Changed(..)));
    assert_eq!(changes.next(), None);
    *case.refuses.lock().expect("unharmed") = None;
    assert_eq!(case.trouble(), None);
    case.save_is_seen("last");
}

#[test]
fn unlistable_folder_is_reported_with_help() {
    let denied = || ErrorKind::Io(io::ErrorKind::PermissionDenied.into());
    let case = Case::new(Some(denied), 0);
    let why = case.trouble().expect("trouble");
    let folder = case.path.parent().expect("a folder").display().to_string();
    assert!(why.contains(&format!("`chmod u+r {folder}`")), "{why}");
    case.save_is_seen("second");
}

#[cfg(target_os = "linux")]
#[test]
fn retries_when_no_watcher_is_available() {
    let case = Case::new(None, 2);
    let why = case.trouble().expect("trouble");
    assert!(why.contains("fs.inotify.max_user_instances="), "{why}");
    let (mut is_seen, mut is_over) = (false, false);
    for round in 0.. {
        if is_seen && is_over {
            break;
        }
        case.save(&format!("round {round}"));
        match case.next() {
            News::Changed(..) => is_seen = true,
            News::Trouble(why) => is_over = why.is_none(),
        }
    }
    case.save_is_seen("last");
}
