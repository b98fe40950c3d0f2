//! Messages about names that do not exist (functions, properties, keys), with suggestions.

use super::{
    super::{api, format_value::type_named},
    Known,
};
use crate::{forms, suggest};

/// Name of the diagnostic, message, and advice.
type Explained = (&'static str, String, Option<String>);

pub fn missing_function(signature: &str, functions: &[&str]) -> Explained {
    let (name, arguments) = signature.split_once('(').unwrap_or((signature, ""));
    let name = name.trim();
    let arguments = plain_types(arguments.trim_end_matches(')'));
    let own = api::signatures(name);
    if !own.is_empty() {
        let message = format!("{} does not take ({arguments})", suggest::key(name));
        let meaning = api::meaning(name).map_or_else(String::new, |text| {
            format!(": {}", super::lower_first(text))
        });
        let help = format!("it is {}{meaning}", own.join(", or "));
        return ("script-error", message, Some(help));
    }
    if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
        let message = format!("{} does not take ({arguments})", suggest::key(name));
        return ("script-error", message, None);
    }
    let message = format!("there is no function {}", suggest::key(name));
    if let Some(help) = suggest::in_script("functions", name) {
        return ("script-error", message, Some(help.to_owned()));
    }
    let known = api::names().into_iter().chain(functions.iter().copied());
    let help = suggest::nearest(name, known).map_or_else(
        || "all functions are listed in docs/scripting.md".to_owned(),
        |meant| format!("did you mean {}?", suggest::key(meant)),
    );
    ("script-error", message, Some(help))
}

/// Names of Rhai's types in plain words.
fn plain_types(arguments: &str) -> String {
    let one = |argument: &str| match argument.trim() {
        "&str | ImmutableString | String" => "text".to_owned(),
        "i64" => "integer".to_owned(),
        "f64" => "float".to_owned(),
        other => other.to_owned(),
    };
    arguments.split(',').map(one).collect::<Vec<_>>().join(", ")
}

/// Message about a key that a map lacks; mostly a key of `ctx.params`.
pub fn missing_key(name: &str, known: &Known) -> Explained {
    let help = suggest::nearest(name, known.params.iter().copied()).map_or_else(
        || "write `\"name\" in map` to ask whether it is there".to_owned(),
        |meant| format!("did you mean {}?", suggest::key(meant)),
    );
    let params: Vec<_> = known.params.iter().map(|name| suggest::key(name)).collect();
    let help = if params.is_empty() {
        format!("{help}; the scene has no [params]")
    } else {
        format!("{help}; [params] has {}", params.join(", "))
    };
    let message = format!("there is no property {}", suggest::key(name));
    ("script-error", message, Some(help))
}

pub fn missing_property(text: &str) -> Explained {
    let quoted: Vec<_> = text.split('\'').skip(1).step_by(2).collect();
    let (name, of) = match quoted[..] {
        [name, of, ..] if text.contains("property") && !name.is_empty() => (name, of),
        _ => return ("script-error", super::lower_first(text), None),
    };
    let shown = suggest::key(name);
    if let Some((message, help)) = forms::explained("property", text) {
        return ("script-error", message, Some(help));
    }
    if text.contains("setter") && api::names().contains(&name) {
        let help = "set the scene with functions such as `ctx.place`".to_owned();
        return ("script-error", format!("{shown} is read-only"), Some(help));
    }
    let owner = match of {
        "ctx" => "ctx.",
        "vec3" => "v.",
        other => {
            let help = format!("{} has no properties", type_named(other));
            let message = format!("there is no property {shown}");
            return ("script-error", message, Some(help));
        }
    };
    let (properties, functions) = api::members(owner);
    if functions.contains(&name) {
        let forms = api::signatures(name).join(", or ");
        let message = format!("{shown} is a function");
        return ("script-error", message, Some(format!("call it: {forms}")));
    }
    if let Some(help) = suggest::in_script("properties", name) {
        return (
            "script-error",
            format!("there is no property {shown}"),
            Some(help.to_owned()),
        );
    }
    let is_letter = |word: &&str| word.len() == 1 && name.starts_with(word);
    let short = || properties.iter().copied().find(is_letter);
    let all = properties.iter().chain(&functions).copied();
    let meant = suggest::nearest(name, all).or_else(short);
    let meant = meant.map(|meant| format!("did you mean `{owner}{meant}`? "));
    let list: Vec<_> = properties.iter().map(|p| format!("`{p}`")).collect();
    let calls = match owner {
        "ctx." if meant.is_none() => {
            ", and sets things by calls, as in `ctx.place(\"ball\", [0, 1, 0])`"
        }
        _ => "",
    };
    let help = format!(
        "{}a {of} has {}{calls}",
        meant.unwrap_or_default(),
        list.join(", ")
    );
    let message = format!("there is no property {shown}");
    ("script-error", message, Some(help))
}
