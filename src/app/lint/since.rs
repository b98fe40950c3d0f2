//! Defaults that have changed since an earlier version, for the look that a scene had by that version.

use std::sync::Arc;

use crate::scene::{
    desc::{Method, ModelSource, Samples, ShadowMode, ShapeDesc, Visibility},
    diagnostic::{Diagnostic, Source, Span},
    stages::Scene,
    syntax::key_text,
};

/// Version whose defaults `check --since` knows.
pub const VERSION: &str = "0.1";

/// A warning that lists what to write for defaults of [`VERSION`], if the texts of the scene leave any of them out;
/// none about bare models. Placed scenes are checked apart, and scripts cannot be.
pub fn changed_defaults(scene: &Scene) -> Option<Diagnostic> {
    let texts = texts(scene)?;
    let mut old = Vec::new();
    let mut add = |applies: bool, path: &[&str], value: &str| {
        let is_written = texts.iter().any(|text| has(text, path));
        if let (true, false, [tables @ .., key]) = (applies, is_written, path) {
            let tables: Vec<_> = tables.iter().map(|it| key_text(it)).collect();
            old.push(format!("`{key} = {value}` in [{}]", tables.join(".")));
        }
    };
    let (reflection, image) = (&scene.reflection, &scene.image);
    let follows_all = reflection.method == Method::Path;
    let is_between = matches!(image.samples, Samples::Count(16..256));
    let is_auto = image.visibility == Visibility::Auto;
    add(true, &["reflection", "multiple_scattering"], "false");
    add(!follows_all, &["reflection", "glint_limit"], "0");
    add(
        is_between && !follows_all,
        &["reflection", "filter"],
        "false",
    );
    add(is_auto, &["image", "visibility"], "\"raster\"");
    for light in scene.lights.iter().filter(|it| is_own(&it.name, &it.at)) {
        let applies = light.value.shadow == ShadowMode::Default && !light.value.kind.has_size();
        add(applies, &["light", &light.name, "shadow"], "\"map\"");
    }
    for model in scene.models.iter().filter(|it| is_own(&it.name, &it.at)) {
        let segments = match model.value.source {
            ModelSource::Shape(ShapeDesc::Sphere { segments: None, .. }) => "128",
            ModelSource::Shape(ShapeDesc::Capsule { segments: None, .. }) => "64",
            _ => continue,
        };
        add(true, &["model", &model.name, "shape", "segments"], segments);
    }
    let message = format!("defaults that this scene leaves out have changed since {VERSION}");
    let help = format!("for the old look write {}", old.join(", "));
    (!old.is_empty())
        .then(|| Diagnostic::new("changed-defaults", scene.own.clone(), message).help(help))
}

/// The texts of the scene's layers that have cameras, lights or models, and its own; `None` without a text.
fn texts(scene: &Scene) -> Option<Vec<Arc<Source>>> {
    let own = scene.own.source.clone().filter(|own| !own.generated)?;
    let cameras = scene.cameras.iter().map(|it| &it.at);
    let others = scene.lights.iter().map(|it| &it.at);
    let others = others.chain(scene.models.iter().map(|it| &it.at));
    let others = cameras.chain(others).filter_map(|at| at.source.clone());
    let mut texts: Vec<_> = [own].into_iter().chain(others).collect();
    texts.dedup();
    Some(texts)
}

/// Whether a text has a key, whose tables may stand in braces.
fn has(text: &Source, path: &[&str]) -> bool {
    let Some((key, tables)) = path.split_last() else {
        return false;
    };
    let root = text.syntax().root();
    let found = tables
        .iter()
        .try_fold(root, |table, name| table.get(*name)?.get_ref().as_table());
    found.is_some_and(|table| table.get(*key).is_some())
}

/// Whether a thing stands in a text of the scene's layers: not in a placed scene, whose names follow a `/`, nor in a script's
/// result.
fn is_own(name: &str, at: &Span) -> bool {
    let is_text = |text: &Arc<Source>| !text.generated && text.returned.is_none();
    !name.contains('/') && at.source.as_ref().is_some_and(is_text)
}
