//! The readers: one per table of the scene text, one line per key. The type, range and default of a
//! key are written here and nowhere else; the manual and the JSON Schema come from running the same readers.

mod environment;
pub mod project;
pub mod timeline;

use crate::declared::{Described, TypeDoc};
use crate::range::ANY;
use crate::table::{Either, Section, Table, value::Names, value::Version};
use crate::{desc::*, diagnostic::Diagnostic};

impl Section for SceneDesc {
    const HEADING: &'static str = "the whole file";

    fn read(t: &mut Table) -> Option<Self> {
        t.need::<Version>("version", ANY);
        let mut scene = Self {
            cameras: t.entries("camera"),
            materials: t.entries("material"),
            models: t.entries("model"),
            instances: t.list("instance"),
            groups: t.entries("group"),
            lights: t.entries("light"),
            decals: t.entries("decal"),
            environment: t.table("environment").unwrap_or_default(),
            reflection: reflection(t),
            probes: t.entries("probe"),
            image: t.table("image").unwrap_or_default(),
            motion: t.table("motion").unwrap_or_default(),
            params: t.params("params"),
            variants: t.changes("variant"),
            late: late_settings(t),
            ..Self::default()
        };
        if let Some(film) = t.table::<timeline::Film>("timeline") {
            (scene.timeline, scene.cuts) = (Some(film.timeline), film.cuts);
        }
        // These were read before, as they add to the tables above; asking for them makes them known keys.
        t.find::<At<String>>("base", ANY);
        t.find::<Names>("remove", ANY);
        t.find::<Names>("include", ANY);
        t.find::<At<String>>("script", ANY);
        if let Some(probe) = scene.probes.get(ProbesDesc::MOST) {
            let most = ProbesDesc::MOST;
            let message = format!("`{}` exceeds the limit of {most} probes", probe.name);
            let help = "remove some, or write a grid in their place: `[probes]` with `spacing_m`";
            let error = Diagnostic::new("too-many-probes", probe.at.clone(), message).help(help);
            t.report.push(error);
        }
        if let Some(decal) = scene.decals.get(DecalDesc::MOST) {
            let most = DecalDesc::MOST;
            let message = format!("`{}` exceeds the limit of {most} decals", decal.name);
            let help = "put several of them into one image with alpha, or remove some";
            let error = Diagnostic::new("too-many-decals", decal.at.clone(), message).help(help);
            t.report.push(error);
        }
        Some(scene)
    }
}

/// Settings of reflections, also of probes, of near-far and of the box.
fn reflection(t: &mut Table) -> ReflectionDesc {
    let reflection = t.table("reflection").unwrap_or_default();
    ReflectionDesc {
        probes: t.table("probes").unwrap_or_default(),
        near_far: t.table("near_far").unwrap_or_default(),
        box_faces: t.table("box_faces").unwrap_or_default(),
        ..reflection
    }
}

/// Places of settings that a later stage may refuse.
fn late_settings(t: &Table) -> Vec<LateSetting> {
    let place = |key: [&'static str; 2]| {
        let at = t.written_in(key[0], key[1])?;
        Some(LateSetting { key, at })
    };
    LATE_SETTINGS.into_iter().filter_map(place).collect()
}

impl Section for ModelDesc {
    const ALSO: &'static [&'static TypeDoc] = &[ModelSource::DOC];
    const HEADING: &'static str = "[model.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(true, &[&["file"], &["shape"]]);
        let file = t.find::<At<String>>("file", ANY);
        let shape = t.table("shape").map(ModelSource::Shape);
        let (mut material, mut overrides) = (None, Vec::new());
        let message = "`material` of a shape must be the name of a `[material.NAME]`, not a table";
        let help = "write `[material.NAME]` and `material = \"NAME\"`";
        let is_refused =
            t.has("shape") && t.refuse_table("wrong-source", "material", message, help);
        if !is_refused {
            match t.name_or_entries("material") {
                Some(Either::Name(name)) => material = Some(name),
                Some(Either::Nested(entries)) => overrides = entries,
                None => {}
            }
        }
        let lights = t.get("lights", ANY, true);
        if material.is_some() && t.has("file") {
            let message = "`material` of a file must be tables that override its materials by name";
            let help = "write `[model.NAME.material.\"*\"]` for all materials of the file";
            t.refuse("wrong-source", "material", message, help);
        }
        if t.has("shape") && t.has("lights") {
            let message = "`lights` applies to files only; shapes have no lights";
            t.refuse("wrong-source", "lights", message, "remove `lights`");
        }
        let animation = AnimationDesc::find(t);
        if t.has("shape") && t.has("animation") {
            let message = "`animation` applies to files only; shapes have no animations";
            let help = "move its instance by `[motion.instance.NAME]`";
            t.refuse("wrong-source", "animation", message, help);
        }
        let variant = t.find("variant", ANY);
        if t.has("shape") && t.has("variant") {
            let message = "`variant` applies to files only; shapes have no variants";
            t.refuse("wrong-source", "variant", message, "remove `variant`");
        }
        let usd = StageDesc::find(t, file.as_ref());
        let source = file.map(ModelSource::File).or(shape);
        Some(Self {
            source: source?,
            material,
            overrides,
            lights,
            variant,
            animation,
            usd,
        })
    }
}
