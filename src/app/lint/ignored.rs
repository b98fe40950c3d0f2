//! Keys that have no effect because of other keys, or because another key is missing.

use std::collections::HashSet;

use crate::scene::{
    desc::{InstanceMaterialDesc, Method, NEEDING, Needing, ReflectionDesc},
    diagnostic::{Diagnostic, Span},
    stages::Scene,
    suggest::example_of,
};

/// Warnings about keys in the scene's text that have no effect; `start` is a span in that text.
pub fn lint(scene: &Scene, start: &Span) -> Vec<Diagnostic> {
    let mut found: Vec<_> = by_path(scene, start).into_iter().collect();
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
            let names = alone.extract_if(.., |key| key.needs == needed);
            let names: Vec<_> = names.map(|key| key.key).collect();
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

/// Places and names of these keys in a table of the scene's text, in the order of the text.
pub fn written(start: &Span, table: &str, keys: &[&str]) -> Vec<(Span, String)> {
    let find = || {
        let source = start.source.as_ref()?;
        let root = source.syntax().root();
        let table = root.get(table)?.get_ref().as_table()?;
        let said = table
            .keys()
            .filter(|key| keys.contains(&key.get_ref().as_str()));
        let place = |range| Span {
            source: Some(source.clone()),
            range,
        };
        let said = said.map(|key| (place(key.span()), key.get_ref().to_string()));
        Some(said.collect::<Vec<_>>())
    };
    let mut found = find().unwrap_or_default();
    found.sort_by_key(|(at, _)| at.range.start);
    found
}

/// Text saying that these keys change nothing.
fn nothing(keys: &[&str]) -> String {
    let names: Vec<_> = keys.iter().map(|key| format!("`{key}`")).collect();
    let change = if keys.len() == 1 { "changes" } else { "change" };
    format!("{} {change} nothing", names.join(", "))
}
