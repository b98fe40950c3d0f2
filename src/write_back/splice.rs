//! Values of one table of scene text, changed in place: every other byte of the text stays.

use std::ops::Range;

use super::{
    insert::{insert, insert_table},
    tree::{Step, find, number},
};
use reflet_base::math::{linear_from_srgb, srgb_from_linear};
use reflet_scene::syntax::{Content, Entries, Node};

/// A value to write.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// One number, or a list of numbers.
    Numbers(Vec<f64>),
    /// Linear color; written as `"#rrggbb"` where that is what stands there.
    Color(Vec<f64>),
    /// Value as TOML, such as text in quotes.
    Toml(String),
}

/// Number of decimals that are written.
const DECIMALS: i32 = 6;
/// Single numbers below this are written with all their digits.
const SMALL: f64 = 1e-3;

/// A number as written: whole numbers have no decimal point.
pub fn shown(value: f64) -> String {
    let scale = 10_f64.powi(DECIMALS);
    let rounded = (value * scale).round() / scale;
    // Turns -0 into 0.
    format!("{}", rounded + 0.0)
}

/// Numbers as written.
pub fn list(values: &[f64]) -> String {
    match values {
        // A small single number is no rounding error.
        [one] if one.abs() < SMALL => format!("{}", *one as f32 + 0.0),
        [one] => shown(*one),
        several => {
            let texts: Vec<_> = several.iter().map(|x| shown(*x)).collect();
            format!("[{}]", texts.join(", "))
        }
    }
}

/// Text of an sRGB color, if the linear color has one and is not far from it.
fn hex(linear: &[f64]) -> Option<String> {
    let mut text = String::from("#");
    for lane in linear {
        let lane = *lane as f32;
        let byte = (srgb_from_linear(lane.clamp(0.0, 1.0)) * 255.0).round();
        let is_near = (linear_from_srgb(byte / 255.0) - lane).abs() < 0.005;
        if !is_near {
            return None;
        }
        text += &format!("{:02x}", byte as u8);
    }
    (linear.len() == 3).then_some(text)
}

impl Value {
    /// The value where nothing stands yet.
    pub fn text(&self) -> String {
        match self {
            Self::Numbers(values) | Self::Color(values) => list(values),
            Self::Toml(text) => text.clone(),
        }
    }
}

/// The text with another value for a key of the table that a locator points to; `order` are the keys of such a table
/// in the order of the manual. The table is made where it is missing.
///
/// # Errors
/// A text with mistakes, or something there that is no table.
pub fn put(
    text: &str,
    root: &Entries,
    locator: &[Step],
    key: &str,
    value: &Value,
    order: &[&str],
) -> Result<String, String> {
    let Some(node) = find(root, locator) else {
        return insert_table(text, root, locator, &[(key, value.text())]);
    };
    let Content::Table(table) = node.get_ref() else {
        return Err("it is not written as a table".to_owned());
    };
    match table.get(key) {
        Some(old) => replace(text, old, value),
        None => Ok(insert(text, node, table, (key, &value.text()), order)),
    }
}

/// The text with another value for a node. A single number stays single if all new values are equal, and numbers that
/// do not change stay as they are written.
pub fn replace(text: &str, old: &Node, value: &Value) -> Result<String, String> {
    let mut parts: Vec<(Range<usize>, String)> = Vec::new();
    match (old.get_ref(), value) {
        (_, Value::Toml(new)) => parts.push((old.span(), new.clone())),
        (Content::Array(items), Value::Numbers(values) | Value::Color(values))
            if items.len() == values.len() =>
        {
            for (item, value) in items.iter().zip(values) {
                let before = number(item).ok_or("it is not written as numbers")?;
                if shown(before) != shown(*value) {
                    parts.push((item.span(), shown(*value)));
                }
            }
        }
        (
            Content::Integer(_) | Content::Float(_),
            Value::Numbers(values) | Value::Color(values),
        ) => {
            let alike = values
                .windows(2)
                .all(|pair| shown(pair[0]) == shown(pair[1]));
            let new = list(if alike { &values[..1] } else { values });
            let is_same = number(old).is_some_and(|old| list(&[old]) == new);
            parts.extend((!is_same).then(|| (old.span(), new)));
        }
        (Content::String(_), Value::Color(values)) => {
            let new = hex(values).map_or_else(|| list(values), |hex| format!("\"{hex}\""));
            parts.push((old.span(), new));
        }
        (_, Value::Numbers(values) | Value::Color(values)) => {
            parts.push((old.span(), list(values)));
        }
    }
    let mut out = text.to_owned();
    for (at, new) in parts.into_iter().rev() {
        out.replace_range(at, &new);
    }
    Ok(out)
}

#[cfg(test)]
#[path = "splice_tests.rs"]
mod tests;
