//! The readers of tables whose keys follow from each other, so that no declaration of their fields says how they are
//! read. The manual and the JSON Schema come from running the readers of all tables.

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
            reflection: ReflectionDesc::with_maps(t),
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
        t.files("base", &["toml"]);
        t.files("include", &["toml"]);
        t.files("script", &["rhai"]);
        let help = "remove some, or write a grid in their place: `[probes]` with `spacing_m`";
        refuse_more(
            t,
            &scene.probes,
            ProbesDesc::MOST,
            ["too-many-probes", "probes", help],
        );
        let help = "put several of them into one image with alpha, or remove some";
        refuse_more(
            t,
            &scene.decals,
            DecalDesc::MOST,
            ["too-many-decals", "decals", help],
        );
        Some(scene)
    }
}

/// Refuses entries of a kind beyond the limit.
fn refuse_more<T>(t: &mut Table, all: &[Entry<T>], most: usize, say: [&'static str; 3]) {
    let [name, kind, help] = say;
    if let Some(Entry {
        name: first, at, ..
    }) = all.get(most)
    {
        let message = format!("`{first}` exceeds the limit of {most} {kind}");
        t.report
            .push(Diagnostic::new(name, at.clone(), message).help(help));
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
        t.files("file", &["gltf", "glb", "usd", "usda", "usdc", "usdz"]);
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
        t.refers("material", &["material"]);
        let lights = t.get("lights", ANY, true);
        if material.is_some() && t.has("file") {
            let message = "`material` of a file must be tables that override its materials by name";
            let help = "write `[model.NAME.material.\"*\"]` for all materials of the file";
            t.refuse("wrong-source", "material", message, help);
        }
        let animation = AnimationDesc::find(t);
        let variant = t.find("variant", ANY);
        for (key, things, help) in [
            ("lights", "lights", "remove `lights`"),
            (
                "animation",
                "animations",
                "move its instance by `[motion.instance.NAME]`",
            ),
            ("variant", "variants", "remove `variant`"),
        ] {
            if t.has("shape") && t.has(key) {
                let message = format!("`{key}` applies to files only; shapes have no {things}");
                t.refuse("wrong-source", key, &message, help);
            }
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
