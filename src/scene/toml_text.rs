//! Text as TOML writes it, and as it stands for values that TOML has not.

use std::fmt::Write as _;

/// Any text as a basic string of TOML, in quotes.
pub fn toml_text(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04X}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// Beginning of the text that stands for many numbers in the result of `setup`, before eight hexadecimal digits for each.
pub const FLOATS_PREFIX: &str = "floats:";

/// Number of numbers that a text with its quotes stands for; `None` if it stands for none.
pub fn floats_in(text: &str) -> Option<usize> {
    let digits = text.trim_matches('"').strip_prefix(FLOATS_PREFIX)?;
    Some(digits.len() / 8)
}
