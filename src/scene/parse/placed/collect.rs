//! The files of placed scenes.

use std::{
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
    sync::Arc,
};

use super::placed_by;
use crate::table::report::Report;
use crate::{
    confined_read::{self, Kind},
    dependencies::Dependencies,
    desc::{At, Include},
    diagnostic::{Diagnostic, Source, Span},
    parse::{
        MOST_BYTES,
        include::{self, Included},
        layers::{self, Base},
    },
    reach::Reach,
    suggest,
    syntax::{Content, Node},
};
use reflet_base::files::{canonicalize, metadata};

/// Largest number of files of placed scenes.
const MOST: usize = 100;

/// Words for placed scenes in messages about their files.
const SCENES: Kind = Kind {
    one: "scene text",
    names: "names of placed scenes start from the scene's folder or an asset folder (--assets DIR)",
    inside: "placed scenes are read only from the scene's folder, asset folders, and the folders below",
    most_mib: MOST_BYTES >> 20,
};

/// A scene that is placed, with its bases and included files.
#[derive(Debug)]
pub struct PlacedFile {
    /// The file.
    pub file: Include,
    /// Folder that names of files in it start from, relative to the folders of the outermost scene; empty,
    /// or with a `/` at its end.
    pub folder: String,
    /// Files that it includes.
    pub included: Included,
    /// Its bases.
    pub bases: Vec<Base>,
}

impl PlacedFile {
    /// Name of the file without its extension.
    pub fn stem(&self) -> &str {
        let name = Path::new(&self.file.name).file_stem();
        name.and_then(|stem| stem.to_str()).unwrap_or("scene")
    }

    /// The file, its included files, and its bases.
    fn files(&self) -> impl Iterator<Item = &Include> {
        let bases = self.bases.iter().flat_map(Base::files);
        let own = std::iter::once(&self.file);
        own.chain(self.included.files()).chain(bases)
    }

    /// Whether a place is in a file that this one or a base of it includes.
    pub fn includes(&self, at: &Span) -> bool {
        self.included.has(at) || self.bases.iter().any(|base| base.includes(at))
    }
}

/// All files of placed scenes, by the folder and the name by which they are placed.
#[derive(Debug, Default)]
pub struct Placed {
    files: Vec<PlacedFile>,
    /// Index in `files`; `None` for a file that cannot be read, which was reported.
    by_name: HashMap<(String, String), Option<usize>>,
    /// Reach of the outermost scene.
    reach: Reach,
}

impl Placed {
    /// The file that a scene in `folder` calls `name`.
    pub fn file(&self, folder: &str, name: &str) -> Option<&PlacedFile> {
        let index = self.by_name.get(&(folder.to_owned(), name.to_owned()))?;
        index.map(|index| &self.files[index])
    }

    /// Whether it was reported that this file cannot be read.
    pub fn is_missing(&self, folder: &str, name: &str) -> bool {
        self.by_name.get(&(folder.to_owned(), name.to_owned())) == Some(&None)
    }

    /// All files, with included files and bases of placed scenes.
    pub fn files(&self) -> impl Iterator<Item = &Include> {
        self.files.iter().flat_map(PlacedFile::files)
    }

    /// Whether a place is in a placed scene.
    pub fn has(&self, at: &Span) -> bool {
        let source = at.source.as_ref();
        source.is_some_and(|source| self.files().any(|file| Arc::ptr_eq(&file.source, source)))
    }

    /// Folders where a placed scene looks for files.
    pub fn reach_of(&self, file: &PlacedFile) -> Reach {
        let folders = self.reach.folders();
        let inner = |folder: &PathBuf| {
            let inner = folder.join(&file.folder);
            // A name that climbs may lead out of this folder though it stays in another one.
            let real = canonicalize(&inner).ok()?;
            let outer = canonicalize(Path::new(".").join(folder)).ok()?;
            let is_inside =
                metadata(&real).is_ok_and(|m| m.is_dir()) && self.reach.holds(&real, &outer);
            is_inside.then_some(inner)
        };
        let mut all: Vec<_> = folders.iter().filter_map(inner).collect();
        let others: Vec<_> = folders.iter().filter(|f| !all.contains(f)).collect();
        all.extend(others.into_iter().cloned());
        self.reach.with_folders(all)
    }

    /// Name, from the folders of the outermost scene, of a file that a scene in `folder` calls `name`.
    pub fn file_name(&self, folder: &str, name: &str) -> String {
        let inside = format!("{folder}{name}");
        let has = |folder: &PathBuf| {
            self.reach.allows(folder, &inside) && metadata(folder.join(&inside)).is_ok()
        };
        match self.reach.folders().iter().any(has) {
            true => inside,
            false => name.to_owned(),
        }
    }
}

/// A placed scene whose file is still to be read.
struct Wanted {
    name: At<String>,
    folder: String,
    /// Files of the scenes around it, outermost first.
    above: Vec<PathBuf>,
}

/// Reads the scenes that some texts place, the outermost scene's own text first, and the scenes that these
/// place in turn.
pub fn collect(
    texts: &[Arc<Source>],
    reach: &Reach,
    dependencies: &Dependencies,
    report: &mut Report,
) -> Placed {
    let mut placed = Placed {
        reach: reach.clone(),
        ..Placed::default()
    };
    let own = texts.first().and_then(|own| canonicalize(&own.path).ok());
    let above: Vec<_> = own.into_iter().collect();
    let mut waiting = Vec::new();
    let wanted = |texts: &[Arc<Source>], folder: &str, above: &[PathBuf]| {
        let names = texts.iter().flat_map(named);
        let wanted = |name| Wanted {
            name,
            folder: folder.to_owned(),
            above: above.to_vec(),
        };
        names.map(wanted).collect::<Vec<_>>()
    };
    waiting.extend(wanted(texts, "", &above));
    waiting.reverse();
    while let Some(next) = waiting.pop() {
        let key = (next.folder.clone(), next.name.value.clone());
        if let Some(known) = placed.by_name.get(&key) {
            // The texts are walked depth first, so each circle has a scene that is met again below itself.
            let path = known.map(|index| &placed.files[index].file.path);
            if path.is_some_and(|path| next.above.contains(path)) {
                report.push(circle(&next));
                report.note_lacking_names();
            }
            continue;
        }
        let file = read(&next, &placed, reach, dependencies, report);
        let index = file.map(|(file, real)| {
            let texts: Vec<_> = file.files().map(|file| Arc::clone(&file.source)).collect();
            let above = [next.above.as_slice(), &[real]].concat();
            waiting.extend(wanted(&texts, &file.folder, &above).into_iter().rev());
            placed.files.push(file);
            placed.files.len() - 1
        });
        if index.is_none() {
            report.note_lacking_names();
        }
        placed.by_name.insert(key, index);
    }
    placed
}

fn circle(next: &Wanted) -> Diagnostic {
    let shown = suggest::text(&next.name.value);
    let message = format!("{shown} places itself, directly or through other scenes");
    let error = Diagnostic::new("circle", next.name.at.clone(), message);
    error.help("take its `[[instance]]` out of one file of the circle")
}

fn read(
    next: &Wanted,
    placed: &Placed,
    reach: &Reach,
    dependencies: &Dependencies,
    report: &mut Report,
) -> Option<(PlacedFile, PathBuf)> {
    let at = next.name.at.clone();
    if placed.files.len() == MOST {
        let message = format!("at most {MOST} files can be placed in a scene");
        report.push(Diagnostic::new("too-many-files", at, message));
        return None;
    }
    let name = placed.file_name(&next.folder, &next.name.value);
    let found = match confined_read::read(reach, &name, &SCENES, dependencies) {
        Ok(found) => found,
        Err(problem) => {
            report.push(problem.at_name("placed-file", at));
            return None;
        }
    };
    if next.above.contains(&found.real) {
        report.push(circle(next));
        return None;
    }
    let folder = name.rfind('/').map_or("", |end| &name[..=end]).to_owned();
    // Its files are looked for beside it first, then as for the outermost scene.
    let beside = found.path.parent().map(Path::to_owned);
    let mut own: Vec<PathBuf> = beside.into_iter().collect();
    let others: Vec<_> = (reach.folders().iter())
        .filter(|f| own.first() != Some(f))
        .collect();
    own.extend(others.into_iter().cloned());
    let own = reach.with_folders(own);
    let source = Arc::new(Source::new(found.path, found.data));
    if !report.admit(&source, &at) {
        return None;
    }
    let included = include::collect(&source, false, &own, dependencies, report);
    let bases = layers::collect(&source, false, &own, dependencies, report);
    let file = PlacedFile {
        folder,
        included,
        bases,
        file: Include {
            name,
            path: found.real.clone(),
            source,
        },
    };
    Some((file, found.real))
}

/// The scenes that a text places, also in its variants.
fn named(source: &Arc<Source>) -> Vec<At<String>> {
    let root = source.syntax().root();
    let variants = root.get("variant").and_then(|n| n.get_ref().as_table());
    let variants = variants.into_iter().flat_map(|all| all.values());
    let tables = variants.filter_map(|node| node.get_ref().as_table());
    let mut seen = HashSet::new();
    let mut found = Vec::new();
    for table in std::iter::once(root).chain(tables) {
        let list = table.get("instance").map(Node::get_ref);
        let Some(Content::Array(list)) = list else {
            continue;
        };
        for instance in list {
            if let Some((name, node)) = placed_by(instance)
                && seen.insert(name.to_owned())
            {
                let at = Span {
                    source: Some(Arc::clone(source)),
                    range: node.span(),
                };
                found.push(At {
                    value: name.to_owned(),
                    at,
                });
            }
        }
    }
    found
}
