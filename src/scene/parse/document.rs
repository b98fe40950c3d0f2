//! The document of a scene: the tree of its text, of its bases and what they include, of variants,
//! of `--set` and of what a script adds, and the description that is read from it. No program is run here.

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

/// The texts that a document is made of; it borrows them.
pub struct Texts<'t> {
    text: &'t str,
    /// Where files are looked for, the scene's own first.
    folders: Vec<PathBuf>,
    /// Each with where it begins in the report.
    overrides: Vec<(&'t str, usize)>,
    variants: Vec<(&'t str, usize)>,
    included: Included,
    bases: Vec<Base>,
    placed: Placed,
    report: Report,
}

impl<'t> Texts<'t> {
    /// A scene's text, the files that it includes, and its bases. `path` is what messages call it,
    /// and its folder is where relative file names start. Files that are looked for are added to
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
    /// Whether this is written in a file that is included, by the scene or by a base, or in a placed
    /// scene.
    fn is_included(&self, at: &Span) -> bool {
        self.included.has(at)
            || self.bases.iter().any(|base| base.includes(at))
            || self.placed.has(at, &self.report)
    }
}

/// The timeline of a tree; mistakes in it are reported when the scene is read.
fn film_of(root: &Node, report: &Report) -> Option<Film> {
    let timeline = root.get_ref().as_table()?.get("timeline")?;
    let mut unheard = report.unheard();
    let film = Table::read::<Film>(
        &mut unheard,
        timeline.get_ref().as_table()?,
        Place::default(),
    );
    film.filter(|_| unheard.errors() == 0)
}

/// What has a name in a tree, of a kind such as `camera`.
fn names_of<T: FromIterator<String>>(kind: &str, root: &Node) -> T {
    let named = root.get_ref().as_table().and_then(|t| t.get(kind));
    let named = named.and_then(|node| node.get_ref().as_table());
    let names = named.into_iter().flat_map(|all| all.keys());
    names.map(|name| name.get_ref().to_string()).collect()
}

/// For those who want no more of a document than what is written.
fn not_run(input: &ScriptInput) -> Diagnostic {
    let message = "the script of a placed scene is not run here";
    Diagnostic::at("script-error", input.file.at.clone(), message).warning()
}

/// A tree that is not yet read, and the messages about it so far.
pub struct Document<'t> {
    texts: &'t Texts<'t>,
    root: Node<'t>,
    /// What broken lines make doubtful.
    shadows: Vec<Shadow>,
    report: Report,
    placed_groups: Vec<PlacedGroup>,
    placed_cameras: HashSet<String>,
}

impl<'t> Document<'t> {
    /// The tree of the texts; `run` runs the scripts of placed scenes, without which it lacks what their
    /// `setup` would add.
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

    /// What is known of placed scenes, inner ones first.
    pub fn placed_groups(&self) -> &[PlacedGroup] {
        &self.placed_groups
    }

    /// Where files are looked for, the scene's own folder first.
    pub fn folders(&self) -> &'t [PathBuf] {
        &self.texts.folders
    }

    /// The name of the script's file; `None` also where broken lines make it doubtful.
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

    /// What `setup` may know of the scene: its parameters and its timeline; `None` if these have
    /// mistakes, which are reported when the scene is read.
    pub fn setup_input(&self) -> Option<(Vec<Entry<ParamValue>>, Option<TimelineDesc>)> {
        let mut unheard = self.report.unheard();
        let root = self.root.get_ref().as_table()?;
        let table = |key| root.get(key).and_then(|node| node.get_ref().as_table());
        let timeline = table("timeline")
            .and_then(|t| Table::read::<Film>(&mut unheard, t, Place::default()))
            .map(|film| film.timeline);
        let values = table("params").map_or_else(Vec::new, |t| params::read(t, &mut unheard));
        (unheard.errors() == 0).then_some((values, timeline))
    }

    /// The declared parameters, with overrides; `None` where that cannot be determined.
    pub fn params(&self) -> Option<Vec<Entry<ParamValue>>> {
        let mut unheard = self.report.unheard();
        let table = self.root.get_ref().as_table()?.get("params");
        let params = match table {
            Some(table) => params::read(table.get_ref().as_table()?, &mut unheard),
            None => Vec::new(),
        };
        (self.report.errors() + unheard.errors() == 0).then_some(params)
    }

    /// Names of all variants.
    pub fn variants(&self) -> Vec<String> {
        names_of("variant", &self.root)
    }

    /// Notes that the script adds nothing because of a mistake: an own one of it, or one that is
    /// reported when the scene is read.
    pub fn lacks_script(&mut self, mistake: Option<Diagnostic>) {
        mistake.into_iter().for_each(|m| self.report.push(m));
        self.report.note_lacking_names();
    }

    /// Lays scene text that `setup` returned beside the scene's own; `script` is what messages call
    /// it.
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
        // Those of included files are definitions only, and are not placed by themselves; neither are those
        // whose instance a layer has removed.
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
