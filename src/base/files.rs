//! Writes files atomically, so that each is either complete or absent, and reads only regular files up to a maximum
//! size.

mod below;
mod folder;
mod goal;
pub mod in_memory;
#[cfg(not(target_arch = "wasm32"))]
mod replace;
mod similar;

use std::{
    collections::HashSet,
    ffi::{OsStr, OsString},
    fs,
    io::{self, Read, Write as _},
    path::{Path, PathBuf},
    sync::{LazyLock, Mutex, PoisonError},
    time::{Duration, SystemTime},
};

use sha2::{Digest as _, Sha256};
use xxhash_rust::xxh3::{Xxh3Default, xxh3_64};

pub use below::{entries_below, has_extension, path_below};
use folder::Folder;
pub use goal::{Goal, Inputs};
#[cfg(target_arch = "wasm32")]
pub use in_memory::{File, canonicalize, metadata};
#[cfg(not(target_arch = "wasm32"))]
pub use replace::replace_content;
pub use similar::similar;
#[cfg(not(target_arch = "wasm32"))]
pub use std::fs::{File, canonicalize, metadata};

/// Coarsest clock tick of common file systems.
const CLOCK_TICK: Duration = Duration::from_millis(50);
/// Age below which a file may change again with the same time stamp: longer than the coarsest tick of any file
/// system (2 s on FAT).
const FRESH: Duration = Duration::from_secs(3);

/// Writes `bytes` to a temporary file beside `goal`, syncs it to the disk and renames it to `goal`; the old content
/// stays complete until then.
///
/// # Errors
/// Same errors as [`Goal::check`], a folder that cannot be written to, or a full disk; no temporary file is left
/// behind.
pub fn write_whole(goal: &Goal, bytes: &[u8]) -> io::Result<()> {
    Temporary::create(goal)?.fill(bytes)?.persist()
}

/// Writes as [`write_whole`] does, where nothing is yet.
///
/// # Errors
/// Same errors, and anything at the target, which stays.
pub fn write_new(goal: &Goal, bytes: &[u8]) -> io::Result<()> {
    static TURN: Mutex<()> = Mutex::new(()); // temporary files of this process for one target have one name
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let temporary = Temporary::create(goal)?.fill(bytes)?;
    temporary.folder.create(&temporary.goal, false)?; // takes the name
    temporary.persist()
}

/// Writes several files, none of which gets its name before all are complete and on the disk.
///
/// # Errors
/// The path of the file that cannot be written, with the system's error; no file is then new, unless renaming itself
/// fails.
pub fn write_together(files: &[(Goal, Vec<u8>)]) -> Result<(), (PathBuf, io::Error)> {
    let mut finished = Vec::new();
    for (goal, bytes) in files {
        let temporary = Temporary::create(goal).and_then(|temporary| temporary.fill(bytes));
        finished.push((
            goal,
            temporary.map_err(|error| (goal.to_path_buf(), error))?,
        ));
    }
    for (goal, temporary) in finished {
        let renamed = temporary.persist();
        renamed.map_err(|error| (goal.to_path_buf(), error))?;
    }
    Ok(())
}

/// Opens a file for reading, and for appending where `appends`, then through no link. A pipe would block and a device
/// never end, so the file type is checked before opening.
///
/// # Errors
/// The system's error, or a path that is not a regular file.
pub fn open_regular(path: &Path, appends: bool) -> io::Result<File> {
    if !metadata(path)?.is_file() {
        let message = "it is not a regular file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    #[cfg(target_arch = "wasm32")]
    return match appends {
        true => Err(io::ErrorKind::Unsupported.into()),
        false => File::open(path),
    };
    #[cfg(not(target_arch = "wasm32"))]
    open_by_system(path, appends)
}

#[cfg(not(target_arch = "wasm32"))]
fn open_by_system(path: &Path, appends: bool) -> io::Result<File> {
    let mut options = fs::OpenOptions::new();
    if appends {
        follow_no_link(&mut options);
    }
    options.read(true).append(appends).open(path)
}

/// Reads all of a file.
///
/// # Errors
/// The system's error, or a file of more than `most` bytes.
pub fn read_at_most(file: &File, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let message = match most >> 20 {
            0 => format!("it is longer than {} KiB", most >> 10),
            mebibytes => format!("it is longer than {mebibytes} MiB"),
        };
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, message));
    }
    Ok(bytes)
}

/// SHA-256 hash of a file's content.
///
/// # Errors
/// The system's error, or a path that is not a regular file.
pub fn content_hash(path: &Path) -> io::Result<[u8; 32]> {
    let mut file = open_regular(path, false)?;
    let mut hash = Sha256::new();
    let mut block = vec![0; 1 << 16];
    loop {
        match file.read(&mut block)? {
            0 => return Ok(hash.finalize().into()),
            length => hash.update(&block[..length]),
        }
    }
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Whether the file's content or name changed after `since`, as far as its modification and inode change times tell.
pub fn written_since(path: &Path, since: SystemTime) -> bool {
    let Ok(metadata) = fs::metadata(path) else {
        return false;
    };
    let since = since.checked_sub(CLOCK_TICK).unwrap_or(since);
    let modified = metadata.modified().is_ok_and(|time| time >= since);
    #[cfg(unix)]
    let moved = {
        use std::os::unix::fs::MetadataExt as _;
        let seconds = Duration::from_secs(metadata.ctime().max(0).unsigned_abs());
        let time = SystemTime::UNIX_EPOCH + seconds;
        time + Duration::from_nanos(metadata.ctime_nsec().max(0).unsigned_abs()) >= since
    };
    #[cfg(not(unix))]
    let moved = false;
    modified || moved
}

/// Metadata of a file, compared to notice that it changed without reading it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stamp {
    length: u64,
    modified: Option<SystemTime>,
    /// Inode number, and seconds and nanoseconds of the inode's last change.
    #[cfg(unix)]
    inode: (u64, i64, i64),
}

impl Stamp {
    /// Stamp of an existing file; `None` where it is missing.
    pub fn read(path: &Path) -> Option<Self> {
        #[cfg(unix)]
        use std::os::unix::fs::MetadataExt as _;
        let metadata = fs::metadata(path).ok()?;
        Some(Self {
            length: metadata.len(),
            modified: metadata.modified().ok(),
            #[cfg(unix)]
            inode: (metadata.ino(), metadata.ctime(), metadata.ctime_nsec()),
        })
    }

    /// Whether the file's content may differ from when it had the stamp `before` (`None`: it was missing). A file
    /// can change twice within a tick of the clock, so a file written within the last seconds may always differ.
    pub fn may_differ(before: Option<&Self>, path: &Path) -> bool {
        let now = Self::read(path);
        let written = now.as_ref().and_then(|stamp| stamp.modified);
        // A time that is still to come says nothing: the clock was set back.
        let is_fresh = |time: SystemTime| time.elapsed().map_or(true, |age| age < FRESH);
        before != now.as_ref() || written.is_some_and(is_fresh)
    }
}

/// Reads a whole text file of at most `most` bytes.
///
/// # Errors
/// Same errors as [`open_regular`] and [`read_at_most`], and a file that is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let bytes = read_at_most(&open_regular(path, false)?, most)?;
    String::from_utf8(bytes).map_err(|_| io::Error::other("it is not UTF-8 text"))
}

/// A temporary file under a hidden name beside its target path; deleted on drop unless it was renamed.
#[derive(Debug)]
pub struct Temporary {
    folder: Folder,
    /// Name of the target in the folder.
    goal: OsString,
    name: OsString,
    /// Open file to write to.
    pub file: fs::File,
    renamed: bool,
}

impl Temporary {
    /// Creates the temporary file beside the target, or beside the file that a typed link leads to.
    ///
    /// # Errors
    /// Same errors as [`Goal::check`], or the system's error.
    pub fn create(goal: &Goal) -> io::Result<Self> {
        Self::open(goal, false)
    }

    /// Creates the temporary file so that only its owner can read it.
    ///
    /// # Errors
    /// Same errors as [`Temporary::create`].
    pub fn create_private(goal: &Goal) -> io::Result<Self> {
        Self::open(goal, true)
    }

    fn open(goal: &Goal, is_private: bool) -> io::Result<Self> {
        goal.check()?;
        let (folder, goal) = goal.opened()?;
        let name = hidden_name(&goal);
        // A leftover of a killed run may have this name.
        let _ = folder.remove(&name);
        Ok(Self {
            file: folder.create(&name, is_private)?,
            folder,
            goal,
            name,
            renamed: false,
        })
    }

    /// Writes all bytes and syncs them to the disk.
    ///
    /// # Errors
    /// The system's error.
    pub fn fill(mut self, bytes: &[u8]) -> io::Result<Self> {
        self.file.write_all(bytes)?;
        self.file.sync_all()?;
        Ok(self)
    }

    /// Renames the temporary file to its target path.
    ///
    /// # Errors
    /// The system's error.
    pub fn persist(mut self) -> io::Result<()> {
        self.folder.rename(&self.name, &self.goal)?;
        self.renamed = true;
        Ok(())
    }
}

/// Brings the new name of a file or folder to the disk, so that it survives a crash; only Unix can sync a folder.
///
/// # Errors
/// The system's error.
pub fn sync_name(path: &Path) -> io::Result<()> {
    if cfg!(unix) {
        fs::File::open(folder_of(path))?.sync_all()?;
    }
    Ok(())
}

/// Path beside `goal` of an unfinished file of this process; [`sweep`] removes it if the process was killed.
pub fn hidden_path(goal: &Path) -> PathBuf {
    folder_of(goal).join(hidden_name(goal.file_name().unwrap_or_default()))
}

/// Name of an unfinished file of this process, for a target of this name.
fn hidden_name(goal: &OsStr) -> OsString {
    let [start, place] = [goal_name(goal), place_name()];
    format!("{start}-{place}-{}.tmp", std::process::id()).into()
}

/// Hash of where process numbers are unique: this boot of this machine, and this container. Where the system does
/// not tell, the hash is of the current time, so it matches this process alone.
static PLACE: LazyLock<u64> = LazyLock::new(|| {
    let boot = fs::read("/proc/sys/kernel/random/boot_id").ok();
    let space = fs::read_link("/proc/self/ns/pid").ok();
    let mut hash = Xxh3Default::new();
    match boot.zip(space) {
        Some((boot, space)) => {
            hash.update(&boot);
            hash.update(space.as_os_str().as_encoded_bytes());
        }
        None => {
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
            hash.update(&now.unwrap_or_default().as_nanos().to_le_bytes());
        }
    }
    hash.digest()
});

/// Prefix of the hidden name of a temporary file for `goal`; its length does not depend on the name of `goal`.
fn goal_name(goal: &OsStr) -> String {
    format!(".reflet-{:016x}", xxh3_64(goal.as_encoded_bytes()))
}

/// Middle part of a hidden name, between the hash of the target name and the process number.
fn place_name() -> String {
    format!("{:016x}", *PLACE)
}

/// Whether a file or folder has a name of [`hidden_path`].
pub fn is_hidden_name(name: &str) -> bool {
    name.starts_with(".reflet-") && hidden_parts(name).is_some()
}

/// Age at which a temporary file counts as abandoned: no run goes that long without writing to its file.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Removes temporary files and folders of killed runs beside these target paths. Whether a run is alive can be checked
/// on Linux only, for processes of this machine, container and boot; elsewhere a temporary file is removed a day after
/// the last write to it.
pub fn sweep(goals: &[Goal]) {
    let opened = goals.iter().filter_map(|goal| goal.opened().ok());
    let opened = opened.map(|(folder, goal)| (goal_name(&goal), folder.path().to_owned()));
    let (of_goals, folders): (HashSet<_>, HashSet<_>) = opened.unzip();
    let here = place_name();
    let entries = folders.into_iter().filter_map(|f| fs::read_dir(f).ok());
    for entry in entries.flatten().flatten() {
        let name = entry.file_name();
        let Some((goal, place, id)) = name.to_str().and_then(hidden_parts) else {
            continue;
        };
        let is_left = if cfg!(target_os = "linux") && place == here {
            !Path::new("/proc").join(id.to_string()).exists()
        } else {
            is_abandoned(&entry)
        };
        if is_left && of_goals.contains(goal) {
            // A leftover is harmless, so errors are ignored.
            let _ = match entry.file_type() {
                Ok(kind) if kind.is_dir() => fs::remove_dir_all(entry.path()),
                _ => fs::remove_file(entry.path()),
            };
        }
    }
}

/// Target hash, place hash and process number of a hidden name.
fn hidden_parts(name: &str) -> Option<(&str, &str, u32)> {
    let mut parts = name.strip_suffix(".tmp")?.rsplitn(3, '-');
    let id = parts.next()?.parse().ok()?;
    let place = parts.next()?;
    Some((parts.next()?, place, id))
}

/// Whether a file was last written to more than [`ABANDONED`] ago; false for links.
fn is_abandoned(entry: &fs::DirEntry) -> bool {
    let written = entry.metadata().and_then(|of| of.modified());
    let age = written.ok().and_then(|time| time.elapsed().ok());
    age.is_some_and(|age| age > ABANDONED)
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // Errors cannot be returned from `drop`, and the next run overwrites the file.
            let _ = self.folder.remove(&self.name);
        }
    }
}

/// Parent folder of a file.
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

impl Temporary {
    /// Path of the temporary file until it is renamed.
    pub fn path(&self) -> PathBuf {
        self.folder.path().join(&self.name)
    }
}

/// Bytes that can be written below a folder; `None` where the system does not tell.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    #[cfg(unix)]
    {
        let found = rustix::fs::statvfs(folder).ok()?;
        found.f_bavail.checked_mul(found.f_frsize)
    }
    #[cfg(not(unix))]
    {
        let _ = folder;
        None
    }
}

#[cfg(not(target_arch = "wasm32"))]
/// Has a file opened only if its path does not end in a link; other systems than Unix do not tell.
fn follow_no_link(options: &mut fs::OpenOptions) {
    #[cfg(unix)]
    {
        use std::os::unix::fs::OpenOptionsExt as _;
        options.custom_flags(rustix::fs::OFlags::NOFOLLOW.bits().cast_signed());
    }
    let _ = options;
}
