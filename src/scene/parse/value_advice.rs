//! Advice for values of a wrong type, length or range: the text to write instead.

use crate::{
    range::Range,
    syntax::{Content, Node},
};

/// A number as it is written; empty for anything else.
fn number_text(node: &Node) -> String {
    match node.get_ref() {
        Content::Integer(i) => i.to_string(),
        Content::Float(f) => f.to_string(),
        _ => String::new(),
    }
}

/// Advice for a value that is right except for the quotes around it.
pub fn unquoted(node: &Node, is_right: impl Fn(&str) -> bool) -> Option<String> {
    let value = node.get_ref().as_str()?.trim();
    is_right(value).then(|| format!("write {value}, without quotes"))
}

/// Advice for numbers in a text where a list of `count` is expected: `size = "1280x720"`.
pub fn list_in_text(node: &Node, count: usize) -> Option<String> {
    let text = node.get_ref().as_str()?;
    let parts = text.split(['x', '×', ',', ' ', '[', ']', '(', ')']);
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    let are_numbers = parts.iter().all(|part| part.parse::<f64>().is_ok());
    (parts.len() == count && are_numbers).then(|| format!("write [{}]", parts.join(", ")))
}

/// Advice for a single number where a list of `count` is expected: about Y for a rotation or its rate, else in all places.
pub fn list_of_number(node: &Node, key: &str, count: usize) -> Option<String> {
    let (Content::Integer(_) | Content::Float(_)) = node.get_ref() else {
        return None;
    };
    // An element of a list is one of several points, which have no place for all.
    if key.contains('[') {
        return None;
    }
    let number = number_text(node);
    Some(match (key, count) {
        ("rate" | "rotation_deg", 3) => {
            format!("write [0, {number}, 0] for a turn about Y, which points up")
        }
        _ => format!("write [{}]", vec![number; count].join(", ")),
    })
}

/// Advice for a list of numbers that is one too short, for a point or a color, or too long.
pub fn list_of_length(items: &[Node], count: usize) -> Option<String> {
    let is_number = |item: &Node| matches!(item.get_ref(), Content::Integer(_) | Content::Float(_));
    let is_near = items.len() + 1 == count || (count + 1..count + 3).contains(&items.len());
    if !(is_near && count <= 4 && items.iter().all(is_number)) {
        return None;
    }
    let mut list: Vec<_> = items.iter().map(number_text).take(count).collect();
    match (items.len() < count, count) {
        (true, 3) => {
            list.push("0".to_owned());
            Some(format!(
                "write three numbers, such as [{}]",
                list.join(", ")
            ))
        }
        (true, _) => None,
        (false, _) => Some(format!("write [{}]", list.join(", "))),
    }
}

/// Advice for an angle that is probably in radians.
pub fn in_degrees(x: f64, key: &str, range: &Range) -> Option<String> {
    let degrees = (x.to_degrees() * 1e3).round() / 1e3;
    let may_be = key.ends_with("_deg") && x.fract() != 0.0 && range.check(degrees).is_ok();
    may_be.then(|| format!("angles are in degrees: {x} radians are {degrees}"))
}
