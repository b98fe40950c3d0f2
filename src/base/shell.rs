//! Words of commands for a POSIX shell.

/// A word as a shell reads it back: in single quotes unless it is plain.
pub fn shell_word(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+@%#".contains(c);
    match !word.is_empty() && !word.starts_with('#') && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_where_a_shell_would_change_them() {
        for (text, want) in [
            ("a/b.####.png", "a/b.####.png"),
            ("#1", "'#1'"),
            ("", "''"),
            ("image.size=[1, 2]", "'image.size=[1, 2]'"),
            ("it's $HOME", "'it'\\''s $HOME'"),
        ] {
            assert_eq!(shell_word(text), want);
        }
    }
}
