//! Settings that a scene may have, whose effect is grain, or not to be seen at all.

use std::collections::HashSet;

use super::text::{each_value, number, rounded, warning, written};
use crate::{
    scene::{
        desc::InstanceMaterialDesc,
        diagnostic::{Diagnostic, Span},
        stages::Scene,
        syntax::{Entries, Node},
    },
    world::{Material, World},
};

/// Warnings about such settings of the scene's text; `start` is a span in that text.
pub fn lint(scene: &Scene, world: &World, start: &Span) -> Vec<Diagnostic> {
    let mut found = grain(scene, start);
    found.extend(invisible_materials(scene, world));
    found.extend(clear(scene));
    found.extend(frosted(scene));
    found.extend(emitters(scene, world));
    found.extend(late_keys(scene, start));
    found.extend(unseen_cameras(scene, world));
    found
}

/// Lenses and shutters that are open for a picture of one sample.
fn grain(scene: &Scene, start: &Span) -> Vec<Diagnostic> {
    if scene.image.samples.count() != 1 {
        return Vec::new();
    }
    let help = "write `samples = 64` in `[image]`; it is 1";
    let moving = scene.image.shutter > 0.0 && !scene.is_still();
    let lens = scene.cameras.iter().find(|c| c.value.aperture_f.is_some());
    let shutter = written(start, "image", &["shutter"]).into_iter().next();
    let (what, at) = match (shutter.filter(|_| moving), lens) {
        (Some((at, _)), _) => ("the shutter".to_owned(), at),
        (None, Some(camera)) => (
            format!("the lens of camera \"{}\"", camera.name),
            camera.at.clone(),
        ),
        (None, None) => return Vec::new(),
    };
    let message = format!("{what} is open, and with 1 sample its blur is grain");
    vec![warning("one-sample", &at, message, help)]
}

/// Materials of alpha 0 that instances show, in a scene without motion.
fn invisible_materials(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let is_clear = |m: &Material| {
        let is_blended = m.blended && m.alpha_cutoff.is_none() && m.patterned.is_empty();
        let is_lamp = m.light && m.emission.max_element() > 0.0;
        is_blended && !is_lamp && m.base_color.w == 0.0
    };
    let used = world.instances.iter().map(|i| &world.materials[i.material]);
    let clear: HashSet<&str> = (used.filter(|m| is_clear(m)))
        .map(|m| m.name.as_str())
        .collect();
    let is_found = |name: &str| scene.is_still() && clear.contains(name);
    let entries = scene.materials.iter().filter(|m| is_found(&m.name));
    let found = entries.map(|material| {
        let message = format!(
            "material \"{}\" is invisible by its `alpha` of 0",
            material.name
        );
        let help = "write `alpha = 1`, or `visible = false` in its instances";
        warning("invisible-material", &material.at, message, help)
    });
    found.collect()
}

/// Materials with an index of refraction, but no color and no way for light through them.
fn clear(scene: &Scene) -> impl Iterator<Item = Diagnostic> {
    scene.materials.iter().filter_map(|entry| {
        let it = &entry.value;
        let is_plain =
            it.base_color.is_none() && it.base_color_texture.is_none() && it.patterned.is_empty();
        let is_white = is_plain && it.checker.is_none() && it.metallic.is_none();
        (it.ior.is_some() && it.transmission.is_none() && is_white).then(|| {
            let message = format!(
                "material \"{}\" has an `ior`, but no light passes through it: it is white",
                entry.name
            );
            warning(
                "opaque-ior",
                &entry.at,
                message,
                "write `transmission = 1` for glass or water",
            )
        })
    })
}

/// Glass that scatters all light, as its roughness is 1 where none is written.
fn frosted(scene: &Scene) -> impl Iterator<Item = Diagnostic> {
    let mut texts = scene.script.iter().flat_map(|script| &script.texts);
    let is_scripted = texts.any(|(_, text)| text.contains("roughness"));
    let is_overridden = scene.instances.iter().any(|it| match &it.material {
        Some(InstanceMaterialDesc::Override(own)) => own.roughness.is_some(),
        _ => false,
    });
    let moved: HashSet<_> = scene.motion.materials.iter().map(|it| &it.name).collect();
    let own = (scene.materials.iter()).filter(move |it| !moved.contains(&it.name));
    own.filter_map(move |entry| {
        let it = &entry.value;
        let is_unwritten = !(is_scripted || is_overridden)
            && it.roughness.is_none()
            && it.metallic_roughness_texture.is_none()
            && it.patterned.is_empty();
        let is_glass = it.transmission > Some(0.5) && it.base_color_texture.is_none();
        (is_glass && is_unwritten).then(|| {
            let message = format!(
                "material \"{}\" has no `roughness`, so its roughness is 1: frosted glass",
                entry.name
            );
            warning(
                "frosted-glass",
                &entry.at,
                message,
                "write `roughness = 0` for clear glass, or 1 for this one",
            )
        })
    })
}

/// Materials with emission that light nothing, in a scene without another light.
fn emitters(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let shines = |m: &Material| m.emission.max_element() > 0.0;
    let materials = world.instances.iter().map(|i| &world.materials[i.material]);
    let all: Vec<&Material> = materials.collect();
    let is_lit = !world.environment.is_black()
        || world.all_lights().next().is_some()
        || all.iter().any(|m| shines(m) && m.light)
        || all.iter().all(|m| shines(m) || m.numbers.metallic >= 1.0);
    let names: HashSet<&str> = (all.iter().filter(|m| shines(m)))
        .map(|m| m.name.as_str())
        .collect();
    let entries = scene
        .materials
        .iter()
        .filter(|m| !is_lit && names.contains(m.name.as_str()));
    let found = entries.map(|entry| {
        let message = format!(
            "material \"{}\" emits light that lights nothing, and there is no other light",
            entry.name
        );
        warning(
            "dark-emission",
            &entry.at,
            message,
            "write `light = true` in it",
        )
    });
    found.collect()
}

/// Keys of motion that have no part in the timeline, because the key before is after its end too, or that are at more
/// than twice its length, as numbers of frames are.
fn late_keys(scene: &Scene, start: &Span) -> Vec<Diagnostic> {
    let (Some(timeline), Some(source)) = (&scene.timeline, &start.source) else {
        return Vec::new();
    };
    let (end, fps) = (f64::from(timeline.end), f64::from(timeline.fps));
    let end_s = end / fps;
    let mut found = Vec::new();
    let root = source.syntax().root();
    if let Some(motion) = root
        .get("motion")
        .and_then(|node| node.get_ref().as_table())
    {
        each_keys(motion, &mut |keys| {
            let times: Vec<_> = keys.iter().filter_map(time_of).collect();
            let is_late = |pair: &&[(f64, &Node)]| pair[0].0 >= end_s || pair[1].0 > 2.0 * end_s;
            let Some([_, (at_s, node)]) = times.windows(2).find(is_late) else {
                return;
            };
            let message = format!(
                "this key is at {at_s} s, and the timeline ends at {} s, with frame {end}",
                rounded(end_s)
            );
            let help = format!(
                "write `end = {}` in `[timeline]`, or, if frame {at_s} was meant, `at_s = {}`",
                (at_s * fps).ceil(),
                rounded(at_s / fps)
            );
            let at = Span {
                source: Some(source.clone()),
                range: node.span(),
            };
            found.push(warning("late-key", &at, message, &help));
        });
    }
    found
}

/// Calls a function with each list `keys` of tables of motion.
fn each_keys(table: &Entries, visit: &mut impl FnMut(&[Node])) {
    each_value(table, "", &mut |path, node| {
        if let Some(keys) = node
            .get_ref()
            .as_array()
            .filter(|_| path.ends_with(".keys"))
        {
            visit(keys);
        }
    });
}

/// Time of a key of motion, s, with its place.
fn time_of(key: &Node) -> Option<(f64, &Node)> {
    let node = key.get_ref().as_table()?.get("at_s")?;
    Some((number(node)?, node))
}

/// Cameras that move and that no frame shows.
fn unseen_cameras(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let cuts: Vec<&str> = scene
        .cuts
        .iter()
        .map(|cut| cut.camera.value.as_str())
        .collect();
    let main = world.cameras.get(world.main_camera());
    let main = main.map(|camera| camera.name.as_str());
    let is_shown = |name: &str| cuts.contains(&name) || main == Some(name);
    let moved = scene
        .motion
        .cameras
        .iter()
        .filter(|moved| !is_shown(&moved.name));
    let found = moved.map(|moved| {
        let (name, shown) = (&moved.name, main.unwrap_or_default());
        let message = format!("camera \"{name}\" moves, and no frame shows it: the film is of \"{shown}\"");
        let help = format!("write `cuts = [{{ frame = 0, camera = \"{name}\" }}]` in `[timeline]`, or render it by `--camera {name}`");
        warning("unseen-camera", &moved.at, message, &help)
    });
    found.collect()
}
