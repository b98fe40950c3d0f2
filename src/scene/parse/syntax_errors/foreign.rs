//! Texts in another language than TOML, known by the first line that says something.

use std::ops::Range;

use crate::suggest;

/// Place of the first line that says something, the language of a text that is not TOML, and advice.
pub fn language(text: &str) -> Option<(Range<usize>, &'static str, &'static str)> {
    let is_remark = |line: &str| {
        let line = line.trim();
        let is_hash = line.starts_with("# ") || line == "#";
        line.is_empty() || is_hash || line.starts_with("//")
    };
    let mut lines = text.lines().filter(|line| !is_remark(line));
    let (first, next) = (lines.next()?, lines.next().unwrap_or_default().trim());
    let start = first.as_ptr() as usize - text.as_ptr() as usize;
    let indent = first.len() - first.trim_start().len();
    let at = start + indent..start + first.trim_end().len();
    let first = first.trim();
    let mut begin = format!("{first}\n{next}");
    for spaced in [" {", "{ ", "{\n"] {
        begin = begin.replace(spaced, "{");
    }
    if is_entry(first) && (next.is_empty() || is_entry(next) || next.starts_with("- ")) {
        "---\n".clone_into(&mut begin);
    }
    let (name, help) = suggest::language(&begin)?;
    Some((at, name, help))
}

/// Whether a line is an entry of YAML, such as `roughness: 0.5`.
fn is_entry(line: &str) -> bool {
    line.split_once(':').is_some_and(|(key, rest)| {
        let is_key = key.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
        is_key && !key.is_empty() && (rest.is_empty() || rest.starts_with(' '))
    })
}
