//! The document of a scene: one tree, merged from its text, bases, included files, variants, `--set` and the
//! additions of a script, and the description that is read from it. The caller runs the scripts.

use std::{
    collections::HashSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    OVERRIDE, Parsed, ReadOptions, VARIANT, additions, extends, hierarchy,
    include::{self, Included},
    layers::{self, Base},
    names,
    placed::{self, Placed, PlacedGroup, Run},
    read::timeline::Film,
    recorded_keys, set,
    syntax_errors::{self, Shadow},
};
use crate::table::{Place, Table, params, report::Report};
use crate::{
    dependencies::Dependencies,
    desc::{At, Entry, Include, ParamValue, SceneDesc, ScriptDesc, TimelineDesc},
    diagnostic::{Diagnostic, Source, Span},
    reach::{Border, Reach},
    syntax::{Content, Entries, Node},
};

/// The texts that a document is made of: a scene's own, its bases, included files and placed scenes.
#[derive(Debug)]
pub struct Texts {
    own: Arc<Source>,
    reach: Reach,
    included: Included,
    bases: Vec<Base>,
    placed: Placed,
    report: Report,
    /// Files that were looked for.
    searched: Dependencies,
}

impl Texts {
    /// Reads the files that a scene's text names: bases, included files and placed scenes. Relative names start from
    /// the folder of the text's path, then from the folders of the border.
    pub fn collect(own: Arc<Source>, border: &Border) -> Self {
        let (mut report, searched) = (Report::default(), Dependencies::default());
        report.add(&own);
        let folder = own.path.parent().unwrap_or(Path::new("")).to_owned();
        let reach = Reach::new(folder, border);
        let included = include::collect(&own, true, &reach, &searched, &mut report);
        let bases = layers::collect(&own, true, &reach, &searched, &mut report);
        let parts = included.files().chain(bases.iter().flat_map(Base::files));
        let parts = parts.map(|file| Arc::clone(&file.source));
        let parts: Vec<_> = [Arc::clone(&own)].into_iter().chain(parts).collect();
        let placed = placed::collect(&parts, &reach, &searched, &mut report);
        Self {
            own,
            reach,
            included,
            bases,
            placed,
            report,
            searched,
        }
    }

    /// The scene's own text.
    pub fn own(&self) -> &Arc<Source> {
        &self.own
    }

    /// The files that the text names, directly or through others, in the order of reading.
    pub fn files(&self) -> impl Iterator<Item = &Include> {
        let bases = self.bases.iter().flat_map(Base::files);
        self.included
            .files()
            .chain(bases)
            .chain(self.placed.files())
    }

    /// Paths of all files that were looked for.
    pub fn searched(&self) -> Vec<PathBuf> {
        self.searched.paths()
    }

    /// Whether a place is in a file that the scene or a base of it includes, or in a placed scene.
    fn is_included(&self, at: &Span) -> bool {
        self.included.has(at)
            || self.bases.iter().any(|base| base.includes(at))
            || self.placed.has(at)
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

/// A tree that is not yet read, and the messages about it so far.
pub struct Document<'t> {
    texts: &'t Texts,
    root: Node,
    /// Parts of the texts that syntax errors make doubtful.
    shadows: Vec<Shadow>,
    report: Report,
    placed_groups: Vec<PlacedGroup>,
    placed_cameras: HashSet<String>,
}

impl<'t> Document<'t> {
    /// Merges the trees of the texts, with the variants and overrides of the options. Instances that place scenes
    /// stay as they are until [`Document::place_scenes`].
    pub fn new(texts: &'t Texts, options: &ReadOptions) -> Self {
        let named = |name: &'static str| move |text: &String| Arc::new(Source::new(name, text));
        let overrides: Vec<_> = options.overrides.iter().map(named(OVERRIDE)).collect();
        let variants: Vec<_> = options.variants.iter().map(named(VARIANT)).collect();
        let own = std::iter::once(&texts.own)
            .chain(&overrides)
            .chain(&variants);
        let files = texts.files().map(|file| &file.source);
        let mut report = (texts.report.clone()).with_sources(own.chain(files).cloned());
        if options.only_chosen {
            report.keep_variants(&options.variants);
        }
        let (tree, mut shadows) = syntax_errors::tree(&texts.own, &mut report);
        let mut root = Node::new(0..0, Content::Table(tree));
        include::merge(&mut root, &texts.included, &mut shadows, &mut report);
        let root = layers::merge(root, &texts.bases, &mut shadows, &mut report);
        let mut root = layers::choose(root, &variants, &mut report);
        for text in &overrides {
            set::apply(&mut root, text, &mut report);
        }
        Self {
            texts,
            root,
            shadows,
            report,
            placed_groups: Vec::new(),
            placed_cameras: HashSet::new(),
        }
    }

    /// Replaces the instances that place scenes by the entries of these scenes. `run` runs their scripts.
    pub fn place_scenes(&mut self, run: Run) {
        let timeline = film_of(&self.root, &self.report).map(|film| film.timeline);
        let own_cameras: HashSet<_> = names_of("camera", &self.root);
        self.placed_groups = placed::expand(
            &mut self.root,
            &self.texts.placed,
            run,
            timeline.as_ref(),
            &mut self.shadows,
            &mut self.report,
        );
        self.placed_cameras = names_of("camera", &self.root);
        (self.placed_cameras).retain(|name| !own_cameras.contains(name));
    }

    /// Groups that stand for placed scenes, inner ones first.
    pub fn placed_groups(&self) -> &[PlacedGroup] {
        &self.placed_groups
    }

    /// Folders where files are looked for, the scene's own first.
    pub fn reach(&self) -> &'t Reach {
        &self.texts.reach
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

    /// Merges scene text that `setup` returned into the tree.
    pub fn add(&mut self, text: &Arc<Source>) {
        additions::merge(&mut self.root, text, &mut self.report);
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
        // Syntax errors that fill the report make all other mistakes doubtful.
        let surplus = report.surplus().filter(|_| !shadows.is_empty());
        extends::resolve(&mut root, &mut report);
        let nothing = Entries::new();
        let table = root.get_ref().as_table().unwrap_or(&nothing);
        let place = Place {
            all: Some(recorded_keys),
            ..Place::default()
        };
        let mut scene = Table::read::<SceneDesc>(&mut report, table, place).unwrap_or_default();
        scene.own = Span {
            source: Some(Arc::clone(&texts.own)),
            range: 0..0,
        };
        scene.folder.clone_from(&texts.reach.folders()[0]);
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
        let used: HashSet<_> = (scene.instances.iter())
            .map(|i| i.model.value.as_str())
            .collect();
        let stands = |m: &Entry<_>| !texts.is_included(&m.at) && !report.is_unplaced(&m.name);
        (scene.models).retain(|m| used.contains(m.name.as_str()) || stands(m));
        report.retain(|d| !shadows.iter().any(|s| s.hides(d)));
        surplus
            .into_iter()
            .for_each(|count| report.restore_surplus(count));
        placed::name_as_written(&placed_groups, &texts.placed, &mut report);
        if report.has("unsupported-version") {
            // In another version other keys may be right.
            report.retain(|d| d.name == "unsupported-version");
        }
        match report.finish() {
            (messages, false) => {
                scene.includes = texts.files().cloned().collect();
                Ok((scene, messages))
            }
            (messages, true) => Err(messages),
        }
    }
}
