//! Words and texts in quotes of scripts.

/// Whether a character may be part of a name.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether a text ends inside of double quotes; multi-line strings in backticks are not recognized.
pub fn in_quotes(before: &str) -> bool {
    let line = before.rsplit('\n').next().unwrap_or_default();
    let (mut open, mut escaped) = (false, false);
    for c in line.chars() {
        match c {
            '"' if !escaped => open = !open,
            '\\' if open && !escaped => {
                escaped = true;
                continue;
            }
            _ => {}
        }
        escaped = false;
    }
    open
}
