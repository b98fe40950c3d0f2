//! Fingerprints: hashes of all inputs of a frame; `--resume` keeps a file only if its fingerprint
//! matches.

use std::{
    collections::HashMap,
    fs,
    path::{Path, PathBuf},
};

use xxhash_rust::xxh3::Xxh3Default;

use crate::error::OutputError;
use reflet_render::{Crop, RenderOptions, runtime::Session};
use reflet_scene::desc::SceneDesc;

/// Choices of a run beside its scene.
#[derive(Clone, Debug)]
pub struct RunSettings {
    /// Hash of the program's source and shaders, which `build.rs` embeds as `REFLET_BUILT_FROM`.
    pub built_from: &'static str,
    /// Name of the chosen camera; empty without one.
    pub camera: String,
    /// Part of the pictures.
    pub crop: Option<Crop>,
    /// Whether pictures are denoised.
    pub denoise: bool,
    /// Number of frames on either side that are denoised with each.
    pub window: u32,
    /// Names of the AOVs, as they were given.
    pub aovs: Vec<String>,
    /// Hash of the shaders, if they come from the user.
    pub own_shaders: Option<u128>,
}

/// Hash of all inputs that frames share: program, scene, script, assets, settings and device. File
/// contents are hashed, not paths, so that shards on several machines agree.
///
/// # Errors
/// A file that cannot be read any more, or that was modified since the scene was opened.
pub fn of_run(settings: &RunSettings, session: &Session) -> Result<u128, OutputError> {
    let loaded = session.scene();
    let mut hash = Xxh3Default::new();
    let mut add = |bytes: &[u8]| {
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    let read = |path: &Path| {
        fs::read(path).map_err(|error| {
            OutputError::Internal(format!("cannot read {}: {error}", path.display()))
        })
    };
    add(settings.built_from.as_bytes());
    add(loaded.text.as_bytes());
    for setting in &loaded.overrides {
        add(setting.as_bytes());
    }
    for (name, text) in loaded.scene.scripts().flat_map(|s| &s.texts) {
        let name = Path::new(&name).file_name().unwrap_or_default();
        add(name.as_encoded_bytes());
        add(text.as_bytes());
    }
    let texts = known_texts(&loaded.scene);
    for file in &loaded.world.files {
        match texts.get(file.as_path()) {
            Some(text) => add(text.as_bytes()),
            None => add(&read(file)?),
        }
    }
    add(settings.camera.as_bytes());
    let crop = settings.crop.map(|crop| crop.to_string());
    add(crop.unwrap_or_default().as_bytes());
    add(&[u8::from(settings.denoise)]);
    add(&settings.window.to_le_bytes());
    for aov in &settings.aovs {
        add(aov.as_bytes());
    }
    // Checked after reading, to detect a save in between.
    if let Some(path) = loaded.dependencies.changed() {
        return Err(OutputError::Internal(format!(
            "{} was saved while the scene was loaded; render again",
            path.display()
        )));
    }
    add(&settings.own_shaders.unwrap_or_default().to_le_bytes());
    // Settings left to `auto` are hashed as they were decided.
    let options = RenderOptions {
        audit: false, // an audit does not change the picture
        ..*session.renderer().options()
    };
    add(format!("{options:?}").as_bytes());
    let gpu = session.gpu();
    add(gpu.adapter_info.name.as_bytes());
    add(gpu.adapter_info.driver_info.as_bytes());
    Ok(hash.digest128())
}

/// Contents of files as they were read, so that a later save of them does not matter.
fn known_texts(scene: &SceneDesc) -> HashMap<&Path, &str> {
    let included = scene.includes.iter();
    let included = included.map(|file| (file.path.as_path(), file.source.text.as_str()));
    let scripts = scene.scripts().flat_map(|script| {
        let texts = script.texts.iter().map(|(_, text)| text.as_str());
        script.files.iter().map(PathBuf::as_path).zip(texts)
    });
    included.chain(scripts).collect()
}

/// Fingerprint of one frame, hexadecimal.
pub fn of_frame(run: u128, frame: u32) -> String {
    let mut hash = Xxh3Default::new();
    hash.update(&run.to_le_bytes());
    hash.update(&frame.to_le_bytes());
    format!("{:032x}", hash.digest128())
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::stages::Scene;

    #[test]
    fn texts_count_as_they_were_read() {
        let temporary = tempfile::tempdir().expect("a folder");
        let folder = temporary.path();
        let folder = folder.canonicalize().expect("there");
        let files = [
            ("a.toml", "[material.a]\n"),
            ("b.rhai", "fn frame(ctx) { }\n"),
        ];
        for (file, text) in files {
            fs::write(folder.join(file), text).expect("writable");
        }
        let text = "version = 1\ninclude = \"a.toml\"\nscript = \"b.rhai\"\ntimeline.end = 1\n";
        let scene = Scene::from_text(text, &folder.join("scene.toml"), &[]);
        let scene = scene.expect("it is right").0;
        for (file, _) in files {
            fs::write(folder.join(file), "saved meanwhile").expect("writable");
        }
        let known = known_texts(&scene);
        for (file, text) in files {
            assert_eq!(known.get(folder.join(file).as_path()), Some(&text));
        }
    }
}
