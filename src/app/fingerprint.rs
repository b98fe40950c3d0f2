//! Fingerprints: hashes of all inputs of a frame; `--resume` keeps a file only if its fingerprint
//! matches.

#[cfg(unix)]
use std::time::Duration;
use std::{
    collections::HashMap,
    fs, io,
    path::{Path, PathBuf},
    time::SystemTime,
};

use xxhash_rust::xxh3::Xxh3Default;

use super::{args::RenderArgs, error::AppError, render_session::RenderSession};
use crate::{render::RenderOptions, scene::desc::SceneDesc};

/// Hash of the program's source and shaders, from `build.rs`.
const BUILT_FROM: &str = env!("REFLET_BUILT_FROM");

/// Hash of all inputs that frames share: program, scene, script, assets, settings and device. File
/// contents are hashed, not paths, so that shards on several machines agree.
///
/// # Errors
/// A file that cannot be read any more, or that was modified since the scene was opened.
pub fn of_run(args: &RenderArgs, session: &RenderSession) -> Result<u128, AppError> {
    let loaded = &session.scene.loaded;
    let mut hash = Xxh3Default::new();
    let mut add = |bytes: &[u8]| {
        hash.update(&(bytes.len() as u64).to_le_bytes());
        hash.update(bytes);
    };
    let read = |path: &Path| {
        let bytes = fs::read(path).map_err(|error| {
            AppError::Internal(format!("cannot read {}: {error}", path.display()))
        })?;
        // Checked after reading, to detect a save in between.
        check_unchanged(path, session.opened)?;
        Ok::<_, AppError>(bytes)
    };
    add(BUILT_FROM.as_bytes());
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
    add(args.camera.as_deref().unwrap_or_default().as_bytes());
    add(&[u8::from(args.denoise)]);
    for aov in &args.aov {
        add(aov.as_bytes());
    }
    if let Some(folder) = &args.shaders {
        for file in shader_files(folder) {
            add(&read(&file)?);
        }
    }
    // Settings left to `auto` are hashed as they were decided.
    let options = RenderOptions {
        audit: false, // an audit does not change the picture
        ..*session.scene.options()
    };
    add(format!("{options:?}").as_bytes());
    let gpu = &session.scene.gpu;
    add(gpu.adapter_info.name.as_bytes());
    add(gpu.adapter_info.driver_info.as_bytes());
    Ok(hash.digest128())
}

/// Contents of files as they were read, so that a later save of them does not matter.
fn known_texts(scene: &SceneDesc) -> HashMap<&Path, &str> {
    let included = scene.includes.iter();
    let included = included.map(|file| (file.path.as_path(), file.text.as_str()));
    let scripts = scene.scripts().flat_map(|script| {
        let texts = script.texts.iter().map(|(_, text)| text.as_str());
        script.files.iter().map(PathBuf::as_path).zip(texts)
    });
    included.chain(scripts).collect()
}

/// Refuses a file modified since then: the loaded content may be outdated.
fn check_unchanged(path: &Path, since: SystemTime) -> Result<(), AppError> {
    let changed = fs::metadata(path).and_then(|file| changed_at(&file));
    match changed {
        Ok(at) if at < since => Ok(()),
        _ => Err(AppError::Internal(format!(
            "{} was saved while the scene was loaded; render again",
            path.display()
        ))),
    }
}

/// Time of the last change of content or name, so that a renamed older file counts as changed.
#[cfg(unix)]
fn changed_at(file: &fs::Metadata) -> io::Result<SystemTime> {
    use std::os::unix::fs::MetadataExt as _;
    let seconds = Duration::from_secs(file.ctime().max(0) as u64);
    Ok(SystemTime::UNIX_EPOCH + seconds + Duration::from_nanos(file.ctime_nsec() as u64))
}

#[cfg(not(unix))]
fn changed_at(file: &fs::Metadata) -> io::Result<SystemTime> {
    file.modified()
}

/// Fingerprint of one frame, hexadecimal.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::stages::Scene;

    #[test]
    fn texts_count_as_they_were_read() {
        let name = format!("reflet-read-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).expect("writable");
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
        fs::remove_dir_all(&folder).expect("clean up");
    }

    #[test]
    fn refuses_a_file_saved_after_loading() {
        let name = format!("reflet-saved-{}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::write(&path, "old").expect("writable");
        let hour = std::time::Duration::from_secs(3600);
        let now = SystemTime::now();
        assert!(check_unchanged(&path, now + hour).is_ok());
        match check_unchanged(&path, now - hour) {
            Err(AppError::Internal(text)) => assert!(text.contains("was saved while"), "{text}"),
            other => panic!("{other:?}"),
        }
        // A file with an old modification time is renamed over the read one.
        let old = fs::File::options().write(true).open(&path).expect("there");
        old.set_modified(now - 2 * hour).expect("settable");
        assert_eq!(check_unchanged(&path, now - hour).is_err(), cfg!(unix));
        fs::remove_file(&path).expect("clean up");
    }
}
