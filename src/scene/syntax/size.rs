//! Size of scene text and of trees, which decides about the memory that reading takes.

use toml_parser::Source;

use super::{Content, Node, TokenKind};

/// Largest number of tables of a scene with all files that it names: as many as a text of 16 MiB can have as
/// `[[instance]]`.
pub const MOST_TABLES: usize = 650_000;

/// Largest number of values that placed scenes and inherited keys may become.
const MOST_VALUES: usize = 4_000_000;

/// Largest number of bytes of all texts of a scene, and of the names and texts that placed scenes become.
pub const MOST_TEXT_BYTES: usize = 32 << 20;

/// Number of tables that a text makes at most, counted without parsing it: its headers, tables in braces and
/// parts of dotted keys. Zero for texts that are too short to have [`MOST_TABLES`].
pub fn tables_in(text: &str) -> usize {
    if text.len() / 2 <= MOST_TABLES {
        return 0;
    }
    let (mut tables, mut dots) = (0, 0);
    let (mut is_line_start, mut is_header) = (true, false);
    for token in Source::new(text).lex() {
        match token.kind() {
            TokenKind::LeftCurlyBracket => (tables, dots) = (tables + 1, 0),
            TokenKind::LeftSquareBracket if is_line_start => {
                (tables, dots, is_header) = (tables + 1, 0, true);
            }
            TokenKind::Dot => dots += 1,
            TokenKind::Equals => (tables, dots) = (tables + dots, 0),
            TokenKind::RightSquareBracket if is_header => {
                (tables, dots, is_header) = (tables + dots, 0, false);
            }
            TokenKind::Comma | TokenKind::Newline => (dots, is_header) = (0, false),
            _ => {}
        }
        is_line_start = matches!(token.kind(), TokenKind::Newline)
            || is_line_start && matches!(token.kind(), TokenKind::Whitespace);
    }
    tables
}

/// Numbers of tables and values of trees, and bytes of their keys and texts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    /// Tables, also inside arrays.
    pub tables: usize,
    /// All values but tables.
    pub values: usize,
    /// Bytes of keys and texts.
    pub text_bytes: usize,
}

impl Size {
    /// Adds a tree. The parser limits the depth of this recursion.
    pub fn add(&mut self, node: &Node) {
        match node.get_ref() {
            Content::Table(entries) => {
                self.tables += 1;
                for (key, node) in entries {
                    self.text_bytes += key.get_ref().len();
                    self.add(node);
                }
            }
            Content::Array(items) => {
                self.values += 1;
                items.iter().for_each(|item| self.add(item));
            }
            Content::String(text) => {
                self.values += 1;
                self.text_bytes += text.len();
            }
            _ => self.values += 1,
        }
    }

    /// The limit that is exceeded, in words.
    pub fn excess(&self) -> Option<String> {
        if self.tables > MOST_TABLES {
            Some(format!("{MOST_TABLES} tables"))
        } else if self.values > MOST_VALUES {
            Some(format!("{MOST_VALUES} values"))
        } else if self.text_bytes > MOST_TEXT_BYTES {
            Some(format!("{} MiB of names and texts", MOST_TEXT_BYTES >> 20))
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::SyntaxTree;

    /// A text that is long enough to be counted.
    fn long(line: &str, times: usize) -> String {
        let mut text = line.repeat(times);
        text += &"# \n".repeat((2 * MOST_TABLES + 2 - text.len().min(2 * MOST_TABLES)) / 3 + 1);
        text
    }

    #[test]
    fn tables_are_counted_as_the_parser_makes_them() {
        for (line, tables) in [
            ("[[a]]\nx = [0.5, 0.5]\n", 1),
            ("x = [{ a = 0.5 }, { b.c = 1 }]\n", 3),
            ("  [a.b]\n", 2),
            ("a.\"=,[{.\".c = \"{[.=\" # [.{\n", 2),
            ("x = 'a' # y\n", 0),
        ] {
            assert_eq!(tables_in(&long(line, 10)), 10 * tables, "{line}");
        }
    }

    #[test]
    fn more_tables_than_allowed_are_refused_before_they_are_parsed() {
        let text = format!("x = [{}]", "{},".repeat(MOST_TABLES + 1));
        let tree = SyntaxTree::parse(&text);
        assert_eq!(tree.errors().len(), 1);
        assert!(tree.root().is_empty());
        let text = format!("x = [{}]", "[],".repeat(MOST_TABLES + 1));
        assert_eq!(SyntaxTree::parse(&text).errors().len(), 0);
    }
}
