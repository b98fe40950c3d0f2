//! Packs, and files that the page saves: pictures with their AOVs, and the frames of films, as `reflet render` writes them.

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Display,
    io::{Cursor, Write as _},
    path::Path,
};

use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;
use zip::{CompressionMethod, ZipWriter, write::SimpleFileOptions};

use crate::{Asked, STATE};
use reflet_base::files::{Goal, canonicalize, open_regular};
use reflet_output::{
    frame_name::Template,
    frames::FrameList,
    pack::{Fault, Manifest, Pack, PackWriter, PackedFile},
    picture_file::PictureFile,
};

/// Most bytes of the files of a pack, and of the files that are saved at once.
const MOST_BYTES: u64 = 512 << 20;

/// Files on their way out of a pack or to the user, by name.
pub(crate) type Saving = BTreeMap<String, Vec<u8>>;

/// Error in words, which JavaScript throws.
pub(crate) fn words(error: impl Display) -> String {
    error.to_string()
}

fn check_size(bytes: u64) -> Result<(), String> {
    let fault = || format!("its files are longer than {} MiB", MOST_BYTES >> 20);
    (bytes <= MOST_BYTES).then_some(()).ok_or_else(fault)
}

/// Reads an untrusted pack, and returns its manifest as JSON; [`take`] hands over its files.
///
/// # Errors
/// Bytes that are no pack, or more than a page takes.
#[wasm_bindgen]
pub fn unpack(bytes: Vec<u8>) -> Result<String, String> {
    let length = bytes.len() as u64;
    let mut pack = Pack::open(Cursor::new(bytes), length).map_err(|fault| fault.0)?;
    let manifest = pack.manifest.clone();
    check_size(manifest.total_bytes())?;
    let mut content = |file: &PackedFile| {
        let mut bytes = Vec::new();
        let take = |block: &[u8]| Ok::<_, Fault>(bytes.extend_from_slice(block));
        pack.extract(file, take).map_err(|fault| fault.0)?;
        Ok((file.path.clone(), bytes))
    };
    let files = manifest
        .files
        .iter()
        .map(&mut content)
        .collect::<Result<Saving, String>>()?;
    STATE.with_borrow_mut(|state| state.saving = files);
    Ok(json!(manifest).to_string())
}

/// Hands over a file of the pack that was read last.
#[wasm_bindgen]
pub fn take(name: &str) -> Vec<u8> {
    STATE.with_borrow_mut(|state| state.saving.remove(name).unwrap_or_default())
}

/// Pack of the shown scene, as it was asked for: every file that it reads.
///
/// # Errors
/// No scene is shown.
#[wasm_bindgen]
pub fn pack(asked: &str) -> Result<Vec<u8>, String> {
    let asked = Asked::new(asked);
    STATE.with_borrow(|state| {
        let session = state.shown.session.as_ref().ok_or("no picture is shown")?;
        let loaded = session.scene();
        let named = session.dependencies().paths().into_iter();
        let read = loaded.world.files.iter().cloned();
        let paths = named.chain(read).chain([asked.scene.clone()]);
        let there = paths.filter_map(|path| canonicalize(path).ok());
        let text = |path: &Path| path.to_string_lossy().trim_start_matches('/').to_owned();
        let time = loaded.scene.timeline.as_ref();
        let manifest = Manifest {
            set: asked.set,
            variant: asked.variant,
            assets: asked.assets.iter().map(|folder| text(folder)).collect(),
            lenient: asked.lenient,
            strict: asked.strict,
            project: asked.project.as_deref().map(text),
            frames: time.map(|time| [time.start, time.end]),
            ..Manifest::new(text(&asked.scene), env!("REFLET_BUILT_FROM"))
        };
        let mut pack = PackWriter::new(Cursor::new(Vec::new()), manifest);
        for path in there.collect::<BTreeSet<_>>() {
            let Ok(file) = open_regular(&path, false) else {
                continue; // a folder that was looked into
            };
            let bytes = file.metadata().map_err(words)?.len();
            pack.add(&text(&path), bytes, file, words, words)?;
        }
        Ok(pack.finish().map_err(words)?.0.into_inner())
    })
}

/// Begins to save frames of the shown scene that a text names as `--frames` does, without text the shown frame.
///
/// # Errors
/// Mistake in the text, and a scene without a timeline.
#[wasm_bindgen]
pub fn frames(text: &str) -> Result<Vec<u32>, String> {
    STATE.with_borrow_mut(|state| {
        state.saving.clear();
        let loaded = state.scene()?;
        if text.is_empty() {
            return Ok(vec![loaded.frame]);
        }
        let timeline = loaded.scene.timeline.as_ref();
        let timeline = timeline.ok_or("the shown scene has no timeline")?;
        Ok(FrameList::parse("frames", text, timeline).map_err(words)?.0)
    })
}

/// Keeps the files of the last picture, named as `--output` names them.
///
/// # Errors
/// A name that is none of a picture, no picture, and too many bytes.
#[wasm_bindgen]
pub fn keep(output: &str) -> Result<(), String> {
    STATE.with_borrow_mut(|state| {
        let picture = state.picture.as_ref().ok_or("no picture is shown")?;
        let frame = state.scene()?.frame;
        let template = Template::new(Path::new(output)).map_err(words)?;
        let path = template.map_or_else(|| output.into(), |template| template.path(frame));
        let file = PictureFile::unchecked(&Goal::typed(path)).map_err(words)?;
        for (path, bytes) in file.encode(picture, None).map_err(words)? {
            state.saving.insert(path.display().to_string(), bytes);
        }
        let bytes = state.saving.values().map(|bytes| bytes.len() as u64).sum();
        check_size(bytes).inspect_err(|_| state.saving.clear())
    })
}

/// Hands over the files that were kept: a file, or several as a ZIP file.
///
/// # Errors
/// More files than a ZIP file has.
#[wasm_bindgen]
pub fn take_kept() -> Result<Vec<u8>, String> {
    let mut files = STATE.with_borrow_mut(|state| std::mem::take(&mut state.saving));
    if files.len() == 1 {
        return Ok(files.pop_first().map_or_else(Vec::new, |(_, only)| only));
    }
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    // They are compressed already.
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    while let Some((name, bytes)) = files.pop_first() {
        zip.start_file(name, stored).map_err(words)?;
        zip.write_all(&bytes).map_err(words)?;
    }
    Ok(zip.finish().map_err(words)?.into_inner())
}
