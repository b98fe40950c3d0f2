//! Answers about a position in a script: names of the API, and of the scenes that use the script.

use std::{collections::BTreeSet, path::Path, sync::Arc};

use serde_json::{Value, json};

use super::{
    answer::{self, PROPERTY, REFERENCE},
    call::{Call, in_quotes, is_word},
    names::{Name, names},
    outline::{Part, Word, beside, words},
    scopes::{Scoped, places, with_scopes},
    script_map::{self, Inside},
    structure,
};
use reflet_base::files::{entries_below, has_extension};
use reflet_scene::{diagnostic::Source, parse, script::api};

/// Kind of completion items in the protocol.
const FUNCTION: u32 = 3;

/// Maximum number of entries of a folder that are searched for scenes of a script.
const MOST_ENTRIES: usize = 1000;

/// Scenes that use a script, with the files that they include: open ones as edited, others from the script's
/// folder.
pub fn scenes_of(script: &Path, open: &[&Arc<Source>]) -> Vec<Scoped> {
    let name = script.file_name().and_then(|name| name.to_str());
    let name = name.unwrap_or_default();
    let mut scenes: Vec<_> = open.iter().map(|file| Arc::clone(file)).collect();
    let folder = script.parent().unwrap_or(Path::new(""));
    let entries = entries_below(folder, 0, false).take(MOST_ENTRIES);
    for entry in entries.filter(|entry| has_extension(entry, &["toml"])) {
        let path = entry.path();
        if scenes.iter().all(|s| s.path != path) {
            let text = parse::read(path).unwrap_or_default();
            scenes.push(Arc::new(Source::new(path, text)));
        }
    }
    let uses =
        |s: &Source| s.path.extension().is_some_and(|e| e == "toml") && s.text.contains(name);
    let scenes = scenes.iter().filter(|s| uses(s));
    scenes.flat_map(with_scopes).collect()
}

/// Completions at a byte offset.
pub fn complete(text: &str, offset: usize, scenes: &[Scoped], snippets: bool) -> Vec<Value> {
    let before = &text[..text.floor_char_boundary(offset)];
    let all = scenes.iter().flat_map(|part| {
        let own = names(&part.source).into_iter();
        own.filter(|n| part.shows(&n.kind)).map(|n| Name {
            name: format!("{}{}", part.prefix, n.name),
            ..n
        })
    });
    let quoted = in_quotes(before);
    let inside = script_map::complete(text, before.len(), quoted, snippets);
    match inside {
        Some(Inside::Items(items)) => return items,
        Some(Inside::Names([])) => return Vec::new(),
        _ => {}
    }
    if quoted {
        let call = Call::around_end_of(before);
        if let Some(names) = (call.as_ref()).and_then(|call| names_of_part(call, scenes)) {
            let item = |name| json!({ "label": name, "kind": REFERENCE });
            return names.iter().map(item).collect();
        }
        let kinds = match inside {
            Some(Inside::Names(kinds)) => kinds,
            _ => call.map_or(&[][..], |call| call.kinds_of_names()),
        };
        let named: BTreeSet<_> = all
            .filter(|n| n.kind != "params")
            .filter(|n| kinds.is_empty() || kinds.contains(&n.kind.as_str()))
            .map(|n| (n.name, n.kind))
            .collect();
        let item = |(name, kind): &(String, String)| json!({ "label": name, "kind": REFERENCE, "detail": kind });
        return named.iter().map(item).collect();
    }
    let owner = before.trim_end_matches(is_word);
    if owner.ends_with("ctx.params.") {
        let params: BTreeSet<_> = all.filter(|n| n.kind == "params").map(|n| n.name).collect();
        return params
            .iter()
            .map(|name| json!({ "label": name, "kind": PROPERTY }))
            .collect();
    }
    if owner.ends_with("ctx.") {
        let (properties, functions) = api::members("ctx.");
        let properties = properties.into_iter().map(|name| item(name, PROPERTY));
        let functions: BTreeSet<_> = functions.into_iter().collect();
        return properties
            .chain(functions.into_iter().map(|name| item(name, FUNCTION)))
            .collect();
    }
    if owner.ends_with('.') {
        return Vec::new();
    }
    let functions: BTreeSet<_> = api::names().into_iter().collect();
    let functions = functions.into_iter();
    functions.map(|name| item(name, FUNCTION)).collect()
}

/// Names that the second argument of a call may be, which names a part of the first: joints of an instance that scripts
/// pose, and materials with a table in a model; `None` for other arguments.
fn names_of_part(call: &Call, scenes: &[Scoped]) -> Option<BTreeSet<String>> {
    if !call.of_context || call.argument != 1 {
        return None;
    }
    let listed = |word: &Word, key: &str| word.part == Part::Value(key.to_owned());
    let of_file = |part: &Scoped| {
        let first = call.first?.strip_prefix(part.prefix.as_str())?;
        let all = words(&part.source);
        let named = all
            .iter()
            .find(|word| listed(word, "name") && word.table == ["instance"] && word.text == first);
        let is_wanted = |word: &&Word| match call.name {
            "joint" => {
                let of = named.and_then(|_| beside(&part.source, word, "name"));
                listed(word, "joints") && of.as_ref() == named
            }
            _ => word.part == Part::Header && word.table == ["model", first, "material"],
        };
        Some(
            all.iter()
                .filter(is_wanted)
                .map(|word| word.text.clone())
                .collect::<Vec<_>>(),
        )
    };
    match call.name {
        "joint" | "material" => Some(scenes.iter().filter_map(of_file).flatten().collect()),
        "morph" => Some(BTreeSet::new()), // names are in files alone
        _ => None,
    }
}

fn item(name: &str, kind: u32) -> Value {
    answer::item(name, kind, &meaning(name).unwrap_or_default())
}

/// Signatures and manual text of an API name, as Markdown.
fn meaning(name: &str) -> Option<String> {
    let texts = api::entries(name).into_iter().map(|entry| {
        let forms: Vec<_> = entry.forms.iter().map(|form| form.0.as_str()).collect();
        format!("```rhai\n{}\n```\n{}", forms.join("\n"), entry.meaning())
    });
    let texts: Vec<_> = texts.collect();
    (!texts.is_empty()).then(|| texts.join("\n\n"))
}

/// Text about the name at a byte offset: the table of a name in quotes, a function of the script, or one of the API.
pub fn hover(text: &str, offset: usize, scenes: &[Scoped]) -> Option<Value> {
    let before = &text[..text.floor_char_boundary(offset)];
    let (name, start) = (word_at(text, offset), before.trim_end_matches(is_word));
    let text = match quoted_at(text, before) {
        Some(quoted) => structure::table(scenes, quoted, |kind| kind != "params")?,
        None => (Some(name).filter(|_| !start.ends_with("ctx.")))
            .and_then(|name| structure::function(text, name))
            .or_else(|| meaning(name))?,
    };
    Some(json!({ "contents": { "kind": "markdown", "value": text } }))
}

/// Locations in the scenes that define the name at a byte offset: a quoted name, or a parameter.
pub fn definition(text: &str, offset: usize, scenes: &[Scoped]) -> Vec<Value> {
    let before = &text[..text.floor_char_boundary(offset)];
    if let Some(name) = quoted_at(text, before) {
        return places(scenes, name, |kind| kind != "params");
    }
    match before.trim_end_matches(is_word).ends_with("ctx.params.") {
        true => places(scenes, word_at(text, offset), |kind| kind == "params"),
        false => Vec::new(),
    }
}

/// Text in quotes around the end of `before`.
fn quoted_at<'t>(text: &'t str, before: &str) -> Option<&'t str> {
    let start = before.rfind('"').filter(|_| in_quotes(before))? + 1;
    text[start..].split(['"', '\n']).next()
}

fn word_at(text: &str, offset: usize) -> &str {
    let offset = text.floor_char_boundary(offset);
    let start = text[..offset].trim_end_matches(is_word).len();
    let end = text[offset..]
        .find(|c| !is_word(c))
        .map_or(text.len(), |i| offset + i);
    &text[start..end]
}
