//! Lines of text as runs of one direction (UAX #9) and one script (UAX #24), each of which is shaped by itself.

use std::ops::Range;

use unicode_bidi::BidiInfo;
use unicode_script::{Script, UnicodeScript as _};

/// A part of a line whose letters have one direction and one script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// Byte range in the line.
    pub range: Range<usize>,
    /// Whether its letters follow each other from right to left.
    pub is_leftward: bool,
}

/// The runs of a line in the order in which they stand, from left to right.
pub fn runs(line: &str) -> Vec<Run> {
    let bidi = BidiInfo::new(line, None);
    let mut found = Vec::new();
    for paragraph in &bidi.paragraphs {
        let (levels, visual) = bidi.visual_runs(paragraph, paragraph.range.clone());
        for range in visual {
            let is_leftward = levels[range.start].is_rtl();
            let first = found.len();
            let parts = by_script(line, range).into_iter();
            found.extend(parts.map(|range| Run { range, is_leftward }));
            if is_leftward {
                found[first..].reverse();
            }
        }
    }
    found
}

/// Parts of a range of one script each; signs of all scripts belong to the part that they stand in.
fn by_script(line: &str, range: Range<usize>) -> Vec<Range<usize>> {
    let (mut parts, mut start, mut script) = (Vec::new(), range.start, None);
    for (at, letter) in line[range.clone()].char_indices() {
        let own = match letter.script() {
            Script::Common | Script::Inherited | Script::Unknown => continue,
            own => own,
        };
        if script.is_some_and(|script| script != own) {
            parts.push(start..range.start + at);
            start = range.start + at;
        }
        script = Some(own);
    }
    parts.push(start..range.end);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_split_where_direction_or_script_changes() {
        for (line, expected) in [
            ("abc, d1.", &[("abc, d1.", false)][..]),
            ("", &[]),
            ("אבג", &[("אבג", true)]),
            // Numbers keep their direction among letters from right to left, and stand left of the letters before them.
            ("אב 12", &[("12", false), ("אב ", true)]),
            ("ab אב cd", &[("ab ", false), ("אב", true), (" cd", false)]),
            ("אב ab גד", &[(" גד", true), ("ab", false), ("אב ", true)]),
            ("abгде!", &[("ab", false), ("где!", false)]),
            ("אבجد", &[("جد", true), ("אב", true)]),
        ] {
            let found = runs(line);
            let found: Vec<_> = (found.iter())
                .map(|run| (&line[run.range.clone()], run.is_leftward))
                .collect();
            assert_eq!(found, expected, "{line}");
        }
    }
}
