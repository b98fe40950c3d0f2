//! Compiled pipelines that are kept between runs: the driver's data, in a file for each adapter, driver and version of
//! Reflet.
//!
//! A driver trusts these bytes, so a file is handed over only if this user alone can write to it, and if it is
//! complete and of the same adapter and driver. In all other cases, and where nothing can be written, pipelines are
//! compiled as without a file.

use std::{
    fs::{self, DirEntry},
    io::{self, Error, ErrorKind},
    path::{Path, PathBuf},
    time::SystemTime,
};

use xxhash_rust::xxh3::xxh3_128;

use super::wait::block_on;
#[cfg(not(target_arch = "wasm32"))]
use reflet_base::cache::is_private;
use reflet_base::files::{Goal, Temporary, open_regular, read_at_most};

/// Extension of the files.
pub const EXTENSION: &str = "pipelines";

/// Maximum number of bytes of a file; pipelines that need more are forgotten, as none of them can be removed alone.
const MOST_BYTES: u64 = 64 << 20;

/// Maximum number of bytes of all files in the folder, of all adapters and drivers; the file that was written longest
/// ago is removed first.
pub const MOST_BYTES_OF_ALL: u64 = 4 * MOST_BYTES;

/// First bytes of a file, with the version of its format.
const MAGIC: [u8; 8] = *b"reflet\0\x01";

/// Magic, hash of adapter and driver, hash of the driver's bytes.
const HEADER_BYTES: usize = MAGIC.len() + 2 * size_of::<u128>();

/// The file of an adapter and driver.
#[derive(Debug)]
struct KeptFile {
    path: PathBuf,
    /// Hash of everything that the driver's bytes are valid for.
    made_by: u128,
}

impl KeptFile {
    /// The file in `folder` for this adapter; `None` where its API has no such bytes.
    fn new(folder: &Path, adapter: &wgpu::AdapterInfo) -> Option<Self> {
        let key = wgpu::util::pipeline_cache_key(adapter)?;
        let version = env!("CARGO_PKG_VERSION");
        let made_by = xxh3_128(format!("{version} {adapter:?}").as_bytes());
        Some(Self {
            path: folder.join(format!("{key}-{made_by:032x}.{EXTENSION}")),
            made_by,
        })
    }

    /// The driver's bytes.
    ///
    /// # Errors
    /// The system's error; a file that others can write to, that is not whole, or that another driver made.
    fn read(&self) -> io::Result<Vec<u8>> {
        let file = open_regular(&self.path, false)?;
        #[cfg(not(target_arch = "wasm32"))] // a page keeps none
        if !is_private(&file.metadata()?) {
            return Err(ErrorKind::PermissionDenied.into());
        }
        let mut bytes = read_at_most(&file, MOST_BYTES)?;
        if bytes.len() < HEADER_BYTES {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        let data = bytes.split_off(HEADER_BYTES);
        match bytes == self.header(&data) {
            true => Ok(data),
            false => Err(Error::from(ErrorKind::InvalidData)),
        }
    }

    fn header(&self, data: &[u8]) -> Vec<u8> {
        let hashes = [self.made_by, xxh3_128(data)].map(u128::to_le_bytes);
        [&MAGIC[..], hashes.as_flattened()].concat()
    }

    /// Writes the driver's bytes, or removes the file where they are too many; older files go if all together are too
    /// large.
    ///
    /// # Errors
    /// The system's error; the file is then as before.
    fn write(&self, data: &[u8]) -> io::Result<()> {
        let bytes = [&self.header(data), data].concat();
        if bytes.len() as u64 > MOST_BYTES {
            return fs::remove_file(&self.path);
        }
        (Temporary::create_private(&Goal::in_folder(&self.path))?.fill(&bytes)?).persist()?;
        let folder = self.path.parent().unwrap_or(Path::new("."));
        remove_oldest(folder, MOST_BYTES_OF_ALL)
    }
}

/// Removes the files that were written longest ago until the others have at most `most` bytes.
fn remove_oldest(folder: &Path, most: u64) -> io::Result<()> {
    let kept = |entry: &DirEntry| entry.path().extension().is_some_and(|e| e == EXTENSION);
    let of = |entry: DirEntry| {
        let found = entry.metadata().ok()?;
        Some((found.modified().ok()?, found.len(), entry.path()))
    };
    let entries = fs::read_dir(folder)?.flatten().filter(kept);
    let mut files: Vec<(SystemTime, u64, PathBuf)> = entries.filter_map(of).collect();
    files.sort();
    let mut sum: u64 = files.iter().map(|(_, bytes, _)| bytes).sum();
    for (_, bytes, path) in files {
        if sum <= most {
            break;
        }
        fs::remove_file(path)?;
        sum -= bytes;
    }
    Ok(())
}

/// Pipelines of a device that are kept between runs.
#[derive(Debug)]
pub(super) struct KeptPipelines {
    /// The driver's store, to which new pipelines are added.
    pub cache: wgpu::PipelineCache,
    file: KeptFile,
    /// Hash of the driver's bytes as they were opened.
    opened: Option<u128>,
}

impl KeptPipelines {
    /// Opens the pipelines that earlier runs left in `folder`; `None` where the device has no such store.
    pub fn open(device: &wgpu::Device, adapter: &wgpu::AdapterInfo, folder: &Path) -> Option<Self> {
        let file = KeptFile::new(folder, adapter)?;
        if !device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
        let data = file.read().ok();
        let descriptor = wgpu::PipelineCacheDescriptor {
            label: Some("kept pipelines"),
            data: data.as_deref(),
            fallback: true,
        };
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        #[expect(
            unsafe_code,
            reason = "a driver is handed bytes that it trusts, which spares compiling in every run"
        )]
        // SAFETY: the same version of the same driver returned these bytes for the same adapter, by hash, in a file
        // that only this user can write to.
        let cache = unsafe { device.create_pipeline_cache(&descriptor) };
        if block_on(scope.pop()).is_some() {
            return None;
        }
        Some(Self {
            opened: cache.get_data().as_deref().map(xxh3_128),
            cache,
            file,
        })
    }

    /// Writes the pipelines, if the driver has more to store than at the start.
    pub fn save(&self) {
        let Some(data) = self.cache.get_data() else {
            return;
        };
        if self.opened != Some(xxh3_128(&data)) {
            // The next run compiles again what cannot be written, such as to a full disk.
            let _ = self.file.write(&data);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(driver_info: &str) -> wgpu::AdapterInfo {
        let mut adapter =
            wgpu::AdapterInfo::new(wgpu::DeviceType::DiscreteGpu, wgpu::Backend::Vulkan);
        driver_info.clone_into(&mut adapter.driver_info);
        adapter
    }

    #[test]
    fn only_what_the_same_driver_wrote_whole_is_read() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let file = KeptFile::new(folder, &adapter("1.0")).expect("Vulkan has a key");
        assert!(file.read().is_err(), "there is none yet");
        file.write(b"pipelines").expect("writable");
        assert_eq!(file.read().expect("whole"), b"pipelines");
        let whole = fs::read(&file.path).expect("readable");
        for length in 0..whole.len() {
            fs::write(&file.path, &whole[..length]).expect("writable");
            assert!(file.read().is_err(), "cut at {length}");
        }
        for at in 0..whole.len() {
            let mut broken = whole.clone();
            broken[at] ^= 1;
            fs::write(&file.path, broken).expect("writable");
            assert!(file.read().is_err(), "changed at {at}");
        }
        fs::write(&file.path, [&whole[..], b"x"].concat()).expect("writable");
        assert!(file.read().is_err(), "longer");

        let other = KeptFile::new(folder, &adapter("1.1")).expect("Vulkan has a key");
        assert_ne!(file.path, other.path);
        fs::write(&other.path, &whole).expect("writable");
        assert!(other.read().is_err(), "another driver's");

        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt as _;
            file.write(b"pipelines").expect("writable");
            file.read().expect("its owner alone can write it");
            let others = fs::Permissions::from_mode(0o666);
            fs::set_permissions(&file.path, others).expect("its mode");
            assert!(file.read().is_err(), "others can write it");
        }
    }

    #[test]
    fn what_cannot_be_kept_leaves_no_file() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let file = KeptFile::new(folder, &adapter("")).expect("Vulkan has a key");
        file.write(b"few").expect("writable");
        let most = usize::try_from(MOST_BYTES).expect("64-bit");
        file.write(&vec![0; most]).expect("removed");
        assert!(!file.path.exists(), "too many bytes");

        let names = ["a", "b", "c"].map(|name| folder.join(name).with_extension(EXTENSION));
        for name in &names {
            fs::write(name, [0; 100]).expect("writable");
        }
        let past = SystemTime::UNIX_EPOCH;
        let oldest = fs::File::options().append(true).open(&names[1]);
        (oldest.and_then(|file| file.set_modified(past))).expect("its time can be set");
        remove_oldest(folder, 250).expect("removable");
        assert_eq!(names.map(|name| name.exists()), [true, false, true]);

        fs::remove_dir_all(folder).expect("removable");
        assert!(file.write(b"few").is_err(), "no folder");
        assert!(!folder.exists());
    }
}
