//! The bytes of a document's buffers: GLB's chunk, `data:` URIs and files beside it.

use std::path::{Path, PathBuf};

use super::{
    Fault, Notes,
    budget::GeometryBudget,
    container::Bytes,
    schema::{Buffer, Root},
    uri::{self, Sandbox},
};

/// The data of every buffer, `None` without a URI or GLB chunk; files that were read are added to `files`. A buffer may
/// have fewer bytes than it says, which is a warning.
pub fn read(
    root: &Root,
    mut binary: Option<Bytes>,
    folder: &Path,
    sandbox: &Sandbox,
    files: &mut Vec<PathBuf>,
    notes: &mut Notes,
    budget: &GeometryBudget,
) -> Result<Vec<Option<Bytes>>, Fault> {
    let mut buffers = Vec::with_capacity(root.buffers.len());
    for (i, buffer) in root.buffers.iter().enumerate() {
        let chunk = if i == 0 { binary.take() } else { None };
        let bytes = read_one(buffer, chunk, folder, sandbox, files);
        let bytes = bytes.and_then(|bytes| {
            // A chunk of the file was taken with it.
            let own = bytes.as_ref().filter(|_| buffer.uri.is_some());
            budget.take_file(own.map_or(0, |bytes| bytes.len()))?;
            Ok(bytes)
        });
        let bytes = bytes.map_err(|f| f.placed(&format!("buffer {i}")))?;
        if let Some(got) = bytes.as_ref().map(|bytes| bytes.len() as u64)
            && got < buffer.byte_length
        {
            let place = format!("buffer {i} of {} bytes has {got}", buffer.byte_length);
            notes.add(
                "buffer-short",
                1,
                "buffers end before their byteLength",
                &place,
            );
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn read_one(
    buffer: &Buffer,
    chunk: Option<Bytes>,
    folder: &Path,
    sandbox: &Sandbox,
    files: &mut Vec<PathBuf>,
) -> Result<Option<Bytes>, Fault> {
    Ok(match buffer.uri.as_deref().map(uri::parse).transpose()? {
        None => chunk,
        Some(uri::Target::Data(bytes)) => Some(Bytes::new(bytes)),
        Some(uri::Target::Relative(name)) => {
            let path = sandbox.resolve(folder, &name)?;
            let place = || format!("\"{}\"", uri::shorten(&name));
            let bytes = sandbox.read(&path).map_err(|f| f.placed(&place()))?;
            files.push(path);
            Some(Bytes::new(bytes))
        }
    })
}
