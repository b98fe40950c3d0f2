//! Values of options: `--size`, `--crop`, and times.

use std::time::Duration;

use crate::render::{Crop, check_size};

/// `--size`
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SizeArg {
    /// Width and height, pixels.
    Pixels([u32; 2]),
    /// Width alone, pixels; the height is as in the scene's proportions.
    Width(u32),
    /// Name of a size of the project.
    Named(String),
}

impl SizeArg {
    /// The value as a word of a command line.
    pub fn word(&self) -> String {
        match self {
            Self::Pixels([width, height]) => format!("{width}x{height}"),
            Self::Width(width) => width.to_string(),
            Self::Named(name) => name.clone(),
        }
    }
}

/// `1280x720`, `1280`, or a name, which begins with a letter.
///
/// # Errors
/// Same errors as [`parse_size`].
pub fn parse_size_or_name(text: &str) -> Result<SizeArg, String> {
    match text.parse() {
        Ok(width) => check_size([width, 1]).map(|()| SizeArg::Width(width)),
        Err(_) if text.starts_with(char::is_alphabetic) => Ok(SizeArg::Named(text.to_owned())),
        Err(_) => parse_size(text).map(SizeArg::Pixels),
    }
}

/// `X,Y,W,H`: left and top edge, width and height of a part of the picture, pixels.
///
/// # Errors
/// Message that names the expected form.
pub fn parse_crop(text: &str) -> Result<Crop, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([x, y, width, height]) if *width > 0 && *height > 0 => Ok(Crop {
            at: [*x, *y],
            size: [*width, *height],
        }),
        _ => Err("expected X,Y,WIDTH,HEIGHT in pixels, such as 100,50,320,180".to_owned()),
    }
}

/// `1280x720` as width and height; other signs that stand for "by" are read too.
///
/// # Errors
/// Message that names the expected form.
pub fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once(['x', 'X', '×', '*', ',']);
    let pair = sides.and_then(|(w, h)| Some([w.trim().parse().ok()?, h.trim().parse().ok()?]));
    match pair {
        Some(size) => check_size(size).map(|()| size),
        None => Err("expected WIDTHxHEIGHT, such as 1280x720".to_owned()),
    }
}

/// A time of at least a tenth of a second, such as `10s`, `2m` or `1h`.
///
/// # Errors
/// Message that names the expected form.
pub fn parse_time(text: &str) -> Result<Duration, String> {
    let (number, unit) = text.split_at(text.len() - text.ends_with(['s', 'm', 'h']) as usize);
    let unit_s = match unit {
        "s" => Some(1.0),
        "m" => Some(60.0),
        "h" => Some(3600.0),
        _ => None,
    };
    let seconds = unit_s.zip(number.parse::<f64>().ok()).map(|(s, n)| s * n);
    let time = seconds
        .filter(|s| *s >= 0.1)
        .map(Duration::try_from_secs_f64);
    time.and_then(Result::ok)
        .ok_or_else(|| "expected a time of at least 0.1s, such as 10s, 2m or 1h".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_options_are_read() {
        let crop = parse_crop("1, 2,3,4").expect("four numbers");
        assert_eq!((crop.at, crop.size), ([1, 2], [3, 4]));
        assert_eq!(crop.to_string(), "1,2,3,4");
        assert!(crop.is_in([4, 6]) && !crop.is_in([3, 6]) && !crop.is_in([4, 5]));
        let far = parse_crop("4294967295,0,1,1").expect("four numbers");
        assert!(!far.is_in([9, 9]));
        assert_eq!(parse_time("2m"), Ok(Duration::from_secs(120)));
        assert_eq!(parse_time("0.5s"), Ok(Duration::from_millis(500)));
        let draft = SizeArg::Named("draft".to_owned());
        assert_eq!(parse_size_or_name("draft"), Ok(draft));
        assert_eq!(parse_size_or_name("2,3"), Ok(SizeArg::Pixels([2, 3])));
        assert_eq!(parse_size_or_name("5"), Ok(SizeArg::Width(5)));
    }
}
