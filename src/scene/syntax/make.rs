//! Entries that the program makes: their ranges are empty, since no text has them.

use super::{Content, Entries, Float, Integer, Key, Node};

/// Entries with these keys and values.
pub fn made<'k>(all: impl IntoIterator<Item = (&'k str, Content)>) -> Entries {
    let entry = |(key, content): (&str, Content)| {
        (Key::new(0..0, key.to_owned()), Node::new(0..0, content))
    };
    all.into_iter().map(entry).collect()
}

impl From<Entries> for Content {
    fn from(entries: Entries) -> Self {
        Self::Table(entries)
    }
}

impl From<&str> for Content {
    fn from(text: &str) -> Self {
        Self::String(text.to_owned())
    }
}

impl From<i64> for Content {
    fn from(value: i64) -> Self {
        Self::Integer(Integer {
            digits: value.to_string().into(),
            radix: 10,
        })
    }
}

/// A whole number becomes an integer, as people write it.
impl From<f64> for Content {
    fn from(value: f64) -> Self {
        match value.to_string() {
            digits if value.fract() == 0.0 => Self::Integer(Integer {
                digits: digits.into(),
                radix: 10,
            }),
            text => Self::Float(Float(text.into())),
        }
    }
}

/// The shortest decimal number that is this one.
impl From<f32> for Content {
    fn from(value: f32) -> Self {
        value
            .to_string()
            .parse::<f64>()
            .map_or_else(|_| f64::from(value).into(), Self::from)
    }
}

impl<T: Into<Content>, const N: usize> From<[T; N]> for Content {
    fn from(values: [T; N]) -> Self {
        let node = |value: T| Node::new(0..0, value.into());
        Self::Array(values.map(node).into())
    }
}
