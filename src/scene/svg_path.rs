//! Paths in the syntax of SVG (<https://www.w3.org/TR/SVG2/paths.html>).

use std::ops::Range;

use svgtypes::{Error, SimplifyingPathParser};

pub use svgtypes::SimplePathSegment as PathSegment;

use crate::range::LIMIT;

/// Largest number of segments of a path.
const MOST_SEGMENTS: usize = 100_000;

/// Mistake in a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathFault {
    /// Byte of the text at which it was found.
    pub byte: usize,
    /// Message.
    pub message: String,
    /// Advice.
    pub help: &'static str,
}

/// Reads a path: absolute lines and Bézier curves, arcs as curves that differ from them by 0.03 % of their radius.
///
/// # Errors
/// The first letter or number that is not of a path; numbers that are not finite or beyond 1e12.
pub fn read(text: &str) -> Result<Vec<PathSegment>, PathFault> {
    let fault = |byte: usize, message: String, help| PathFault {
        byte: byte.min(text.len()),
        message,
        help,
    };
    let mut segments = Vec::new();
    for segment in SimplifyingPathParser::from(text) {
        let help = "a path is letters with numbers after them: M x y (start), L x y, H x, V y, C x1 y1 x2 y2 x y, \
                    Q x1 y1 x y, A rx ry turn large sweep x y, Z (end); small letters are relative";
        let segment = segment.map_err(|error| {
            let byte = byte_of(&error, text);
            let rest = text.get(byte..).unwrap_or_default();
            let found: String = rest.chars().take(12).collect();
            let message = match found.is_empty() {
                true => "`path` ends where a number is missing".to_owned(),
                false => format!("`path` is not understood from \"{found}\" on"),
            };
            fault(byte, message, help)
        })?;
        if !numbers(&segment).iter().all(|x| x.abs() <= LIMIT) {
            let message = "a number of `path` is larger than 1e12".to_owned();
            let byte = too_large(text);
            return Err(fault(byte, message, "use smaller numbers and `scale`"));
        }
        if segments.len() == MOST_SEGMENTS {
            let message = format!("`path` must have at most {MOST_SEGMENTS} segments");
            return Err(fault(text.len(), message, "split it into several shapes"));
        }
        segments.push(segment);
    }
    if !segments
        .iter()
        .any(|s| !matches!(s, PathSegment::MoveTo { .. }))
    {
        let message = "`path` draws nothing".to_owned();
        return Err(fault(
            0,
            message,
            "write for example \"M 0 0 L 1 0 L 0 1 Z\"",
        ));
    }
    Ok(segments)
}

/// Byte of the number of a path that is beyond 1e12, by itself or added to the numbers before it.
fn too_large(text: &str) -> usize {
    let literals: Vec<_> = literals(text).collect();
    let own = |at: &Range<usize>| text[at.clone()].parse::<f64>().ok();
    let is_large = |at: &&Range<usize>| own(at).is_some_and(|x| x.abs() > LIMIT);
    if let Some(large) = literals.iter().find(is_large) {
        return large.start;
    }
    // A sum of relative numbers: the first of them behind which a segment ends too far away.
    let first = literals.partition_point(|at| {
        let before = SimplifyingPathParser::from(&text[..at.end]);
        let mut known = before.map_while(Result::ok);
        known.all(|segment| numbers(&segment).iter().all(|x| x.abs() <= LIMIT))
    });
    literals.get(first).map_or(0, |at| at.start)
}

/// Byte ranges of the numbers of a path.
fn literals(text: &str) -> impl Iterator<Item = Range<usize>> {
    let bytes = text.as_bytes();
    let (mut next, mut last) = (0, 0);
    std::iter::from_fn(move || {
        let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
        while next < bytes.len() && !is_digit(next) {
            next += 1;
        }
        let mut start = next;
        while start > last && b"+-.".contains(&bytes[start - 1]) {
            start -= 1;
        }
        let mut has_point = bytes[start..next].contains(&b'.');
        while is_digit(next) || bytes.get(next) == Some(&b'.') && !has_point {
            has_point |= bytes[next] == b'.';
            next += 1;
        }
        let is_exponent = matches!(bytes.get(next), Some(b'e' | b'E'));
        let sign = usize::from(matches!(bytes.get(next + 1), Some(b'+' | b'-')));
        if is_exponent && is_digit(next + 1 + sign) {
            next += 1 + sign;
            while is_digit(next) {
                next += 1;
            }
        }
        last = next;
        (start < next).then_some(start..next)
    })
}

/// Byte at which an error was found; svgtypes counts characters from 1.
fn byte_of(error: &Error, text: &str) -> usize {
    let position = match error {
        Error::UnexpectedData(position)
        | Error::InvalidChar(_, position)
        | Error::InvalidString(_, position)
        | Error::InvalidNumber(position) => *position,
        _ => return text.len(),
    };
    let before = text.char_indices().nth(position.saturating_sub(1));
    before.map_or(text.len(), |(byte, _)| byte)
}

/// The coordinates of a segment; unused ones are 0.
fn numbers(segment: &PathSegment) -> [f64; 6] {
    match *segment {
        PathSegment::MoveTo { x, y } | PathSegment::LineTo { x, y } => [x, y, 0.0, 0.0, 0.0, 0.0],
        PathSegment::CurveTo {
            x1,
            y1,
            x2,
            y2,
            x,
            y,
        } => [x1, y1, x2, y2, x, y],
        PathSegment::Quadratic { x1, y1, x, y } => [x1, y1, x, y, 0.0, 0.0],
        PathSegment::ClosePath => [0.0; 6],
    }
}
