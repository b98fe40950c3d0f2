//! Keys that have no effect because of other keys, or because another key is missing.

use std::collections::HashSet;

use super::text::{rounded, warning, written};
use crate::scene::{
    desc::{
        CAMERA, CameraDesc, InstanceMaterialDesc, LIGHT, Method, NEEDING, Needing, ReflectionDesc,
    },
    diagnostic::{Diagnostic, Span},
    motion::{Kind, Names},
    stages::{Animator, Scene},
    suggest::example_of,
};
use crate::world::World;
use reflet_preview::write_back::{TrackName, all_tracks};

/// Warnings about keys in the scene's text that have no effect; `start` is a span in that text.
pub fn lint(scene: &Scene, world: &World, start: &Span) -> Vec<Diagnostic> {
    let mut found: Vec<_> = by_path(scene, start).into_iter().collect();
    found.extend(lenses(scene));
    found.extend(far_focus(scene, world));
    found.extend(still_orbits(scene));
    found.extend(dark_environment(scene, world, start));
    found.extend(shutter(scene, start));
    found.extend(materials(scene));
    found.extend(tracks_below_scripts(scene));
    found
}

/// Tracks of values that the script sets in the first, a middle and the last frame, unless it reads places.
fn tracks_below_scripts(scene: &Scene) -> Vec<Diagnostic> {
    let mut texts = scene.script.iter().flat_map(|script| &script.texts);
    let timeline = scene.timeline.as_ref();
    let frames = timeline.map(|it| [it.start, it.start + (it.end - it.start) / 3, it.end]);
    let Some(frames) = frames.filter(|_| scene.has_frame_script()) else {
        return Vec::new();
    };
    if texts.any(|(_, text)| text.contains(".position") || text.contains(".matrix")) {
        return Vec::new();
    }
    let animator = Animator::new(scene);
    let states = frames.map(|frame| animator.pose(frame).map(|state| state.scripted));
    let [Ok(first), Ok(middle), Ok(last)] = states else {
        return Vec::new();
    };
    let names = Names::from_scene(&scene.desc);
    let found = all_tracks(scene).into_iter().filter_map(|found| {
        let TrackName { kind, name, key } = &found.name;
        let of_key = |keys: &[&str]| keys.iter().position(|known| known == key);
        let (kind, index, field) = match *kind {
            "camera" => (Kind::Camera, names.cameras.get(name), of_key(&CAMERA.each_ref().map(|it| it.key))),
            "light" => (Kind::Light, names.lights.get(name), of_key(&LIGHT.each_ref().map(|it| it.key))),
            "instance" | "group" => (Kind::Node, names.instances.get(name), of_key(&["translation", "rotation_deg", "scale"])),
            _ => return None,
        };
        let (index, field) = (*index?, field?);
        let is_set = [&first, &middle, &last]
            .iter()
            .all(|frame| frame.has(kind, index, field));
        let message = format!(
            "the script sets `{key}` of \"{name}\" in the first, a middle and the last frame, where its track in `[motion]` changes nothing"
        );
        let help = "remove one of the two, or let the script compute both";
        is_set.then(|| warning("ignored-key", found.at, message, help))
    });
    found.collect()
}

/// Keys that method `path` ignores, because it follows all light.
fn by_path(scene: &Scene, start: &Span) -> Option<Diagnostic> {
    if scene.reflection.method != Method::Path {
        return None;
    }
    let keys = written(start, "reflection", ReflectionDesc::REPLACED_BY_PATH);
    let (at, _) = keys.first()?.clone();
    let names: Vec<_> = keys.iter().map(|(_, name)| name.as_str()).collect();
    let message = format!(
        "`method = \"path\"` follows all light, so {}",
        nothing(&names)
    );
    let help = "remove them, or choose another method";
    Some(Diagnostic::new("ignored-key", at, message).help(help))
}

/// An open shutter in a scene without motion.
fn shutter(scene: &Scene, start: &Span) -> Option<Diagnostic> {
    if scene.image.shutter <= 0.0 || !scene.is_still() {
        return None;
    }
    let key = written(start, "image", &["shutter"]);
    let at = key.first().map_or(start, |(at, _)| at).clone();
    let message = format!("nothing moves in the scene, so {}", nothing(&["shutter"]));
    let help = "remove it, or write `[motion]`, a script with `frame`, or `animation` of a model";
    Some(Diagnostic::new("ignored-key", at, message).help(help))
}

/// Numbers of lenses that change nothing beside the others of their camera, which neither motion nor a script changes.
fn lenses(scene: &Scene) -> Vec<Diagnostic> {
    let texts = || scene.script.iter().flat_map(|script| &script.texts);
    if texts().any(|(_, text)| text.contains("aperture") || text.contains("orthographic")) {
        return Vec::new();
    }
    let moved: HashSet<_> = scene.motion.cameras.iter().map(|it| &it.name).collect();
    let cameras = (scene.cameras.iter()).filter(|it| !moved.contains(&it.name));
    let found = cameras.filter_map(|camera| {
        let it = &camera.value;
        let focus = it.focus_m.map(|_| "focus_m");
        let (key, why, help) = match it.orthographic_height_m {
            Some(_) => (
                focus.or((it.fov_deg != CameraDesc::default().fov_deg).then_some("fov_deg"))?,
                "is orthographic, with parallel rays",
                "remove it, or remove `orthographic_height_m` for a perspective camera",
            ),
            None => (
                focus.filter(|_| it.aperture_f.is_none())?,
                "has no `aperture_f`, which makes everything sharp",
                "write `aperture_f = 2.8` beside it and `samples = 64` in `[image]`, or remove it",
            ),
        };
        let message = format!("camera \"{}\" {why}, so {}", camera.name, nothing(&[key]));
        Some(warning("ignored-key", &camera.at, message, help))
    });
    found.collect()
}

/// Open lenses that focus ten times as far as the farthest corner of the scene.
fn far_focus(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let bounds = world.static_bounds();
    let moved: HashSet<_> = scene.motion.cameras.iter().map(|it| &it.name).collect();
    let cameras =
        (scene.cameras.iter()).filter(|it| !bounds.is_empty() && !moved.contains(&it.name));
    let found = cameras.filter_map(|camera| {
        let placed = world.cameras.iter().find(|it| it.name == camera.name)?;
        let (it, eye) = (&placed.value, placed.value.eye);
        let focus_m = it.focus_m.filter(|_| it.aperture_f.is_some())?;
        let farthest_m = (eye - bounds.min)
            .abs()
            .max((eye - bounds.max).abs())
            .length();
        let message = format!(
            "camera \"{}\" focuses at {focus_m} m, far beyond the whole scene, so all is blurred",
            camera.name
        );
        let target_m = rounded(eye.distance(it.target).into());
        let help =
            format!("write `focus_m = {target_m}`, the distance of its target, or leave it out");
        let is_far = focus_m > 10.0 * farthest_m;
        is_far.then(|| warning("unlikely-value", &camera.at, message, &help))
    });
    found.collect()
}

/// Orbits of cameras about an axis on which they stand.
fn still_orbits(scene: &Scene) -> impl Iterator<Item = Diagnostic> {
    scene.motion.cameras.iter().filter_map(|moved| {
        let camera = scene.cameras.iter().find(|it| it.name == moved.name)?;
        let mut tracks = moved.value.tracks.iter();
        let (_, track) = tracks.find(|(field, _)| CAMERA[*field].key == "eye")?;
        let has_more = track.follow.is_some() || track.rate.is_some() || track.oscillate.is_some();
        let is_alone = track.keys.is_empty() && !has_more;
        let orbit = track.orbit.as_ref().filter(|_| is_alone)?;
        let from_center = camera.value.eye - orbit.center;
        let is_on_axis = from_center.reject_from(orbit.axis).length() < 1e-4;
        let name = &moved.name;
        let message =
            format!("camera \"{name}\" stands on the axis of its own orbit, so it does not move");
        let [x, y, z] = camera.value.target.to_array();
        let help = format!(
            "write the point that it shall go around, such as `center = [{x}, {y}, {z}]`, its target"
        );
        is_on_axis.then(|| warning("ignored-key", &moved.at, message, &help))
    })
}

/// An intensity of an environment that has no light.
fn dark_environment(scene: &Scene, world: &World, start: &Span) -> Option<Diagnostic> {
    let it = &scene.environment;
    let is_idle = it.intensity != 1.0 && !it.is_written && world.environment.is_black();
    let (at, _) = written(start, "environment", &["intensity"])
        .pop()
        .filter(|_| is_idle)?;
    let message = format!(
        "the environment has no light of its own, so {}",
        nothing(&["intensity"])
    );
    let help = "write its `color`, such as `color = [0.5, 0.6, 0.8]`, or the `file` of a panorama";
    Some(warning("ignored-key", &at, message, help))
}

/// Materials that lack a key without which others have no effect. Only materials named by shapes and instances
/// are checked: others may override a file's material, which has the key.
fn materials(scene: &Scene) -> Vec<Diagnostic> {
    let of_shapes = scene
        .models
        .iter()
        .filter_map(|m| m.value.material.as_ref());
    let of_instances = scene.instances.iter().filter_map(|i| match &i.material {
        Some(InstanceMaterialDesc::Named(name)) => Some(name),
        _ => None,
    });
    let used: HashSet<_> = of_shapes
        .chain(of_instances)
        .map(|name| &name.value)
        .collect();
    let mut found = Vec::new();
    for entry in scene.materials.iter().filter(|m| used.contains(&m.name)) {
        let is_alone = |key: &&Needing| (key.is_alone)(&entry.value);
        let it = &entry.value;
        let is_metal = it.metallic == Some(1.0) && it.metallic_roughness_texture.is_none();
        let tints_edges = it.edge_tint == Some(true);
        let of_others = [
            ("transmission", it.transmission > Some(0.0)),
            ("diffuse_transmission", it.diffuse_transmission > Some(0.0)),
            (
                "reflectivity",
                it.reflectivity.is_some() && it.ior.is_none(),
            ),
            ("specular", it.specular.is_some() && !tints_edges),
            (
                "specular_color",
                it.specular_color.is_some() && !tints_edges,
            ),
        ];
        let idle = of_others
            .into_iter()
            .filter(|(_, has)| is_metal && scene.is_still() && *has);
        let idle: Vec<_> = idle.map(|(key, _)| key).collect();
        if !idle.is_empty() {
            let message = format!(
                "material \"{}\" is all metal, so {}",
                entry.name,
                nothing(&idle)
            );
            let tints = match idle.contains(&"specular_color") {
                true => ", `edge_tint = true` for a metal with colored edges",
                false => "",
            };
            let help = format!(
                "write `metallic = 0`, as for glass and plastic{tints}, or remove `{}`",
                idle.join("`, `")
            );
            found.push(Diagnostic::new("ignored-key", entry.at.clone(), message).help(help));
        }
        let mut alone: Vec<_> = NEEDING.iter().filter(is_alone).collect();
        alone.retain(|key| key.key != "emission_strength" || it.patterned.is_empty());
        while let Some(&&Needing { needs: needed, .. }) = alone.first() {
            let names = alone.iter().filter(|key| key.needs == needed);
            let names: Vec<_> = names.map(|key| key.key).collect();
            let rows = alone.iter().filter(|key| names.contains(&key.key));
            let mut needs: Vec<_> = rows.map(|key| key.needs).collect();
            needs.sort_unstable();
            needs.dedup();
            alone.retain(|key| !names.contains(&key.key));
            let message = format!(
                "material \"{}\" has no `{}`, so {}",
                entry.name,
                needs.join("` and no `"),
                nothing(&names)
            );
            let them = if names.len() == 1 { "it" } else { "them" };
            let needs: Vec<_> = needs.into_iter().map(example_of).collect();
            let help = format!("write {}, or remove {them}", needs.join(" and "));
            found.push(Diagnostic::new("ignored-key", entry.at.clone(), message).help(help));
        }
    }
    found
}

/// Text saying that these keys change nothing.
fn nothing(keys: &[&str]) -> String {
    let names: Vec<_> = keys.iter().map(|key| format!("`{key}`")).collect();
    let change = if keys.len() == 1 { "changes" } else { "change" };
    format!("{} {change} nothing", names.join(", "))
}
