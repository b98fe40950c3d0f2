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

/// A number with a single comma, and signs between thousands alone before the comma.
static AT_COMMA: LazyLock<Regex> = LazyLock::new(|| {
    forms::pattern(
        r"^(?<whole>[+-]?(?:[0-9]{1,3}(?:[. ][0-9]{3})+|[0-9][0-9_]*)),(?<rest>[0-9]+(?:[eE][+-]?[0-9]+)?)$",
    )
});

/// Numbers with decimal commas, which other signs divide.
static DECIMALS: LazyLock<Regex> = LazyLock::new(|| {
    let number = r"(?:<n>(?:,[0-9]+)?)";
    forms::pattern(&format!(r"^{number}(?:(?:\s*[;x×*]\s*|\s+){number})+$"))
});

static ELEMENT: LazyLock<Regex> = LazyLock::new(|| forms::pattern("<n>"));
static DECIMAL_ELEMENT: LazyLock<Regex> =
    LazyLock::new(|| forms::pattern("[+-]?[0-9]+,[0-9]+|<n>"));
static TWO_WHOLE: LazyLock<Regex> = LazyLock::new(|| forms::pattern(r"^[0-9]+\s*\*\s*[0-9]+$"));

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
    let key = key?.as_str().rsplit('.').next()?.trim_matches(['"', '\'']);
    // A `value` of a track has the type of the key that moves.
    let name = match key {
        "value" => m.key.rsplit('.').next()?,
        key => key,
    };
    let none = ValueTypes::default();
    let types = types_of(m.is_project, m.table, name).unwrap_or(&none);
    let text = inner.trim();
    let numbers = Numbers {
        key,
        open: at.and_then(|at| value[at..].chars().next()),
        text,
        parts: parts(text, types)?,
    };
    let takes_list = !types.lists.is_empty();
    if text.contains('*') && (types.number || !(TWO_WHOLE.is_match(text) && types.takes(2))) {
        return None; // a product
    }
    let is_one = !takes_list || numbers.open != Some('[') && numbers.parts.len() == 1;
    let explained = match numbers.open {
        _ if types.number && is_one => numbers.as_one(types),
        None if types.number == takes_list => {
            numbers.as_either().or_else(|| numbers.as_list(types))
        }
        _ => numbers.as_list(types),
    };
    explained.map(|words| Words {
        at: Some(all),
        ..words
    })
}

/// Numbers that any signs divide, as TOML writes them; commas are decimal where other signs divide the numbers, and where
/// commas divide twice as many numbers as the key takes.
fn parts(text: &str, types: &ValueTypes) -> Option<Vec<String>> {
    let elements = |of: &Regex| of.find_iter(text).map(|it| it.as_str()).collect();
    let mut parts: Vec<&str> = elements(&ELEMENT);
    let is_paired = text.split(',').all(is_whole)
        && text.matches(", ").count() + 1 < parts.len()
        && !types.takes(parts.len())
        && parts.len().is_multiple_of(2)
        && types.takes(parts.len() / 2);
    let joined: Vec<String>;
    if is_paired {
        joined = parts.chunks(2).map(|pair| pair.join(",")).collect();
        parts = joined.iter().map(String::as_str).collect();
    } else if DECIMALS.is_match(text) {
        parts = elements(&DECIMAL_ELEMENT);
    }
    // Whole numbers have commas between thousands.
    let is_size = !types.lists.is_empty() && !types.fraction;
    let point = |part: &str| match is_size && THOUSANDS.is_match(part) {
        true => part.replace(',', ""),
        false => part.replace(',', "."),
    };
    let numbers = parts.into_iter().map(|part| number(&point(part)));
    numbers.collect()
}

/// Whether a text is a whole number in digits.
fn is_whole(text: &str) -> bool {
    let digits = text.trim().trim_start_matches(['+', '-']);
    !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())
}

/// A number as TOML writes it, unless it is too large.
fn number(text: &str) -> Option<String> {
    if parse_value(text).is_ok() {
        return Some(text.to_owned());
    }
    let number: f64 = text.parse().ok()?;
    number.is_finite().then(|| number.to_string())
}

impl Numbers<'_> {
    /// Digits before and behind a single comma without blanks.
    fn at_comma(&self) -> Option<(String, &str)> {
        let found = AT_COMMA.captures(self.text)?;
        let whole = found.name("whole")?.as_str().replace(['.', ' '], "");
        Some((whole, found.name("rest")?.as_str()))
    }

    /// The digits of a number with commas or spaces between its thousands.
    fn joined(&self) -> Option<String> {
        let is_it = THOUSANDS.is_match(self.text);
        is_it.then(|| self.text.replace([' ', ','], ""))
    }

    /// The numbers as a single one.
    fn as_one(&self, types: &ValueTypes) -> Option<Words> {
        let is_decimal = types.fraction && self.at_comma().is_some();
        if let Some(digits) = self.joined().filter(|_| !is_decimal) {
            let message = format!("{} {THOUSANDS_SIGNS}", suggest::key(self.text));
            return words(message, format!("write {digits}"));
        }
        match (self.at_comma(), self.parts.as_slice()) {
            (_, [one]) => {
                let open = self.open?;
                let message = format!("a number stands without brackets, here `{open}`");
                words(message, format!("write {one}"))
            }
            (Some((whole, rest)), _) if types.fraction => {
                let number = number(&format!("{whole}.{rest}"))?;
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
        let list = self.parts.join(", ");
        let Some((whole, rest)) = self.at_comma() else {
            let message = format!("{} {THOUSANDS_SIGNS}", suggest::key(self.text));
            let digits = self.joined()?;
            return words(message, format!("write {digits}, or [{list}] as a list"));
        };
        let point = number(&format!("{whole}.{rest}"))?;
        let help = format!("write {point}, or as a list [{list}]");
        self.as_thousands().or_else(|| words(DECIMAL, help))
    }

    /// A number that may have a decimal comma, or a comma between thousands.
    fn as_thousands(&self) -> Option<Words> {
        let (whole, rest) = self.at_comma()?;
        let is_grouped = rest.len() == 3 && is_whole(rest) && !self.text.contains(['.', ' ']);
        let may_be = is_grouped && whole.trim_start_matches(['+', '-']) != "0";
        let [point, joined] = [".", ""].map(|sign| number(&[&whole, sign, rest].concat()));
        let (point, joined) = (point?, joined?);
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
        let mut list = self.parts.clone();
        let help = match types.lists.first() {
            // Zeros behind a scale would flatten the thing.
            Some(lengths) if !types.takes(list.len()) && types.number => {
                let (length, one) = (lengths.end(), list.first()?);
                format!(
                    "write one number, as in `{} = {one}`, or a list of {length}",
                    self.key
                )
            }
            Some(lengths) if !types.takes(list.len()) => {
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
const THOUSANDS_SIGNS: &str = "has commas or spaces, which no number has";
