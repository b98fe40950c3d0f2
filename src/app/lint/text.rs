//! Entries of the scene's own text, which warnings about keys and values go through.

use crate::{
    scene::{
        diagnostic::{Diagnostic, Span},
        stages::Scene,
        syntax::{Content, Entries, Node},
    },
    world::World,
};

/// A warning at a place, with advice.
pub fn warning(name: &'static str, at: &Span, message: String, help: &str) -> Diagnostic {
    Diagnostic::new(name, at.clone(), message).help(help)
}

/// Adds the place of an instance to a warning, if the text has one.
pub fn related(warning: Diagnostic, scene: &Scene, world: &World, instance: usize) -> Diagnostic {
    match world.place_of(scene, instance) {
        Some(at) => {
            let name = &world.instances[instance].name;
            warning.related(at.clone(), format!("\"{name}\" is here"))
        }
        None => warning,
    }
}

/// Calls a function with each key of a table and of the tables in it, and its value; `path` and the key have dots and
/// the keys of the tables around it before them.
pub fn each_value(table: &Entries, path: &str, visit: &mut impl FnMut(&str, &Node)) {
    for (key, node) in table {
        let path = format!("{path}.{}", key.get_ref());
        visit(&path, node);
        let list = node.get_ref().as_array().into_iter().flatten();
        for inner in list
            .chain([node])
            .filter_map(|node| node.get_ref().as_table())
        {
            each_value(inner, &path, visit);
        }
    }
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

/// A number of the text, of either kind.
pub fn number(node: &Node) -> Option<f64> {
    match node.get_ref() {
        Content::Integer(x) => Some(x.value()? as f64),
        Content::Float(x) => x.value(),
        _ => None,
    }
}

/// A number with three digits behind the point.
pub fn rounded(x: f64) -> f64 {
    (x * 1e3).round() / 1e3 + 0.0
}

/// A number with two significant digits.
pub fn two_digits(x: f32) -> f64 {
    format!("{x:.1e}").parse().unwrap_or_default()
}
