//! The readers of tables whose keys follow from each other, so that no declaration of their fields says how they are
//! read. The manual and the JSON Schema come from running the readers of all tables.

pub mod timeline;

use crate::range::range;
use std::sync::Arc;

use glam::Vec3;

use crate::{
    declared::{Described, TypeDoc},
    desc::{EnvironmentDesc, EnvironmentShadow, LightGroup, ProjectDesc, *},
    diagnostic::{Diagnostic, Source},
    parse::syntax_errors,
    range::{ANY, FROM_0},
    table::{
        Either, Place, Section, Table,
        color::Color,
        report::Report,
        value::{Names, Version},
    },
};

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
    let place = |(key, _): ([&'static str; 2], _)| {
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
        t.files("file", MODEL_ENDINGS);
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
            let help = format!(
                "write `[{}.material.\"*\"]` with `extends = {}` for all materials of the file, or this line in its \
                 `[[instance]]`",
                t.path(),
                material
                    .as_ref()
                    .map_or_else(String::new, |it| crate::suggest::text(&it.value))
            );
            t.refuse("wrong-source", "material", message, &help);
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

/// Text of a project, and warnings about it.
///
/// # Errors
/// All mistakes of the text.
pub fn read_project(
    source: &Arc<Source>,
) -> Result<(ProjectDesc, Vec<Diagnostic>), Vec<Diagnostic>> {
    let mut report = Report::default();
    report.add(source);
    let (tree, shadows) = syntax_errors::tree(source, &mut report);
    let place = Place {
        whole: "a project",
        ..Place::default()
    };
    let read = Table::read::<ProjectDesc>(&mut report, &tree, place);
    report.retain(|d| !shadows.iter().any(|s| s.hides(d)));
    match report.finish() {
        (messages, false) => Ok((read.unwrap_or_default(), messages)),
        (messages, true) => Err(messages),
    }
}

impl Section for EnvironmentDesc {
    const HEADING: &'static str = "[environment]";

    fn read(t: &mut Table) -> Option<Self> {
        let gradient: &[&str] = &["zenith", "horizon", "ground"];
        t.one_of(false, &[&["file"], &["color"], gradient]);
        let color = t.find("color", FROM_0).unwrap_or(Color(Vec3::ZERO));
        let default = Self::default();
        let has_colors = ["color", "zenith", "horizon", "ground"]
            .map(|key| t.has(key))
            .contains(&true);
        let environment = Self {
            zenith: t.get("zenith", FROM_0, color).0,
            horizon: t.get("horizon", FROM_0, color).0,
            ground: t.get("ground", FROM_0, color).0,
            file: t.find("file", ANY),
            layer: t.find("layer", ANY),
            rotation_deg: t.get("rotation_deg", ANY, default.rotation_deg),
            intensity: t.get("intensity", FROM_0, default.intensity),
            visible: t.get("visible", ANY, default.visible),
            background: t
                .find("background", range(0.0, 1000.0))
                .map(|Color(color)| color),
            shadow: t.find("shadow", ANY).unwrap_or(match has_colors {
                true => EnvironmentShadow::None,
                false => EnvironmentShadow::Ray,
            }),
            fog: t.table("fog"),
            light_group: LightGroup::find(t).unwrap_or_default(),
            is_written: has_colors || t.has("file"),
        };
        t.files("file", PANORAMA_ENDINGS);
        let of_file = t.needing("file", &["rotation_deg", "layer"]);
        if let Some(key) = of_file.first().filter(|_| t.clean()) {
            let does = if *key == "layer" { "is of" } else { "turns" };
            let message = format!("`{key}` {does} a `file`; there is none");
            t.refuse("wrong-source", key, &message, &format!("remove `{key}`"));
        }
        Some(environment)
    }
}
