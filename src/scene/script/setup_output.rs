//! Result of `setup` as scene text, so that the readers of scene text check it like any other.

use std::fmt::Write as _;

use glam::{DMat4, DQuat, DVec3};
use rhai::{Array, Dynamic, Map};

use super::{floats::Floats, format_value::named, limits::NESTED};
use crate::{diagnostic::TABLES, suggest, toml_text::toml_text};

/// Key of the only table that a scene has once.
const ENVIRONMENT: &str = "environment";

/// Most bytes of the text of a result. Copies of one `floats` share their numbers in a script, but not in the text.
const MOST_OUTPUT_BYTES: usize = 256 << 20;

/// Mistake in the result of `setup`.
#[derive(Debug, Default)]
pub struct Wrong {
    /// Message: the found value, and the expected one.
    pub message: String,
    /// Advice on what to do.
    pub help: Option<String>,
    /// Names on the path to the mistake, outermost first.
    pub path: Vec<String>,
}

impl Wrong {
    fn new(message: String) -> Self {
        Self {
            message,
            ..Self::default()
        }
    }

    fn under(mut self, name: &str) -> Self {
        self.path.insert(0, name.to_owned());
        self
    }
}

/// The returned map as scene text; `None` for `()`.
///
/// # Errors
/// A value that `setup` must not return.
pub fn text(returned: &Dynamic) -> Result<Option<String>, Wrong> {
    if returned.is_unit() {
        return Ok(None);
    }
    let Some(map) = returned.read_lock::<Map>() else {
        let found = named(returned);
        let mut wrong = Wrong::new(format!(
            "setup must return a map such as `#{{ instances: [] }}`, not {found}"
        ));
        let is_list = returned.is_array();
        wrong.help = Some(match is_list {
            true => "return `#{ instances: list }`".to_owned(),
            false => "return `#{ }` for nothing".to_owned(),
        });
        return Err(wrong);
    };
    let mut out = String::new();
    let known: Vec<&str> = TABLES.iter().map(|t| t.0).chain([ENVIRONMENT]).collect();
    if let Some(key) = map.keys().find(|k| !known.contains(&k.as_str())) {
        let meant = suggest::nearest(key, known.iter().copied());
        let meant = meant.map(|meant| format!("; did you mean {}?", suggest::key(meant)));
        let (shown, meant) = (suggest::key(key), meant.unwrap_or_default());
        let mut wrong = Wrong::new(format!("setup cannot return {shown}{meant}"));
        wrong.help = Some(format!(
            "it may return {}",
            known
                .iter()
                .map(|key| suggest::key(key))
                .collect::<Vec<_>>()
                .join(", ")
        ));
        return Err(wrong.under(key));
    }
    if let Some(value) = map.get(ENVIRONMENT) {
        let Some(table) = value.read_lock::<Map>() else {
            let message = format!("`{ENVIRONMENT}` of what setup returns must be a map");
            return Err(Wrong::new(message).under(ENVIRONMENT));
        };
        let _ = writeln!(out, "[{ENVIRONMENT}]");
        keys(&mut out, &table).map_err(|w| w.under(ENVIRONMENT))?;
    }
    for (key, table, is_list) in TABLES {
        let Some(value) = map.get(key) else { continue };
        let wrong = |what: &str| {
            let message = format!("`{key}` of what setup returns must be {what}");
            Wrong::new(message).under(key)
        };
        if is_list {
            let list = value.read_lock::<Array>();
            for item in list
                .ok_or_else(|| wrong("an array of maps, such as `[#{ … }]`"))?
                .iter()
            {
                let item = item.read_lock::<Map>();
                let item = item.ok_or_else(|| wrong("an array of maps, such as `[#{ … }]`"))?;
                let _ = writeln!(out, "[[{table}]]");
                keys(&mut out, &item).map_err(|w| w.under(key))?;
            }
        } else {
            let named = value.read_lock::<Map>();
            let shape = "a map of names to maps, such as `#{ a: #{ … } }`";
            for (name, item) in named.ok_or_else(|| wrong(shape))?.iter() {
                let item = item.read_lock::<Map>();
                let item = item.ok_or_else(|| wrong(shape))?;
                let _ = writeln!(out, "[{table}.{}]", quoted(name));
                keys(&mut out, &item).map_err(|w| w.under(name).under(key))?;
            }
        }
    }
    Ok(Some(out))
}

/// Writes the keys of a table.
pub fn keys(out: &mut String, map: &Map) -> Result<(), Wrong> {
    for (key, item) in map {
        let _ = write!(out, "{} = ", quoted(key));
        value(out, item, key, 0)?;
        out.push('\n');
    }
    Ok(())
}

/// A key as TOML: quoted if it is not a bare key.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        toml_text(text)
    }
}

fn numbers(out: &mut String, list: &[f64]) {
    let texts: Vec<_> = list.iter().map(|x| number(*x)).collect();
    let _ = write!(out, "[{}]", texts.join(", "));
}

/// A float with a decimal point; `nan` and `inf` are TOML too, and refused by the readers.
fn number(x: f64) -> String {
    match x {
        x if x.is_nan() => "nan".into(),
        x => format!("{x:?}"),
    }
}

fn value(out: &mut String, item: &Dynamic, key: &str, depth: usize) -> Result<(), Wrong> {
    let wrong = |message: String| Wrong::new(message).under(key);
    if depth == NESTED {
        let key = suggest::key(key);
        return Err(wrong(format!(
            "{key} has arrays and maps that are nested more than {NESTED} deep"
        )));
    }
    if out.len() > MOST_OUTPUT_BYTES {
        return Err(wrong(format!(
            "`setup` returns more than {} MiB: return each `floats` once, and place its mesh by instances",
            MOST_OUTPUT_BYTES >> 20
        )));
    }
    if let Ok(i) = item.as_int() {
        let _ = write!(out, "{i}");
    } else if let Ok(x) = item.as_float() {
        out.push_str(&number(x));
    } else if let Ok(b) = item.as_bool() {
        let _ = write!(out, "{b}");
    } else if let Some(text) = item.read_lock::<rhai::ImmutableString>() {
        out.push_str(&toml_text(&text));
    } else if let Some(v) = item.read_lock::<DVec3>() {
        numbers(out, &v.to_array());
    } else if let Some(q) = item.read_lock::<DQuat>() {
        numbers(out, &q.to_array());
    } else if let Some(m) = item.read_lock::<DMat4>() {
        numbers(out, &m.to_cols_array());
    } else if let Some(floats) = item.read_lock::<Floats>() {
        floats.write(out);
    } else if let Some(list) = item.read_lock::<Array>() {
        out.push('[');
        for (i, item) in list.iter().enumerate() {
            out.push_str(if i > 0 { ", " } else { "" });
            value(out, item, key, depth + 1)?;
        }
        out.push(']');
    } else if let Some(map) = item.read_lock::<Map>() {
        out.push_str("{ ");
        for (i, (inner, item)) in map.iter().enumerate() {
            out.push_str(if i > 0 { ", " } else { "" });
            let _ = write!(out, "{} = ", quoted(inner));
            value(out, item, inner, depth + 1).map_err(|w| w.under(key))?;
        }
        out.push_str(" }");
    } else {
        let found = named(item);
        return Err(wrong(format!(
            "{} is {found}, which is not a valid value in a scene",
            suggest::key(key)
        )));
    }
    Ok(())
}
