//! Packs: a scene and everything that it reads as one ZIP file, read and written without a disk. The commands `pack` and
//! `unpack` bring them from and to files, and the page that runs by itself from and to its memory.

mod manifest;

use std::io::{self, Read, Seek, Write};

use sha2::{Digest as _, Sha256};
use zip::{ZipArchive, ZipWriter, result::ZipError, write::SimpleFileOptions};

pub use manifest::{LIST, Manifest, PackedFile, fault_of_name};
use reflet_base::files::hex;

/// Reason why bytes are refused as a pack.
#[derive(Debug)]
pub struct Fault(pub String);

impl From<ZipError> for Fault {
    fn from(error: ZipError) -> Self {
        Self(format!("it is not a complete ZIP file: {error}"))
    }
}

/// An untrusted pack that is read.
#[derive(Debug)]
pub struct Pack<R> {
    zip: ZipArchive<R>,
    /// Its checked manifest.
    pub manifest: Manifest,
}

impl<R: Read + Seek> Pack<R> {
    /// Checks the names and lengths of all files of a pack of so many bytes.
    ///
    /// # Errors
    /// Bytes that are no pack, a damaged manifest, files that it does not list, and files that would expand beyond reason.
    pub fn open(from: R, pack_bytes: u64) -> Result<Self, Fault> {
        let mut zip = ZipArchive::new(from)?;
        let manifest = read_list(&mut zip)?;
        match manifest.fault_of_size(pack_bytes) {
            Some(fault) => Err(Fault(fault)),
            None => Ok(Self { zip, manifest }),
        }
    }

    /// Hands over a file of the manifest, block by block.
    ///
    /// # Errors
    /// An error of `take`, and at the end a length or hash that differs from the manifest.
    pub fn extract<E: From<Fault>>(
        &mut self,
        file: &PackedFile,
        take: impl FnMut(&[u8]) -> Result<(), E>,
    ) -> Result<(), E> {
        let name = &file.path;
        let entry = (self.zip.by_name(name))
            .map_err(|error| Fault(format!("\"{name}\" cannot be read: {error}")))?;
        let damaged = |error| Fault(format!("\"{name}\" is damaged: {error}")).into();
        let entry = entry.take(file.bytes.saturating_add(1));
        if copy_hashed(name, entry, damaged, take)? == *file {
            return Ok(());
        }
        let text = format!("\"{name}\" is not what was packed: its length or hash differs");
        Err(Fault(text).into())
    }
}

fn read_list(zip: &mut ZipArchive<impl Read + Seek>) -> Result<Manifest, Fault> {
    let absent = |_| {
        Fault(format!(
            "it has no {LIST}, so `reflet pack` did not write it"
        ))
    };
    let mut text = Vec::new();
    let entry = zip.by_name(LIST).map_err(absent)?;
    let damaged = |error: String| Fault(format!("its {LIST} is damaged: {error}"));
    let read = entry.take(manifest::MOST_BYTES + 1).read_to_end(&mut text);
    read.map_err(|error| damaged(error.to_string()))?;
    if text.len() as u64 > manifest::MOST_BYTES {
        return Err(damaged(format!(
            "it is longer than {} MiB",
            manifest::MOST_BYTES >> 20
        )));
    }
    let manifest: Manifest =
        serde_json::from_slice(&text).map_err(|error| damaged(error.to_string()))?;
    if let Some(fault) = manifest.fault() {
        return Err(Fault(fault));
    }
    match zip.len().checked_sub(manifest.files.len() + 1) {
        Some(0) => Ok(manifest),
        Some(more) => Err(Fault(format!(
            "it holds {more} files that its list does not have"
        ))),
        None => Err(Fault("it lacks files of its list".to_owned())),
    }
}

/// A pack that is written: its files, then the manifest. Equal files give equal bytes.
pub struct PackWriter<W: Write + Seek> {
    zip: ZipWriter<W>,
    /// Manifest with the files so far.
    pub manifest: Manifest,
}

impl<W: Write + Seek> PackWriter<W> {
    /// Begins a pack with a manifest without files.
    pub fn new(goal: W, manifest: Manifest) -> Self {
        let zip = ZipWriter::new(goal);
        Self { zip, manifest }
    }

    /// Adds a file of so many bytes.
    ///
    /// # Errors
    /// Error of the source as `unread` says it, or of the goal as `unwritten` does.
    pub fn add<E>(
        &mut self,
        name: &str,
        bytes: u64,
        from: impl Read,
        unread: impl Fn(io::Error) -> E,
        unwritten: impl Fn(io::Error) -> E,
    ) -> Result<(), E> {
        let is_large = bytes >= u64::from(u32::MAX);
        let options = SimpleFileOptions::default().large_file(is_large);
        let begun = self.zip.start_file(name, options);
        begun.map_err(|error| unwritten(error.into()))?;
        let write = |block: &[u8]| self.zip.write_all(block).map_err(&unwritten);
        let file = copy_hashed(name, from, unread, write)?;
        self.manifest.files.push(file);
        Ok(())
    }

    /// Writes the manifest.
    ///
    /// # Errors
    /// Error of the goal.
    pub fn finish(mut self) -> io::Result<(W, Manifest)> {
        let list = serde_json::to_vec_pretty(&self.manifest)?;
        self.zip.start_file(LIST, SimpleFileOptions::default())?;
        self.zip.write_all(&list)?;
        Ok((self.zip.finish()?, self.manifest))
    }
}

/// Hands over a file block by block, and returns its entry in the manifest.
fn copy_hashed<E>(
    name: &str,
    mut from: impl Read,
    unread: impl Fn(io::Error) -> E,
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<PackedFile, E> {
    let (mut bytes, mut hash, mut block) = (0, Sha256::new(), vec![0; 1 << 16]);
    loop {
        let length = from.read(&mut block).map_err(&unread)?;
        if length == 0 {
            return Ok(PackedFile {
                path: name.to_owned(),
                bytes,
                sha256: hex(&hash.finalize()),
            });
        }
        take(&block[..length])?;
        hash.update(&block[..length]);
        bytes += length as u64;
    }
}
