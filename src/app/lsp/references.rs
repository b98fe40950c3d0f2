//! References to a name in all texts of a scene and of its project, and renaming.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use serde_json::{Value, json};

use super::{
    is_script,
    names::{Name, border_of, names, uses, with_parts},
    position::{range, uri_of},
};
use crate::{
    files::folder_of,
    scene::{diagnostic::Source, parse, toml_text::toml_text},
};

/// Maximum number of files that are searched, and depth of the folders.
const MOST_FILES: usize = 1000;
const DEPTH: usize = 6;

/// A named thing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Target {
    kind: String,
    name: String,
}

/// A place of a name in a file.
pub struct Place {
    file: Arc<Source>,
    name: Name,
    is_definition: bool,
    /// Start of the text before the name in the same word, such as `light.` in `remove = ["light.lamp"]`.
    lead: String,
}

/// The texts in which a name of a file may be used: the file and its parts, and all texts of its project, or of its
/// folder without one. Open texts are taken as they are edited.
pub fn texts(file: &Arc<Source>, open: &[&Arc<Source>]) -> Vec<Arc<Source>> {
    let mut all: Vec<Arc<Source>> = vec![Arc::clone(file)];
    let mut add = |path: &Path| {
        if all.len() >= MOST_FILES || all.iter().any(|known| same(&known.path, path)) {
            return;
        }
        let edited = open.iter().find(|open| same(&open.path, path));
        let text = || {
            let text = match is_script(path) {
                true => fs::read_to_string(path).ok()?,
                false => parse::read(path).ok()?,
            };
            Some(Arc::new(Source::new(path, text)))
        };
        all.extend(edited.map(|open| Arc::clone(open)).or_else(text));
    };
    if !is_script(&file.path) {
        with_parts(file).iter().for_each(|part| add(&part.path));
    }
    let border = border_of(&file.path);
    let (folder, depth) = match border.project {
        Some(project) => (project, DEPTH),
        None => (folder_of(&file.path).to_owned(), 0),
    };
    let mut found = Vec::new();
    files_below(&folder, depth, &mut found);
    found.iter().for_each(|path| add(path));
    all
}

fn same(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    a == b || a.file_name() == b.file_name() && real(a) == real(b)
}

fn files_below(folder: &Path, depth: usize, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = (fs::read_dir(folder).into_iter().flatten().flatten())
        .filter(|entry| !entry.file_name().to_string_lossy().starts_with('.'))
        .collect();
    entries.sort_by_key(fs::DirEntry::file_name);
    for entry in entries {
        let path = entry.path();
        match entry.file_type() {
            _ if found.len() >= MOST_FILES => return,
            Ok(kind) if kind.is_dir() && depth > 0 => files_below(&path, depth - 1, found),
            Ok(kind) if kind.is_file() => {
                let is_text = path
                    .extension()
                    .is_some_and(|end| end == "toml" || end == "rhai");
                found.extend(is_text.then_some(path));
            }
            _ => {}
        }
    }
}

/// The named thing at a byte offset of a file, with its range there.
pub fn target(file: &Arc<Source>, offset: usize, texts: &[Arc<Source>]) -> Option<(Target, Name)> {
    let is_at = |name: &Name| (name.range.start..=name.range.end).contains(&offset);
    if is_script(&file.path) {
        let name = script_names(file).into_iter().find(is_at)?;
        let is_param = name.kind == "params";
        let defined = texts.iter().flat_map(|text| names(text));
        let mut defined = defined.filter(|d| d.name == name.name);
        let found = defined.find(|d| (d.kind == "params") == is_param)?;
        let kind = found.kind;
        return Some((
            Target {
                kind,
                name: name.name.clone(),
            },
            name,
        ));
    }
    let own = names(file).into_iter().find(is_at);
    if let Some(own) = own {
        let (kind, name) = (own.kind.clone(), own.name.clone());
        return Some((Target { kind, name }, own));
    }
    let (name, kinds) = uses(file).into_iter().find(|(name, _)| is_at(name))?;
    let defined = texts.iter().flat_map(|text| names(text));
    let mut defined = defined.filter(|d| d.name == name.name && kinds.contains(&d.kind));
    let kind = defined.next()?.kind;
    Some((
        Target {
            kind,
            name: name.name.clone(),
        },
        name,
    ))
}

/// All places of a named thing.
pub fn places(target: &Target, texts: &[Arc<Source>]) -> Vec<Place> {
    let mut all = Vec::new();
    for file in texts {
        let mut add = |name: Name, is_definition: bool, lead: String| {
            let file = Arc::clone(file);
            all.push(Place {
                file,
                name,
                is_definition,
                lead,
            });
        };
        if is_script(&file.path) {
            let is_param = target.kind == "params";
            let found = script_names(file).into_iter();
            found
                .filter(|n| n.name == target.name && (n.kind == "params") == is_param)
                .for_each(|name| add(name, false, String::new()));
            continue;
        }
        let own = names(file).into_iter();
        own.filter(|n| n.kind == target.kind && n.name == target.name)
            .for_each(|name| add(name, true, String::new()));
        for (name, kinds) in uses(file) {
            if name.name == target.name && kinds.contains(&target.kind) {
                let word = file.text[name.range.clone()].trim_matches(['"', '\'']);
                let lead = word.strip_suffix(name.name.as_str()).unwrap_or_default();
                let lead = lead.to_owned();
                add(name, false, lead);
            }
        }
    }
    all.sort_by(|a, b| (&a.file.path, a.name.range.start).cmp(&(&b.file.path, b.name.range.start)));
    all.dedup_by(|a, b| a.file.path == b.file.path && a.name.range == b.name.range);
    all
}

/// Names in a script: texts in quotes, and `ctx.params.NAME` with the kind `params`.
fn script_names(file: &Source) -> Vec<Name> {
    const PARAM: &str = "ctx.params.";
    let mut found = Vec::new();
    let mut start = 0;
    for line in file.text.split_inclusive('\n') {
        let code = line.split("//").next().unwrap_or_default();
        let mut quotes = code.match_indices('"').map(|(at, _)| at);
        while let (Some(open), Some(close)) = (quotes.next(), quotes.next()) {
            found.push(Name {
                kind: String::new(),
                name: code[open + 1..close].to_owned(),
                range: start + open..start + close + 1,
            });
        }
        for (at, _) in code.match_indices(PARAM) {
            let rest = &code[at + PARAM.len()..];
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
            let name = &rest[..end.unwrap_or(rest.len())];
            let from = start + at + PARAM.len();
            found.push(Name {
                kind: "params".to_owned(),
                name: name.to_owned(),
                range: from..from + name.len(),
            });
        }
        start += line.len();
    }
    found
}

/// Locations of places in the protocol's form.
pub fn locations(places: &[Place], with_definitions: bool) -> Vec<Value> {
    let shown = places
        .iter()
        .filter(|place| with_definitions || !place.is_definition);
    let location = |place: &Place| {
        let at = range(&place.file.text, &place.name.range);
        json!({ "uri": uri_of(&place.file.path), "range": at })
    };
    shown.map(location).collect()
}

/// Edits that give a named thing another name.
///
/// # Errors
/// A message about a name that is empty, has line breaks or quotes, is no word where a word is needed, or that is taken.
pub fn rename(target: &Target, new: &str, texts: &[Arc<Source>]) -> Result<Value, String> {
    let is_word = !new.is_empty() && new.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if new.trim().is_empty() || new.contains(|c: char| c.is_control() || c == '"' || c == '\\') {
        return Err("a name has at least one character, no quotes and no line breaks".to_owned());
    }
    if target.kind == "params" && !is_word {
        return Err("the name of a parameter is one word, as scripts use it".to_owned());
    }
    let known = texts.iter().flat_map(|text| names(text));
    if known
        .into_iter()
        .any(|n| n.kind == target.kind && n.name == new)
    {
        return Err(format!("another {} is named \"{new}\"", target.kind));
    }
    let mut edits: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for place in places(target, texts) {
        let text = &place.file.text;
        let old = &text[place.name.range.clone()];
        let is_bare = !old.starts_with(['"', '\'']);
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-".contains(c);
        let written = match is_bare && new.chars().all(is_plain) {
            true => new.to_owned(),
            false => toml_text(&format!("{}{new}", place.lead)),
        };
        let edit = json!({ "range": range(text, &place.name.range), "newText": written });
        edits
            .entry(uri_of(&place.file.path))
            .or_default()
            .push(edit);
    }
    Ok(json!({ "changes": edits }))
}
