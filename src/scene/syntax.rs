//! Syntax tree of a scene text: its tables, keys and values with their places, its errors, and the tokens that
//! print the text again byte by byte.
//!
//! [`Source::syntax`](super::diagnostic::Source::syntax) makes the tree of a text once; reader, lint, language
//! server and write-back share it. Parsing never fails as a whole, so that a text that is being typed has a tree.

mod size;
mod write;

use std::{collections::BTreeMap, fmt, ops::Range};

use toml::{
    Spanned,
    de::{DeTable, DeValue, Error},
};
use toml_parser::Source;

/// Kind of a token.
pub use toml_parser::lexer::TokenKind;

pub use self::{
    size::{MOST_TABLES, MOST_TEXT_BYTES, Size, tables_in},
    write::{key_text, to_text, value_text},
};

/// A key with its byte range in the text.
pub type Key = Spanned<String>;

/// A value with its byte range in the text; for a table with a header, the range of the header.
pub type Node = Spanned<Content>;

/// Keys of a table with their values, sorted by name; the ranges tell the order of the text.
pub type Entries = BTreeMap<Key, Node>;

/// Entries of a table in the order of the file.
pub fn in_order(entries: &Entries) -> Vec<(&Key, &Node)> {
    let mut all: Vec<_> = entries.iter().collect();
    all.sort_by_key(|(name, _)| name.span().start);
    all
}

/// Value of a key or of an element of an array.
#[derive(Clone, Debug)]
pub enum Content {
    /// Text in quotes, with its escapes resolved.
    String(String),
    /// Number without point and exponent.
    Integer(Integer),
    /// Number with point or exponent, `inf` or `nan`.
    Float(Float),
    /// `true` or `false`.
    Boolean(bool),
    /// Date or time, which no key of a scene takes.
    Datetime,
    /// Array of values, or the tables of `[[name]]`.
    Array(Vec<Node>),
    /// Table in braces, with a header, or made by dotted keys.
    Table(Entries),
}

/// Digits of an integer as they are written, since no type of fixed size holds them all.
#[derive(Clone, Debug)]
pub struct Integer {
    digits: Box<str>,
    radix: u32,
}

/// Text of a float as it is written, without underscores.
#[derive(Clone, Debug)]
pub struct Float(Box<str>);

/// Syntax error, or a key that is defined twice.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SyntaxError {
    /// Byte range of the error in the text.
    pub at: Range<usize>,
    /// Message of the parser.
    pub message: String,
}

/// Tables, keys and values of a text, as far as they can be understood, and its errors.
#[derive(Clone, Debug)]
pub struct SyntaxTree {
    root: Entries,
    errors: Vec<SyntaxError>,
}

/// Message of the error of a text that has more than [`MOST_TABLES`] tables and is therefore not parsed.
pub const TOO_MANY_TABLES: &str = "too many tables";

impl SyntaxTree {
    /// Parses a text.
    pub fn parse(text: &str) -> Self {
        #[cfg(debug_assertions)]
        parsed::add(text);
        if tables_in(text) > MOST_TABLES {
            return Self {
                root: Entries::new(),
                errors: vec![SyntaxError {
                    at: 0..0,
                    message: TOO_MANY_TABLES.to_owned(),
                }],
            };
        }
        let (root, errors) = DeTable::parse_recoverable(text);
        let mut errors: Vec<_> = errors.iter().map(SyntaxError::from).collect();
        errors.sort_by_key(|error| error.at.start);
        Self {
            root: entries(root.into_inner()),
            errors,
        }
    }

    /// Tree without errors, made by the program.
    pub fn new(root: Entries) -> Self {
        Self {
            root,
            errors: Vec::new(),
        }
    }

    /// Entries of the text: top-level keys and tables.
    pub fn root(&self) -> &Entries {
        &self.root
    }

    /// Errors in the order of the text.
    pub fn errors(&self) -> &[SyntaxError] {
        &self.errors
    }

    /// Entries of a text without errors.
    ///
    /// # Errors
    /// The first error.
    pub fn correct(&self) -> Result<&Entries, &SyntaxError> {
        self.errors.first().map_or(Ok(&self.root), Err)
    }

    /// Copy of the entries with all ranges moved.
    pub fn moved(&self, by: usize) -> Entries {
        moved_entries(&self.root, by)
    }

    /// Copy of the entries with all ranges moved, but `[variant.NAME]` only where `keeps` selects it.
    pub fn moved_with_variants(&self, by: usize, keeps: impl Fn(&str) -> bool) -> Entries {
        let copy = |(key, node): (&Key, &Node)| {
            let node = match node.get_ref() {
                Content::Table(all) if key.get_ref() == "variant" => {
                    let kept = all.iter().filter(|(name, _)| keeps(name.get_ref()));
                    let kept = kept.map(|(name, node)| (moved_key(name, by), moved(node, by)));
                    Node::new(shift(node.span(), by), Content::Table(kept.collect()))
                }
                _ => moved(node, by),
            };
            (moved_key(key, by), node)
        };
        self.root.iter().map(copy).collect()
    }
}

/// Parses one value, such as of `--set`.
///
/// # Errors
/// The first syntax error.
pub fn parse_value(text: &str) -> Result<Node, SyntaxError> {
    let parsed = DeValue::parse(text).map_err(|error| SyntaxError::from(&error))?;
    Ok(node(parsed))
}

fn shift(at: Range<usize>, by: usize) -> Range<usize> {
    at.start + by..at.end + by
}

fn moved_key(key: &Key, by: usize) -> Key {
    Key::new(shift(key.span(), by), key.get_ref().clone())
}

fn moved_entries(entries: &Entries, by: usize) -> Entries {
    let moved = |(key, node): (&Key, &Node)| (moved_key(key, by), moved(node, by));
    entries.iter().map(moved).collect()
}

/// Copy of a node with all ranges moved. The parser limits the depth of this recursion.
pub fn moved(node: &Node, by: usize) -> Node {
    let content = match node.get_ref() {
        Content::Array(items) => Content::Array(items.iter().map(|i| moved(i, by)).collect()),
        Content::Table(table) => Content::Table(moved_entries(table, by)),
        plain => plain.clone(),
    };
    Node::new(shift(node.span(), by), content)
}

impl From<&Error> for SyntaxError {
    fn from(error: &Error) -> Self {
        Self {
            at: error.span().unwrap_or(0..0),
            message: error.message().to_owned(),
        }
    }
}

/// Owned form of a parsed table.
fn entries(table: DeTable) -> Entries {
    (table.into_iter())
        .map(|(key, value)| {
            let key = Key::new(key.span(), key.into_inner().into_owned());
            (key, node(value))
        })
        .collect()
}

/// Owned form of a parsed value. The parser limits the depth of this recursion.
fn node(parsed: Spanned<DeValue>) -> Node {
    let at = parsed.span();
    let content = match parsed.into_inner() {
        DeValue::String(text) => Content::String(text.into_owned()),
        DeValue::Integer(i) => Content::Integer(Integer {
            digits: i.as_str().into(),
            radix: i.radix(),
        }),
        DeValue::Float(x) => Content::Float(Float(x.as_str().into())),
        DeValue::Boolean(value) => Content::Boolean(value),
        DeValue::Datetime(_) => Content::Datetime,
        DeValue::Array(items) => Content::Array(items.into_iter().map(node).collect()),
        DeValue::Table(table) => Content::Table(entries(table)),
    };
    Node::new(at, content)
}

impl Content {
    /// The text of a string.
    pub fn as_str(&self) -> Option<&str> {
        match self {
            Self::String(text) => Some(text),
            _ => None,
        }
    }

    /// The value of a boolean.
    pub fn as_bool(&self) -> Option<bool> {
        match self {
            Self::Boolean(value) => Some(*value),
            _ => None,
        }
    }

    /// The elements of an array.
    pub fn as_array(&self) -> Option<&Vec<Node>> {
        match self {
            Self::Array(items) => Some(items),
            _ => None,
        }
    }

    /// The entries of a table.
    pub fn as_table(&self) -> Option<&Entries> {
        match self {
            Self::Table(entries) => Some(entries),
            _ => None,
        }
    }
}

impl Integer {
    /// The value; `None` past 128 bits.
    pub fn value(&self) -> Option<i128> {
        i128::from_str_radix(&self.digits, self.radix).ok()
    }
}

impl fmt::Display for Integer {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(match self.radix {
            2 => "0b",
            8 => "0o",
            16 => "0x",
            _ => "",
        })?;
        out.write_str(&self.digits)
    }
}

impl Float {
    /// The value, which is infinite past the range of doubles.
    pub fn value(&self) -> Option<f64> {
        self.0.parse().ok()
    }
}

impl fmt::Display for Float {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        out.write_str(&self.0)
    }
}

/// Record of the texts that are parsed on a thread, for tests of other crates; builds without debug assertions lack it.
#[cfg(debug_assertions)]
pub mod parsed {
    use std::cell::RefCell;

    thread_local! {
        static TEXTS: RefCell<Option<Vec<String>>> = const { RefCell::new(None) };
    }

    /// Adds a text that is parsed to the record of this thread, if it has one.
    pub(super) fn add(text: &str) {
        TEXTS.with_borrow_mut(|texts| texts.iter_mut().for_each(|list| list.push(text.to_owned())));
    }

    /// Starts an empty record on this thread.
    pub fn record() {
        TEXTS.set(Some(Vec::new()));
    }

    /// Ends the record of this thread, and returns its texts.
    pub fn end() -> Vec<String> {
        TEXTS.take().unwrap_or_default()
    }
}

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

/// Piece of a text that is not divided further.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token {
    /// Kind of the token.
    pub kind: TokenKind,
    /// Byte range in the text.
    pub at: Range<usize>,
}

/// All tokens of a text in its order, which follow each other without gaps.
pub fn tokens(text: &str) -> Vec<Token> {
    // The lexer skips a byte order mark without a token.
    let mark = text.starts_with('\u{feff}').then(|| Token {
        kind: TokenKind::Whitespace,
        at: 0..'\u{feff}'.len_utf8(),
    });
    let lexed = Source::new(text).lex().map(|token| Token {
        kind: token.kind(),
        at: token.span().start()..token.span().end(),
    });
    let lexed = lexed.filter(|token| token.kind != TokenKind::Eof);
    mark.into_iter().chain(lexed).collect()
}
