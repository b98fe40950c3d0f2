//! Defaults that have changed since an earlier version, for the look that a scene had by that version.

use crate::scene::{
    desc::{ModelSource, ShadowMode, ShapeDesc, Visibility},
    diagnostic::{Diagnostic, Span},
    stages::Scene,
    syntax::key_text,
};

/// Versions whose defaults `check --since` knows.
pub const VERSIONS: [&str; 1] = ["0.1"];

/// A warning that lists what to write for the defaults of version 0.1, if the scene leaves any of them out.
pub fn changed_defaults(scene: &Scene) -> Option<Diagnostic> {
    let reflection = &scene.reflection;
    let mut old = Vec::new();
    let mut add = |applies: bool, key: &str, table: &str| {
        if applies {
            old.push(format!("`{key}` in {table}"));
        }
    };
    add(
        reflection.multiple_scattering,
        "multiple_scattering = false",
        "[reflection]",
    );
    add(
        reflection.glint_limit.is_none(),
        "glint_limit = 0",
        "[reflection]",
    );
    add(
        scene.image.visibility == Visibility::Auto,
        "visibility = \"raster\"",
        "[image]",
    );
    // Texts of placed scenes and scripts are other ones, which are checked apart.
    let is_own = |at: &Span| at.source == scene.own.source;
    for light in scene.lights.iter().filter(|it| is_own(&it.at)) {
        let is_left_out = light.value.shadow == ShadowMode::Default && !light.value.kind.has_size();
        let table = format!("[light.{}]", key_text(&light.name));
        add(is_left_out, "shadow = \"map\"", &table);
    }
    for model in scene.models.iter().filter(|it| is_own(&it.at)) {
        let segments = match model.value.source {
            ModelSource::Shape(ShapeDesc::Sphere { segments: None, .. }) => 128,
            ModelSource::Shape(ShapeDesc::Capsule { segments: None, .. }) => 64,
            _ => continue,
        };
        let table = format!("the shape of [model.{}]", key_text(&model.name));
        add(true, &format!("segments = {segments}"), &table);
    }
    let message = "defaults that this scene leaves out have changed since version 0.1";
    let help = format!("for the look of then write {}", old.join(", "));
    (!old.is_empty())
        .then(|| Diagnostic::new("changed-defaults", scene.own.clone(), message).help(help))
}
