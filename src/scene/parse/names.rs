//! Names that refer to other tables: all of them must exist, and names must be unique.

use std::{
    collections::{HashMap, HashSet},
    ops::Range,
};

use super::{entry_kinds::named_elsewhere, extends, hierarchy};
use crate::syntax::{Entries, key_text};
use crate::table::report::Report;
use crate::{
    desc::{At, ByName, InstanceMaterialDesc, ModelSource, SceneDesc},
    diagnostic::{Diagnostic, Span},
};
use crate::{forms, suggest};

mod motion;

/// Tables that can be referred to, by name, with the place of the name.
struct Names<'a> {
    /// Kind of the tables, such as `model`.
    kind: &'static str,
    places: HashMap<&'a str, Range<usize>>,
    /// The first names in the order of the file, for suggestions.
    first: Vec<&'a str>,
    root: &'a Entries,
    used: HashSet<&'a str>,
}

impl<'a> Names<'a> {
    /// Names from the tree, not from the description: a table with a mistake still has its name.
    fn from_tree(kind: &'static str, root: &'a Entries) -> Self {
        let table = root.get(kind).and_then(|node| node.get_ref().as_table());
        let keys = table.into_iter().flat_map(|t| t.keys());
        let mut keys: Vec<_> = keys.map(|k| (k.get_ref().as_str(), k.span())).collect();
        keys.sort_by_key(|(_, at)| at.start);
        let first = keys
            .iter()
            .take(suggest::MOST_NAMES)
            .map(|(name, _)| *name)
            .collect();
        let places = keys.into_iter().collect();
        Self {
            kind,
            places,
            first,
            root,
            used: HashSet::new(),
        }
    }

    /// Reports a reference to a name that does not exist, and suggests the nearest name.
    fn refer(&mut self, to: &At<String>, report: &mut Report) {
        if let Some((name, _)) = self.places.get_key_value(to.value.as_str()) {
            self.used.insert(name);
            return;
        }
        if report.lacks_names() {
            return;
        }
        let (kind, name) = (self.kind, suggest::text(&to.value));
        let message = format!("no {kind} is named {name}");
        let mut error = Diagnostic::new("dangling-name", to.at.clone(), message);
        if !report.is_full() {
            let form = forms::explained("name", &format!("{kind} {}", to.value));
            let elsewhere = named_elsewhere(self.root, &to.value);
            let table = format!("write a table `[{kind}.{}]`", key_text(&to.value));
            let lead = match elsewhere.is_empty() {
                true => format!("{table}, or name one of the {kind}s that are there:"),
                false => format!("the {kind}s are"),
            };
            let help = if let Some((_, help)) = form {
                help
            } else if self.first.is_empty() {
                table
            } else {
                suggest::hint(&to.value, &self.first, suggest::text, &lead)
            };
            error.help = Some(format!("{elsewhere}{help}"));
            if let Some(meant) = suggest::nearest(&to.value, self.first.iter().copied()) {
                let note = format!("{} is defined here", suggest::text(meant));
                error.related = Some((report.span(&self.places[meant]).shown(), note));
            }
        }
        report.push(error);
    }
}

/// Checks all references of the scene; `root` is the tree that it was read from. Materials at places
/// where `is_included` is true need not be used.
pub fn check(
    scene: &SceneDesc,
    root: &Entries,
    is_included: &dyn Fn(&Span) -> bool,
    report: &mut Report,
) {
    let mut models = Names::from_tree("model", root);
    let mut materials = Names::from_tree("material", root);
    let by_name = ByName::from_entries(&scene.models);
    for model in &scene.models {
        let is_shape = matches!(model.value.source, ModelSource::Shape(_));
        if let (true, Some(name)) = (is_shape, &model.value.material) {
            materials.refer(name, report);
        }
    }
    for instance in &scene.instances {
        models.refer(&instance.model, report);
        if let Some(over) = &instance.over {
            models.refer(&over.model, report);
        }
        if let Some(InstanceMaterialDesc::Named(name)) = &instance.material {
            materials.refer(name, report);
        }
        let model = (instance.animation.as_ref())
            .and_then(|_| by_name.index(&instance.model.value))
            .map(|index| &scene.models[index]);
        if let Some(shape) = model.filter(|m| matches!(m.value.source, ModelSource::Shape(_))) {
            let message = "the model of this instance is a shape, which has no animations";
            let error = Diagnostic::new("wrong-motion", instance.at.clone(), message)
                .help("remove `animation`; `[motion.instance.NAME]` moves it")
                .related(shape.at.clone(), "the model is here");
            report.push(error);
        }
    }
    for decal in &scene.decals {
        materials.refer(&decal.value.material, report);
    }
    check_projected_onto(scene, report);
    check_instance_names(root, report);
    hierarchy::check(root, report);
    let mut cameras = Names::from_tree("camera", root);
    // Cameras of model files, with a `/` in their names, are known only when the files are loaded.
    let own = (scene.cuts.iter()).filter(|cut| !cut.camera.value.contains('/'));
    own.for_each(|cut| cameras.refer(&cut.camera, report));
    motion::check(scene, root, report);
    if report.errors() == 0 {
        materials
            .used
            .extend(extends::tables(root).filter_map(extends::extended));
        warn(scene, &materials, is_included, report);
    }
}

/// Checks that the instances and groups exist onto which decals are projected.
fn check_projected_onto(scene: &SceneDesc, report: &mut Report) {
    let named = scene.decals.iter().filter_map(|d| d.value.only.as_ref());
    let mut unknown = named.flatten().peekable();
    if unknown.peek().is_none() || report.lacks_names() {
        return;
    }
    let all: Vec<&str> = scene.node_names().flatten().collect();
    let known: HashSet<&str> = all.iter().copied().collect();
    for name in unknown.filter(|name| !known.contains(name.value.as_str())) {
        let message = format!(
            "no instance or group is named {}",
            suggest::text(&name.value)
        );
        let help = match all.is_empty() {
            true => {
                "give an `[[instance]]` a `name`, or leave `only` out for all of them".to_owned()
            }
            false => {
                let first = &all[..all.len().min(suggest::MOST_NAMES)];
                suggest::hint(&name.value, first, suggest::text, "the names are")
            }
        };
        report.push(Diagnostic::new("dangling-name", name.at.clone(), message).help(help));
    }
}

/// Reports each name that an earlier instance has too; from the tree, which has the place of the name.
fn check_instance_names(root: &Entries, report: &mut Report) {
    let list = root
        .get("instance")
        .and_then(|node| node.get_ref().as_array());
    let mut seen: HashMap<&str, Range<usize>> = HashMap::new();
    for item in list.into_iter().flatten() {
        let node = item
            .get_ref()
            .as_table()
            .and_then(|table| table.get("name"));
        let Some((name, at)) = node.and_then(|n| Some((n.get_ref().as_str()?, n.span()))) else {
            continue;
        };
        let Some(first) = seen.get(name) else {
            seen.insert(name, at);
            continue;
        };
        let first = report.span(first).shown();
        let message = format!("two instances are named {}", suggest::text(name));
        let error = report.error("duplicate-name", &at, message);
        error.help = Some("instance names must be unique: give one of them another `name`".into());
        error.related = Some((first, "the first one is here".into()));
    }
}

/// Warns of unused materials and of a scene without models.
fn warn(
    scene: &SceneDesc,
    materials: &Names,
    is_included: &dyn Fn(&Span) -> bool,
    report: &mut Report,
) {
    for material in &scene.materials {
        let is_used = materials.used.contains(material.name.as_str());
        if !is_used && !is_included(&material.at) {
            let message = format!(
                "no model, instance or decal uses {}",
                suggest::text(&material.name)
            );
            let warning = Diagnostic::new("unused-material", material.at.clone(), message);
            let help = format!(
                "name it by `material = {}`, or remove it",
                suggest::text(&material.name)
            );
            report.push(warning.help(help).warning());
        }
    }
    if scene.models.is_empty() {
        let message = "the scene has no model, so there is nothing to see";
        let help = "write `[model.NAME]` with `file = \"….glb\"` or `shape = { kind = \"box\" }`";
        let start = report.span(&(0..0));
        report.push(
            Diagnostic::new("empty-scene", start, message)
                .help(help)
                .warning(),
        );
    }
}
