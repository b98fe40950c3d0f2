//! Tokens of a script's text, for messages and warnings; comments are left out.

use std::ops::Range;

/// A word, a number, a text in quotes, or a sign.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Token<'t> {
    /// Text of the token as it is written.
    pub text: &'t str,
    /// Range of the token in the text, bytes.
    pub at: Range<usize>,
}

impl Token<'_> {
    /// Whether the token is a name or a keyword.
    pub fn is_word(&self) -> bool {
        self.text
            .starts_with(|c: char| c.is_alphabetic() || c == '_')
    }
}

/// Signs of two characters that must be told from their parts.
const PAIRS: [&str; 12] = [
    "#{", "..", "::", "==", "!=", "<=", ">=", "/=", "+=", "-=", "*=", "=>",
];

/// Tokens of a text, in order.
pub fn tokens(text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let length = match c {
            c if c.is_whitespace() => {
                at += c.len_utf8();
                continue;
            }
            '/' if rest.starts_with("//") => {
                at += rest.find('\n').unwrap_or(rest.len());
                continue;
            }
            '/' if rest.starts_with("/*") => {
                at += rest.find("*/").map_or(rest.len(), |end| end + 2);
                continue;
            }
            '"' | '`' | '\'' => length_of_text(rest, c),
            c if c.is_ascii_digit() => length_of_number(rest),
            c if c.is_alphabetic() || c == '_' => {
                let ends = |c: char| !(c.is_alphanumeric() || c == '_');
                rest.find(ends).unwrap_or(rest.len())
            }
            _ if PAIRS.iter().any(|pair| rest.starts_with(pair)) => 2,
            c => c.len_utf8(),
        };
        found.push(Token {
            text: &rest[..length],
            at: at..at + length,
        });
        at += length;
    }
    found
}

fn length_of_text(rest: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (i, c) in rest.char_indices().skip(1) {
        if c == quote && !is_escaped {
            return i + 1;
        }
        is_escaped = c == '\\' && !is_escaped && quote != '`';
    }
    rest.len()
}

/// Length of a number such as `1`, `1_000`, `0xff`, `1.5` or `1e-3`, bytes; the points of `0..3` and `1.abs()`
/// do not belong to it.
fn length_of_number(rest: &str) -> usize {
    let digits = |text: &str| {
        let ends = |c: char| !(c.is_ascii_alphanumeric() || c == '_');
        text.find(ends).unwrap_or(text.len())
    };
    let mut length = digits(rest);
    let fraction = rest[length..].strip_prefix('.');
    if let Some(fraction) = fraction.filter(|f| f.starts_with(|c: char| c.is_ascii_digit())) {
        length += 1 + digits(fraction);
    }
    let exponent = rest[..length].ends_with(['e', 'E']) && !rest.starts_with("0x");
    if let Some(sign) = rest[length..].strip_prefix(['-', '+']).filter(|_| exponent) {
        length += 1 + digits(sign);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_texts_and_signs_are_told_apart() {
        let text =
            "let a=1.5e-3/b; // c / d\nfor i in 0..3 { x /= \"}\\\"\" + `$`; } /* { */ #{k:0xff}";
        let found: Vec<_> = tokens(text).iter().map(|t| t.text).collect();
        let wanted =
            r##"let a = 1.5e-3 / b ; for i in 0 .. 3 { x /= "}\"" + `$` ; } #{ k : 0xff }"##;
        assert_eq!(found.join(" "), wanted);
    }

    #[test]
    fn what_does_not_end_ends_with_the_text() {
        for text in ["\"a", "`é", "/* a", "1.", "// x", "é1"] {
            let end = tokens(text).last().map_or(0, |t| t.at.end);
            assert!(end <= text.len(), "{text}");
        }
    }
}
