//! Folders that file names of a scene start from, and the border that they must not leave.

use std::{
    collections::BTreeMap,
    path::{Component, Path, PathBuf},
    sync::Arc,
};

use super::diagnostic::Source;
use reflet_base::files::canonicalize;

/// Texts of files that are open in an editor, which are read in place of files on the disk.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UnsavedTexts(Arc<BTreeMap<PathBuf, Arc<str>>>);

impl UnsavedTexts {
    /// Texts of files that exist; others cannot be named by a scene.
    pub fn new<'a>(files: impl IntoIterator<Item = &'a Arc<Source>>) -> Self {
        let real = |file: &Arc<Source>| {
            let path = canonicalize(&file.path).ok()?;
            Some((path, Arc::from(file.text.as_str())))
        };
        Self(Arc::new(files.into_iter().filter_map(real).collect()))
    }

    /// Text of the file of a canonical path.
    pub fn text(&self, real: &Path) -> Option<&str> {
        self.0.get(real).map(AsRef::as_ref)
    }
}

/// Folders that a scene may read besides its own.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Border {
    /// Folders where files are looked for after the scene's own, in this order.
    pub assets: Vec<PathBuf>,
    /// Folders where scripts alone are looked for, after all others.
    pub scripts: Vec<PathBuf>,
    /// Canonical folder of the scene's project: inside it, names may climb by `..`.
    pub project: Option<PathBuf>,
    /// Texts that stand for files inside of the border.
    pub unsaved: UnsavedTexts,
}

impl From<Vec<PathBuf>> for Border {
    /// Folders of assets alone, without a project.
    fn from(assets: Vec<PathBuf>) -> Self {
        Self {
            assets,
            ..Self::default()
        }
    }
}

/// Folders in which the file names of one scene are looked for, its own first.
#[derive(Clone, Debug, Default)]
pub struct Reach {
    folders: Vec<PathBuf>,
    scripts: Vec<PathBuf>,
    project: Option<PathBuf>,
    unsaved: UnsavedTexts,
}

impl Reach {
    /// Reach of a scene in the folder `own`.
    pub fn new(own: PathBuf, border: &Border) -> Self {
        let folders = std::iter::once(own).chain(border.assets.iter().cloned());
        Self {
            folders: folders.collect(),
            scripts: border.scripts.clone(),
            project: border.project.clone(),
            unsaved: border.unsaved.clone(),
        }
    }

    /// Folders where files are looked for, the scene's own first.
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// Canonical folder of the project; `None` for a scene of no project.
    pub fn project(&self) -> Option<&Path> {
        self.project.as_deref()
    }

    /// Texts that stand for files inside of the border.
    pub fn unsaved(&self) -> &UnsavedTexts {
        &self.unsaved
    }

    /// The same border with other folders, of which the first is the scene's own.
    pub fn with_folders(&self, folders: Vec<PathBuf>) -> Self {
        Self {
            folders,
            ..self.clone()
        }
    }

    /// Reach of scripts, which are also looked for in the libraries of scripts.
    pub fn of_scripts(&self) -> Self {
        let all = self.folders.iter().chain(&self.scripts);
        self.with_folders(all.cloned().collect())
    }

    /// Whether a name from a folder stays inside of it or of the project, as far as the name itself tells.
    pub fn allows(&self, folder: &Path, name: &str) -> bool {
        let Ok(folder) = canonicalize(Path::new(".").join(folder)) else {
            return false;
        };
        let path = lexical(&folder, Path::new(name));
        path.is_some_and(|path| self.holds(&path, &folder))
    }

    /// Whether a canonical path is inside of a canonical folder, or inside of the project.
    pub fn holds(&self, path: &Path, folder: &Path) -> bool {
        path.starts_with(folder) || self.project().is_some_and(|own| path.starts_with(own))
    }
}

/// Path of the relative `name` from a canonical folder, without looking at the disk; `None` for an absolute name and
/// one that climbs above the root.
pub fn lexical(folder: &Path, name: &Path) -> Option<PathBuf> {
    let mut path = folder.to_owned();
    for part in name.components() {
        match part {
            Component::Normal(part) => path.push(part),
            Component::CurDir => {}
            Component::ParentDir if path.pop() => {}
            _ => return None,
        }
    }
    Some(path)
}
