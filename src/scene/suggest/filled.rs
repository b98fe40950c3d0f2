//! Advice with values of the text that it is about.

use std::{cell::Cell, sync::LazyLock};

use regex::{Captures, Regex};

/// A place in an advice for a value of the text, with an example for texts without one: `{value/2:0.5}`, `{value*fps-1:47}`,
/// `{height:720}` or `{!value:true}`. `value` is the value of the key that the advice is about, another name is the value of
/// another key; signs are followed from left to right, and `!` is the opposite of a truth value.
static SLOT: LazyLock<Regex> = LazyLock::new(|| {
    let slot = r"\{(!?[a-z0-9_.]+(?:[-*/][a-z0-9_.]+)*):([^{}]+)\}";
    Regex::new(slot).expect("it is right")
});

/// An advice with its places filled by values of the text, or all by their examples, where some of the values are missing, unlike
/// the examples, or where `fits` says of the advised key and its value that they are not allowed.
pub fn filled(
    help: &str,
    key: &str,
    value_of: impl Fn(&str) -> Option<String>,
    fits: impl Fn(&str, &str) -> bool,
) -> String {
    let lacks = Cell::new(false);
    let fill = |slot: &Captures| {
        let (expression, example) = (&slot[1], &slot[2]);
        let value_of = |name: &str| value_of(if name == "value" { key } else { name });
        let value = match expression.strip_prefix('!') {
            Some(name) => value_of(name).and_then(|value| opposite(&value)),
            None if expression.contains(['-', '*', '/']) => computed(expression, value_of),
            None => value_of(expression).map(|value| color_of(value, example)),
        };
        let is_short = |text: &str| text.len() <= 60 && !text.contains(char::is_control);
        let value = value.filter(|value| is_like(value, example) && is_short(value));
        // A missing number beside others is 0 only where the example is.
        lacks.set(lacks.get() || value.is_none() && example != "0");
        value.unwrap_or_else(|| example.to_owned())
    };
    let own = SLOT.replace_all(help, fill).into_owned();
    if !lacks.get() && setting(&own).is_none_or(|(key, value)| fits(key, value)) {
        return own;
    }
    SLOT.replace_all(help, "$2").into_owned()
}

/// Key and value of the first line of scene text in an advice.
pub fn setting(help: &str) -> Option<(&str, &str)> {
    help.split('`').nth(1)?.split_once(" = ")
}

/// A value, or its first three numbers where a color is meant and it is a list of three or four.
fn color_of(value: String, example: &str) -> String {
    let list = value
        .strip_prefix('[')
        .and_then(|list| list.strip_suffix(']'));
    let parts: Vec<_> = list.map_or_else(Vec::new, |list| list.split(',').map(str::trim).collect());
    match example.starts_with("\"#") && [3, 4].contains(&parts.len()) {
        true => format!("[{}]", parts[..3].join(", ")),
        false => value,
    }
}

/// Whether two values have one form: two numbers, two texts, or lists of one length.
fn is_like(a: &str, b: &str) -> bool {
    let form = |text: &str| {
        let first = text.chars().next().filter(|c| "\"'[{".contains(*c));
        let first = first.map(|c| if c == '\'' { '"' } else { c });
        let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
        let commas = if first == Some('"') {
            0
        } else {
            text.matches(',').count()
        };
        (first, is_number, commas)
    };
    form(a) == form(b) || b.starts_with("\"#") && form(a) == form("[0, 0, 0]")
}

fn opposite(value: &str) -> Option<String> {
    let value: bool = value.parse().ok()?;
    Some((!value).to_string())
}

/// The number that the expression of a place computes; `None` where a value is missing or no number.
fn computed(expression: &str, value_of: impl Fn(&str) -> Option<String>) -> Option<String> {
    let number = |word: &str| {
        let value = value_of(word).unwrap_or_else(|| word.to_owned());
        value.parse::<f64>().ok()
    };
    let (mut rest, mut result, mut sign) = (expression, None, '+');
    while !rest.is_empty() {
        let end = rest.find(['-', '*', '/']).unwrap_or(rest.len());
        let x = number(&rest[..end])?;
        result = Some(match (result, sign) {
            (Some(before), '-') => before - x,
            (Some(before), '*') => before * x,
            (Some(before), '/') => before / x,
            _ => x,
        });
        sign = rest[end..].chars().next().unwrap_or_default();
        rest = rest.get(end + 1..).unwrap_or_default();
    }
    let result = result.filter(|x: &f64| x.is_finite())?;
    Some(((result * 1e4).round() / 1e4 + 0.0).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{parse::recorded_keys, suggest::rows, table::key_recorder::accepts};

    #[test]
    fn values_of_the_text_stand_in_advice_where_they_are_allowed() {
        let value_of = |key: &str| match key {
            "gloss" => Some("1".to_owned()),
            "text" => Some("\"a, b\"".to_owned()),
            "z" => Some("-3".to_owned()),
            "off" => Some("true".to_owned()),
            "fps" => Some("25".to_owned()),
            "rgba" => Some("[1, 0, 0, 0.5]".to_owned()),
            _ => None,
        };
        for (help, key, want) in [
            ("write `a = {1-value:0.3}`", "gloss", "write `a = 0`"),
            ("write `a = {value/4:0.3}`", "gloss", "write `a = 0.25`"),
            ("write `a = {360/value:12}`", "gloss", "write `a = 360`"),
            ("write `a = {!off:true}`", "z", "write `a = false`"),
            ("write `a = {!z:true}`", "z", "write `a = true`"),
            ("write `a = {value*fps-1:47}`", "gloss", "write `a = 24`"),
            ("write `a = {value*lost-1:47}`", "gloss", "write `a = 47`"),
            ("write `a = {value:\"b\"}`", "text", "write `a = \"a, b\"`"),
            ("write `a = {value:0.5}`", "text", "write `a = 0.5`"),
            (
                "write `a = {value:\"#fff\"}`",
                "rgba",
                "write `a = [1, 0, 0]`",
            ),
            ("write `a = [{x:0}, {z:0}]`", "z", "write `a = [0, -3]`"),
            ("write `a = [{x:1}, {z:0}]`", "z", "write `a = [1, 0]`"),
        ] {
            assert_eq!(filled(help, key, value_of, |_, _| true), want);
        }
        let refused = filled("write `a = {value:0.5}`", "z", value_of, |_, _| false);
        assert_eq!(refused, "write `a = 0.5`");
    }

    /// A row is meant for tables that have a key of its list; some table of them must take the example.
    #[test]
    fn tables_take_the_examples_of_advice() {
        for (words, beside, help) in rows() {
            let help = filled(help, "", |_| None, |_, _| true);
            let Some((key, value)) = setting(&help) else {
                continue;
            };
            let tables = recorded_keys().iter().filter(|table| {
                let names = table.variants.iter().map(|variant| variant.word);
                let mut names = names.chain(table.all_keys().map(|key| key.name));
                names.any(|name| beside.split(' ').any(|word| word == name))
            });
            let records = tables.flat_map(|table| table.all_keys());
            let records: Vec<_> = records.filter(|it| it.name == key).collect();
            let all = recorded_keys();
            let is_taken = records.is_empty() || records.iter().any(|it| accepts(it, value, all));
            assert!(is_taken, "{words} beside {beside}: {help}");
        }
    }

    #[test]
    fn values_in_tables_of_advice_have_ranges_too() {
        let all = recorded_keys();
        for (key, right, wrong) in [
            ("repeat", "{ count = [2, 1, 1] }", "{ count = [0, 1, 1] }"),
            ("fog", "{ density = 0.1 }", "{ density = -1 }"),
        ] {
            let records = || all.iter().flat_map(|table| table.all_keys());
            let takes = |value| records().any(|it| it.name == key && accepts(it, value, all));
            assert!(takes(right) && !takes(wrong), "{key}");
        }
    }
}
