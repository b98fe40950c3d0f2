//! Script parameters that are never used.

use crate::scene::{
    diagnostic::Diagnostic,
    script::lint::{Params, used_params},
    stages::Scene,
};

/// Warnings about parameters that the script does not read.
pub fn params(scene: &Scene) -> Vec<Diagnostic> {
    let texts = scene.script.iter().flat_map(|s| &s.texts);
    let Params::Named(used) = used_params(texts.map(|(_, text)| text.as_str())) else {
        return Vec::new();
    };
    let unused = scene
        .params
        .iter()
        .filter(|p| !used.contains(p.name.as_str()));
    let warn = |name: &str, at: &crate::scene::diagnostic::Span| {
        let (message, help) = match &scene.script {
            None => (
                format!("nothing reads the parameter \"{name}\": the scene has no script"),
                "write `script = \"….rhai\"`, or remove the parameter".to_owned(),
            ),
            Some(script) => (
                format!("nothing reads the parameter \"{name}\""),
                format!("write `ctx.params.{name}` in {}, or remove it", script.name),
            ),
        };
        Diagnostic::new("unused-param", at.clone(), message).help(help)
    };
    unused.map(|p| warn(&p.name, &p.at)).collect()
}
