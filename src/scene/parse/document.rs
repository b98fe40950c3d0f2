//! The document of a scene: one tree, merged from its text, bases, included files, variants, `--set` and the
//! additions of a script, and the description that is read from it. The caller runs the scripts.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
};

use toml::de::{DeTable, DeValue};

use super::{
    OVERRIDE, Parsed, ReadOptions, VARIANT, additions, extends, hierarchy,
    include::{self, Included},
    layers::{self, Base},
    names, params,
    placed::{self, Placed, PlacedGroup, Run, ScriptInput},
    read::timeline::Film,
    report::Report,
    set,
    syntax::{self, Shadow},
    table::{Place, Table},
    value::Node,
};
use crate::scene::{
    dependencies::Dependencies,
    desc::{At, Entry, ParamValue, SceneDesc, ScriptDesc, TimelineDesc},
    diagnostic::{Diagnostic, Returned, Span},
};

/// The texts that a document is made of; the document borrows them.
pub struct Texts<'t> {
    text: &'t str,
    /// Folders where files are looked for, the scene's own first.
    folders: Vec<PathBuf>,
    /// Overrides, each with the position where it begins in the report; so are the variants.
    overrides: Vec<(&'t str, usize)>,
    variants: Vec<(&'t str, usize)>,
    included: Included,
    bases: Vec<Base>,
    placed: Placed,
    report: Report,
}

impl<'t> Texts<'t> {
    /// Collects a scene's text, its bases, included files and placed scenes. `path` names the text in
    /// messages, and relative file names start from its folder. Files that are looked for are added to
    /// `dependencies`.
    pub fn collect(
        text: &'t str,
        path: &Path,
        options: &'t ReadOptions,
        dependencies: &Dependencies,
    ) -> Self {
        let mut report = Report::default();
        report.add_scene(path, text, options.generated);
        let mut add = |name: &str, text: &'t String| {
            let start = report.add_source(Path::new(name), text);
            (text.as_str(), start)
        };
        let overrides = options
            .overrides
            .iter()
            .map(|text| add(OVERRIDE, text))
            .collect();
        let variants = options
            .variants
            .iter()
            .map(|name| add(VARIANT, name))
            .collect();
        let own = path.parent().unwrap_or(Path::new("")).to_owned();
        let folders: Vec<_> = [own]
            .into_iter()
            .chain(options.assets.iter().cloned())
            .collect();
        let included = include::collect((text, 0), path, &folders, dependencies, &mut report);
        let bases = layers::collect((text, 0), path, &folders, dependencies, &mut report);
        let parts = bases.iter().flat_map(Base::texts);
        let parts: Vec<_> = included.texts().chain(parts).collect();
        let parts = [&[(text, 0)], parts.as_slice()].concat();
        let placed = placed::collect(&parts, path, &folders, dependencies, &mut report);
        Self {
            text,
            folders,
            overrides,
            variants,
            included,
            bases,
            placed,
            report,
        }
    }
}

impl Texts<'_> {
    /// Whether a place is in a file that the scene or a base of it includes, or in a placed scene.
    fn is_included(&self, at: &Span) -> bool {
        self.included.has(at)
            || self.bases.iter().any(|base| base.includes(at))
            || self.placed.has(at, &self.report)
    }
}

/// The timeline of a tree; mistakes in it are reported when the scene is read.
fn film_of(root: &Node, report: &Report) -> Option<Film> {
    let timeline = root.get_ref().as_table()?.get("timeline")?;
    let mut silent = report.silent();
    let film = Table::read::<Film>(
        &mut silent,
        timeline.get_ref().as_table()?,
        Place::default(),
    );
    film.filter(|_| silent.errors() == 0)
}

/// Names of the entries of a kind, such as `camera`, in a tree.
fn names_of<T: FromIterator<String>>(kind: &str, root: &Node) -> T {
    let named = root.get_ref().as_table().and_then(|t| t.get(kind));
    let named = named.and_then(|node| node.get_ref().as_table());
    let names = named.into_iter().flat_map(|all| all.keys());
    names.map(|name| name.get_ref().to_string()).collect()
}

/// Warning in place of the result of a script, for callers that read a document without running scripts.
fn not_run(input: &ScriptInput) -> Diagnostic {
    let message = "the script of a placed scene is not run here";
    Diagnostic::at("script-error", input.file.at.clone(), message).warning()
}

/// A tree that is not yet read, and the messages about it so far.
pub struct Document<'t> {
    texts: &'t Texts<'t>,
    root: Node<'t>,
    /// Parts of the texts that syntax errors make doubtful.
    shadows: Vec<Shadow>,
    report: Report,
    placed_groups: Vec<PlacedGroup>,
    placed_cameras: HashSet<String>,
}

impl<'t> Document<'t> {
    /// Builds the tree of the texts. `run` runs the scripts of placed scenes; without it the tree lacks the
    /// additions of their `setup`.
    pub fn new(texts: &'t Texts<'t>, run: Option<Run>) -> Self {
        let mut report = texts.report.clone();
        let (root, mut shadows) = syntax::parse(texts.text, 0, &mut report);
        let mut root = Node::new(root.span(), DeValue::Table(root.into_inner()));
        include::merge(&mut root, &texts.included, &mut shadows, &mut report);
        let root = layers::merge(root, &texts.bases, &mut shadows, &mut report);
        let mut root = layers::choose(root, &texts.variants, &mut report);
        for (text, start) in &texts.overrides {
            set::apply(&mut root, text, *start, &mut report);
        }
        let timeline = film_of(&root, &report).map(|film| film.timeline);
        let nothing = |input: &ScriptInput| Err(Box::new(not_run(input)));
        let run = (run.unwrap_or(&nothing), timeline.as_ref());
        let own_cameras: HashSet<_> = names_of("camera", &root);
        let placed_groups =
            placed::expand(&mut root, &texts.placed, run, &mut shadows, &mut report);
        let mut placed_cameras: HashSet<_> = names_of("camera", &root);
        placed_cameras.retain(|name| !own_cameras.contains(name));
        Self {
            texts,
            root,
            shadows,
            report,
            placed_groups,
            placed_cameras,
        }
    }

    /// Groups that stand for placed scenes, inner ones first.
    pub fn placed_groups(&self) -> &[PlacedGroup] {
        &self.placed_groups
    }

    /// Folders where files are looked for, the scene's own first.
    pub fn folders(&self) -> &'t [PathBuf] {
        &self.texts.folders
    }

    /// Name of the script's file; `None` also where syntax errors make it doubtful.
    pub fn script(&mut self) -> Option<At<String>> {
        let root = self.root.get_ref().as_table();
        let root = root.filter(|_| self.shadows.is_empty());
        let node = root?.get("script")?;
        let Some(value) = node.get_ref().as_str() else {
            self.report.note_lacking_names(); // its type is reported when the scene is read
            return None;
        };
        Some(At {
            value: value.to_owned(),
            at: self.report.span(&node.span()),
        })
    }

    /// Input of `setup`: the scene's parameters and its timeline; `None` if these have mistakes, which are
    /// reported when the scene is read.
    pub fn setup_input(&self) -> Option<(Vec<Entry<ParamValue>>, Option<TimelineDesc>)> {
        let mut silent = self.report.silent();
        let root = self.root.get_ref().as_table()?;
        let table = |key| root.get(key).and_then(|node| node.get_ref().as_table());
        let timeline = table("timeline")
            .and_then(|t| Table::read::<Film>(&mut silent, t, Place::default()))
            .map(|film| film.timeline);
        let values = table("params").map_or_else(Vec::new, |t| params::read(t, &mut silent));
        (silent.errors() == 0).then_some((values, timeline))
    }

    /// The declared parameters, with overrides; `None` where mistakes keep them from being determined.
    pub fn params(&self) -> Option<Vec<Entry<ParamValue>>> {
        let mut silent = self.report.silent();
        let table = self.root.get_ref().as_table()?.get("params");
        let params = match table {
            Some(table) => params::read(table.get_ref().as_table()?, &mut silent),
            None => Vec::new(),
        };
        (self.report.errors() + silent.errors() == 0).then_some(params)
    }

    /// Names of all variants.
    pub fn variants(&self) -> Vec<String> {
        names_of("variant", &self.root)
    }

    /// Notes that the script adds nothing because of a mistake: `mistake`, or if that is `None`, one that
    /// is reported when the scene is read.
    pub fn lacks_script(&mut self, mistake: Option<Diagnostic>) {
        mistake.into_iter().for_each(|m| self.report.push(m));
        self.report.note_lacking_names();
    }

    /// Merges scene text that `setup` returned into the tree; `script` is the name of the script in
    /// messages.
    pub fn add(&mut self, text: &'t str, script: &str, returned: Returned) {
        let base = self.report.add_returned(script, returned, text);
        additions::merge(&mut self.root, text, base, &mut self.report);
    }

    /// Reads the description of a scene with this script.
    ///
    /// # Errors
    /// All mistakes of the texts, in their order, at most 100.
    pub fn read(self, script: Option<ScriptDesc>) -> Parsed {
        let Self {
            texts,
            mut root,
            shadows,
            mut report,
            placed_groups,
            placed_cameras,
        } = self;
        extends::resolve(&mut root, &mut report);
        let nothing = DeTable::new();
        let table = root.get_ref().as_table().unwrap_or(&nothing);
        let mut scene =
            Table::read::<SceneDesc>(&mut report, table, Place::default()).unwrap_or_default();
        scene.own = texts.report.span(&(0..0));
        scene.folder.clone_from(&texts.folders[0]);
        scene.script = script;
        scene.placed_cameras = placed_cameras;
        let declared = placed_groups.iter().filter(|g| !g.params.is_empty());
        scene.placed_params = (declared)
            .map(|group| (group.name.clone(), group.params.clone()))
            .collect();
        if shadows.is_empty() {
            let is_included = |at: &Span| texts.is_included(at);
            names::check(&scene, table, &is_included, &mut report);
            if report.errors() == 0 {
                scene.parents = hierarchy::parents(&scene, table);
            }
        }
        // A model that no instance uses is placed at the origin, but not if it comes from an included file,
        // which only defines it, or if a layer has removed its instance.
        let instances = &scene.instances;
        let is_used = |name: &str| instances.iter().any(|i| i.model.value == name);
        let stands = |m: &Entry<_>| !texts.is_included(&m.at) && !report.is_unplaced(&m.name);
        (scene.models).retain(|m| is_used(&m.name) || stands(m));
        report.retain(|d| !shadows.iter().any(|s| s.hides(d)));
        placed::name_as_written(&placed_groups, &texts.placed, &mut report);
        if report.has("unsupported-version") {
            // In another version other keys may be right.
            report.retain(|d| d.name == "unsupported-version");
        }
        match report.finish() {
            (messages, false) => {
                let bases = texts.bases.iter().flat_map(Base::files);
                let parts = texts.included.files().chain(bases);
                scene.includes = parts.chain(texts.placed.files()).cloned().collect();
                Ok((scene, messages))
            }
            (messages, true) => Err(messages),
        }
    }
}
