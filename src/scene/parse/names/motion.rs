//! Checks `[motion]`: the entries that it moves must exist and must have the values that it moves.

mod zero_scale;

use std::collections::HashSet;

use super::Names;
use crate::syntax::{Entries, key_text};
use crate::table::report::Report;
use crate::{
    desc::{
        At, ByName, CAMERA, DecalMotionDesc, Entry, InstanceDesc, InstanceMaterialDesc,
        InstanceMotionDesc, LIGHT, LightMotionDesc, MATERIAL, MaterialDesc, MaterialMotionDesc,
        ModelMotionDesc, ModelSource, PlacementDesc, SceneDesc, TrackDesc, Tracks,
    },
    diagnostic::{Diagnostic, Span},
    motion::{DECAL, ModelTables},
    number::{Field, Form},
    parse::overlay,
    suggest,
};

/// A scene with the indices of its entries by name.
struct Indexed<'a> {
    scene: &'a SceneDesc,
    instances: ByName<'a>,
    groups: ByName<'a>,
    lights: ByName<'a>,
    materials: ByName<'a>,
    models: ByName<'a>,
    nodes: NodeNames<'a>,
}

impl<'a> Indexed<'a> {
    fn new(scene: &'a SceneDesc, root: &'a Entries) -> Self {
        Self {
            scene,
            instances: ByName::of_names(scene.instances.iter().map(|i| i.name.as_deref())),
            groups: ByName::from_entries(&scene.groups),
            lights: ByName::from_entries(&scene.lights),
            materials: ByName::from_entries(&scene.materials),
            models: ByName::from_entries(&scene.models),
            nodes: NodeNames::from_tree(root),
        }
    }

    fn instance(&self, name: &str) -> Option<&'a InstanceDesc> {
        Some(&self.scene.instances[self.instances.index(name)?])
    }
}

/// Names of instances and groups, from the tree: one with a mistake still has its name.
struct NodeNames<'a> {
    instances: HashSet<&'a str>,
    /// The first names of instances, for suggestions.
    first: Vec<&'a str>,
    groups: Option<&'a Entries>,
}

impl<'a> NodeNames<'a> {
    fn from_tree(root: &'a Entries) -> Self {
        let list = root.get("instance").and_then(|n| n.get_ref().as_array());
        let names = || list.into_iter().flatten().filter_map(overlay::name_of);
        Self {
            instances: names().collect(),
            first: names().take(suggest::MOST_NAMES).collect(),
            groups: root.get("group").and_then(|n| n.get_ref().as_table()),
        }
    }

    fn is_group(&self, name: &str) -> bool {
        self.groups.is_some_and(|groups| groups.contains_key(name))
    }

    /// Checks the name of an instance.
    fn refer(&self, name: &str, at: &Span, report: &mut Report) {
        if self.instances.contains(name) || report.lacks_names() {
            return;
        }
        let message = format!("no instance is named {}", suggest::text(name));
        let error = Diagnostic::new("dangling-name", at.clone(), message);
        if report.is_full() {
            return report.push(error);
        }
        let help = if self.is_group(name) {
            format!(
                "it is a group; write `[motion.group.{}]`",
                key_text(&suggest::clip(name))
            )
        } else if self.first.is_empty() {
            "give an `[[instance]]` a `name`".to_owned()
        } else {
            let lead = "the instances with a name are";
            suggest::hint(name, &self.first, suggest::text, lead)
        };
        report.push(error.help(help));
    }
}

/// Checks all names of `[motion]`, and that there is a timeline to move on.
pub fn check(scene: &SceneDesc, root: &Entries, report: &mut Report) {
    let motion = &scene.motion;
    refer_all("camera", root, &motion.cameras, report);
    refer_all("light", root, &motion.lights, report);
    refer_all("material", root, &motion.materials, report);
    refer_all("model", root, &motion.models, report);
    refer_all("group", root, &motion.groups, report);
    refer_all("decal", root, &motion.decals, report);
    let all = Indexed::new(scene, root);
    for entry in &motion.instances {
        all.nodes.refer(&entry.name, &entry.at, report);
        check_override(&all, entry, report);
        if let Some(instance) = all.instance(&entry.name) {
            check_placed(
                scene,
                &instance.placement,
                &instance.at,
                &entry.value,
                &entry.at,
                report,
            );
        }
        check_own(&entry.value, report);
    }
    for entry in &motion.groups {
        if let Some(index) = all.groups.index(&entry.name) {
            let group = &scene.groups[index];
            check_placed(
                scene,
                &group.value.placement,
                &group.at,
                &entry.value,
                &entry.at,
                report,
            );
        }
        check_own(&entry.value, report);
    }
    decals(&all, &motion.decals, report);
    for entry in &motion.cameras {
        check_tracks(&all, &entry.value.tracks, &CAMERA, &entry.at, report);
    }
    for entry in &motion.lights {
        check_tracks(&all, &entry.value.tracks, &LIGHT, &entry.at, report);
        check_light(&all, entry, report);
    }
    for entry in &motion.materials {
        check_tracks(&all, &entry.value.tracks, &MATERIAL, &entry.at, report);
        if let Some(index) = all.materials.index(&entry.name) {
            let path = || format!("`[material.{}]`", suggest::clip(&entry.name));
            check_material(&scene.materials[index].value, entry, path, report);
        }
    }
    for entry in &motion.models {
        check_model(&all, entry, report);
    }
    if scene.timeline.is_none() && report.errors() == 0 {
        warn_of_standing_still(scene, root, report);
    }
}

/// Warns of motion in a scene without a timeline, where it stands still.
fn warn_of_standing_still(scene: &SceneDesc, root: &Entries, report: &mut Report) {
    let script = scene.script.as_ref().filter(|script| script.has_frame);
    let script = script.and_then(|_| root.get("script"));
    let (at, what) = match (first_motion(scene), script) {
        (Some(first), _) => (first, "something moves"),
        (None, Some(script)) => (
            report.span(&script.span()),
            "the script has `fn frame(ctx)`",
        ),
        (None, None) => return,
    };
    let message = format!("{what}, but there is no `[timeline]`, so only time 0 is shown");
    let warning = Diagnostic::new("no-timeline", at, message);
    report.push(warning.help("write `[timeline]` with `end = 47`").warning());
}

/// Refuses motion of an entry that is placed by `matrix`, and scale tracks that pass through 0.
fn check_placed(
    scene: &SceneDesc,
    placement: &PlacementDesc,
    at: &Span,
    motion: &InstanceMotionDesc,
    moved_at: &Span,
    report: &mut Report,
) {
    let is_moved = motion.is_placed_by_tracks() || motion.shown.is_none();
    if is_moved && motion.moves() && matches!(placement, PlacementDesc::Matrix(_)) {
        let message =
            "an instance, a group or a decal that is placed by `matrix` cannot have motion";
        let error = Diagnostic::new("wrong-motion", moved_at.clone(), message)
            .help("place it by `translation`, `rotation_deg` and `scale`")
            .related(at.clone(), "it is placed here");
        report.push(error);
    }
    zero_scale::check(scene.timeline.as_ref(), placement, motion, moved_at, report);
}

/// Refuses instances, groups and decals that follow others: in a loop of these no order would be right.
fn check_own(motion: &InstanceMotionDesc, report: &mut Report) {
    for track in [&motion.translation, &motion.rotation_deg] {
        if let Some(follow) = track.as_ref().and_then(|t| t.follow.as_ref()) {
            let message = "an instance, a group or a decal cannot follow another one";
            let error = Diagnostic::new("wrong-motion", follow.instance.at.clone(), message);
            report.push(
                error.help("only cameras and lights follow; name the other one as its `parent`"),
            );
        }
    }
}

fn check_model(all: &Indexed, entry: &Entry<ModelMotionDesc>, report: &mut Report) {
    let model = all.models.index(&entry.name);
    let model = model.map(|index| &all.scene.models[index]);
    let has_keys = !entry.value.materials.is_empty() || report.errors() == 0;
    let shape = model.filter(|m| matches!(m.value.source, ModelSource::Shape(_)));
    if let Some(model) = shape.filter(|_| has_keys) {
        let name = suggest::text(&entry.name);
        let message = format!("model {name} is a shape, which has no materials of its own");
        let error = Diagnostic::new("wrong-motion", entry.at.clone(), message)
            .help("write `[motion.material.NAME]` with the name of its `[material.NAME]`")
            .related(model.at.clone(), "the model is here");
        report.push(error);
    }
    let tables = ModelTables::for_model(model);
    for material in &entry.value.materials {
        check_tracks(all, &material.value.tracks, &MATERIAL, &material.at, report);
        let path = || {
            let [model, name] = [&entry.name, &material.name].map(|name| suggest::clip(name));
            let name = if name == "*" { "\"*\"".into() } else { name };
            format!("`[model.{model}.material.{name}]`")
        };
        check_material(&tables.written(&material.name), material, path, report);
    }
}

/// Checks motion of an instance's own material, which the instance must have.
fn check_override(all: &Indexed, entry: &Entry<InstanceMotionDesc>, report: &mut Report) {
    let Some(motion) = &entry.value.material else {
        return;
    };
    check_tracks(all, &motion.tracks, &MATERIAL, &entry.at, report);
    let Some(instance) = all.instance(&entry.name) else {
        return;
    };
    let help = match &instance.material {
        Some(InstanceMaterialDesc::Override(rest)) => {
            let motion = Entry {
                name: entry.name.clone(),
                at: entry.at.clone(),
                value: motion.clone(),
            };
            let path = || format!("`material` of instance {}", suggest::text(&entry.name));
            return check_material(rest, &motion, path, report);
        }
        Some(InstanceMaterialDesc::Named(name)) => {
            let name = suggest::clip(&name.value);
            format!("write `[motion.material.{name}]`, or `material = {{}}` in its [[instance]]")
        }
        None => "write `material = {}` in its [[instance]]".to_owned(),
    };
    let message = "this instance has no `material = { … }` of its own that could change";
    let error = Diagnostic::new("wrong-motion", entry.at.clone(), message).help(help);
    report.push(error.related(instance.at.clone(), "the instance is here"));
}

fn first_motion(scene: &SceneDesc) -> Option<Span> {
    let motion = &scene.motion;
    let cameras = motion.cameras.iter().map(|e| &e.at);
    let instances = motion.instances.iter().chain(&motion.groups).map(|e| &e.at);
    let lights = motion.lights.iter().map(|e| &e.at);
    let lights = lights.chain(motion.decals.iter().map(|e| &e.at));
    let materials = motion.materials.iter().map(|e| &e.at);
    let models = scene.models.iter().map(|e| &e.value.animation);
    let played = models.chain(scene.instances.iter().map(|i| &i.animation));
    let played = played.flatten().flat_map(|a| &a.name).map(|name| &name.at);
    let all = cameras.chain(instances).chain(lights);
    let of_files = motion.models.iter().map(|e| &e.at);
    let all = all.chain(materials).chain(of_files).chain(played);
    all.min_by_key(|at| at.range.start).cloned()
}

fn followed(track: &TrackDesc) -> Option<&At<String>> {
    Some(&track.follow.as_ref()?.instance)
}

fn refer_all<T>(kind: &'static str, root: &Entries, moved: &[Entry<T>], report: &mut Report) {
    let mut names = Names::from_tree(kind, root);
    for entry in moved {
        let to = At {
            value: entry.name.clone(),
            at: entry.at.clone(),
        };
        names.refer(&to, report);
    }
}

/// Checks motion of decals. One that is placed by `matrix` may still change its size and opacity.
fn decals(all: &Indexed, motion: &[Entry<DecalMotionDesc>], report: &mut Report) {
    let known = ByName::from_entries(&all.scene.decals);
    for Entry { name, at, value } in motion {
        check_own(&value.place, report);
        check_tracks(all, &value.tracks, &DECAL, at, report);
        if let (Some(index), true) = (known.index(name), value.place.is_placed_by_tracks()) {
            let decal = &all.scene.decals[index];
            check_placed(
                all.scene,
                &decal.value.placement,
                &decal.at,
                &value.place,
                at,
                report,
            );
        }
    }
}

/// Checks the instances that tracks follow.
fn check_tracks<T>(
    all: &Indexed,
    tracks: &Tracks,
    fields: &[Field<T>],
    at: &Span,
    report: &mut Report,
) {
    for (field, track) in tracks {
        if fields[*field].form == Form::Vector {
            if let Some(follow) = followed(track)
                && !all.nodes.is_group(&follow.value)
            {
                (all.nodes).refer(&follow.value, &follow.at, report);
            }
        } else if track.follow.is_some() || track.orbit.is_some() {
            let message = "`follow` and `orbit` apply to positions alone";
            report.push(Diagnostic::new("wrong-motion", at.clone(), message));
        }
    }
}

fn check_light(all: &Indexed, entry: &Entry<LightMotionDesc>, report: &mut Report) {
    let Some(index) = all.lights.index(&entry.name) else {
        return;
    };
    let light = &all.scene.lights[index];
    let kind = light.value.kind.name();
    let fields = entry.value.tracks.iter().map(|(field, _)| &LIGHT[*field]);
    for field in fields.filter(|field| (field.get)(&light.value).is_none()) {
        let message = format!("`{}` does not apply to a {kind} light", field.key);
        let known = LIGHT.iter().filter(|it| (it.get)(&light.value).is_some());
        let known: Vec<_> = known.map(|it| it.key).collect();
        let help = suggest::hint(field.key, &known, suggest::key, "its tracks are");
        let error = Diagnostic::new("wrong-motion", entry.at.clone(), message).help(help);
        report.push(error.related(light.at.clone(), "the light is here"));
    }
}

/// Refuses tracks of values that need another key in the material's table, which messages call `path`.
fn check_material(
    rest: &MaterialDesc,
    entry: &Entry<MaterialMotionDesc>,
    path: impl Fn() -> String,
    report: &mut Report,
) {
    for (field, _) in &entry.value.tracks {
        let field = &MATERIAL[*field];
        if let Some(lacking) = field.lacks(rest) {
            let message = format!("`{}` moves, but {} has none", field.key, path());
            let error = Diagnostic::new("wrong-motion", entry.at.clone(), message);
            report.push(error.help(format!("write `{lacking}` in {}", path())));
        }
    }
}
