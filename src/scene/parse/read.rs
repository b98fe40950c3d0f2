//! The readers: one per table of the scene text, one line per key. The type, range and default of a
//! key are written here and nowhere else; the manual and the JSON Schema come from running the same readers.

mod decal;
mod environment;
mod instance;
mod light;
mod material;
mod mesh;
mod motion;
mod outline;
mod outlined;
pub mod project;
mod scatter;
mod shape;
pub mod timeline;
mod track;

use glam::Vec3;

use super::hierarchy;
use crate::declared::{Described, TypeDoc};
use crate::range::{
    ABOVE_0, ANY, APERTURE_F, BOUNCES, DIFFUSE_BOUNCES, LAYERS, RATE, SEPARATION_M, STEPS, range,
};
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

impl Section for CameraDesc {
    const HEADING: &'static str = "[camera.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        hierarchy::declare_parent(t);
        let camera = Self {
            eye: t.get("eye", ANY, default.eye),
            target: t.get("target", ANY, default.target),
            up: t.get("up", ANY, default.up),
            fov_deg: t.get("fov_deg", range(1.0, 170.0), default.fov_deg),
            orthographic_height_m: t.find("orthographic_height_m", ABOVE_0),
            near_m: t.find("near_m", ABOVE_0),
            aperture_f: t.find("aperture_f", APERTURE_F),
            focus_m: t.find("focus_m", ABOVE_0),
        };
        if !t.clean() {
            return Some(camera);
        }
        if camera.orthographic_height_m.is_some() && camera.aperture_f.is_some() {
            let message = "an orthographic camera has no aperture";
            let help =
                "leave out `aperture_f`, or `orthographic_height_m` for a perspective camera";
            t.refuse("orthographic-aperture", "aperture_f", message, help);
        }
        let forward = (camera.target - camera.eye).as_dvec3();
        let up = camera.up.as_dvec3();
        let key = ["target", "eye"]
            .into_iter()
            .find(|k| t.has(k))
            .unwrap_or("target");
        if forward.length() == 0.0 {
            let help = "move `eye` or `target`: the camera looks from one to the other";
            t.refuse(
                "zero-direction",
                key,
                "`target` must differ from `eye`",
                help,
            );
        } else if up.length() == 0.0 {
            t.refuse(
                "zero-direction",
                "up",
                "`up` must not be zero",
                "write `up = [0, 1, 0]`",
            );
        } else if forward.normalize().cross(up.normalize()).length() < 1e-6 {
            let key = if t.has("up") { "up" } else { key };
            let message = "`up` must not point along the view, from `eye` to `target`";
            let help = "for a view straight down or up, write `up = [0, 0, -1]`";
            t.refuse("zero-direction", key, message, help);
        }
        Some(camera)
    }
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

impl Section for ReflectionDesc {
    const HEADING: &'static str = "[reflection]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        let mut settings = Self {
            method: t.get("method", ANY, default.method),
            marched: t.get("marched", ANY, default.marched),
            trace: t.get("trace", ANY, default.trace),
            accept: t.get("accept", ANY, default.accept),
            bounces: t.get("bounces", BOUNCES, default.bounces),
            diffuse_bounces: t.get("diffuse_bounces", DIFFUSE_BOUNCES, default.diffuse_bounces),
            steps: t.get("steps", STEPS, default.steps),
            layers: t.get("layers", LAYERS, default.layers),
            separation_m: t.find("separation_m", SEPARATION_M),
            rate: t.get("rate", RATE, default.rate),
            unit_m: t.find("unit_m", ABOVE_0),
            reuse_light: t.get("reuse_light", ANY, default.reuse_light),
            fade: t.get("fade", ANY, default.fade),
            filter: t.get("filter", ANY, default.filter),
            multiple_scattering: t.get("multiple_scattering", ANY, default.multiple_scattering),
            ..default
        };
        if settings.rate == 3 {
            let (message, help) = ("`rate` must be 1, 2 or 4, not 3", "write 2 or 4");
            t.refuse("out-of-range", "rate", message, help);
        }
        for field in &REFLECTION {
            if let Some(default) = (field.get)(&default) {
                let value = t.get(field.key, field.range, default.x);
                (field.put)(&mut settings, Vec3::splat(value));
            }
        }
        Some(settings)
    }
}
