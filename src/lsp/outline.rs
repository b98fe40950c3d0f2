//! Keys, values and headers of scene text with their places. Uses only the tokens of the syntax tree, since the
//! text before the cursor breaks off in the middle.

use std::ops::Range;

use reflet_scene::{diagnostic::Source, syntax::TokenKind};

/// Syntactic role of a word in scene text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Part {
    /// A key in `[…]`.
    Header,
    /// A key before `=`.
    Key,
    /// A value, or one of an array, of this key.
    Value(String),
    /// A word in a comment, or behind a header.
    Nothing,
}

/// A word in scene text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// Keys of the table that contains it, from the top of the file: `["camera", "main"]`; for a header, the keys
    /// before it.
    pub table: Vec<String>,
    /// Syntactic role of the word.
    pub part: Part,
    /// The word, without quotes.
    pub text: String,
    /// Byte range in the text, with quotes.
    pub range: Range<usize>,
}

/// A table or array inside a value.
struct Inline {
    keys: Vec<String>,
    is_table: bool,
}

/// Walks the tokens of a text.
#[derive(Default)]
struct Walk {
    words: Vec<Word>,
    header: Vec<String>,
    inline: Vec<Inline>,
    /// Parts of the current key or open header; the last is empty behind a dot.
    key: Vec<String>,
    in_header: bool,
    in_value: bool,
    is_over: bool,
}

/// All words of a text.
pub fn words(source: &Source) -> Vec<Word> {
    words_before(source, source.text.len()).0
}

/// Words of a text before a byte offset, the last one up to there, and an empty word with the role that text typed
/// there would have.
pub fn words_before(source: &Source, offset: usize) -> (Vec<Word>, Word) {
    let text = &source.text[..source.text.floor_char_boundary(offset)];
    let mut walk = Walk::default();
    for token in source.tokens() {
        if token.at.start >= text.len() {
            break;
        }
        let range = token.at.start..token.at.end.min(text.len());
        walk.token(token.kind, &text[range.clone()], range);
    }
    let end = walk.word(String::new(), text.len()..text.len());
    (walk.words, end)
}

/// Value of a key of the same `[[instance]]`: between the same headers.
pub fn beside(file: &Source, word: &Word, key: &str) -> Option<Word> {
    let header = |at: usize| file.text[..at].rfind("\n[[").map_or(0, |start| start + 1);
    let own = header(word.range.start);
    let is_it = |known: &Word| {
        known.part == Part::Value(key.to_owned()) && header(known.range.start) == own
    };
    words(file).into_iter().find(is_it)
}

impl Walk {
    fn token(&mut self, kind: TokenKind, raw: &str, range: Range<usize>) {
        let in_array = self.inline.last().is_some_and(|i| !i.is_table);
        match kind {
            TokenKind::Newline if self.inline.is_empty() => {
                self.statement();
                self.in_header = false;
                self.is_over = false;
            }
            TokenKind::Newline if self.is_over => self.is_over = false,
            TokenKind::Comment => self.is_over = true,
            TokenKind::LeftSquareBracket if !self.in_value && self.inline.is_empty() => {
                self.in_header = true;
                self.key.clear();
            }
            TokenKind::RightSquareBracket if self.in_header => {
                self.header = std::mem::take(&mut self.key);
                self.in_header = false;
                self.is_over = true;
            }
            TokenKind::RightSquareBracket | TokenKind::RightCurlyBracket => {
                if let Some(inline) = self.inline.pop() {
                    self.key = inline.keys;
                }
                self.in_value = true;
            }
            TokenKind::LeftSquareBracket | TokenKind::LeftCurlyBracket if self.in_value => {
                let keys = std::mem::take(&mut self.key);
                let is_table = kind == TokenKind::LeftCurlyBracket;
                self.inline.push(Inline { keys, is_table });
                self.in_value = !is_table;
            }
            TokenKind::Equals => self.in_value = true,
            TokenKind::Comma if !in_array => self.statement(),
            TokenKind::Dot if !self.in_value => self.key.push(String::new()),
            TokenKind::LiteralString
            | TokenKind::BasicString
            | TokenKind::MlLiteralString
            | TokenKind::MlBasicString
            | TokenKind::Atom => self.text(raw, range),
            _ => {}
        }
    }

    /// Begins the next key.
    fn statement(&mut self) {
        self.key.clear();
        self.in_value = false;
    }

    fn text(&mut self, raw: &str, range: Range<usize>) {
        let quote = raw.chars().next().filter(|c| ['"', '\''].contains(c));
        let text = quote.map_or(raw, |quote| raw.trim_matches(quote));
        let word = self.word(text.to_owned(), range);
        if !self.in_value {
            match self.key.last_mut() {
                Some(last) => *last = text.to_owned(),
                None => self.key.push(text.to_owned()),
            }
        }
        self.words.push(word);
    }

    fn word(&self, text: String, range: Range<usize>) -> Word {
        let mut table = self.header.clone();
        if self.in_header {
            table.clear();
        }
        table.extend(self.inline.iter().flat_map(|i| i.keys.iter().cloned()));
        let in_array = self.inline.last().is_some_and(|i| !i.is_table);
        let (path, part) = match self.key.split_last() {
            _ if self.is_over => (&[][..], Part::Nothing),
            Some((last, path)) if self.in_value => (path, Part::Value(last.clone())),
            None if self.in_value && in_array => {
                let key = table.pop().unwrap_or_default();
                (&[][..], Part::Value(key))
            }
            Some((_, path)) if self.in_header => (path, Part::Header),
            Some((_, path)) => (path, Part::Key),
            None if self.in_header => (&[][..], Part::Header),
            None => (&[][..], Part::Key),
        };
        table.extend(path.iter().cloned());
        Word {
            table,
            part,
            text,
            range,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Table, role and text of the word at `|`.
    fn word_at_mark(text: &str) -> String {
        let (before, after) = text.split_once('|').expect("a mark");
        let source = Source::new("a.toml", format!("{before}{after}"));
        let (mut words, end) = words_before(&source, before.len());
        let word = match words.pop() {
            Some(word) if word.range.end == before.len() => word,
            _ => end,
        };
        let part = match word.part {
            Part::Header => "header".to_owned(),
            Part::Key => "key".to_owned(),
            Part::Value(key) => format!("value of {key}"),
            Part::Nothing => "nothing".to_owned(),
        };
        let (table, text) = (word.table.join("."), word.text);
        format!("[{table}] {part}: {text}").trim_end().to_owned()
    }

    /// Lines of `places.txt`: a text with its cursor, and the table, role and beginning of the word there.
    #[test]
    fn a_cursor_knows_its_table_and_its_key() {
        for case in include_str!("tests/places.txt").lines() {
            let (text, wanted) = case.split_once(" => ").expect("a place");
            assert_eq!(word_at_mark(&text.replace("\\n", "\n")), wanted, "{text}");
        }
    }

    /// The text behind the cursor does not change what is completed there.
    #[test]
    fn a_cursor_sees_the_text_before_it_alone() {
        let text = include_str!("../../scenes/atrium.toml");
        let whole = Source::new("a.toml", text);
        for (offset, _) in text.char_indices().step_by(7) {
            let alone = Source::new("a.toml", &text[..offset]);
            let (found, end) = words_before(&whole, offset);
            let (mut want, want_end) = words_before(&alone, offset);
            let near = found.len().saturating_sub(3);
            assert_eq!(found.len(), want.len(), "{offset}");
            assert_eq!(found[near..], want.split_off(near), "{offset}");
            assert_eq!(end, want_end, "{offset}");
        }
    }
}
