//! References to a name in all texts of a scene and of its project, and renaming.

use std::{collections::BTreeMap, ops::Range, path::Path, sync::Arc};

use serde_json::{Value, json};

use super::{
    call::Call,
    is_script,
    names::{Name, border_of, kinds_of_value, names, uses, with_parts},
    position::{location, range, uri_of},
    scopes::{Placement, is_named, placements, split},
};
use reflet_base::files::{
    canonicalize, entries_below, folder_of, has_extension, open_regular, read_at_most,
};
use reflet_scene::{diagnostic::Source, parse, script::tokens::tokens, toml_text::toml_text};

/// Maximum number of files that are searched, and depth of the folders.
const MOST_FILES: usize = 1000;
const DEPTH: usize = 6;

/// Largest script that is read, bytes, as where scenes run them.
const MOST_SCRIPT_BYTES: u64 = 1 << 20;

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
    /// Whether it is a part of a word in quotes, such as `bulb` in `"lamp.bulb"`, where `lamp` is a placed scene.
    is_part: bool,
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
                true => {
                    let bytes = open_regular(path, false)
                        .and_then(|file| read_at_most(&file, MOST_SCRIPT_BYTES));
                    String::from_utf8(bytes.ok()?).ok()?
                }
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
    entries_below(&folder, depth, false)
        .filter(|entry| entry.file_type().is_file() && has_extension(entry, &["toml", "rhai"]))
        .take(MOST_FILES)
        .for_each(|entry| add(entry.path()));
    all
}

/// Whether two paths name one file.
pub fn same(a: &Path, b: &Path) -> bool {
    let real = |path: &Path| canonicalize(path).unwrap_or_else(|_| path.to_owned());
    a == b || a.file_name() == b.file_name() && real(a) == real(b)
}

/// The named thing at a byte offset of a file, with its range there.
pub fn target(file: &Arc<Source>, offset: usize, texts: &[Arc<Source>]) -> Option<(Target, Name)> {
    let is_at = |name: &Name| (name.range.start..=name.range.end).contains(&offset);
    let target = |kind: &str, name: &str| Target {
        kind: kind.to_owned(),
        name: name.to_owned(),
    };
    if let Some(own) = own_names(file).into_iter().find(is_at) {
        return Some((target(&own.kind, &own.name), own));
    }
    let (name, kinds) = used_names(file).into_iter().find(|(name, _)| is_at(name))?;
    let defined = texts.iter().flat_map(|text| own_names(text));
    let mut defined = defined.filter(|d| d.name == name.name && kinds.contains(&d.kind));
    if let Some(Name { kind, .. }) = defined.next() {
        return Some((target(&kind, &name.name), name));
    }
    let placements = placements_in(texts);
    let split = split(&name.name, &placements)?;
    let (start, end) = within_quotes(file, &name)?;
    if let Some((group, at)) =
        (split.groups.iter()).find(|(_, at)| (start + at.start..=start + at.end).contains(&offset))
    {
        let place = name.at(start + at.start..start + at.end);
        return Some((target("instance", group), place));
    }
    let kind = kind_in(split.file, split.name, &kinds, texts)?;
    Some((target(&kind, split.name), name.at(start + split.start..end)))
}

/// All scenes that texts place.
fn placements_in(texts: &[Arc<Source>]) -> Vec<Placement> {
    let scenes = texts.iter().filter(|text| !is_script(&text.path));
    scenes.flat_map(|text| placements(text)).collect()
}

/// Bytes of a name in quotes, without these; `None` for a bare one, which has no prefix.
fn within_quotes(file: &Source, name: &Name) -> Option<(usize, usize)> {
    let (start, end) = (name.range.start + 1, name.range.end - 1);
    (file.text.get(start..end)? == name.name).then_some((start, end))
}

/// Kind of a name that a placed file defines, of these kinds.
fn kind_in(file: &str, name: &str, kinds: &[String], texts: &[Arc<Source>]) -> Option<String> {
    let files = texts.iter().filter(|text| is_named(&text.path, file));
    let mut defined = files.flat_map(|text| own_names(text));
    let found = defined.find(|d| d.name == name && kinds.contains(&d.kind))?;
    Some(found.kind)
}

/// All places of a named thing.
pub fn places(target: &Target, texts: &[Arc<Source>]) -> Vec<Place> {
    let mut all = Vec::new();
    let placed = placements_in(texts);
    for file in texts {
        let mut add = |name: Name, is_definition: bool, lead: String| {
            let file = Arc::clone(file);
            all.push(Place {
                file,
                name,
                is_definition,
                is_part: false,
                lead,
            });
        };
        let own = own_names(file).into_iter();
        own.filter(|n| n.kind == target.kind && n.name == target.name)
            .for_each(|name| add(name, true, String::new()));
        for (name, kinds) in used_names(file) {
            if name.name == target.name && kinds.contains(&target.kind) {
                let word = file.text[name.range.clone()].trim_matches(['"', '\'']);
                let lead = word.strip_suffix(name.name.as_str()).unwrap_or_default();
                let lead = lead.to_owned();
                add(name, false, lead);
            }
        }
        all.extend(parts_in(target, file, &placed, texts));
    }
    all.sort_by(|a, b| (&a.file.path, a.name.range.start).cmp(&(&b.file.path, b.name.range.start)));
    all.dedup_by(|a, b| a.file.path == b.file.path && a.name.range == b.name.range);
    all
}

/// Places of a named thing in names behind groups of placed scenes: the name itself, or a group.
fn parts_in(
    target: &Target,
    file: &Arc<Source>,
    placed: &[Placement],
    texts: &[Arc<Source>],
) -> Vec<Place> {
    let mut all = Vec::new();
    for (name, kinds) in used_names(file) {
        let Some((start, end)) = within_quotes(file, &name) else {
            continue;
        };
        let Some(split) = split(&name.name, placed) else {
            continue;
        };
        let mut add = |range: Range<usize>| {
            all.push(Place {
                file: Arc::clone(file),
                name: name.at(range),
                is_definition: false,
                is_part: true,
                lead: String::new(),
            });
        };
        for (group, at) in &split.groups {
            if target.kind == "instance" && *group == target.name {
                add(start + at.start..start + at.end);
            }
        }
        let is_it = split.name == target.name && kinds.contains(&target.kind);
        let own = std::slice::from_ref(&target.kind);
        if is_it && kind_in(split.file, split.name, own, texts).is_some() {
            add(start + split.start..end);
        }
    }
    all
}

/// Names that a text defines; a script defines none.
fn own_names(file: &Source) -> Vec<Name> {
    match is_script(&file.path) {
        true => Vec::new(),
        false => names(file),
    }
}

/// Names that a text uses, each with the kinds that it may be of.
fn used_names(file: &Source) -> Vec<(Name, Vec<String>)> {
    match is_script(&file.path) {
        true => script_names(file),
        false => uses(file),
    }
}

/// Names in a script, each with the kinds that it may be of: texts in quotes that a call of the API takes as a name, or
/// that are the value of a key which names something, and `ctx.params.NAME` with the kind `params`. Other texts are
/// none, as they may be anything.
fn script_names(file: &Source) -> Vec<(Name, Vec<String>)> {
    let tokens = tokens(&file.text);
    let mut found = Vec::new();
    let mut add = |name: &str, range: Range<usize>, kinds: &[&str]| {
        let name = Name {
            kind: String::new(),
            name: name.to_owned(),
            range,
        };
        let kinds = kinds.iter().map(|kind| (*kind).to_owned());
        found.push((name, kinds.collect()));
    };
    for (i, token) in tokens.iter().enumerate() {
        let before = |n: usize| i.checked_sub(n).map_or("", |i| tokens[i].text);
        let quoted = token.text.strip_prefix('"');
        let quoted = quoted.and_then(|text| text.strip_suffix('"'));
        if let Some(name) = quoted {
            let call = || Call::around_end_of(&file.text[..=token.at.start]);
            let kinds = match before(1) {
                ":" => kinds_of_value(before(2)),
                _ => call().map_or(&[][..], |call| call.kinds_of_names()),
            };
            if !kinds.is_empty() {
                add(name, token.at.clone(), kinds);
            }
        } else if token.is_word() && [4, 3, 2, 1].map(before) == ["ctx", ".", "params", "."] {
            add(token.text, token.at.clone(), &["params"]);
        }
    }
    found
}

/// Locations of places in the protocol's form.
pub fn locations(places: &[Place], with_definitions: bool) -> Vec<Value> {
    let shown = (places.iter()).filter(|place| with_definitions || !place.is_definition);
    shown
        .map(|place| location(&place.file, &place.name.range))
        .collect()
}

/// Edits that give a named thing another name.
///
/// # Errors
/// A message about a name that is empty, has line breaks or quotes, is no word where a word is needed, or that is
/// taken.
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
        let written = match place.is_part || (is_bare && new.chars().all(is_plain)) {
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
