//! Copy of a scene, everything that it reads and the shaders in a folder where they can be edited.

use std::{
    env, fs, io,
    path::{Path, PathBuf},
};

use tempfile::TempDir;

use crate::{
    app::{
        args::SceneArgs,
        error::AppError,
        pack::{CopiedScene, Layout},
    },
    files::folder_of,
    gpu::ShaderLibrary,
    runtime::{SceneSource, model_viewer_scene::is_bare, scene_text::SceneText},
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
}

fn write(path: &Path, text: &str) -> Result<(), AppError> {
    let made = fs::create_dir_all(folder_of(path));
    let written = made.and_then(|()| fs::write(path, text));
    written.map_err(|e| failed(path, &e))
}

/// The text of the built-in scene or of a model's viewer, whose files stay where they are.
fn generated(
    path: Option<&Path>,
    from: &SceneArgs,
    folder: &Path,
) -> Result<CopiedScene, AppError> {
    let opened = SceneText::read(path, &from.options())
        .and_then(|text| text.open(&[], &Dependencies::default()))
        .map_err(AppError::Scene)?;
    let own = &opened.scene.desc.folder;
    let own = std::path::absolute(own).unwrap_or_else(|_| own.clone());
    let scene = folder.join(SCENE);
    write(&scene, &opened.text)?;
    Ok(CopiedScene {
        scene,
        from: SceneArgs {
            assets: [vec![own], from.assets.clone()].concat(),
            project: None,
            no_project: true,
            ..from.clone()
        },
    })
}

fn failed(path: &Path, error: &io::Error) -> AppError {
    AppError::Internal(format!("cannot write {}: {error}", path.display()))
}

/// Copy of a scene in a temporary folder.
#[derive(Debug)]
pub struct SceneCopy {
    folder: TempDir,
    /// Path of the scene's file below the folder.
    scene: PathBuf,
    from: SceneArgs,
    text: String,
    desc: SceneDesc,
    library: ShaderLibrary,
}

const SCENE: &str = "scene.toml";
const SHADERS: &str = "shaders";
/// File name of the script that is added to scenes without one.
const OWN_SCRIPT: &str = "reload.rhai";

impl SceneCopy {
    /// Copies a scene with everything that it reads, or the text of the built-in one or of a model's viewer.
    ///
    /// # Errors
    /// Errors of the scene or the shaders; a temporary folder that cannot be written to.
    pub fn new(
        path: Option<&Path>,
        from: &SceneArgs,
        shaders: Option<&Path>,
    ) -> Result<Self, AppError> {
        let library = crate::app::shaders::library(shaders)?;
        let temporary = env::temp_dir();
        let folder = temporary.canonicalize().and_then(tempfile::tempdir_in);
        let folder = folder.map_err(|e| failed(&temporary, &e))?;
        let own = folder.path().join("project");
        fs::create_dir(&own).map_err(|e| failed(&own, &e))?;
        let CopiedScene { scene, from } = match path.filter(|path| !is_bare(path)) {
            Some(path) => {
                let copied = Layout::for_scene(path, from)?.copy_to(&own);
                copied.map_err(|e| failed(&own, &e))?
            }
            None => generated(path, from, &own)?,
        };
        let opened = SceneText::read(Some(&scene), &from.options())
            .and_then(|text| text.open(&[], &Dependencies::default()))
            .map_err(AppError::Scene)?;
        let (text, desc) = (opened.text, opened.scene.desc.clone());
        for (name, shader) in library.texts() {
            write(&folder.path().join(SHADERS).join(name), shader)?;
        }
        Ok(Self {
            folder,
            scene,
            from,
            text,
            desc,
            library,
        })
    }

    /// Source from which the copied scene is opened.
    pub fn origin(&self) -> SceneSource {
        SceneSource {
            path: Some(self.scene.clone()),
            options: self.from.options(),
            shaders: Some(self.folder.path().join(SHADERS)),
            text: None,
        }
    }

    /// File of an edit, prepared for editing; `None` where the scene has no such file or number. A
    /// scene without a script gets one that sets a camera.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn edited(&self, edit: Edit) -> Result<Option<Edited>, AppError> {
        let new = |path: PathBuf, text: String, number: Option<(usize, usize)>| Edited {
            name: (path.strip_prefix(self.folder.path()).unwrap_or(&path))
                .display()
                .to_string(),
            path,
            text,
            number,
            entry: None,
            comment: if edit == Edit::Text { '#' } else { '/' },
        };
        let edited = |path, text, number| Ok(Some(new(path, text, number)));
        match edit {
            Edit::Text => edited(self.scene.clone(), self.text.clone(), number(&self.text)),
            Edit::Shader(name) => {
                let found = self.library.texts().find(|(known, _)| *known == name);
                let Some((_, text)) = found else {
                    return Ok(None);
                };
                let path = self.folder.path().join(SHADERS).join(name);
                Ok(Some(Edited {
                    entry: entry(text),
                    ..new(path, text.to_owned(), None)
                }))
            }
            Edit::Script => {
                if let Some(script) = &self.desc.script
                    && let (Some(path), Some((_, text))) =
                        (script.files.first(), script.texts.first())
                {
                    return edited(path.clone(), text.clone(), None);
                }
                let camera = self.desc.cameras.first();
                let set = camera.map_or(String::new(), |camera| {
                    let name = serde_json::Value::from(camera.name.as_str());
                    let fov_deg = camera.value.fov_deg;
                    format!("ctx.camera({name}, #{{ fov_deg: {fov_deg} }});")
                });
                let script = format!("fn frame(ctx) {{\n    {set}\n}}\n");
                let path = folder_of(&self.scene).join(OWN_SCRIPT);
                write(&path, &script)?;
                let scene = format!("script = \"{OWN_SCRIPT}\"\n{}", self.text);
                write(&self.scene, &scene)?;
                edited(path, script, None)
            }
        }
    }
}

/// A file that is edited repeatedly.
#[derive(Debug)]
pub struct Edited {
    path: PathBuf,
    name: String,
    text: String,
    /// Byte range of a number that is varied.
    number: Option<(usize, usize)>,
    /// Start of the body of a shader's entry point, and the name of its first parameter.
    entry: Option<(usize, String)>,
    comment: char,
}

impl Edited {
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
        write(&self.path, &text)
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
