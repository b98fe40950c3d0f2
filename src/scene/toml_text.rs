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

/// Beginning of the text that stands for many numbers in the result of `setup`, before eight hexadecimal digits for
/// each.
pub const FLOATS_PREFIX: &str = "floats:";

/// Largest number of numbers of one such text.
pub const MOST_FLOATS: usize = 6_000_000;

/// The numbers that a text stands for; `None` if it is not such a text.
pub(crate) fn read_floats(text: &str) -> Option<Vec<f32>> {
    let digits = text.strip_prefix(FLOATS_PREFIX)?.as_bytes();
    let number = |eight: &[u8]| {
        let digit = |bits: Option<u32>, byte: &u8| Some(bits? << 4 | (*byte as char).to_digit(16)?);
        eight.iter().fold(Some(0), digit).map(f32::from_bits)
    };
    let whole = digits.len().is_multiple_of(8) && digits.len() / 8 <= MOST_FLOATS;
    whole.then(|| digits.chunks_exact(8).map(number).collect())?
}

/// Number of numbers that a text with its quotes stands for; `None` if it stands for none.
pub fn floats_in(text: &str) -> Option<usize> {
    let digits = text.trim_matches('"').strip_prefix(FLOATS_PREFIX)?;
    Some(digits.len() / 8)
}
