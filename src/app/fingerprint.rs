//! What a frame was made from, as a number: `--resume` keeps a file only if it is still the same.

use std::{fs, path::Path};

use xxhash_rust::xxh3::Xxh3Default;

use super::{cli::RenderArgs, error::AppError, scene::LoadedScene};
use crate::gpu::Gpu;

/// Name under which pictures carry it.
pub const KEYWORD: &str = "reflet-fingerprint";

/// Of the texts of this program and its shaders, made by `build.rs`.
const BUILT_FROM: &str = env!("REFLET_BUILT_FROM");

/// The same for all frames of a command: program, scene, script, assets, settings and device. The
/// files' contents count and not their paths, so that shards on several machines agree.
///
/// # Errors
/// A file that can no longer be read.
pub fn of_run(args: &RenderArgs, loaded: &LoadedScene, gpu: &Gpu) -> Result<u128, AppError> {
    let mut hash = Xxh3Default::new();
    let mut add = |bytes: &[u8]| {
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    let read = |path: &Path| {
        fs::read(path)
            .map_err(|error| AppError::Internal(format!("cannot read {}: {error}", path.display())))
    };
    add(BUILT_FROM.as_bytes());
    add(loaded.text.as_bytes());
    for setting in &loaded.overrides {
        add(setting.as_bytes());
    }
    for (name, text) in loaded.desc.script.iter().flat_map(|s| s.texts()) {
        let name = Path::new(&name).file_name().unwrap_or_default();
        add(name.as_encoded_bytes());
        add(text.as_bytes());
    }
    for file in &loaded.world.files {
        add(&read(file)?);
    }
    add(args.camera.as_deref().unwrap_or_default().as_bytes());
    for aov in &args.aov {
        add(aov.as_bytes());
    }
    if let Some(folder) = &args.shaders {
        for file in shader_files(folder) {
            add(&read(&file)?);
        }
    }
    add(gpu.adapter_info.name.as_bytes());
    add(gpu.adapter_info.driver_info.as_bytes());
    Ok(hash.digest128())
}

/// Of one frame, in hexadecimal digits.
pub fn of_frame(run: u128, frame: u32) -> String {
    let mut hash = Xxh3Default::new();
    hash.update(&run.to_le_bytes());
    hash.update(&frame.to_le_bytes());
    format!("{:032x}", hash.digest128())
}

fn shader_files(folder: &Path) -> Vec<std::path::PathBuf> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files.extend(shader_files(&path));
        } else if path.extension().is_some_and(|e| e == "wgsl") {
            files.push(path);
        }
    }
    files.sort();
    files
}
