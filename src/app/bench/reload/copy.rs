//! Copy of a scene, its included files, its script and the shaders in a folder where they can be edited.

use std::{
    env, fs, io,
    path::{Component, Path, PathBuf},
    process,
    sync::atomic::{AtomicU32, Ordering},
};

use crate::{
    app::{args::SceneArgs, error::AppError},
    gpu::ShaderLibrary,
    runtime::{SceneSource, scene_options::border, scene_text::SceneText},
    scene::{dependencies::Dependencies, desc::SceneDesc},
};

/// Kind of edit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edit {
    /// Change of a number in the scene text.
    Text,
    /// Change of the script.
    Script,
    /// Change of the shader with this name.
    Shader(&'static str),
}

impl Edit {
    /// Name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Script => "script",
            Self::Shader(_) => "shader",
        }
    }

    /// Target of the time until rendering starts, in 95 of 100 saves, milliseconds.
    pub const fn target_ms(self) -> f64 {
        match self {
            Self::Text | Self::Script => 100.0,
            Self::Shader(_) => 300.0,
        }
    }
}

/// Temporary folder that is removed when this is dropped.
#[derive(Debug)]
struct Folder(PathBuf);

impl Drop for Folder {
    fn drop(&mut self) {
        // A folder that cannot be removed is left to the system's cleanup of temporary files.
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl Folder {
    fn new() -> Result<Self, AppError> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("reflet-reload-{}-{number}", process::id());
        let path = env::temp_dir().join(name);
        let made = fs::create_dir_all(&path).and_then(|()| path.canonicalize());
        made.map(Self).map_err(|e| failed(&path, &e))
    }

    fn write(&self, name: &str, text: &str) -> Result<(), AppError> {
        let path = self.0.join(name);
        let folder = path.parent().unwrap_or(&self.0);
        let written = fs::create_dir_all(folder).and_then(|()| fs::write(&path, text));
        written.map_err(|e| failed(&path, &e))
    }
}

fn failed(path: &Path, error: &io::Error) -> AppError {
    AppError::Internal(format!("cannot write {}: {error}", path.display()))
}

/// Copy of a scene in a temporary folder.
#[derive(Debug)]
pub struct SceneCopy {
    folder: Folder,
    from: SceneArgs,
    text: String,
    desc: SceneDesc,
    /// Path of the scene's script below the folder, if it has one.
    script: Option<String>,
    library: ShaderLibrary,
}

const SCENE: &str = "scene.toml";
const SHADERS: &str = "shaders";
/// File name of the script that is added to scenes without one.
const OWN_SCRIPT: &str = "reload.rhai";

impl SceneCopy {
    /// Copies a scene, or the built-in one, with its included files and script; models and images are not copied.
    ///
    /// # Errors
    /// Errors of the scene or the shaders; a temporary folder that cannot be written to.
    pub fn new(
        path: Option<&Path>,
        from: &SceneArgs,
        shaders: Option<&Path>,
    ) -> Result<Self, AppError> {
        let library = crate::app::shaders::library(shaders)?;
        let opened = SceneText::read(path, &from.options())
            .and_then(|text| text.open(&[], &Dependencies::default()))
            .map_err(AppError::Scene)?;
        let project = opened.project;
        let (text, desc) = (opened.text, opened.scene.desc.clone());
        let folder = Folder::new()?;
        let below = desc.folder.display().to_string();
        let local = |name: &str| {
            let relative = Path::new(name)
                .strip_prefix(&below)
                .unwrap_or(Path::new(name));
            relative.display().to_string()
        };
        let scripts = desc.scripts().flat_map(|s| &s.texts);
        for (name, script) in scripts {
            folder.write(&local(name), script)?;
        }
        for file in &desc.includes {
            if Path::new(&file.name)
                .components()
                .any(|part| part == Component::ParentDir)
            {
                let text = format!(
                    "{}: a scene is copied to be changed, which is not done with files above it",
                    file.name
                );
                return Err(AppError::Usage(text));
            }
            folder.write(&file.name, &file.source.text)?;
        }
        folder.write(SCENE, &text)?;
        for (name, shader) in library.texts() {
            folder.write(&format!("{SHADERS}/{name}"), shader)?;
        }
        let mut from = from.clone();
        // Relative paths in the scene start at its own folder.
        let own = std::path::absolute(&desc.folder).unwrap_or_else(|_| desc.folder.clone());
        let assets = border(&from.assets, project.as_deref()).assets;
        from.assets = [vec![own], assets].concat();
        Ok(Self {
            script: desc.script.as_ref().map(|script| local(&script.name)),
            folder,
            from,
            text,
            desc,
            library,
        })
    }

    /// Source from which the copied scene is opened.
    pub fn origin(&self) -> SceneSource {
        SceneSource {
            path: Some(self.folder.0.join(SCENE)),
            options: self.from.options(),
            shaders: Some(self.folder.0.join(SHADERS)),
            text: None,
        }
    }

    /// File of an edit, prepared for editing; `None` where the scene has no such file or number. A
    /// scene without a script gets one that sets a camera.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn edited(&self, edit: Edit) -> Result<Option<Edited<'_>>, AppError> {
        let new = |name: String, text: String, number: Option<(usize, usize)>| Edited {
            folder: &self.folder,
            name,
            text,
            number,
            entry: None,
            comment: if edit == Edit::Text { '#' } else { '/' },
        };
        let edited = |name, text, number| Ok(Some(new(name, text, number)));
        match edit {
            Edit::Text => edited(SCENE.to_owned(), self.text.clone(), number(&self.text)),
            Edit::Shader(name) => {
                let found = self.library.texts().find(|(known, _)| *known == name);
                let Some((_, text)) = found else {
                    return Ok(None);
                };
                Ok(Some(Edited {
                    entry: entry(text),
                    ..new(format!("{SHADERS}/{name}"), text.to_owned(), None)
                }))
            }
            Edit::Script => {
                let texts = self.desc.script.as_ref().map(|s| &s.texts);
                if let (Some(name), Some(texts)) = (&self.script, texts) {
                    return edited(name.clone(), texts[0].1.clone(), None);
                }
                let camera = self.desc.cameras.first();
                let set = camera.map_or(String::new(), |camera| {
                    let name = serde_json::Value::from(camera.name.as_str());
                    let fov_deg = camera.value.fov_deg;
                    format!("ctx.camera({name}, #{{ fov_deg: {fov_deg} }});")
                });
                let script = format!("fn frame(ctx) {{\n    {set}\n}}\n");
                self.folder.write(OWN_SCRIPT, &script)?;
                let scene = format!("script = \"{OWN_SCRIPT}\"\n{}", self.text);
                self.folder.write(SCENE, &scene)?;
                edited(OWN_SCRIPT.to_owned(), script, None)
            }
        }
    }
}

/// A file that is edited repeatedly.
#[derive(Debug)]
pub struct Edited<'a> {
    folder: &'a Folder,
    name: String,
    text: String,
    /// Byte range of a number that is varied.
    number: Option<(usize, usize)>,
    /// Start of the body of a shader's entry point, and the name of its first parameter.
    entry: Option<(usize, String)>,
    comment: char,
}

impl Edited<'_> {
    /// Path below the copy's folder.
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// Saves the file with another number, if it has one, another statement in the shader, if it is one, and another
    /// comment at its end.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn save(&self, i: u32) -> Result<(), AppError> {
        let mut text = self.text.clone();
        if let Some((start, end)) = self.number
            && let Ok(value) = text[start..end].parse::<f32>()
        {
            let part = 1.0 - 0.001 * (1 + i % 9) as f32;
            text.replace_range(start..end, &format!("{:?}", value * part));
        }
        if let Some((start, id)) = &self.entry {
            // Comments and unused code change no pipeline. No invocation returns here.
            let no_id = u32::MAX - i;
            text.insert_str(*start, &format!(" if ({id}.x == {no_id}u) {{ return; }}"));
        }
        let comment = String::from(self.comment).repeat(2);
        text.push_str(&format!("\n{comment} edit {i}\n"));
        self.folder.write(&self.name, &text)
    }
}

/// Start of the body of a shader's `main`, and the name of its first parameter, a vector of indices.
fn entry(text: &str) -> Option<(usize, String)> {
    let main = text.find("fn main(")?;
    let body = main + text[main..].find(") {")? + 3;
    let (_, named) = text[main..body].split_once(") ")?;
    let (name, _) = named.split_once(": vec3u")?;
    Some((body, name.to_owned()))
}

/// Byte range of the first roughness in scene text, otherwise of the first intensity of a light.
fn number(text: &str) -> Option<(usize, usize)> {
    let found = ["\nroughness = ", "\nintensity_cd = ", "\nintensity_lux = "]
        .into_iter()
        .find_map(|key| Some(text.find(key)? + key.len()))?;
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let length = text[found..]
        .find(|c| !is_part(c))
        .unwrap_or(text.len() - found);
    (length > 0).then_some((found, found + length))
}
