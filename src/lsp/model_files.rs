//! Names in the files of models: materials, nodes, variants and animations.

use std::{cell::RefCell, collections::BTreeMap, path::PathBuf, sync::Arc};

use super::{
    outline::{Part, Word, beside, words},
    scopes::with_scopes,
};
use reflet_render::runtime::scene_text::{SceneOptions, SceneText};
use reflet_scene::{
    dependencies::Dependencies, diagnostic::Source, project::ProjectChoice, toml_text::toml_text,
};

/// Names in one file.
#[derive(Clone, Debug, Default)]
struct Contents {
    materials: Vec<String>,
    nodes: Vec<String>,
    variants: Vec<String>,
    animations: Vec<String>,
}

/// Files that were read since the last save, by the scene text and the path in it; a file that cannot be read has no
/// names.
#[derive(Debug, Default)]
pub struct ModelFiles(RefCell<BTreeMap<(PathBuf, String), Contents>>);

impl ModelFiles {
    /// Forgets all files, which may have changed.
    pub fn clear(&self) {
        self.0.borrow_mut().clear();
    }

    /// Names of the file of a model that may stand for a word; `None` where the word names nothing in such a file.
    pub fn names_at(&self, file: &Arc<Source>, word: &Word) -> Option<Vec<String>> {
        let table: Vec<&str> = word.table.iter().map(String::as_str).collect();
        let key = match &word.part {
            Part::Value(key) => key.as_str(),
            Part::Key | Part::Header => "",
            Part::Nothing => return None,
        };
        let (model, list): (_, fn(&Contents) -> &[String]) = match (key, table.as_slice()) {
            ("", [.., "model", model, "material"]) => (Some(*model), |c| &c.materials),
            ("variant", [.., "model", model]) => (Some(*model), |c| &c.variants),
            ("animation", [.., "model", model]) | ("name", [.., "model", model, "animation"]) => {
                (Some(*model), |c| &c.animations)
            }
            ("animation", ["instance"]) | ("name", ["instance", "animation"]) => {
                (None, |c| &c.animations)
            }
            ("joints", ["instance"]) => (None, |c| &c.nodes),
            _ => return None,
        };
        let model = model.map(str::to_owned);
        let model = model.or_else(|| Some(beside(file, word, "model")?.text))?;
        let path = ["model".to_owned(), model];
        let is_file =
            |word: &Word| word.part == Part::Value("file".to_owned()) && word.table == path;
        let (source, name) = with_scopes(file).into_iter().find_map(|part| {
            let found = words(&part.source).into_iter().find(is_file)?;
            Some((part.source, found.text))
        })?;
        let mut known = self.0.borrow_mut();
        let entry = known.entry((source.path.clone(), name.clone()));
        let contents = entry.or_insert_with(|| read(&source, &name).unwrap_or_default());
        Some(list(contents).to_vec())
    }
}

/// Reads a file as a scene text names it.
fn read(scene: &Source, name: &str) -> Option<Contents> {
    let text = format!("version = 1\nmodel.read.file = {}\n", toml_text(name));
    let source = Arc::new(Source::new(&scene.path, text));
    let options = SceneOptions {
        project: ProjectChoice::Search,
        ..SceneOptions::default()
    };
    let text = SceneText::from_source(source, &options);
    let opened = text.open(&[], &Dependencies::default()).ok()?;
    let world = opened.load(String::new()).ok()?.world;
    let listed = world.models.first()?;
    Some(Contents {
        materials: listed.names.materials.to_vec(),
        nodes: listed.names.nodes.to_vec(),
        variants: listed.variants.clone(),
        animations: world
            .animations
            .iter()
            .map(|clip| clip.name.clone())
            .collect(),
    })
}
