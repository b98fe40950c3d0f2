//! Functions, operators and properties that scripts have beyond Rhai's own: their registration, and their reference,
//! which has an example of each that a test runs.

use std::{
    fmt::Write as _,
    ops::{Range, RangeInclusive},
    sync::{Arc, LazyLock},
};

use glam::{DMat4, DQuat, DVec3};
use rhai::Engine;
use serde::Deserialize;

use super::{context::rig, limits::limits};
use crate::{
    desc::{CAMERA, LIGHT, MATERIAL, MaterialDesc},
    motion::DECAL,
    number::Field,
    script::{
        context::Context,
        format_value::{mat4, quat, vec3},
        source_files::Sources,
        value::WrongKey,
    },
};

pub use self::definitions::definitions;

mod definitions;
mod floats;
mod math;
mod random;
mod scene;
mod text;

/// One function, operator or property.
#[derive(Deserialize)]
pub struct Entry {
    /// Signatures such as `vec3(x, y, z)`, each with its result type; `?` depends on the arguments.
    pub forms: Vec<(String, String)>,
    /// Description of it; see [`Entry::meaning`].
    text: String,
    /// Statements that end in an expression, which is true.
    pub example: String,
}

impl Entry {
    /// Description for the manual, with `{camera}`, `{decal}`, `{light}` and `{material}` replaced by their keys, and
    /// `{own}` by the keys that a material's own table must have before scripts set them.
    pub fn meaning(&self) -> String {
        let plain = MaterialDesc::default();
        let is_own = |f: &&Field<_>| f.lacks(&plain).is_some_and(|own| own.starts_with(f.key));
        let text = self.text.replace("{camera}", &keys(&CAMERA, "and"));
        let text = text.replace("{light}", &keys(&LIGHT, "and"));
        let text = text.replace("{decal}", &keys(&DECAL, "and"));
        let text = text.replace("{own}", &keys(MATERIAL.iter().filter(is_own), "or"));
        text.replace("{material}", &keys(&MATERIAL, "and"))
    }
}

fn keys<'f, T: 'static>(fields: impl IntoIterator<Item = &'f Field<T>>, word: &str) -> String {
    let keys = fields.into_iter().map(|f| format!("`{}`", f.key));
    match keys.collect::<Vec<_>>().split_last() {
        Some((last, others)) => format!("{} {word} {last}", others.join(", ")),
        None => String::new(),
    }
}

/// A chapter of the reference.
#[derive(Deserialize)]
pub struct Group {
    /// Heading of the chapter.
    title: String,
    /// Entries of the chapter.
    pub entries: Vec<Entry>,
}

#[derive(Deserialize)]
struct Reference {
    group: Vec<Group>,
}

/// All chapters of the reference.
pub static API: LazyLock<Vec<Group>> = LazyLock::new(|| {
    let read = toml::from_str::<Reference>(include_str!("api/reference.toml"));
    read.expect("tests read it").group
});

const INTRODUCTION: &str = include_str!("api/introduction.md");

/// Registers all types and functions with an engine; fonts are files beside these sources.
pub fn register(engine: &mut Engine, sources: &Arc<Sources>) {
    register_types(engine);
    scene::register(engine);
    math::register(engine);
    floats::register(engine);
    random::register(engine);
    text::register(engine, sources);
}

/// Signatures of all entries.
fn forms() -> impl Iterator<Item = &'static str> {
    let entries = API.iter().flat_map(|group| &group.entries);
    entries.flat_map(|entry| entry.forms.iter().map(|(form, _)| form.as_str()))
}

/// Name in a signature: `place` in `ctx.place(name, position)`.
fn name_of(signature: &str) -> &str {
    let call = signature.split('(').next().unwrap_or(signature);
    call.rsplit('.').next().unwrap_or(call).trim()
}

/// All names, for suggestions.
pub fn names() -> Vec<&'static str> {
    let is_word = |name: &&str| name.chars().all(|c| c.is_alphanumeric() || c == '_');
    forms().map(name_of).filter(is_word).collect()
}

/// Entries with a form of that name.
pub fn entries(name: &str) -> Vec<&'static Entry> {
    let entries = API.iter().flat_map(|group| &group.entries);
    let has_name = |e: &&Entry| e.forms.iter().any(|(form, _)| name_of(form) == name);
    entries.filter(has_name).collect()
}

/// Signatures of the forms with that name, in code marks.
pub fn signatures(name: &str) -> Vec<String> {
    let forms = forms().filter(|form| name_of(form) == name);
    forms.map(|form| format!("`{form}`")).collect()
}

/// First sentence of the manual about the forms with that name.
pub fn meaning(name: &str) -> Option<&'static str> {
    let sentence = entries(name).first()?.text.split(". ").next()?;
    // Lists of keys are in the manual.
    Some(sentence.trim_end_matches('.')).filter(|text| !text.contains('{'))
}

/// Keys of the map that a function of `ctx` takes; none if it takes no map.
pub fn map_keys(function: &str) -> Vec<&'static str> {
    fn all<T>(fields: &'static [Field<T>]) -> Vec<&'static str> {
        fields.iter().map(|field| field.key).collect()
    }
    match function {
        "camera" => all(&CAMERA),
        "light" => all(&LIGHT),
        "decal" => all(&DECAL),
        "material" | "instance_material" => all(&MATERIAL),
        "joint" => rig::KEYS.to_vec(),
        _ => Vec::new(),
    }
}

/// Properties and functions whose signatures begin with an owner such as `ctx.`, without the owner.
pub fn members(owner: &str) -> (Vec<&'static str>, Vec<&'static str>) {
    let own = forms().filter_map(|form| form.strip_prefix(owner));
    let mut members = (Vec::new(), Vec::new());
    for form in own {
        match form.split_once('(') {
            None => members.0.push(form),
            Some((name, _)) => members.1.push(name),
        }
    }
    members
}

/// Manual of scripts as Markdown, `docs/scripting.md`.
pub fn manual() -> String {
    let mut out = INTRODUCTION.to_owned();
    out.push_str("\n## Limits\n\n| what | at most |\n|---|---|\n");
    for (what, most) in limits() {
        let _ = writeln!(out, "| {what} | {most} |");
    }
    for group in API.iter() {
        let _ = write!(
            out,
            "\n## {}\n\n| write | meaning | true, for example |\n|---|---|---|\n",
            group.title
        );
        for entry in &group.entries {
            let forms: Vec<_> = entry.forms.iter().map(|f| format!("`{}`", f.0)).collect();
            let cells = [
                forms.join("<br>"),
                entry.meaning(),
                format!("`{}`", entry.example),
            ];
            let _ = writeln!(
                out,
                "| {} |",
                cells.map(|c| c.replace('|', "\\|")).join(" | ")
            );
        }
    }
    out
}

/// Registers the names of the types, and `to_string` and `to_debug` of them.
fn register_types(engine: &mut Engine) {
    engine.register_type_with_name::<DVec3>("vec3");
    engine.register_type_with_name::<DQuat>("quat");
    engine.register_type_with_name::<DMat4>("mat4");
    engine.register_type_with_name::<Context>("ctx");
    engine.register_type_with_name::<WrongKey>("error");
    engine.register_type_with_name::<Range<i64>>("range");
    engine.register_type_with_name::<RangeInclusive<i64>>("range");
    for name in ["to_string", "to_debug"] {
        engine.register_fn(name, |v: &mut DVec3| vec3(v));
        engine.register_fn(name, |q: &mut DQuat| quat(q));
        engine.register_fn(name, |m: &mut DMat4| mat4(m));
        engine.register_fn(name, |_: &mut Context| "ctx".to_owned());
        engine.register_fn(name, |wrong: &mut WrongKey| wrong.message.clone());
    }
}
