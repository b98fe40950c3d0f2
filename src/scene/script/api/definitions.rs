//! The reference of scripts as a Rhai definition file, from which editors complete and explain names.

use std::fmt::Write as _;

use super::{API, Entry};

const HEADER: &str = "\
// Generated from src/scene/script/api; `UPDATE_DOCS=1 cargo test --test scene` writes it anew.
// Functions that scripts of Reflet have in addition to Rhai's own, for language servers that read Rhai
// definition files. A script has `fn setup(ctx)`, `fn frame(ctx)` or both; docs/scripting.md explains them.
module static;
";

/// Content of the definition file, `docs/reflet.d.rhai`. It has no operators: editors have nothing to complete
/// there.
pub fn definitions() -> String {
    let mut out = HEADER.to_owned();
    for group in API.iter() {
        let _ = write!(out, "\n// {}\n", group.title);
        for entry in &group.entries {
            define(&mut out, entry);
        }
    }
    out
}

fn define(out: &mut String, entry: &Entry) {
    for (form, gives) in &entry.forms {
        let Some(definition) = definition(form, gives) else {
            continue;
        };
        let text = entry.meaning().replace('\n', "\n/// ");
        let _ = write!(
            out,
            "\n/// {text}\n///\n/// True, for example: `{}`\n{definition}\n",
            entry.example
        );
    }
}

/// Definition of a form: `ctx.position(name)`, which gives `vec3`, becomes `fn position(ctx: ctx, name: String)
/// -> vec3;`.
fn definition(form: &str, gives: &str) -> Option<String> {
    let (path, arguments) = match form.split_once('(') {
        Some((path, rest)) => (path, Some(rest.strip_suffix(')')?)),
        None => (form, None),
    };
    let (owner, name) = match path.split_once('.') {
        Some((owner, name)) => (Some(owner), name),
        None => (None, path),
    };
    if !name.chars().all(|c| c.is_alphanumeric() || c == '_') {
        return None; // an operator
    }
    let parameter = |name: &str| match name {
        "#{ … }" => "values: Map".to_owned(),
        "value" => "value: ?".to_owned(),
        name => format!("{name}: {}", type_of(name)),
    };
    let given = arguments.unwrap_or_default().split(", ");
    let given = given.filter(|name| !name.is_empty());
    let parameters: Vec<_> = owner.into_iter().chain(given).map(parameter).collect();
    let get = if arguments.is_none() { "get " } else { "" };
    let parameters = parameters.join(", ");
    Some(format!("fn {get}{name}({parameters}) -> {gives};"))
}

/// Type of a parameter, which has the same name throughout the reference; `?` where several types are accepted,
/// as integers and floats are nearly everywhere.
fn type_of(parameter: &str) -> &'static str {
    match parameter {
        "ctx" => "ctx",
        "name" | "model" | "text" => "String",
        "seed" | "id" | "frame" => "int",
        "v" | "vector" => "vec3",
        "q" => "quat",
        "f" => "floats",
        "m" | "matrix" => "mat4",
        _ => "?",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_become_definitions() {
        for (form, gives, want) in [
            (
                "vec3(x, y, z)",
                "vec3",
                Some("fn vec3(x: ?, y: ?, z: ?) -> vec3;"),
            ),
            ("ctx.frame", "int", Some("fn get frame(ctx: ctx) -> int;")),
            (
                "ctx.light(name, #{ … })",
                "()",
                Some("fn light(ctx: ctx, name: String, values: Map) -> ();"),
            ),
            ("a + b", "vec3", None),
            ("-a", "vec3", None),
        ] {
            assert_eq!(definition(form, gives).as_deref(), want, "{form}");
        }
    }
}
