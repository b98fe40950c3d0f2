//! File names of frames, with placeholders of the frame number, also in the notations of other programs.

use std::{
    ops::Range,
    path::{Path, PathBuf},
};

use super::frames::clipped;
use crate::error::OutputError;

/// Placeholder of the camera's name in the name of the output.
pub const CAMERA: &str = "{camera}";

/// Maximum number of digits in a placeholder; more than a frame number has.
const MOST_DIGITS: usize = 20;

/// Notations of placeholders that are understood, for messages.
const KNOWN: &str = "write #### (or %04d, $F4, <frame>, {frame:04})";

/// A file name with a frame number placeholder, `film.####.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template {
    folder: PathBuf,
    before: String,
    digits: usize,
    after: String,
}

impl Template {
    /// Splits a name at its placeholder; `None` without any. The number is written with at least
    /// as many digits as there are `#`s, or as `%04d`, `$F4`, `<frame4>` and `{frame:04}` say.
    ///
    /// # Errors
    /// [`OutputError::Usage`] for two placeholders, more than 20 digits, a notation that is not
    /// understood, a placeholder in the name of a folder that does not exist, and a name that is
    /// not UTF-8.
    pub fn new(path: &Path) -> Result<Option<Self>, OutputError> {
        let shown = path.display().to_string();
        let usage = |why: String| {
            Err(OutputError::Usage(format!(
                "--output {}: {why}",
                clipped(&shown)
            )))
        };
        let Some(name) = path.file_name() else {
            return Ok(None);
        };
        let Some(name) = name.to_str() else {
            return usage("the name must be UTF-8".to_owned());
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let number = match number_in(name) {
            Ok(number) => number,
            Err(why) => return usage(why),
        };
        if let Some(placeholder) = in_folder(folder) {
            return usage(format!(
                "the frame number goes into the file name, not into the name of a folder; \
                 {placeholder} is in that of {}",
                clipped(&folder.display().to_string())
            ));
        }
        Ok(number.map(|(at, digits)| Self {
            folder: folder.to_owned(),
            before: name[..at.start].to_owned(),
            digits,
            after: name[at.end..].to_owned(),
        }))
    }

    /// File of a frame; longer numbers are not truncated.
    pub fn path(&self, frame: u32) -> PathBuf {
        let digits = self.digits;
        let name = format!("{}{frame:0digits$}{}", self.before, self.after);
        self.folder.join(name)
    }
}

/// Range of the placeholder of the frame number in a file name, and its number of digits; `None` without any.
///
/// # Errors
/// Message for two placeholders, more than 20 digits, and a notation that is not understood.
pub fn number_in(name: &str) -> Result<Option<(Range<usize>, usize)>, String> {
    let mut places = places(name)?;
    match places.as_slice() {
        [(_, digits)] if *digits > MOST_DIGITS => Err(format!(
            "{digits} digits for the frame number; write at most {MOST_DIGITS} #"
        )),
        [] | [_] => Ok(places.pop()),
        _ => Err("the frame number may appear only once".to_owned()),
    }
}

/// Whether the path of a folder has a placeholder of the frame number. A lone `#` may be part of a name.
pub fn has_number(folder: &str) -> bool {
    let is_number = |(at, _): &(Range<usize>, usize)| &folder[at.clone()] != "#";
    places(folder).is_ok_and(|places| places.iter().any(is_number))
}

/// Placeholder in the name of a folder that does not exist. A lone `#` may be part of a name.
fn in_folder(folder: &Path) -> Option<String> {
    if folder.is_dir() {
        return None;
    }
    let text = folder.to_str()?;
    let (at, _) = places(text).ok()?.first()?.clone();
    (&text[at.clone()] != "#").then(|| text[at].to_owned())
}

/// Whether a character, of one byte, has letters or digits on both of its sides.
fn is_inside_word(name: &str, at: usize) -> bool {
    let [before, after] = [
        name[..at].chars().next_back(),
        name[at + 1..].chars().next(),
    ];
    before
        .zip(after)
        .is_some_and(|(a, b)| a.is_alphanumeric() && b.is_alphanumeric())
}

/// Length of a placeholder in bytes and its number of digits, or an error message.
type Found = Result<(usize, usize), String>;

/// Ranges of all placeholders in a name, with their numbers of digits.
fn places(name: &str) -> Result<Vec<(Range<usize>, usize)>, String> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(first) = name[at..].chars().next() {
        let rest = &name[at..];
        let here = match first {
            // A lone `#` inside of a word is a part of it, as in `a#b.png`.
            '#' => run(rest, '#')
                .filter(|(length, _)| *length > 1 || !is_inside_word(name, at))
                .map(Ok),
            '@' => run(rest, '@')
                .filter(|(length, _)| *length > 1)
                .map(|(length, _)| {
                    Err(format!(
                        "{} is not understood; {KNOWN}",
                        clipped(&rest[..length])
                    ))
                }),
            '%' => printf(rest),
            '$' => houdini(rest),
            '<' => bracketed(rest, '>'),
            '{' => bracketed(rest, '}'),
            _ => None,
        };
        at += match here.transpose()? {
            Some((length, digits)) => {
                found.push((at..at + length, digits));
                length
            }
            None => first.len_utf8(),
        };
    }
    Ok(found)
}

/// A run of one character, such as `####`.
fn run(text: &str, c: char) -> Option<(usize, usize)> {
    let length = text.chars().take_while(|next| *next == c).count();
    Some((length, length))
}

/// Number of leading digits.
fn digits_of(text: &str) -> usize {
    text.bytes().take_while(u8::is_ascii_digit).count()
}

/// Number of digits that `text` asks for, at least 1; an overflow gives the maximum, which is refused later.
fn count(text: &str) -> usize {
    text.parse()
        .unwrap_or(if text.is_empty() { 1 } else { usize::MAX })
        .max(1)
}

fn not_understood(text: &str) -> Found {
    Err(format!("{} is not understood; {KNOWN}", clipped(text)))
}

/// `%04d` or `%d`, as in C, ffmpeg and Python.
fn printf(text: &str) -> Option<Found> {
    let flags = text[1..].bytes().take_while(|b| b"-+".contains(b)).count();
    let width = digits_of(&text[1 + flags..]);
    let end = 1 + flags + width;
    let kind = text[end..].chars().next().filter(|c| "diu".contains(*c))?;
    let (shown, number) = (&text[..=end], &text[1 + flags..end]);
    let next = text[end + 1..].chars().next();
    // `100%done.png` has no number, and `%d_` has one.
    let in_word = number.is_empty() && next.is_some_and(char::is_alphanumeric);
    let padded = number.is_empty() || number.len() > 1 && number.starts_with('0');
    Some(match flags == 0 && kind == 'd' && padded && !in_word {
        true => Ok((end + 1, count(number))),
        false => not_understood(shown),
    })
}

/// `$F4`, `$F` or `${F4}`, as in Houdini.
fn houdini(text: &str) -> Option<Found> {
    let (inner, close) = match text.strip_prefix("${F") {
        Some(inner) => (inner, 1),
        None => (text.strip_prefix("$F")?, 0),
    };
    let width = digits_of(inner);
    let rest = &inner[width..];
    let length = text.len() - rest.len() + close;
    let ends = match close {
        1 => rest.starts_with('}'),
        _ => !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'),
    };
    Some(match ends {
        true => Ok((length, count(&inner[..width]))),
        false => not_understood(text),
    })
}

/// `<frame>`, `<frame4>` or `<f4>`, as in Maya and RenderMan, and `{frame}` or `{frame:04}`, as in
/// Python. Another word in brackets is most likely a placeholder of another program.
fn bracketed(text: &str, close: char) -> Option<Found> {
    if text.starts_with(CAMERA) {
        return None; // `{camera}`, not a frame number
    }
    let length = text.find(close)? + 1;
    let inner = text[1..length - 1].to_ascii_lowercase();
    let is_word = |w: &str| {
        w.chars()
            .all(|c| c.is_ascii_lowercase() || "_ ".contains(c))
    };
    let (name, width) = match inner.split_once(':') {
        Some((name, width)) => (name, width.strip_suffix('d').unwrap_or(width)),
        None => inner.split_at(inner.trim_end_matches(|c: char| c.is_ascii_digit()).len()),
    };
    if ["frame", "f"].contains(&name) && digits_of(width) == width.len() {
        return Some(Ok((length, count(width))));
    }
    (!name.is_empty() && is_word(name)).then(|| not_understood(&text[..length]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn template(name: &str) -> Result<Option<Template>, String> {
        Template::new(Path::new(name)).map_err(|error| error.to_string())
    }

    /// Lines of `frame_names.txt`: a name, and the name of its frame 7; nothing for names without a placeholder, and after `!` a
    /// part of the message about what only looks like one.
    #[test]
    fn placeholders_of_other_programs_give_the_same_names() {
        for case in include_str!("frame_names.txt").lines() {
            if let Some((name, says)) = case.split_once(" ! ") {
                let why = template(name).expect_err(name);
                assert!(why.contains(says) && why.len() < 300, "{name}: {why}");
                continue;
            }
            let (name, want) = case.split_once(" =").expect("a name");
            let found = template(name).unwrap_or_else(|why| panic!("{why}"));
            let path = found.map(|found| found.path(7));
            assert_eq!(
                path.as_deref(),
                want.strip_prefix(' ').map(Path::new),
                "{name}"
            );
        }
        let walk = template("walk.%04d.png").expect("right").expect("has one");
        assert_eq!(walk.path(123_456), Path::new("walk.123456.png"));
        let widest = template(&"#".repeat(20)).expect("right").expect("has one");
        assert_eq!(widest.path(7), Path::new("00000000000000000007"));
    }

    #[test]
    fn wide_placeholders_are_refused() {
        for many in [21, 70_000] {
            let why = template(&format!("{}.png", "#".repeat(many))).expect_err("too many");
            assert!(
                why.ends_with("write at most 20 #") && why.len() < 200,
                "{why}"
            );
        }
    }
}
