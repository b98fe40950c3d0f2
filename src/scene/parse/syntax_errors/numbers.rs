//! Numbers that TOML cannot read, with the number to write instead.

use super::{Mistake, Words, is_number, words};
use crate::{
    desc::{CAMERA, LIGHT},
    number as fields,
    range::Range,
    suggest,
    table::value_advice::{rounded, without_unit},
};

/// Explains a number that TOML cannot read: `1.6*2`, `60deg`, `.5`.
pub fn number(m: &Mistake) -> Option<Words> {
    let (element, key) = element(m);
    element
        .starts_with(|c: char| c.is_ascii_digit() || "+-.(".contains(c))
        .then_some(())?;
    if let Some(result) = computed(element) {
        let message = format!("TOML does not compute {}", suggest::key(element));
        return words(message, result);
    }
    let digits = element.trim_end_matches(|c: char| c.is_alphabetic() || "%°²".contains(c));
    if digits.len() < element.len() && is_number(digits.trim()) {
        let unit = &element[digits.len()..];
        let message = format!("a number has no unit, here {}", suggest::key(unit));
        return words(message, without_unit(digits.trim(), unit, key));
    }
    let value: f64 = element
        .parse()
        .ok()
        .filter(|x: &f64| x.is_finite() && x.to_string() != element)?;
    let message = format!(
        "{} is no number of TOML, which needs digits on both sides of the decimal point, and no leading zeros",
        suggest::key(element)
    );
    words(message, format!("write {value}"))
}

/// The element of a list that the parser points at, else the whole value; and its key.
fn element<'t>(m: &Mistake<'t>) -> (&'t str, &'t str) {
    let offset = m.line.len() - m.rest.len().min(m.line.len());
    let ends = |c: char| ",[]{}=#".contains(c);
    let start = m.line[..offset].rfind(ends).map_or(0, |i| i + 1);
    let end = m.line[offset..]
        .find(ends)
        .map_or(m.line.len(), |i| offset + i);
    let before = m.line[..start].rsplit_once('=');
    let key = before.map_or("", |(key, _)| key.trim_end());
    let key = key.rsplit(|c: char| !c.is_alphanumeric() && c != '_');
    (
        m.line[start..end].trim(),
        key.into_iter().next().unwrap_or_default(),
    )
}

/// Explains a constant by name, alone or times or over a number: `fov_deg = PI / 4`, `rotation_deg = [0, PI, 0]`.
pub fn constant(m: &Mistake) -> Option<Words> {
    let (text, key) = element(m);
    let (sign, rest) = match text.strip_prefix('-') {
        Some(rest) => (-1.0, rest.trim_start()),
        None => (1.0, text),
    };
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|x| x.is_finite());
    let turns = match (rest.split_once('/'), rest.split_once('*')) {
        (Some((a, b)), None) => turns_of(a)? / number(b).filter(|x| *x != 0.0)?,
        (None, Some((a, b))) => match number(a) {
            Some(factor) => factor * turns_of(b)?,
            None => turns_of(a)? * number(b)?,
        },
        (None, None) => turns_of(rest)?,
        _ => return None,
    };
    let message = format!("TOML has no constant {}", suggest::key(text));
    let degrees = rounded(360.0 * sign * turns);
    let too_far = range_of(key).and_then(|range| range.check(degrees).err());
    let help = match (key.ends_with("_deg"), too_far) {
        (true, Some(wanted)) => format!("it is {degrees} in degrees, and `{key}` must be {wanted}"),
        (true, None) => format!("write {degrees}, in degrees"),
        (false, _) => format!("write {}", rounded(std::f64::consts::TAU * sign * turns)),
    };
    words(message, help)
}

/// Range of a number of cameras or lights.
fn range_of(key: &str) -> Option<&'static Range> {
    let camera = fields::find(&CAMERA, key);
    let field = camera.map(|field| &field.range);
    field.or(fields::find(&LIGHT, key).map(|field| &field.range))
}

/// Turns of a constant of angles.
fn turns_of(name: &str) -> Option<f64> {
    match name.trim().to_lowercase().as_str() {
        "pi" | "π" | "math.pi" => Some(0.5),
        "tau" | "τ" | "math.tau" => Some(1.0),
        _ => None,
    }
}

/// Advice for an arithmetic expression; with its result, if it is two numbers and an operator.
fn computed(element: &str) -> Option<String> {
    let allowed = |c: char| c.is_ascii_digit() || ".+-*/^() ".contains(c);
    let operator = element[1..]
        .find(['*', '/', '+', '-', '^'])
        .map(|i| i + 1)?;
    element.chars().all(allowed).then_some(())?;
    let (a, b) = (element[..operator].trim(), element[operator + 1..].trim());
    let result = match (
        a.parse::<f64>(),
        b.parse::<f64>(),
        element.as_bytes()[operator],
    ) {
        (Ok(a), Ok(b), b'*') => a * b,
        (Ok(a), Ok(b), b'/') => a / b,
        (Ok(a), Ok(b), b'+') => a + b,
        (Ok(a), Ok(b), b'-') => a - b,
        _ => return Some("write the result; scripts can compute".to_owned()),
    };
    // Rounded, so that 1.1 * 3 is 3.3.
    let result = (result * 1e9).round() / 1e9;
    result
        .is_finite()
        .then(|| format!("write {result}; scripts can compute"))
}
