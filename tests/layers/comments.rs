//! Comments that begin with a fragment (`Of`, `As`, `Those`, `Which`, `What`) instead of naming their thing.

/// Words that begin a fragment: a reader must guess the noun before them.
const FRAGMENTS: [&str; 5] = ["Of", "As", "Those", "Which", "What"];

/// Syntax of a language's comments.
#[derive(Clone, Copy, PartialEq)]
pub enum Syntax {
    /// Rust and WGSL: `///`, `//!` and `//`.
    Slashes,
    /// Python: `#` and docstrings.
    Python,
}

impl Syntax {
    /// Markers at the beginning of a comment's own line; longer ones first.
    const fn markers(self) -> &'static [&'static str] {
        match self {
            Self::Slashes => &["///", "//!", "//"],
            Self::Python => &["#", "r\"\"\"", "\"\"\"", "'''"],
        }
    }

    /// Marker of a comment behind code, with the spaces that tell it from text such as a URL.
    const fn trailing(self) -> &'static str {
        match self {
            Self::Slashes => " // ",
            Self::Python => "  # ",
        }
    }

    /// Marker and text of a line that is a comment.
    fn own_line(self, line: &str) -> Option<(&'static str, &str)> {
        let line = line.trim_start();
        let mut markers = self.markers().iter();
        markers.find_map(|marker| Some((*marker, line.strip_prefix(marker)?.trim())))
    }
}

/// Line number (from 1) and text of each comment that begins with a fragment. A line that continues the
/// comment directly above is none; a paragraph after an empty comment line or a heading begins anew.
pub fn fragments(text: &str, syntax: Syntax) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    // Marker of the comment on the line above, and whether that line only opens a docstring.
    let (mut above, mut is_opened) = (None, false);
    for (number, line) in (1..).zip(text.lines()) {
        let own = syntax.own_line(line);
        let begins = match own {
            Some((marker, comment)) => above != Some(marker) && is_fragment(comment),
            None if is_opened && is_fragment(line.trim()) => true,
            None => line.split(syntax.trailing()).skip(1).any(is_fragment),
        };
        if begins {
            found.push((number, line.trim().to_owned()));
        }
        is_opened = own.is_some_and(|(marker, comment)| marker.len() >= 3 && comment.is_empty())
            && syntax == Syntax::Python;
        above = match own {
            Some((marker, comment)) => {
                Some(marker).filter(|_| !comment.is_empty() && !comment.starts_with("# "))
            }
            None => line
                .contains(syntax.trailing())
                .then(|| syntax.trailing().trim()),
        };
    }
    found
}

fn is_fragment(comment: &str) -> bool {
    let word = comment.split(|c: char| !c.is_alphanumeric()).next();
    word.is_some_and(|word| FRAGMENTS.contains(&word))
}
