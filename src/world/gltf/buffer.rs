//! The bytes of a document's buffers: GLB's chunk, `data:` URIs and files beside it.

use std::path::{Path, PathBuf};

use super::{
    Fault, Notes,
    budget::GeometryBudget,
    container::Bytes,
    schema::{self, Root},
    uri::{self, Sandbox},
};

/// Names of errors of buffers that are not there.
const IS_MISSING: [&str; 5] = [
    "file-not-found",
    "file-unreadable",
    "not-a-file",
    "path-escape",
    "uri-broken",
];

/// The bytes of a buffer, or the error of one that cannot be read; `None` without a URI or GLB chunk.
pub type Buffer = Option<Result<Bytes, Fault>>;

/// The data of every buffer; files that were read are added to `files`. A buffer may have fewer bytes than it says, or
/// be missing where the load forgives that, which are warnings.
pub fn read(
    root: &Root,
    mut binary: Option<Bytes>,
    folder: &Path,
    sandbox: &Sandbox,
    files: &mut Vec<PathBuf>,
    notes: &mut Notes,
    budget: &GeometryBudget,
) -> Result<Vec<Buffer>, Fault> {
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
        let bytes = match bytes.map_err(|f| f.placed(&format!("buffer {i}"))) {
            Err(fault) if root.is_lenient && IS_MISSING.contains(&fault.name) => {
                let what = "buffers cannot be read, and are left out with what they hold";
                notes.add("buffer-left-out", 1, what, &fault.message);
                buffers.push(Some(Err(fault)));
                continue;
            }
            bytes => bytes?,
        };
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
        buffers.push(bytes.map(Ok));
    }
    Ok(buffers)
}

fn read_one(
    buffer: &schema::Buffer,
    chunk: Option<Bytes>,
    folder: &Path,
    sandbox: &Sandbox,
    files: &mut Vec<PathBuf>,
) -> Result<Option<Bytes>, Fault> {
    Ok(match buffer.uri.as_deref().map(uri::parse).transpose()? {
        None => chunk,
        Some(uri::Target::Data(bytes)) => Some(Bytes::new(bytes)),
        Some(uri::Target::Relative(name)) => {
            let path = sandbox.resolve(folder, &name);
            let path = path.map_err(|fault| fault.looked_for_in(folder))?;
            let place = || format!("\"{}\"", uri::shorten(&name));
            let bytes = sandbox.read(&path).map_err(|f| f.placed(&place()))?;
            files.push(path);
            Some(Bytes::new(bytes))
        }
    })
}
