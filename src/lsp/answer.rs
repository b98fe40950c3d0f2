//! Answers about a position in scene text: completion, hover and definitions.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use serde_json::{Value, json};

use super::{
    call::is_word,
    model_files::ModelFiles,
    names::{Name, border_of, files_of_value, kinds_of_value, names, with_parts},
    outline::{Part, Word, beside, words, words_before},
    position::{location, range, uri_of},
    scopes::{Scoped, is_named, places, with_scopes},
    structure,
};
use reflet_base::files::{
    canonicalize, entries_below, folder_of, has_extension, metadata, path_below,
};
use reflet_scene::{
    desc::{DecalChanges, LightGroup},
    diagnostic::Source,
    manual::{key_text, section_text, variant_text},
    parse::{
        Form, KeyRecord, SectionRecord,
        entry_kinds::ENTRY_KINDS,
        tables::{Below, Manual, is_project, keys_of},
    },
    reach::Reach,
    toml_text::toml_text,
};

/// Limits of file completion: number of files, and depth of the folders searched.
const MOST_FILES: usize = 500;
const DEPTH: usize = 3;

/// Kinds of completion items in the protocol.
const MODULE: u32 = 9;
pub const PROPERTY: u32 = 10;
pub const VALUE: u32 = 12;
const FILE: u32 = 17;
const FOLDER: u32 = 19;
pub const REFERENCE: u32 = 18;

/// How completed keys are written: with their sign and default value.
#[derive(Clone, Copy, Debug)]
pub struct KeyForm {
    sign: &'static str,
    /// Whether the client selects the value of a snippet, so that typing replaces it.
    snippets: bool,
}

impl KeyForm {
    /// The form at a byte offset of a text, where ` = ` or `: ` is the sign; none where the sign stands there already.
    pub fn at(text: &str, offset: usize, sign: &'static str, snippets: bool) -> Self {
        let rest = text[text.floor_char_boundary(offset)..].trim_start_matches(is_word);
        let has_sign = rest.trim_start().starts_with(sign.trim());
        Self {
            sign: if has_sign { "" } else { sign },
            snippets,
        }
    }

    /// Completion of a key with the value that it has where it is left out.
    pub fn item(self, key: &KeyRecord, default: Option<&Value>, text: &str) -> Value {
        let mut item = item(key.name, PROPERTY, text);
        let is_plain = |form: &Form| matches!(form, Form::Value(..) | Form::Table(_));
        if self.sign.is_empty() || !key.forms.iter().any(is_plain) {
            return item; // tables with names are seldom written as values
        }
        let default = default.map(|value| value.to_string().replace(',', ", "));
        let is_text = |form: &Form| matches!(form, Form::Value(_, s) if s["type"] == "string");
        let value = match (self.snippets, default) {
            (false, default) => default.unwrap_or_default(),
            (true, Some(default)) => {
                let escaped = default.replace('\\', "\\\\").replace('$', "\\$");
                format!("${{1:{}}}", escaped.replace('}', "\\}"))
            }
            (true, None) if key.forms.iter().all(is_text) => "\"$1\"".to_owned(),
            (true, None) => "$1".to_owned(),
        };
        item["insertText"] = format!("{}{}{value}", key.name, self.sign).into();
        item["insertTextFormat"] = if self.snippets { 2 } else { 1 }.into();
        item
    }
}

/// Completions at a byte offset.
pub fn complete(
    file: &Arc<Source>,
    offset: usize,
    snippets: bool,
    models: &ModelFiles,
) -> Vec<Value> {
    let before = &file.text[..file.text.floor_char_boundary(offset)];
    let (mut words, end) = words_before(file, offset);
    let word = match words.pop() {
        Some(word) if word.range.end == before.len() => word,
        _ => end,
    };
    let quoted = before[word.range.start..].starts_with(['"', '\'']);
    if let Some(names) = models.names_at(file, &word) {
        let is_key = matches!(word.part, Part::Key | Part::Header);
        let item = |name: &String| {
            let mut item = item(name, REFERENCE, "");
            let is_bare = is_key && name.chars().all(|c| is_word(c) && c.is_ascii() || c == '-');
            if !quoted && !is_bare {
                item["insertText"] = toml_text(name).into();
            }
            item
        };
        return names.iter().map(item).collect();
    }
    match &word.part {
        Part::Header => headers(file, &word),
        Part::Key => match Manual::for_file(&file.path).table(&word.table) {
            Some(section) => {
                let form = KeyForm::at(&file.text, offset, " = ", snippets);
                let kind = kind_at(file, section, &word.table, offset);
                keys(section, kind, form, &plain_keys(file, &word.table))
            }
            None => (params_at(file, &word).iter())
                .map(|(name, _)| item(&name.name, PROPERTY, ""))
                .collect(),
        },
        Part::Value(key) => values(file, &word, key, quoted),
        Part::Nothing => Vec::new(),
    }
}

/// A completion with the text of the manual.
pub fn item(label: &str, kind: u32, text: &str) -> Value {
    json!({
        "label": label,
        "kind": kind,
        "documentation": { "kind": "markdown", "value": text },
    })
}

/// Whether a key of this table has the default that its text states, unless a file, a base, or another key of the table
/// gives it another value: in `[material.NAME]` alone.
fn plain_keys(file: &Source, table: &[String]) -> impl Fn(&str) -> bool {
    let written = words(file);
    let has = |table: &[String], names: &[&str]| {
        let is_key = |w: &&Word| w.part == Part::Key && w.table == table;
        written
            .iter()
            .filter(is_key)
            .any(|w| names.contains(&w.text.as_str()))
    };
    let is_own = matches!(table, [kind, _] if kind == "material")
        && !has(table, &["extends"])
        && !has(&[], &["base", "include"]);
    let has_index = has(table, &["ior"]);
    move |key| is_own && !(has_index && key == "reflectivity")
}

/// The value behind the word "Default" of a manual's text, if a sentence or a part of it ends there.
fn stated_default(text: &str) -> Option<Value> {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, stated) = text.rsplit_once("Default ")?;
    let stated = stated.trim_start_matches('`').trim_end_matches('.');
    for (word, color) in [("white", json!([1, 1, 1])), ("black", json!([0, 0, 0]))] {
        if stated.starts_with(word) {
            return Some(color);
        }
    }
    let stated = stated.split(". ").next().unwrap_or(stated);
    let mut values = serde_json::Deserializer::from_str(stated).into_iter();
    let value = values.next()?.ok()?;
    let rest = &stated[values.byte_offset()..];
    (rest.is_empty() || rest.starts_with([',', '`'])).then_some(value)
}

/// Keys of a table; of its kind alone, where that is known. Keys without a recorded default have the default that their
/// text states, where `is_plain`.
pub fn keys(
    section: &'static SectionRecord,
    kind: Option<&str>,
    form: KeyForm,
    is_plain: &dyn Fn(&str) -> bool,
) -> Vec<Value> {
    let mut seen = BTreeSet::new();
    let is_own = |of: &Option<&str>| kind.is_none() || of.is_none() || *of == kind;
    let own = keys_of(section).filter(|(of, key)| is_own(of) && seen.insert(key.name));
    let mut all: Vec<_> = own
        .map(|(word, key)| {
            let text = key_text(section, word, key);
            let stated = || stated_default(&text).filter(|_| is_plain(key.name));
            form.item(key, key.default.clone().or_else(stated).as_ref(), &text)
        })
        .collect();
    if let Some(first) = section.variants.first() {
        all.push(item(first.key, PROPERTY, &section_text(section)));
    }
    all
}

/// Completions of a table header: tables, or names in use where users choose names.
fn headers(file: &Arc<Source>, word: &Word) -> Vec<Value> {
    match Manual::for_file(&file.path).below(&word.table) {
        Some(Below::Table(section)) => {
            let is_table = |key: &KeyRecord| {
                key.forms
                    .iter()
                    .any(|form| !matches!(form, Form::Value(..)))
            };
            let tables = keys_of(section).filter(|(_, key)| is_table(key));
            tables
                .map(|(word, key)| item(key.name, MODULE, &key_text(section, word, key)))
                .collect()
        }
        Some(Below::Names(section)) => {
            let kind = word.table.last().map_or("", String::as_str);
            let text = &section_text(section);
            let mut all = names_of_kind(file, kind);
            all.remove(&word.text);
            all.iter().map(|name| item(name, REFERENCE, text)).collect()
        }
        None => Vec::new(),
    }
}

/// Kind of the table of these keys around a byte offset, if the manual lists it.
fn kind_at(
    file: &Source,
    section: &'static SectionRecord,
    table: &[String],
    offset: usize,
) -> Option<&'static str> {
    let key = section.variants.first()?.key;
    let is_kind = |word: &Word| word.part == Part::Value(key.to_owned()) && word.table == table;
    let chosen = words(file).into_iter().filter(is_kind).find(|word| {
        let between = word.range.end.min(offset)..word.range.start.max(offset);
        file.text.get(between).is_some_and(is_in_one_table)
    })?;
    let known = section.variants.iter().find(|v| v.word == chosen.text)?;
    Some(known.word)
}

/// Whether a part of a text begins and ends in the same table.
fn is_in_one_table(part: &str) -> bool {
    let (mut depth, mut in_quotes) = (0_i32, false);
    for (before, c) in part
        .chars()
        .scan(' ', |last, c| Some((std::mem::replace(last, c), c)))
    {
        match c {
            '"' => in_quotes = !in_quotes,
            '[' if before == '\n' && depth == 0 => return false,
            '{' | '[' if !in_quotes => depth += 1,
            '}' | ']' if !in_quotes => depth -= 1,
            _ => {}
        }
        if depth < 0 {
            return false;
        }
    }
    depth == 0
}

/// Parameters of the scene that an instance places, where a word stands in its `params`, each with the file that has
/// it.
fn params_at(file: &Arc<Source>, word: &Word) -> Vec<(Name, Arc<Source>)> {
    if !(word.table.iter()).eq(["instance", "model", "params"]) {
        return Vec::new();
    }
    let Some(scene) = beside(file, word, "scene") else {
        return Vec::new();
    };
    let parts = with_parts(file);
    let placed = parts.iter().find(|part| is_named(&part.path, &scene.text));
    let texts = placed.map_or_else(Vec::new, with_parts);
    let params = texts.iter().flat_map(|text| {
        let all = names(text).into_iter().filter(|name| name.kind == "params");
        all.map(|name| (name, Arc::clone(text)))
    });
    params.collect()
}

fn names_of_kind(file: &Arc<Source>, kind: &str) -> BTreeSet<String> {
    let all = with_scopes(file)
        .into_iter()
        .filter(|part| part.shows(kind));
    let names = |part: Scoped| {
        let own = names(&part.source).into_iter();
        own.filter(|n| n.kind == kind)
            .map(move |n| format!("{}{}", part.prefix, n.name))
    };
    all.flat_map(names).collect()
}

/// Completions of the value of a key, in quotes unless it is `quoted` already.
pub fn values(file: &Arc<Source>, word: &Word, name: &str, quoted: bool) -> Vec<Value> {
    let text = |text: &str| match quoted {
        true => text.to_owned(),
        false => format!("\"{text}\""),
    };
    let mut all = Vec::new();
    let manual = Manual::for_file(&file.path);
    if let Some((section, _, key)) = manual.key(&word.table, name) {
        let meaning = key_text(section, None, key);
        let words = key.words.iter().map(|word| word.name);
        all.extend(words.map(|w| item(&text(w), VALUE, &meaning)));
        let is_switch = |form: &Form| matches!(form, Form::Value(_, s) if s["type"] == "boolean");
        if key.forms.iter().any(is_switch) && !quoted {
            all.extend(["true", "false"].map(|w| item(w, VALUE, &meaning)));
        }
    }
    if let Some(section) = manual.table(&word.table) {
        let chosen = section.variants.iter().filter(|v| v.key == name);
        all.extend(chosen.map(|v| item(&text(v.word), VALUE, &variant_text(section, v.word))));
    }
    if is_project(&file.path) {
        if word.table.is_empty() && ["assets", "scripts"].contains(&name) {
            let mut found = BTreeSet::new();
            let folder = folder_of(&file.path);
            let folders = entries_below(folder, DEPTH, false)
                .filter(|entry| entry.file_type().is_dir())
                .filter_map(|entry| path_below(&entry, folder));
            found.extend(folders.take(MOST_FILES));
            all.extend(found.iter().map(|name| item(&text(name), FOLDER, "")));
        }
        return all;
    }
    let known = known_words(file, &word.table, name);
    all.extend(known.iter().map(|word| item(&text(word), VALUE, "")));
    for kind in kinds_of_value(name) {
        let names = names_of_kind(file, kind);
        all.extend(names.iter().map(|name| item(&text(name), REFERENCE, "")));
    }
    let ends = files_of_value(&file.path, &word.table, name);
    if !ends.is_empty() {
        let mut found = BTreeSet::new();
        let reach = Reach::new(folder_of(&file.path).to_owned(), &border_of(&file.path));
        for folder in folders(&file.path) {
            let real = |path: &Path| canonicalize(path).unwrap_or_default();
            let own = real(&folder);
            let files = entries_below(&folder, DEPTH, true)
                .filter(|entry| !entry.file_type().is_dir() && has_extension(entry, ends))
                .filter(|entry| reach.holds(&real(entry.path()), &own))
                .filter_map(|entry| path_below(&entry, &folder));
            found.extend(files.take(MOST_FILES - found.len()));
        }
        all.extend(found.iter().map(|name| item(&text(name), FILE, "")));
    }
    all
}

/// Folder of a file, then the asset folders, also of its project.
fn folders(path: &Path) -> Vec<PathBuf> {
    let own = path.parent().unwrap_or(Path::new("")).to_owned();
    let border = border_of(path);
    let all = std::iter::once(own).chain(border.assets);
    all.chain(border.scripts).collect()
}

/// Word at a byte offset.
fn word_at(source: &Source, offset: usize) -> Option<Word> {
    let is_at = |word: &Word| (word.range.start..=word.range.end).contains(&offset);
    words(source).into_iter().find(is_at)
}

/// Manual text about the word at a byte offset; for a name the table that defines it.
pub fn hover(file: &Arc<Source>, offset: usize) -> Option<Value> {
    let word = word_at(file, offset)?;
    let kinds = match &word.part {
        Part::Value(key) => kinds_of_value(key),
        _ => &[],
    };
    let table = structure::table(&with_scopes(file), &word.text, |kind| kinds.contains(&kind));
    let text = table.or_else(|| Some(meaning(file, &word)?.replace('\n', "\n\n")))?;
    Some(json!({
        "contents": { "kind": "markdown", "value": text },
        "range": range(&file.text, &word.range),
    }))
}

/// Text of the manual about a word.
fn meaning(file: &Source, word: &Word) -> Option<String> {
    let manual = Manual::for_file(&file.path);
    let of_key = |table: &[String], name: &str| {
        let (section, variant, key) = manual.key(table, name)?;
        Some(key_text(section, variant, key))
    };
    match &word.part {
        Part::Value(name) => {
            let chosen = manual.table(&word.table).and_then(|section| {
                let mut known = section.variants.iter();
                let known = known.any(|v| v.key == name && v.word == word.text);
                known.then(|| variant_text(section, &word.text))
            });
            chosen.or_else(|| of_key(&word.table, name))
        }
        Part::Key => of_key(&word.table, &word.text).or_else(|| {
            let section = manual.table(&word.table)?;
            let chooses = section.variants.iter().any(|v| v.key == word.text);
            chooses.then(|| section_text(section))
        }),
        Part::Header => {
            let keys: Vec<_> = word.table.iter().chain([&word.text]).cloned().collect();
            let (Below::Table(section) | Below::Names(section)) = manual.below(&keys)?;
            Some(section_text(section))
        }
        Part::Nothing => None,
    }
}

/// Locations of the definition of the name at a byte offset: a table, an instance, or a file.
pub fn definition(file: &Arc<Source>, offset: usize) -> Vec<Value> {
    let Some(word) = word_at(file, offset) else {
        return Vec::new();
    };
    if word.part == Part::Key {
        let mut params = params_at(file, &word).into_iter();
        let own = params.find(|(name, _)| name.name == word.text);
        let place = own.map(|(name, text)| location(&text, &name.range));
        return place.into_iter().collect();
    }
    let kinds: Vec<String> = match (&word.part, word.table.as_slice()) {
        (Part::Value(key), table) => {
            let ends = files_of_value(&file.path, table, key);
            let at_start =
                |path: PathBuf| json!({ "uri": uri_of(&path), "range": range("", &(0..0)) });
            if !ends.is_empty() {
                let mut files = folders(&file.path).into_iter().map(|f| f.join(&word.text));
                return files
                    .find(|f| metadata(f).is_ok_and(|found| found.is_file()))
                    .map(at_start)
                    .into_iter()
                    .collect();
            }
            kinds_of_value(key)
                .iter()
                .map(|kind| (*kind).to_owned())
                .collect()
        }
        // [motion.instance.NAME]
        (Part::Header, [motion, kind]) if motion == "motion" => vec![kind.clone()],
        _ => Vec::new(),
    };
    places(&with_scopes(file), &word.text, |k| {
        kinds.iter().any(|kind| kind == k)
    })
}

/// Words for the value of a key in a table, where no list of the manual has them.
pub fn known_words(file: &Arc<Source>, table: &[String], key: &str) -> Vec<String> {
    let table: Vec<&str> = table.iter().map(String::as_str).collect();
    match (key, table.as_slice()) {
        ("changes", ["decal", _] | ["variant", _, "decal", _]) => {
            DecalChanges::WORDS.map(str::to_owned).to_vec()
        }
        ("light_group", _) => light_groups(file),
        ("remove", []) => entries(file, true),
        ("remove", ["variant", _]) => entries(file, false),
        _ => Vec::new(),
    }
}

/// Names of groups that the scene has.
fn light_groups(file: &Arc<Source>) -> Vec<String> {
    let mut found = BTreeSet::from([LightGroup::default().name().to_owned()]);
    for part in with_scopes(file) {
        let is_group = |part: &Part| matches!(part, Part::Value(key) if key == "light_group");
        let words = words(&part.source).into_iter();
        found.extend(words.filter(|w| is_group(&w.part)).map(|w| w.text));
    }
    found.retain(|name| LightGroup::new(name).is_some());
    found.into_iter().collect()
}

/// Entries of the scene, such as `light.lamp`; with `below` of its base and included files alone, whose entries a layer
/// may take out.
fn entries(file: &Arc<Source>, below: bool) -> Vec<String> {
    let mut found = BTreeSet::new();
    for part in with_scopes(file).iter().skip(usize::from(below)) {
        let own = names(&part.source).into_iter();
        let is_entry = |kind: &str| kind == "instance" || ENTRY_KINDS.contains(&kind);
        let entries = own.filter(|name| part.prefix.is_empty() && is_entry(&name.kind));
        found.extend(entries.map(|name| format!("{}.{}", name.kind, name.name)));
    }
    found.into_iter().collect()
}
