//! Reads one value: checks its type and range, and reports what it should have been. The same
//! implementations describe the value in the JSON Schema and in the manual.

use glam::Vec3;
use serde_json::{Value as Json, json};

use super::{
    located::At,
    report::Report,
    value_advice::{
        frames_of_time, in_range, list_instead, list_of_length, list_of_scale, number_instead,
        text_instead, truth, unquoted,
    },
};
use crate::declared::Word;
use crate::syntax::{Content, Node};
use crate::{
    diagnostic::Diagnostic,
    range::{ANY, Range},
    suggest,
};

/// Name of a value in messages, such as `fov_deg` or `eye[1]`, and its range.
pub struct Named<'a> {
    /// Name of the key.
    pub key: &'a str,
    /// Range of its numbers.
    pub range: &'a Range,
}

/// A type that a value right of `=` can have.
pub trait Value: Sized {
    /// Whether it consists of numbers, to which a range applies.
    const RANGED: bool = false;
    /// Words of which it is one; none for other types.
    const WORDS: &'static [Word] = &[];
    /// The expected value in words, such as `three numbers`.
    fn expected() -> String;
    /// The expected array of such values in words, such as `two numbers`.
    fn several(count: &str) -> String {
        let one = Self::expected();
        let kind = one.strip_prefix("a ").unwrap_or(&one);
        format!("{count} {kind}s")
    }
    /// The only allowed value, if there is just one.
    fn example() -> Option<String> {
        None
    }
    /// JSON Schema of the value.
    fn schema(range: &Range) -> Json;
    /// The value as in scene text, for defaults.
    fn to_json(&self) -> Json;
    /// Reads the value, or reports what is wrong with it.
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self>;
}

/// Description of a node with an article, for messages that end in `not …`.
pub fn found(node: &Node) -> String {
    match node.get_ref() {
        Content::String(s) => format!("the text {}", suggest::text(s)),
        Content::Integer(i) => format!("the number {i}"),
        Content::Float(f) => format!("the number {f}"),
        Content::Boolean(b) => format!("{b}"),
        Content::Datetime => "a date".into(),
        Content::Array(items) => match items.len() {
            1 => "an array of 1 value".into(),
            n => format!("an array of {n} values"),
        },
        Content::Table(_) => "a table".into(),
    }
}

/// A number as it is written.
fn digits(node: &Node) -> String {
    found(node).replace("the number ", "")
}

/// Reports a value of another type.
pub fn wrong_type<'r>(
    node: &Node,
    key: &str,
    expected: &str,
    report: &'r mut Report,
) -> &'r mut Diagnostic {
    let message = format!("`{key}` must be {expected}, not {}", found(node));
    report.error("wrong-type", &node.span(), message)
}

/// Number from an integer or a float; `None` and a message for anything else.
fn number(node: &Node, named: &Named, expected: &str, report: &mut Report) -> Option<f64> {
    let x = match node.get_ref() {
        // An integer past 128 bits is larger than any range allows.
        Content::Integer(i) => i.value().map_or(f64::MAX, |x| x as f64),
        Content::Float(x) => x.value().unwrap_or(f64::MAX),
        _ => {
            let quoted = unquoted(node, |text| {
                // Rust reads `.5` and `5.`, TOML does not.
                let is_toml = text.starts_with(|c: char| "+-".contains(c) || c.is_ascii_digit())
                    && text.ends_with(|c: char| c.is_ascii_digit());
                let x = text.parse().ok().filter(|x: &f64| x.is_finite());
                is_toml && x.is_some_and(|x| named.range.check(x).is_ok())
            });
            let frames = || frames_of_time(node, named.key);
            wrong_type(node, named.key, expected, report).help =
                (quoted.or_else(frames)).or_else(|| number_instead(node, named.key, named.range));
            return None;
        }
    };
    let (key, at) = (named.key, node.span());
    if !x.is_finite() {
        let message = format!("`{key}` must be a finite number, not {}", digits(node));
        report.error("not-finite", &at, message);
        return None;
    }
    if let Err(words) = named.range.check(x) {
        let message = format!("`{key}` must be {words}, not {}", digits(node));
        report.error("out-of-range", &at, message).help = in_range(x, key, named.range);
        return None;
    }
    Some(x)
}

impl Value for f32 {
    const RANGED: bool = true;

    fn expected() -> String {
        "a number".into()
    }
    fn schema(range: &Range) -> Json {
        range.schema("number")
    }
    fn to_json(&self) -> Json {
        // Through text, so that 0.1 stays 0.1.
        let shortest: f64 = self.to_string().parse().unwrap_or(f64::from(*self));
        if shortest.fract() == 0.0 {
            json!(shortest as i64)
        } else {
            json!(shortest)
        }
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        number(node, named, &Self::expected(), report).map(|x| x as f32)
    }
}

impl Value for u32 {
    const RANGED: bool = true;

    fn expected() -> String {
        "a whole number".into()
    }
    fn schema(range: &Range) -> Json {
        range.schema("integer")
    }
    fn to_json(&self) -> Json {
        json!(self)
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let x = number(node, named, &Self::expected(), report)?;
        if x.fract() != 0.0 {
            let help = format!("write {}", x.round());
            wrong_type(node, named.key, &Self::expected(), report).help = Some(help);
            return None;
        }
        Some(x as u32)
    }
}

impl Value for bool {
    fn expected() -> String {
        "true or false".into()
    }
    fn schema(_: &Range) -> Json {
        json!({ "type": "boolean" })
    }
    fn to_json(&self) -> Json {
        json!(self)
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let value = node.get_ref().as_bool();
        if value.is_none() {
            let quoted = unquoted(node, |text| matches!(text, "true" | "false"));
            wrong_type(node, named.key, &Self::expected(), report).help =
                quoted.or_else(|| truth(node));
        }
        value
    }
}

impl Value for String {
    fn expected() -> String {
        "text in quotes".into()
    }
    fn schema(_: &Range) -> Json {
        json!({ "type": "string", "minLength": 1 })
    }
    fn to_json(&self) -> Json {
        json!(self)
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        match node.get_ref().as_str() {
            Some("") => {
                let message = format!("`{}` must not be empty", named.key);
                report.error("empty-text", &node.span(), message).help = Some(format!(
                    "write `{} = \"NAME\"`, or remove the key",
                    named.key
                ));
                None
            }
            Some(text) => Some(text.to_owned()),
            None => {
                wrong_type(node, named.key, &Self::expected(), report).help = text_instead(node);
                None
            }
        }
    }
}

impl Value for At<String> {
    fn expected() -> String {
        String::expected()
    }
    fn schema(range: &Range) -> Json {
        String::schema(range)
    }
    fn to_json(&self) -> Json {
        self.value.to_json()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let value = String::read(node, named, report)?;
        Some(Self {
            value,
            at: report.span(&node.span()),
        })
    }
}

/// One name, or an array of them.
pub struct Names(pub Vec<At<String>>);

impl Value for Names {
    fn expected() -> String {
        "text in quotes, or an array of them".into()
    }
    fn schema(range: &Range) -> Json {
        let one = String::schema(range);
        json!({ "anyOf": [one, { "type": "array", "items": one }] })
    }
    fn to_json(&self) -> Json {
        self.0.iter().map(At::to_json).collect()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        match node.get_ref() {
            Content::Array(items) => {
                // Every element is read, so that every wrong one is reported.
                let names = items.iter().map(|item| At::read(item, named, report));
                let names: Vec<Option<_>> = names.collect();
                names.into_iter().collect::<Option<_>>().map(Self)
            }
            Content::String(_) => At::read(node, named, report).map(|name| Self(vec![name])),
            _ => {
                let help = format!("write `{} = [\"…\"]`", named.key);
                wrong_type(node, named.key, &Self::expected(), report).help =
                    text_instead(node).or(Some(help));
                None
            }
        }
    }
}

impl<T: Value, const N: usize> Value for [T; N] {
    const RANGED: bool = T::RANGED;

    fn expected() -> String {
        const WORDS: [&str; 5] = ["no", "one", "two", "three", "four"];
        T::several(&WORDS.get(N).map_or(N.to_string(), |w| (*w).into()))
    }
    fn several(count: &str) -> String {
        let one = Self::expected();
        match one.split_once(' ') {
            Some((number, rest)) => format!("{count} arrays of {number} {rest}"),
            None => format!("{count} arrays"),
        }
    }
    fn schema(range: &Range) -> Json {
        json!({ "type": "array", "items": T::schema(range), "minItems": N, "maxItems": N })
    }
    fn to_json(&self) -> Json {
        self.iter().map(T::to_json).collect()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let (key, expected) = (named.key, Self::expected());
        let Some(items) = node.get_ref().as_array() else {
            let help = list_instead(node, key, N);
            wrong_type(node, key, &expected, report).help = help;
            return None;
        };
        if items.len() != N {
            let message = format!("`{key}` must be {expected}, not {}", found(node));
            let error = report.error("wrong-length", &node.span(), message);
            error.help = list_of_length(items, key, N, named.range);
            return None;
        }
        let read = |(i, item)| {
            let key = format!("{key}[{i}]");
            T::read(
                item,
                &Named {
                    key: &key,
                    range: named.range,
                },
                report,
            )
        };
        // Every element is read, so that every wrong one is reported.
        let values: Vec<Option<T>> = items.iter().enumerate().map(read).collect();
        values
            .into_iter()
            .collect::<Option<Vec<T>>>()?
            .try_into()
            .ok()
    }
}

impl Value for Vec3 {
    const RANGED: bool = true;

    fn expected() -> String {
        <[f32; 3]>::expected()
    }
    fn schema(range: &Range) -> Json {
        <[f32; 3]>::schema(range)
    }
    fn to_json(&self) -> Json {
        self.to_array().to_json()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        <[f32; 3]>::read(node, named, report).map(Self::from)
    }
}

/// The version of the scene text; there is only one so far.
pub struct Version;

impl Version {
    /// The version that this program reads.
    pub const CURRENT: u32 = 1;
}

impl Value for Version {
    fn expected() -> String {
        Self::CURRENT.to_string()
    }
    fn example() -> Option<String> {
        Some(Self::expected())
    }
    fn schema(_: &Range) -> Json {
        json!({ "const": Self::CURRENT })
    }
    fn to_json(&self) -> Json {
        json!(Self::CURRENT)
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        let any = Named {
            key: named.key,
            range: &ANY,
        };
        let current = Self::CURRENT;
        let help = || format!("write `version = {current}`");
        let Some(version) = number(node, &any, &Self::expected(), report) else {
            report.advise(help());
            return None;
        };
        let written = digits(node);
        if version == f64::from(current) {
            return Some(Self);
        }
        let message = format!("version {written} is not supported; this program reads {current}");
        let error = report.error("unsupported-version", &node.span(), message);
        error.help = Some(help());
        None
    }
}

/// One number for all three axes, or three.
pub struct Scale(pub Vec3);

impl Value for Scale {
    const RANGED: bool = true;

    fn expected() -> String {
        "one or three numbers".into()
    }
    fn schema(range: &Range) -> Json {
        json!({ "anyOf": [f32::schema(range), Vec3::schema(range)] })
    }
    fn to_json(&self) -> Json {
        self.0.to_json()
    }
    fn read(node: &Node, named: &Named, report: &mut Report) -> Option<Self> {
        match node.get_ref() {
            Content::Array(items) if items.len() == 3 => Vec3::read(node, named, report).map(Self),
            Content::Array(items) => {
                wrong_type(node, named.key, &Self::expected(), report).help = list_of_scale(items);
                None
            }
            _ => {
                number(node, named, &Self::expected(), report).map(|x| Self(Vec3::splat(x as f32)))
            }
        }
    }
}
