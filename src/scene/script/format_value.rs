//! Values of scripts as text: in messages and when they are printed.

use std::ops::{Range, RangeInclusive};

use glam::{DMat4, DQuat, DVec3};
use rhai::{Array, Dynamic, FnPtr, Map};

use crate::suggest;

/// Maximum length of a thrown value in a message, characters.
const MOST: usize = 500;

/// Description of a value for messages, with its article.
pub fn named(value: &Dynamic) -> String {
    match value.type_name() {
        "string" => format!(
            "the text {}",
            suggest::text(&value.clone().into_string().unwrap_or_default())
        ),
        "array" => match value.read_lock::<Array>().map_or(0, |a| a.len()) {
            1 => "an array of 1 value".to_owned(),
            n => format!("an array of {n} values"),
        },
        other => type_named(other),
    }
}

/// Plain name of a type of Rhai or Rust, with its article.
pub fn type_named(name: &str) -> String {
    match name {
        "i64" => "an integer",
        "f64" => "a float",
        "bool" => "true or false",
        "char" => "a character",
        "Fn" => "a function",
        "string" => "a text",
        "array" => "an array",
        "map" => "a map",
        "()" => "nothing",
        "ctx" => "`ctx`",
        other if other.ends_with("Context") => "`ctx`",
        other if other.contains("Range") => "a range",
        other if other.contains("DVec3") => "a vec3",
        other if other.contains("DQuat") => "a quat",
        other if other.contains("DMat4") => "a mat4",
        other if other.to_lowercase().contains("floats") => "`floats`",
        other => return format!("a {other}"),
    }
    .to_owned()
}

/// A thrown value as text, cut to the length of a message.
pub fn thrown(value: &Dynamic) -> String {
    let mut out = String::new();
    write(&mut out, value, false);
    if out.chars().count() <= MOST {
        return out;
    }
    out.chars().take(MOST - 1).chain(['…']).collect()
}

/// Appends the beginning of a value, at least as much as a message shows.
fn write(out: &mut String, value: &Dynamic, is_inside: bool) {
    if out.len() > 4 * MOST {
        return;
    }
    if let Some(list) = value.read_lock::<Array>() {
        out.push('[');
        for (i, item) in list.iter().take(MOST).enumerate() {
            out.push_str(if i > 0 { ", " } else { "" });
            write(out, item, true);
        }
        out.push(']');
    } else if let Some(map) = value.read_lock::<Map>() {
        out.push_str("#{");
        for (i, (key, item)) in map.iter().take(MOST).enumerate() {
            out.push_str(if i > 0 { ", " } else { "" });
            out.extend(key.chars().take(MOST));
            out.push_str(": ");
            write(out, item, true);
        }
        out.push('}');
    } else if let Ok(text) = value.as_immutable_string_ref() {
        let beginning: String = text.chars().take(MOST + 1).collect();
        match is_inside {
            true => out.push_str(&format!("{beginning:?}")),
            false => out.push_str(&beginning),
        }
    } else if let Some(v) = value.read_lock::<DVec3>() {
        out.push_str(&vec3(&v));
    } else if let Some(q) = value.read_lock::<DQuat>() {
        out.push_str(&quat(&q));
    } else if let Some(m) = value.read_lock::<DMat4>() {
        out.push_str(&mat4(&m));
    } else if let Some(range) = value.read_lock::<Range<i64>>() {
        out.push_str(&format!("{range:?}"));
    } else if let Some(range) = value.read_lock::<RangeInclusive<i64>>() {
        out.push_str(&format!("{range:?}"));
    } else if value.type_name().ends_with("Context") {
        out.push_str("ctx");
    } else if value.is::<FnPtr>() {
        out.push_str("a function");
    } else {
        out.push_str(&value.to_string());
    }
}

/// A vector as scripts write it.
pub fn vec3(v: &DVec3) -> String {
    format!("vec3({}, {}, {})", v.x, v.y, v.z)
}

/// A rotation as scripts write it.
pub fn quat(q: &DQuat) -> String {
    format!("quat({}, {}, {}, {})", q.x, q.y, q.z, q.w)
}

/// A matrix by rows, as scripts write it.
pub fn mat4(m: &DMat4) -> String {
    let rows = m.transpose().to_cols_array_2d();
    let row = |[a, b, c, d]: [f64; 4]| format!("{a}, {b}, {c}, {d}");
    format!("mat4({})", rows.map(row).join("; "))
}
