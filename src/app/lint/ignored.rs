//! Keys that method `path` leaves out: it follows all light, whatever they say.

use toml::de::DeTable;

use crate::scene::{
    desc::Method,
    diagnostic::{Diagnostic, Span},
    stages::Scene,
};

/// What [`ReflectionDesc::settled`](crate::scene::desc::ReflectionDesc::settled) replaces.
const REPLACED: [&str; 9] = [
    "bounces",
    "diffuse_bounces",
    "glint_limit",
    "roughness_cutoff",
    "ray_length_u",
    "reuse_light",
    "fade",
    "filter",
    "blur_px",
];

/// Warns of the first of them that the text says, and names all; `start` is in the scene's text.
pub fn lint(scene: &Scene, start: &Span) -> Option<Diagnostic> {
    let source = start.source.as_ref()?;
    if scene.reflection.method != Method::Path {
        return None;
    }
    let root = DeTable::parse(&source.text).ok()?.into_inner();
    let table = root.get("reflection")?.get_ref().as_table()?;
    let mut keys: Vec<_> = table
        .keys()
        .filter(|key| REPLACED.contains(&key.get_ref().as_ref()))
        .map(|key| (key.span(), key.get_ref().as_ref()))
        .collect();
    keys.sort_by_key(|(range, _)| range.start);
    let (range, _) = keys.first()?.clone();
    let names: Vec<String> = keys.iter().map(|(_, name)| format!("`{name}`")).collect();
    let at = Span {
        source: Some(source.clone()),
        range,
    };
    let message = format!(
        "`method = \"path\"` follows all light, so {} {} nothing",
        names.join(", "),
        if names.len() == 1 {
            "changes"
        } else {
            "change"
        }
    );
    let help = "remove them, or choose another method";
    Some(Diagnostic::at("ignored-key", at, message).help(help))
}
