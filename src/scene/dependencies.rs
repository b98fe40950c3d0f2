//! List of the files that were read or looked for, so that they can be watched for changes.

use std::{
    path::PathBuf,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use reflet_base::files::Stamp;

/// Paths of all files that were read or looked for, as they were named: links are not resolved, and the
/// files need not exist. Clones share one list.
#[derive(Clone, Debug, Default)]
pub struct Dependencies(Arc<Mutex<Vec<Dependency>>>);

#[derive(Clone, Debug)]
struct Dependency {
    path: PathBuf,
    /// Stamp before the file was read; `None` if it was missing.
    stamp: Option<Stamp>,
}

impl Dependencies {
    /// Adds a file, once; it must not have been read before.
    pub fn add(&self, path: PathBuf) {
        let mut list = self.list();
        if list.iter().all(|known| known.path != path) {
            let stamp = Stamp::read(&path);
            list.push(Dependency { path, stamp });
        }
    }

    /// Paths of all files that were looked for so far.
    pub fn paths(&self) -> Vec<PathBuf> {
        self.list().iter().map(|known| known.path.clone()).collect()
    }

    /// First file that was saved, replaced, created or deleted since it was added. Only what the file system tells of
    /// the file is compared, never the clock, which may have been set in between.
    pub fn changed(&self) -> Option<PathBuf> {
        let list = self.list();
        let changed = list
            .iter()
            .find(|known| Stamp::read(&known.path) != known.stamp);
        changed.map(|known| known.path.clone())
    }

    /// Adds the files of another list, with the stamps that they have there.
    pub fn extend(&self, other: &Self) {
        if Arc::ptr_eq(&self.0, &other.0) {
            return;
        }
        let mut list = self.list();
        for new in other.list().iter() {
            if list.iter().all(|known| known.path != new.path) {
                list.push(new.clone());
            }
        }
    }

    fn list(&self) -> MutexGuard<'_, Vec<Dependency>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::{
        fs,
        time::{Duration, SystemTime},
    };

    use super::*;

    #[test]
    fn changes_are_found_whatever_the_clock_says() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let [file, missing] = ["a.toml", "b.toml"].map(|name| folder.join(name));
        let hour = Duration::from_secs(3600);
        for written in [SystemTime::now() + hour, SystemTime::now() - hour] {
            fs::write(&file, "old").expect("writable");
            let set = |time| {
                let opened = fs::File::options().write(true).open(&file);
                opened.expect("there").set_modified(time).expect("settable");
            };
            // In the future, as after a clock was set back, and long ago.
            set(written);
            let known = Dependencies::default();
            known.add(file.clone());
            known.add(missing.clone());
            assert_eq!(known.changed(), None);
            // A save with any time counts, also when the file is renamed over the old one.
            fs::write(folder.join("new"), "new").expect("writable");
            fs::rename(folder.join("new"), &file).expect("renamed");
            set(written);
            assert_eq!(known.changed(), cfg!(unix).then(|| file.clone()));
            fs::write(&file, "longer").expect("writable");
            assert_eq!(known.changed(), Some(file.clone()));
            let known = Dependencies::default();
            known.add(missing.clone());
            fs::write(&missing, "").expect("writable");
            assert_eq!(known.changed(), Some(missing.clone()));
            fs::remove_file(&missing).expect("there");
        }
    }
}
