//! Advice for values of a wrong type, length or range: the text to write instead.

use crate::{
    forms,
    range::{LIMIT, Range, UNIT},
    suggest::{self, other_values},
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
fn list_in_text(text: &str, count: usize) -> Option<String> {
    let lower = text.to_lowercase();
    let known = other_values().sizes.get(&lower).filter(|_| count == 2);
    if let Some(size) = known {
        return Some(format!("write [{size}]"));
    }
    let parts = text.split(['x', '×', ',', ' ', '[', ']', '(', ')']);
    let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
    let are_numbers = parts.iter().all(|part| part.parse::<f64>().is_ok());
    (parts.len() == count && are_numbers).then(|| format!("write [{}]", parts.join(", ")))
}

/// Keys of points, ways and counts, of which one number in all places is hardly meant.
const ALONG_X: &str = "count step translation position eye target offset";

/// Advice for a single number where a list of `count` is expected: about Y for a rotation or a rate, along X for a
/// way, else in all places.
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
        ("rotation_deg", 3) => {
            format!("write [0, {number}, 0] for a turn about Y, which points up")
        }
        ("amplitude", 3) => format!("write [0, {number}, 0] for a swing along Y, which points up"),
        ("rate" | "value", 3) => {
            format!(
                "write [0, {number}, 0] for Y, which points up: a turn about it, or a way along it"
            )
        }
        _ if count == 3 && ALONG_X.split(' ').any(|k| k == key) => {
            let rest = u8::from(key == "count");
            format!("write [{number}, {rest}, {rest}] for X alone")
        }
        ("size", 2) if number.parse().is_ok_and(|width: u32| width >= 64) => {
            let width: u32 = number.parse().unwrap_or_default();
            format!("write [{width}, {}], width and height", width / 16 * 9)
        }
        _ => format!("write [{}]", vec![number; count].join(", ")),
    })
}

fn is_number(item: &Node) -> bool {
    matches!(item.get_ref(), Content::Integer(_) | Content::Float(_))
}

/// Advice for a list of numbers in place of a list of such lists.
pub fn in_a_list(node: &Node, key: &str) -> Option<String> {
    let items = node.get_ref().as_array()?;
    let numbers: Vec<_> = items.iter().map(number_text).collect();
    (!items.is_empty() && items.iter().all(is_number))
        .then(|| format!("write `{key} = [[{}]]`, a list of one", numbers.join(", ")))
}

/// Advice for a list of numbers that is one too short, for a point or a color, or too long.
pub fn list_of_length(items: &[Node], key: &str, count: usize, range: &Range) -> Option<String> {
    if let ([only], 2) = (items, count) {
        return list_of_number(only, key, count);
    }
    let is_near = items.len() + 1 == count || (count + 1..count + 3).contains(&items.len());
    if !(is_near && count <= 4 && items.iter().all(is_number)) {
        return None;
    }
    let mut list: Vec<_> = items.iter().map(number_text).collect();
    if key == "size" && count == 2 && list.iter().filter(|text| *text != "0").count() == 2 {
        list.retain(|text| text != "0"); // the height of a flat thing
    }
    list.truncate(count);
    match (items.len() < count, count) {
        (true, 4) if key.contains("rotation") => Some(format!(
            "four numbers are a quaternion, `[0, 0, 0, 1]` for no turn; degrees about X, Y and Z are `rotation_deg = [{}]`",
            list.join(", ")
        )),
        (true, 3) => {
            list.push(if range.contains(0.0) { "0" } else { "1" }.to_owned());
            Some(format!(
                "write three numbers, such as [{}]",
                list.join(", ")
            ))
        }
        (true, _) => None,
        (false, 3) if key == "rotation_deg" => Some(
            "degrees about X, Y and Z are three numbers, as in [0, 45, 0]; a quaternion is `rotation_quat`"
                .to_owned(),
        ),
        (false, _) => {
            let are_whole = items.iter().all(|x| matches!(x.get_ref(), Content::Integer(_)));
            let comma = if are_whole { "; decimals have a point, 0.5" } else { "" };
            Some(format!("write [{}]{comma}", list.join(", ")))
        }
    }
}

/// Advice for a value that is no list where a list of `count` is expected.
pub fn list_instead(node: &Node, key: &str, count: usize) -> Option<String> {
    let lanes = || {
        let table = node.get_ref().as_table()?;
        let names = match table.contains_key("r") {
            true => ["r", "g", "b"],
            false => ["x", "y", "z"],
        };
        let names = &names[..count.min(3)];
        let lanes = names
            .iter()
            .map(|lane| table.get(*lane).map_or("0".to_owned(), number_text));
        let lanes: Vec<_> = lanes.collect();
        let is_whole = lanes.len() == count && lanes.iter().all(|lane| !lane.is_empty());
        let has_lanes = names.iter().any(|lane| table.contains_key(*lane));
        let bytes: Vec<_> = lanes
            .iter()
            .filter_map(|lane| lane.parse::<u8>().ok())
            .collect();
        if let (["r", ..], [r, g, b]) = (names, &bytes[..])
            && r.max(g).max(b) > &15
        {
            return Some(format!("write \"#{r:02x}{g:02x}{b:02x}\""));
        }
        (is_whole && has_lanes).then(|| format!("write [{}]", lanes.join(", ")))
    };
    (node.get_ref().as_str())
        .and_then(|text| list_in_text(text, count))
        .or_else(lanes)
        .or_else(|| list_of_number(node, key, count))
}

/// Advice for a truth value or a text where a number in this range is expected.
pub fn number_instead(node: &Node, key: &str, range: &Range) -> Option<String> {
    let of_list = || number_of_list(node.get_ref().as_array()?);
    (number_of_truth(node, range).or_else(|| number_for_text(node, key, range))).or_else(of_list)
}

/// Advice for a list of numbers where one is expected: the first number but 0.
fn number_of_list(items: &[Node]) -> Option<String> {
    let numbers: Vec<_> = items.iter().map(number_text).collect();
    let mut turned = numbers.iter().filter(|text| *text != "0");
    let number = turned.next().or(numbers.first())?;
    let is_sure = turned.all(|other| other == number);
    let one = if is_sure { "" } else { "one number, such as " };
    (!number.is_empty()).then(|| format!("write {one}{number}, without brackets"))
}

/// Advice for a truth value where a number in this range is expected.
fn number_of_truth(node: &Node, range: &Range) -> Option<String> {
    let Content::Boolean(is_true) = node.get_ref() else {
        return None;
    };
    let number = u8::from(*is_true);
    range
        .contains(f64::from(number))
        .then(|| format!("write {number}, or a number between"))
}

/// Advice for a text where a number in this range is expected: without its unit, if it is a number with one.
fn number_for_text(node: &Node, key: &str, range: &Range) -> Option<String> {
    let text = node.get_ref().as_str()?.trim();
    if let Some((_, help)) = forms::explained("number", &format!("{key} = {text}")) {
        return Some(help);
    }
    let digits = text.trim_end_matches(|c: char| c.is_alphabetic() || "%° ".contains(c));
    if digits.len() < text.len() && digits.parse::<f64>().is_ok() {
        return Some(without_unit(digits, text[digits.len()..].trim(), key));
    }
    suggest::examples(key)
        .is_empty()
        .then(|| format!("write a number, such as {}", range.clamp(1.0)))
}

/// Advice for a time where the number of a frame is expected, as by the keys of the timeline.
pub fn frames_of_time(node: &Node, key: &str) -> Option<String> {
    let text = node.get_ref().as_str()?.trim();
    let seconds: f64 = text.strip_suffix('s')?.trim().parse().ok()?;
    let is_time = (0.0..1e6).contains(&seconds);
    let frame = (seconds * 24.0).round();
    match key {
        "end" if is_time && frame >= 1.0 => Some(format!(
            "it is the last frame, {text} times `fps` less 1: write {} at `fps = 24`",
            frame - 1.0
        )),
        "start" | "frame" if is_time => Some(format!(
            "it is a frame, {text} times `fps`: write {frame} at `fps = 24`"
        )),
        _ => None,
    }
}

/// Advice for a number with a unit: the number in the unit that scene text has.
pub fn without_unit(number: &str, unit: &str, key: &str) -> String {
    if let Some(key) = other_values().light_keys.get(unit) {
        return format!("write `{key} = {number}`, whose unit it is, or {number} alone");
    }
    let known = other_values().units.get(unit);
    let value = number.parse::<f64>().ok().zip(known);
    let lens = value.filter(|(length_mm, _)| unit == "mm" && (4.0..=2000.0).contains(length_mm));
    if let ("fov_deg", Some((length_mm, _))) = (key, lens) {
        let fov_deg = (20.0 * (12.0 / length_mm).atan().to_degrees()).round() / 10.0;
        return format!(
            "write {fov_deg}, the vertical angle of a lens of {number} mm on full frame"
        );
    }
    // Keys end with the abbreviation of their unit, but for lengths of shapes and places.
    let key = key.split('[').next().unwrap_or(key);
    let ends = |end: &str| key.ends_with(end);
    let is_of_key = match known.map_or("", |(_, unit)| unit) {
        "meters" => ends("_m") || other_values().lengths.iter().any(|length| length == key),
        "degrees" => ends("_deg") || ["rate", "value", "amplitude"].contains(&key),
        "seconds" => ends("_s"),
        _ => true,
    };
    if !is_of_key {
        return format!("`{key}` has another unit than {unit}, or none: write a number alone");
    }
    value.map_or_else(
        || format!("write {number}"),
        |(value, (factor, name))| format!("write {}, in {name}", rounded(value * factor)),
    )
}

/// A number with at most six digits behind the point.
pub fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6
}

/// Advice for another value where a text is expected: a number in quotes, or the only text of a list.
pub fn text_instead(node: &Node) -> Option<String> {
    match node.get_ref() {
        Content::Integer(_) | Content::Float(_) => {
            Some(format!("write \"{}\", in quotes", number_text(node)))
        }
        Content::Array(items) => {
            let text = items.first()?.get_ref().as_str()?;
            Some(format!("write {}, without brackets", suggest::text(text)))
        }
        Content::Boolean(_) => Some("write a name in quotes `\"`, or remove the key".to_owned()),
        _ => None,
    }
}

/// Advice for a text or a number that means true or false.
pub fn truth(node: &Node) -> Option<String> {
    let word = match node.get_ref() {
        Content::String(text) => text.to_lowercase(),
        _ => number_text(node),
    };
    let meant = match word.as_str() {
        "yes" | "on" | "1" | "true" => true,
        "no" | "off" | "0" | "false" => false,
        _ => return None,
    };
    Some(format!("write {meant}, without quotes"))
}

/// Advice for a number out of its range: degrees in place of radians, a share in place of a percentage, else the end
/// that is near.
pub fn in_range(x: f64, key: &str, range: &Range) -> Option<String> {
    if let Some(degrees) = in_degrees(x, key, range) {
        return Some(degrees);
    }
    if key == "shutter" && (10.0..=360.0).contains(&x) {
        return Some(format!(
            "it is a share of the frame's time: a shutter of {x}° is open for {}",
            (x / 360.0 * 1e3).round() / 1e3
        ));
    }
    if key == "outer_deg" && (90.0..180.0).contains(&x) {
        return Some(format!(
            "write {}, half of the angle across the cone",
            x / 2.0
        ));
    }
    if *range == UNIT && x > 100.0 && x <= 255.0 && x.fract() == 0.0 {
        return Some(format!(
            "it is a share: {x} of 255 are {}",
            (x / 2.55).round() / 100.0
        ));
    }
    if *range == UNIT && (10.0..=100.0).contains(&x) {
        return Some(format!("it is a share: {x} % are {}", x / 100.0));
    }
    if range.check(x).is_err() && range.check(-x).is_ok() && x < 0.0 {
        return Some(format!("write {}", -x));
    }
    if let Some(usual) = other_values().usual.get(key) {
        return Some(format!("write {usual}, which is usual"));
    }
    let (end, is_open) = match x <= range.min {
        true => (range.min, range.above_min),
        false => (range.max, range.below_max),
    };
    if is_open && end == 0.0 && range.check(0.01).is_ok() {
        return Some("write a little more, such as 0.01".to_owned());
    }
    (!is_open && end.abs() < LIMIT).then(|| format!("write {end}, the nearest that is allowed"))
}

/// Advice for a list of factors that is too short or too long.
pub fn list_of_scale(items: &[Node]) -> Option<String> {
    let factors: Vec<_> = items.iter().map(number_text).take(3).collect();
    let list = match factors.as_slice() {
        [x] => return Some(format!("write {x}, without brackets")),
        [x, y] => [x, y, x],
        [x, y, z] => [x, y, z],
        _ => return None,
    };
    Some(format!(
        "write three numbers, such as [{}]",
        list.map(String::as_str).join(", ")
    ))
}

/// Advice for an angle that is probably in radians.
fn in_degrees(x: f64, key: &str, range: &Range) -> Option<String> {
    let degrees = (x.to_degrees() * 1e3).round() / 1e3;
    let may_be = key.ends_with("_deg") && x.fract() != 0.0 && range.check(degrees).is_ok();
    may_be.then(|| format!("angles are in degrees: {x} radians are {degrees}"))
}
