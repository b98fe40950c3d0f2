//! Tokens of scene text: each byte belongs to one, white space and comments too, also where the text is no TOML.

use std::ops::Range;

use toml_parser::Source;

/// Kind of a token.
pub use toml_parser::lexer::TokenKind;

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
