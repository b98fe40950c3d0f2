//! Files of a page, which has no disk: bytes by path, below `/`, that the page hands over. The same names as in
//! `std::fs` read them.

use std::{
    cell::RefCell,
    collections::{BTreeMap, BTreeSet},
    io::{self, Cursor, ErrorKind, Read, Seek, SeekFrom},
    mem,
    path::{Component, Path, PathBuf},
    sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard},
};

type Files = BTreeMap<PathBuf, Arc<[u8]>>;

static FILES: RwLock<Files> = RwLock::new(Files::new());

/// Paths that were looked for and are not there, for the page to find.
static MISSING: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Most of them; a script may look for any number.
const MOST_MISSING: usize = 1000;

fn files() -> RwLockReadGuard<'static, Files> {
    FILES.read().unwrap_or_else(PoisonError::into_inner)
}

/// Path from the root without `.` and `..`.
fn whole(path: &Path) -> PathBuf {
    let mut whole = PathBuf::from("/");
    for part in path.components() {
        match part {
            Component::Normal(name) => whole.push(name),
            Component::ParentDir => drop(whole.pop()),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    whole
}

/// Puts a file in its place.
pub fn put(path: &Path, bytes: Vec<u8>) {
    let mut files = FILES.write().unwrap_or_else(PoisonError::into_inner);
    files.insert(whole(path), bytes.into());
}

/// Removes all files.
pub fn clear() {
    let mut files = FILES.write().unwrap_or_else(PoisonError::into_inner);
    files.clear();
}

/// Paths that were looked for since the last call and are not there.
pub fn take_missing() -> BTreeSet<PathBuf> {
    mem::take(&mut MISSING.lock().unwrap_or_else(PoisonError::into_inner))
}

fn not_found(path: PathBuf) -> io::Error {
    let mut missing = MISSING.lock().unwrap_or_else(PoisonError::into_inner);
    if missing.len() < MOST_MISSING {
        missing.insert(path);
    }
    ErrorKind::NotFound.into()
}

/// File of this name in a folder, or in the nearest folder above that has one; it is not looked for elsewhere.
pub fn nearest(folder: &Path, name: &str) -> Option<PathBuf> {
    let (folder, files) = (whole(folder), files());
    let mut places = folder.ancestors().map(|folder| folder.join(name));
    places.find(|path| files.contains_key(path))
}

/// Kind and size of a file or folder.
#[derive(Clone, Copy, Debug)]
pub struct Metadata {
    /// Number of bytes; `None` for a folder.
    bytes: Option<u64>,
}

#[expect(missing_docs, reason = "the names of the standard library")]
#[expect(clippy::len_without_is_empty, reason = "likewise")]
impl Metadata {
    pub fn is_file(&self) -> bool {
        self.bytes.is_some()
    }

    pub fn is_dir(&self) -> bool {
        self.bytes.is_none()
    }

    pub fn len(&self) -> u64 {
        self.bytes.unwrap_or(0)
    }
}

/// Kind and size of a file or folder at a path; folders are there where files are below them.
///
/// # Errors
/// Nothing is there.
pub fn metadata(path: impl AsRef<Path>) -> io::Result<Metadata> {
    let (path, files) = (whole(path.as_ref()), files());
    let bytes = files.get(&path).map(|bytes| bytes.len() as u64);
    let is_folder = || path == Path::new("/") || files.keys().any(|file| file.starts_with(&path));
    match bytes.is_some() || is_folder() {
        true => Ok(Metadata { bytes }),
        false => Err(not_found(path)),
    }
}

/// The one path of a file or folder.
///
/// # Errors
/// Nothing is there.
pub fn canonicalize(path: impl AsRef<Path>) -> io::Result<PathBuf> {
    metadata(&path).map(|_| whole(path.as_ref()))
}

/// A file below a folder; folders are not listed.
#[derive(Debug)]
pub struct DirEntry(PathBuf, Metadata);

#[expect(missing_docs, reason = "the names of walkdir")]
impl DirEntry {
    pub fn path(&self) -> &Path {
        &self.0
    }

    pub fn file_type(&self) -> Metadata {
        self.1
    }
}

/// Files below a folder, by name, to `depth` folders below it; there are no links.
pub fn entries_below(folder: &Path, depth: usize, _: bool) -> impl Iterator<Item = DirEntry> {
    let (files, top) = (files(), whole(folder));
    let below = files.iter().filter_map(|(path, bytes)| {
        let rest = path.strip_prefix(&top).ok()?;
        let bytes = Some(bytes.len() as u64);
        let is_near = (1..=depth + 1).contains(&rest.components().count());
        is_near.then(|| DirEntry(folder.join(rest), Metadata { bytes }))
    });
    below.collect::<Vec<_>>().into_iter()
}

/// A file that is read.
#[derive(Debug)]
pub struct File(RefCell<Cursor<Arc<[u8]>>>);

impl File {
    /// Opens a file.
    ///
    /// # Errors
    /// There is none.
    pub fn open(path: impl AsRef<Path>) -> io::Result<Self> {
        let path = whole(path.as_ref());
        let bytes = files().get(&path).cloned();
        let bytes = bytes.ok_or_else(|| not_found(path))?;
        Ok(Self(RefCell::new(Cursor::new(bytes))))
    }

    /// Its size.
    ///
    /// # Errors
    /// None.
    pub fn metadata(&self) -> io::Result<Metadata> {
        let bytes = Some(self.0.borrow().get_ref().len() as u64);
        Ok(Metadata { bytes })
    }
}

impl Read for &File {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.borrow_mut().read(buffer)
    }
}

impl Read for File {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.0.get_mut().read(buffer)
    }
}

impl Seek for File {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.0.get_mut().seek(to)
    }
}
