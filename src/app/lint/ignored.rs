//! Keys that have no effect because of other keys, or because another key is missing.

use std::collections::HashSet;

use super::text::{TextEntry, each_entry, number, rounded, warning, written};
use crate::{
    scene::{
        desc::{InstanceMaterialDesc, Method, NEEDING, Needing, ReflectionDesc},
        diagnostic::{Diagnostic, Span},
        stages::Scene,
        suggest::example_of,
        syntax::Node,
    },
    world::World,
};

/// Warnings about keys in the scene's text that have no effect; `start` is a span in that text.
pub fn lint(scene: &Scene, world: &World, start: &Span) -> Vec<Diagnostic> {
    let mut found: Vec<_> = by_path(scene, start).into_iter().collect();
    found.extend(idle(scene, start));
    found.extend(excessive(scene, world, start));
    found.extend(shutter(scene, start));
    found.extend(materials(scene));
    found
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

/// Keys of the scene's own text that change nothing beside the others of their table, or by their value. Texts of several
/// layers are left out, and keys that motion or scripts may change.
fn idle(scene: &Scene, start: &Span) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let Some(source) = &start.source else {
        return found;
    };
    let root = source.syntax().root();
    if root.contains_key("base") || root.contains_key("include") {
        return found;
    }
    let mut moved = HashSet::new();
    each_entry(root, "", &mut |it| {
        moved.extend(
            it.table
                .starts_with("motion.")
                .then(|| it.name().to_owned()),
        );
    });
    let scripts: Vec<_> = scene.script.iter().flat_map(|it| &it.texts).collect();
    let is_moved = |key: &str| moved.contains(key) || scripts.iter().any(|it| it.1.contains(key));
    each_entry(root, "", &mut |it: &TextEntry| {
        let has = |key: &str| it.beside.contains_key(key) || is_moved(key);
        let kind = it.table.split('.').next().unwrap_or_default();
        let key = it.name();
        let (message, help) = match (kind, key) {
            ("camera", "fov_deg" | "focus_m")
                if it.beside.contains_key("orthographic_height_m") =>
            {
                (
                    format!(
                        "the rays of an orthographic camera are parallel, so {}",
                        nothing(&[key])
                    ),
                    "remove it, or remove `orthographic_height_m` for a perspective camera",
                )
            }
            ("camera", "focus_m") if !has("aperture_f") => (
                format!(
                    "without `aperture_f` everything is sharp, so {}",
                    nothing(&[key])
                ),
                "write `aperture_f = 2.8` beside it and `samples = 64` in `[image]`, or remove it",
            ),
            ("motion", "rate") if is_track(it) && is_zero(it.node) => (
                "a rate of 0 changes nothing".to_owned(),
                "write the change in each second, as in `rate = [0, 90, 0]` for a quarter turn about Y, or remove the track",
            ),
            ("motion", "keys") if is_track(it) && has_one_value(it.node, &source.text) => (
                "all keys have the same value, so nothing changes".to_owned(),
                "write another value at another time, as in `{ at_s = 2, value = … }`, or write the value outside of `[motion]`",
            ),
            _ => return,
        };
        if kind == "motion" || !(is_moved(key) || it.beside.contains_key("extends")) {
            found.push(warning("ignored-key", &it.at(source), message, help));
        }
    });
    found
}

/// Whether a track has nothing but its keys or its rate.
fn is_track(it: &TextEntry) -> bool {
    let others = ["keys", "rate", "follow", "orbit", "oscillate"];
    (others.iter().filter(|key| it.beside.contains_key(**key))).count() == 1
}

/// Whether a value of scene text is 0, or a list of nothing else.
fn is_zero(node: &Node) -> bool {
    match node.get_ref().as_array() {
        Some(list) => !list.is_empty() && list.iter().all(is_zero),
        None => number(node) == Some(0.0),
    }
}

/// Whether the keys of a track have one value between them, by their text.
fn has_one_value(keys: &Node, text: &str) -> bool {
    let keys = keys.get_ref().as_array().into_iter().flatten();
    let values = keys.map(|key| Some(&text[key.get_ref().as_table()?.get("value")?.span()]));
    let values: HashSet<_> = values.collect();
    values.len() == 1 && !values.contains(&None)
}

/// Numbers of the scene's own text that are so large that hardly anything is seen, or changes.
fn excessive(scene: &Scene, world: &World, start: &Span) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let (Some(source), Some(camera)) = (&start.source, world.cameras.get(world.main_camera()))
    else {
        return found;
    };
    let camera = &camera.value;
    let length_m = f64::from(camera.eye.distance(camera.target));
    let height_m = 2.0 * f64::from(camera.half_height_m(length_m as f32));
    let timeline = scene.timeline.as_ref().filter(|it| it.end > 0);
    let seconds = timeline.map(|it| (f64::from(it.end), f64::from(it.fps)));
    each_entry(source.syntax().root(), "", &mut |it| {
        let Some(x) = number(it.node) else { return };
        let (message, help) = match (it.table, it.name(), seconds) {
            ("environment.fog", "density", _)
                if x * length_m > 12.0 && !it.beside.contains_key("falloff_m") =>
            {
                let fitting = rounded(0.5 / length_m);
                let message = format!("fog of density {x} hides all that the camera looks at");
                (message, format!("write `density = {fitting}`"))
            }
            (table, "size", _)
                if x > 4.0 * height_m
                    && table.ends_with(".shape")
                    && it.beside.contains_key("text") =>
            {
                let message = format!("letters of {x} m are several times as high as the picture");
                (
                    message,
                    format!("write `size = {}`, in meters", rounded(height_m / 8.0)),
                )
            }
            (_, "period_s", Some((end, fps))) if x * fps > 50.0 * end => {
                let message = format!(
                    "a period of {x} s is so much longer than the timeline that next to nothing changes"
                );
                let frames = rounded(x / fps);
                (
                    message,
                    format!("write `period_s = {frames}` if {x} frames were meant"),
                )
            }
            _ => return,
        };
        found.push(warning("unlikely-value", &it.at(source), message, &help));
    });
    found
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
        if is_metal && it.transmission > Some(0.0) && scene.is_still() {
            let message = format!(
                "material \"{}\" is all metal, so {}",
                entry.name,
                nothing(&["transmission"])
            );
            let help = "write `metallic = 0` for glass, or remove `transmission`";
            found.push(Diagnostic::new("ignored-key", entry.at.clone(), message).help(help));
        }
        let mut alone: Vec<_> = NEEDING.iter().filter(is_alone).collect();
        alone.retain(|key| key.key != "emission_strength" || it.patterned.is_empty());
        while let Some(&&Needing { needs: needed, .. }) = alone.first() {
            let names = alone.iter().filter(|key| key.needs == needed);
            let names: Vec<_> = names.map(|key| key.key).collect();
            alone.retain(|key| !names.contains(&key.key));
            let message = format!(
                "material \"{}\" has no `{needed}`, so {}",
                entry.name,
                nothing(&names)
            );
            let them = if names.len() == 1 { "it" } else { "them" };
            let help = format!("write {}, or remove {them}", example_of(needed));
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
