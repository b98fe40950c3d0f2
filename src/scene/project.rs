//! Projects: `reflet.toml` with settings that all scenes below its folder share, and the border that it gives them.

mod find;

use std::{
    io,
    path::{Path, PathBuf},
    sync::Arc,
};

pub use self::find::{UNPACKED, find};
use crate::{
    desc::{At, ProjectDesc},
    diagnostic::{Diagnostic, Source},
    parse::read_project,
    reach::{Border, lexical},
    suggest,
};
use reflet_base::files::{canonicalize, open_regular, read_at_most};

/// Name of the file of a project.
pub const FILE: &str = ProjectDesc::FILE;

/// Largest file of a project, MiB.
const MOST_MIB: u64 = 1;

/// How the project of a scene is chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ProjectChoice {
    /// No scene is of a project.
    #[default]
    None,
    /// The project that is found upward from the scene, as [`find`] does.
    Search,
    /// The project of this file, or of the file in this folder, which the user names.
    Named(PathBuf),
}

/// A project that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct Project {
    /// Canonical path of its file.
    pub file: PathBuf,
    /// Canonical folder of the project, which its scenes' files must not leave.
    pub folder: PathBuf,
    /// Content of the file.
    pub desc: ProjectDesc,
    /// Warnings about it.
    pub warnings: Vec<Diagnostic>,
}

impl ProjectChoice {
    /// The project of a scene at `path`; `None` for a scene of no project.
    ///
    /// # Errors
    /// Mistakes in the project's file; a named project that does not exist or whose folder does not hold the scene.
    pub fn project_of(&self, path: &Path) -> Result<Option<Project>, Vec<Diagnostic>> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let folder = Path::new(".").join(folder);
        match self {
            Self::None => Ok(None),
            Self::Search => find(&folder).map(|file| Project::open(&file)).transpose(),
            Self::Named(named) => {
                let file = match named.is_dir() {
                    true => named.join(FILE),
                    false => named.clone(),
                };
                let project = Project::open(&file)?;
                let holds = |folder: PathBuf| folder.starts_with(&project.folder);
                // A missing scene is reported when it is read.
                match canonicalize(&folder).map_or(true, holds) {
                    true => Ok(Some(project)),
                    false => {
                        let own = project.folder.display();
                        let message =
                            format!("it is not in the project, whose folder is \"{own}\"");
                        let error = Diagnostic::in_file("project-folder", path, message);
                        Err(vec![error.help("name another folder by --project")])
                    }
                }
            }
        }
    }
}

impl Project {
    /// Reads the project of a file, which must not be a link to another folder.
    ///
    /// # Errors
    /// A file that is missing, too large or not UTF-8; all mistakes in its text, and folders that lead out of it.
    pub fn open(file: &Path) -> Result<Self, Vec<Diagnostic>> {
        let refuse = |message: String| Diagnostic::in_file("project-file", file, message);
        let unreadable = |e: io::Error| match e.kind() {
            io::ErrorKind::NotFound => refuse("there is no such file of a project".to_owned())
                .help("`reflet new NAME` makes a project"),
            io::ErrorKind::FileTooLarge => {
                refuse(format!("the file of a project has at most {MOST_MIB} MiB"))
            }
            _ => refuse(format!("cannot be read: {e}")),
        };
        let real = canonicalize(file).map_err(|e| vec![unreadable(e)])?;
        let folder = file.parent().unwrap_or(Path::new(""));
        let folder = canonicalize(Path::new(".").join(folder));
        if folder.is_ok_and(|folder| real.parent() != Some(&folder)) {
            let help = "copy it; its folder is what the scenes of the project may read";
            let message = "the file of a project must not be a link to another folder".to_owned();
            return Err(vec![refuse(message).help(help)]);
        }
        let opened = open_regular(&real, false);
        let bytes = opened.and_then(|file| read_at_most(&file, MOST_MIB << 20));
        let bytes = bytes.map_err(|e| vec![unreadable(e)])?;
        let text = String::from_utf8(bytes).map_err(|_| {
            let help = "save the file as UTF-8 in your editor";
            vec![refuse("it must be UTF-8 text".to_owned()).help(help)]
        })?;
        Self::from_source(&Arc::new(Source::new(real, text)))
    }

    /// Reads the text of a project, which may be unsaved; its path has the project's folder.
    ///
    /// # Errors
    /// All mistakes in the text, and folders that lead out of the project.
    pub fn from_source(source: &Arc<Source>) -> Result<Self, Vec<Diagnostic>> {
        let (desc, mut warnings) = read_project(source)?;
        let folder = source.path.parent().unwrap_or(Path::new(""));
        let folder = canonicalize(Path::new(".").join(folder));
        let folder = folder.unwrap_or_default();
        let mut errors = Vec::new();
        let folders = desc.assets.iter().map(|name| ("assets", name));
        for (key, name) in folders.chain(desc.scripts.iter().map(|name| ("scripts", name))) {
            match check_folder(&folder, key, name) {
                Ok(warning) => warnings.extend(warning),
                Err(error) => errors.push(*error),
            }
        }
        if let Some(output) = &desc.output
            && let Err(error) = inside(&folder, output)
        {
            errors.push(*error);
        }
        if !errors.is_empty() {
            return Err(warnings.into_iter().chain(errors).collect());
        }
        let file = source.path.clone();
        Ok(Self {
            file,
            folder,
            desc,
            warnings,
        })
    }

    /// Name of the project in messages.
    pub fn name(&self) -> String {
        let own = self.folder.file_name().unwrap_or_default();
        let own = || own.to_string_lossy().into_owned();
        self.desc.name.clone().unwrap_or_else(own)
    }

    /// Folders where files of its scenes are looked for, the project's own last.
    pub fn asset_folders(&self) -> Vec<PathBuf> {
        let named = self.desc.assets.iter();
        let named = named.map(|name| self.folder.join(&name.value));
        named.chain([self.folder.clone()]).collect()
    }

    /// The project and its border, as a part of a sentence about a scene.
    pub fn in_words(&self) -> String {
        let (name, folder) = (self.name(), self.folder.display());
        format!(", in the project \"{name}\" with the border {folder}")
    }

    /// Adds its folders to a scene's folders, after the folders that the user names.
    pub fn extend(&self, border: &mut Border) {
        border.assets.extend(self.asset_folders());
        let scripts = self.desc.scripts.iter();
        border
            .scripts
            .extend(scripts.map(|name| self.folder.join(&name.value)));
        border.project = Some(self.folder.clone());
    }

    /// Width and height of the size with a name, pixels.
    ///
    /// # Errors
    /// Message that names the sizes of the project.
    pub fn size(&self, name: &str) -> Result<[u32; 2], String> {
        let sizes = &self.desc.sizes;
        let found = sizes.iter().find(|size| size.name == name);
        found.map(|size| size.value).ok_or_else(|| {
            let names: Vec<_> = sizes.iter().map(|size| size.name.as_str()).collect();
            let file = self.file.display();
            match names.is_empty() {
                true => format!("{file} has no [sizes]; write [sizes] with {name} = [640, 360]"),
                false => suggest::hint(name, &names, suggest::text, "the sizes of the project are"),
            }
        })
    }

    /// Warnings about the camera and the variants that the project names, where a scene has none of that name but one
    /// of a similar name. A scene of a project need not have them.
    pub fn misspelt(&self, scene: &str, cameras: &[&str], variants: &[&str]) -> Vec<Diagnostic> {
        let named = (self
            .desc
            .camera
            .iter()
            .map(|name| ("camera", name, cameras)))
        .chain((self.desc.variant.iter()).map(|name| ("variant", name, variants)));
        let warnings = named.filter_map(|(kind, name, known)| {
            if known.contains(&name.value.as_str()) {
                return None;
            }
            let similar = suggest::nearest(&name.value, known.iter().copied())?;
            let shown = suggest::text(&name.value);
            let message = format!("the scene {scene} has no {kind} {shown}");
            let warning = Diagnostic::new("project-name", name.at.clone(), message).warning();
            Some(warning.help(format!("did you mean {}?", suggest::text(similar))))
        });
        warnings.collect()
    }
}

/// Path of a name from the project's folder, which it must not leave.
fn inside(folder: &Path, name: &At<String>) -> Result<PathBuf, Box<Diagnostic>> {
    let shown = suggest::text(&name.value);
    let path = lexical(folder, Path::new(&name.value));
    let is_name = !name.value.is_empty() && !name.value.contains(['\\', '\0']);
    path.filter(|path| is_name && path.starts_with(folder))
        .ok_or_else(|| {
            let message = format!("{shown} is not inside of the project's folder");
            let error = Diagnostic::new("project-border", name.at.clone(), message);
            let help = "write a name that starts from the folder of reflet.toml; --assets DIR and REFLET_ASSETS name \
                        folders elsewhere";
            Box::new(error.help(help))
        })
}

/// Checks a folder of files; a missing one is a warning.
fn check_folder(
    folder: &Path,
    key: &str,
    name: &At<String>,
) -> Result<Option<Diagnostic>, Box<Diagnostic>> {
    let path = inside(folder, name)?;
    let shown = suggest::text(&name.value);
    let at = || name.at.clone();
    let itself = || {
        let message =
            format!("{shown} is the project's own folder, which is always looked in, last");
        Box::new(Diagnostic::new("project-itself", at(), message).help("leave it out"))
    };
    if path == folder {
        return Err(itself());
    }
    // A page asks for a file when a scene names it: a folder whose files have not come yet is not missing.
    if cfg!(target_arch = "wasm32") {
        return Ok(None);
    }
    let real = match path.canonicalize() {
        Ok(real) => real,
        Err(_) => {
            let message = format!("there is no folder {shown}, so nothing is found in it");
            let warning = Diagnostic::new("no-folder", at(), message);
            let help = format!("make it, or take it out of `{key}`");
            return Ok(Some(warning.help(help).warning()));
        }
    };
    if real == folder {
        return Err(itself());
    }
    if !real.starts_with(folder) {
        let message = format!("{shown} is a link that leads out of the project's folder");
        let help = "name the folder that it leads to by --assets DIR or in REFLET_ASSETS";
        return Err(Box::new(
            Diagnostic::new("project-border", at(), message).help(help),
        ));
    }
    if !real.is_dir() {
        let message = format!("{shown} is a file, and `{key}` names folders");
        let error = Diagnostic::new("no-folder", at(), message);
        return Err(Box::new(error.help("write the folder that has it")));
    }
    Ok(None)
}
