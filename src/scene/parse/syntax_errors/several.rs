//! Numbers of a value in forms that TOML has not: `640;360`, `0 1 5`, `vec3(0, 1, 5)`, `1,000`, `0,5`.

use std::sync::LazyLock;

use regex::Regex;

use super::{
    Mistake, Words,
    value_types::{ValueTypes, types_of},
    words,
};
use crate::{forms, suggest, syntax::parse_value};

/// A key and its numbers: in brackets of any kind, or bare up to the end of the line, of the table or list, or the next key.
static NUMBERS: LazyLock<Regex> = LazyLock::new(|| {
    let next = r"(?:(?:\s*[,;]\s*|\s*[x×*]\s*|\s+)<n>)";
    let all = format!(r"\s*<n>{next}*\s*");
    forms::pattern(&format!(
        r"(?<key>[^\s=,{{}}\[\]()]+)\s*=\s*(?:(?<closed><k>*\s*\({all}\)|<{all}>|\[{all}\]|\{{{all}\}})|(?<bare><n>{next}+)\s*(?:[,;]?\s*(?:#.*)?$|[}}\]]|,\s*[^\s=,]+\s*=))"
    ))
});

static THOUSANDS: LazyLock<Regex> =
    LazyLock::new(|| forms::pattern(r"^[1-9][0-9]{0,2}(?:[ ,][0-9]{3})+(?:\.[0-9]+)?$"));

/// Numbers of a key in a line.
struct Numbers<'t> {
    key: &'t str,
    /// Bracket around the numbers.
    open: Option<char>,
    /// The numbers without brackets.
    text: &'t str,
    /// The numbers as TOML writes them.
    parts: Vec<String>,
}

/// Explains the numbers of a value.
pub fn several(m: &Mistake) -> Option<Words> {
    let place = m.line.len().checked_sub(m.rest.len())?;
    let (all, key, value) = NUMBERS.captures_iter(m.line).find_map(|found| {
        let value = found.name("closed").or(found.name("bare"))?;
        let is_it = (value.start()..=found.get(0)?.end()).contains(&place);
        let is_wrong = parse_value(value.as_str()).is_err();
        (is_it && is_wrong).then(|| (value.range(), found.name("key"), value.as_str()))
    })?;
    let at = value.find(['(', '<', '[', '{']);
    let inner = at.map_or(value, |at| &value[at + 1..value.len() - 1]);
    let numbers = Numbers {
        key: key?.as_str().rsplit('.').next()?,
        open: at.and_then(|at| value[at..].chars().next()),
        text: inner.trim(),
        parts: parts(inner),
    };
    // A `value` of a track has the type of the key that moves.
    let name = match numbers.key {
        "value" => m.key.rsplit('.').next()?,
        key => key,
    };
    let none = ValueTypes::default();
    let types = types_of(m.is_project, m.table, name).unwrap_or(&none);
    let takes_list = !types.lists.is_empty();
    if numbers.text.contains('*') && (types.number || !takes_list) {
        return None; // a product
    }
    let explained = match (types.number, takes_list, numbers.open) {
        (true, false, open) if open != Some('[') => numbers.as_one(types),
        (number, _, None) if number == takes_list => {
            numbers.as_either().or_else(|| numbers.as_list(types))
        }
        _ => numbers.as_list(types),
    };
    explained.map(|words| Words {
        at: Some(all),
        ..words
    })
}

/// Numbers that any signs divide, as TOML writes them; commas are decimal where other signs divide the numbers.
fn parts(text: &str) -> Vec<String> {
    let has_point = |part: &&str| {
        part.split_once(',')
            .is_none_or(|(a, b)| !a.is_empty() && !b.is_empty() && !b.contains(','))
    };
    let spaced = || text.split([' ', '\t', ';']).filter(|part| !part.is_empty());
    let is_decimal =
        text.contains(',') && spaced().count() > 1 && spaced().all(|part| has_point(&part));
    if is_decimal {
        return spaced()
            .map(|part| number(&part.replace(',', ".")))
            .collect();
    }
    let parts = text.split([' ', '\t', ';', ',', 'x', '×', '*']);
    parts.filter(|part| !part.is_empty()).map(number).collect()
}

/// A number as TOML writes it.
fn number(text: &str) -> String {
    match (parse_value(text), text.parse::<f64>()) {
        (Err(_), Ok(number)) => number.to_string(),
        _ => text.to_owned(),
    }
}

impl Numbers<'_> {
    /// Digits before and behind a single comma without blanks.
    fn at_comma(&self) -> Option<(&str, &str)> {
        let (whole, rest) = self.text.split_once(',')?;
        let is_digit = |c: char| c.is_ascii_digit();
        let is_whole = whole.ends_with(is_digit) && rest.chars().all(is_digit);
        is_whole.then_some((whole, rest))
    }

    /// The numbers as a single one.
    fn as_one(&self, types: &ValueTypes) -> Option<Words> {
        let named = suggest::key(self.text);
        let is_decimal = types.fraction && self.at_comma().is_some();
        if THOUSANDS.is_match(self.text) && !is_decimal {
            let digits = self.text.replace([' ', ','], "");
            let message = format!("{named} has commas or spaces, which no number has");
            return words(message, format!("write {digits}"));
        }
        match (self.at_comma(), self.parts.as_slice()) {
            (_, [one]) => words(
                "a number stands without parentheses `( )`",
                format!("write {one}"),
            ),
            (Some((whole, rest)), _) if types.fraction => {
                let number = number(&format!("{whole}.{rest}"));
                (self.as_thousands()).or_else(|| words(DECIMAL, format!("write {number}")))
            }
            (_, parts) => {
                let key = suggest::key(self.key);
                let message = format!("{key} takes one number, not several");
                let help = format!("write a single one, as in `{} = {}`", self.key, parts[0]);
                words(message, help)
            }
        }
    }

    /// The numbers where one number and a list are right, or the key is unknown.
    fn as_either(&self) -> Option<Words> {
        let (whole, rest) = self.at_comma()?;
        let (point, list) = (number(&format!("{whole}.{rest}")), self.parts.join(", "));
        let help = format!("write {point}, or as a list [{list}]");
        self.as_thousands().or_else(|| words(DECIMAL, help))
    }

    /// A number that may have a decimal comma, or a comma between thousands.
    fn as_thousands(&self) -> Option<Words> {
        let (whole, rest) = self.at_comma()?;
        let may_be = rest.len() == 3 && whole.trim_start_matches(['+', '-']) != "0";
        let [point, joined] = [".", ""].map(|sign| number(&[whole, sign, rest].concat()));
        let message = format!("`{whole},{rest}` is no number: commas stand between numbers");
        let help = format!("write {joined}, or {point} with a decimal point");
        may_be.then(|| words(message, help))?
    }

    /// The numbers as a list.
    fn as_list(&self, types: &ValueTypes) -> Option<Words> {
        let is_alone = |part: &str| !part.trim().contains([' ', '\t']);
        let message = match self.open {
            Some('(') => "a list stands in square brackets `[ ]`, not in parentheses `( )`".into(),
            Some('<') => "a list stands in square brackets `[ ]`, not in `< >`".into(),
            Some('{') => "a list stands in square brackets `[ ]`, not in braces `{ }`".into(),
            Some(_) if self.text.contains(';') => {
                "commas stand between the numbers of a list, not `;`".into()
            }
            Some(_) if self.text.split(',').all(is_alone) => return None, // a number is wrong
            Some(_) => {
                let [one, next] = [self.parts.first()?, self.parts.get(1)?];
                format!("a comma is missing between `{one}` and `{next}`")
            }
            None if self.text.contains(',') => "a list stands in square brackets `[ ]`".into(),
            None => "a list stands in square brackets `[ ]`, with commas".into(),
        };
        let count = self.parts.len() as u64;
        let is_long_enough = types.lists.iter().any(|lengths| lengths.contains(&count));
        let mut list = self.parts.clone();
        let help = match types.lists.first() {
            Some(lengths) if !is_long_enough => {
                let length = count.clamp(*lengths.start(), *lengths.end());
                list.resize(length as usize, "0".to_owned());
                let list = list.join(", ");
                format!("write a list of {length} numbers, such as [{list}]")
            }
            _ => format!("write [{}]", suggest::clip(&list.join(", "))),
        };
        words(message, help)
    }
}

const DECIMAL: &str = "numbers have a decimal point `.`, not a comma `,`";
