//! Writes files so that they are either whole or not there; reads only what is a file and ends.

use std::{
    collections::HashSet,
    fs::{self, File, OpenOptions},
    io::{self, Read, Write as _},
    path::{Path, PathBuf},
    sync::LazyLock,
    time::{Duration, SystemTime},
};

use sha2::{Digest as _, Sha256};
use xxhash_rust::xxh3::{Xxh3Default, xxh3_64};

/// Clocks of file systems tick this coarsely.
const CLOCK_TICK: Duration = Duration::from_millis(50);
/// Longer than any clock of a file system takes for a tick: two seconds on FAT.
const FRESH: Duration = Duration::from_secs(3);

/// Writes `bytes` beside `path`, syncs them to the disk and moves them there in one step; what
/// was at `path` stays whole until then.
///
/// # Errors
/// When the folder cannot be written to or the disk is full; nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.file_name().is_none() {
        let message = "the path has no file name";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    Temporary::create(path)?.fill(bytes)?.rename_to(path)
}

/// Writes several files, none of which gets its name before all are complete and on the disk.
///
/// # Errors
/// The file that cannot be written, and what the system says; none of them is then new, unless the
/// last step itself fails.
pub fn write_together(files: &[(PathBuf, Vec<u8>)]) -> Result<(), (PathBuf, io::Error)> {
    let mut finished = Vec::new();
    for (path, bytes) in files {
        let temporary = Temporary::create(path).and_then(|temporary| temporary.fill(bytes));
        finished.push((path, temporary.map_err(|error| (path.clone(), error))?));
    }
    for (path, temporary) in finished {
        let renamed = temporary.rename_to(path);
        renamed.map_err(|error| (path.clone(), error))?;
    }
    Ok(())
}

/// Opens a file to be read, and to be appended to where `appends`. A pipe would block and a device
/// never end, so the kind is checked before opening.
///
/// # Errors
/// What the system says, and what is no regular file.
pub fn open_regular(path: &Path, appends: bool) -> io::Result<File> {
    if !fs::metadata(path)?.is_file() {
        let message = "it is not a regular file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    OpenOptions::new().read(true).append(appends).open(path)
}

/// Reads all of a file.
///
/// # Errors
/// What the system says, and a file of more than `most` bytes.
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

/// The SHA-256 of a file's content.
///
/// # Errors
/// What the system says, and what is no regular file.
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

/// Whether content or name of the file changed since then, as far as its times tell.
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

/// What the system says of a file without reading it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stamp {
    length: u64,
    modified: Option<SystemTime>,
    /// Of the inode: its number and when it was last changed.
    #[cfg(unix)]
    inode: (u64, i64, i64),
}

impl Stamp {
    /// Of a file that is there.
    pub fn of(path: &Path) -> Option<Self> {
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

    /// Whether the file's content may be another than when it had this stamp, or none. Within a tick
    /// of the clock it may change twice, so what was written just now may always.
    pub fn may_differ(before: Option<&Self>, path: &Path) -> bool {
        let now = Self::of(path);
        let written = now.as_ref().and_then(|stamp| stamp.modified);
        let age = written.and_then(|time| time.elapsed().ok());
        before != now.as_ref() || age.is_some_and(|age| age < FRESH)
    }
}

/// Reads all of a text.
///
/// # Errors
/// As [`open_regular`] and [`read_at_most`], and what is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    let bytes = read_at_most(&open_regular(path, false)?, most)?;
    String::from_utf8(bytes).map_err(|_| io::Error::other("it is not UTF-8 text"))
}

/// A file under a hidden name beside its goal; gone unless it is renamed.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
    /// Where to write.
    pub file: File,
    renamed: bool,
}

impl Temporary {
    /// Creates it beside `goal`.
    ///
    /// # Errors
    /// What the system says.
    pub fn create(goal: &Path) -> std::io::Result<Self> {
        if goal.is_dir() {
            let message = "a folder is there";
            return Err(io::Error::new(io::ErrorKind::IsADirectory, message));
        }
        let [start, place] = [goal_name(goal), place_name()];
        let name = format!("{start}-{place}-{}.tmp", std::process::id());
        let path = folder_of(goal).join(name);
        // A leftover of a killed run may have this name; `create_new` never follows a link.
        let _ = fs::remove_file(&path);
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&path)?;
        Ok(Self {
            path,
            file,
            renamed: false,
        })
    }

    /// Writes all of it, to the disk.
    ///
    /// # Errors
    /// What the system says.
    pub fn fill(mut self, bytes: &[u8]) -> std::io::Result<Self> {
        self.file.write_all(bytes)?;
        self.file.sync_all()?;
        Ok(self)
    }

    /// Gives it its name.
    ///
    /// # Errors
    /// What the system says.
    pub fn rename_to(mut self, goal: &Path) -> std::io::Result<()> {
        fs::rename(&self.path, goal)?;
        self.renamed = true;
        // The new name itself must survive a crash too; only Unix can sync a folder.
        if cfg!(unix) {
            File::open(folder_of(goal))?.sync_all()?;
        }
        Ok(())
    }
}

/// Where process numbers mean the same: this boot of this machine, and this container. Where the
/// system does not tell, it is this process alone.
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

/// What a hidden name beside `goal` begins with. It is short however long the goal's name is.
fn goal_name(goal: &Path) -> String {
    let name = goal.file_name().unwrap_or_default().as_encoded_bytes();
    format!(".reflet-{:016x}", xxh3_64(name))
}

/// What follows it, before the number of the process.
fn place_name() -> String {
    format!("{:016x}", *PLACE)
}

/// Longer than any run goes without writing to its file: an older temporary file has no live owner.
const ABANDONED: Duration = Duration::from_secs(24 * 3600);

/// Removes temporary files of killed runs beside these files. Whether a run is alive can be checked on
/// Linux, for this machine, container and boot only; elsewhere its files are removed a day after the
/// last write.
pub fn sweep(goals: &[PathBuf]) {
    let of_goals: HashSet<_> = goals.iter().map(|goal| goal_name(goal)).collect();
    let folders: HashSet<_> = goals.iter().map(|goal| folder_of(goal)).collect();
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
            let _ = fs::remove_file(entry.path()); // nobody waits for it
        }
    }
}

/// Goal, place and process of a hidden name.
fn hidden_parts(name: &str) -> Option<(&str, &str, u32)> {
    let mut parts = name.strip_suffix(".tmp")?.rsplitn(3, '-');
    let id = parts.next()?.parse().ok()?;
    let place = parts.next()?;
    Some((parts.next()?, place, id))
}

/// Whether a file has not been written to for long; false for links.
fn is_abandoned(entry: &fs::DirEntry) -> bool {
    let written = entry.metadata().and_then(|of| of.modified());
    let age = written.ok().and_then(|time| time.elapsed().ok());
    age.is_some_and(|age| age > ABANDONED)
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // Nobody is left to tell, and the next run overwrites it.
            let _ = fs::remove_file(&self.path);
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
    /// Where it is until it is renamed.
    pub fn path(&self) -> &Path {
        &self.path
    }
}
