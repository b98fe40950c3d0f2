//! `instances_from = "points.csv"`: copies of an instance from a CSV file with one copy a row and named columns.

use std::{path::Path, sync::Arc};

use glam::{Affine3A, DQuat, DVec4, Quat, Vec3};

use super::{Loader, error_at};
use crate::gltf::{Fault, uri::shorten};
use reflet_base::files::metadata;
use reflet_scene::{
    desc::{At, turned},
    diagnostic::{Diagnostic, Source, Span},
    range::ANY,
};

/// Maximum number of rows of a file.
pub const MOST_ROWS: usize = 1_000_000;
/// Largest file, bytes.
const MOST_BYTES: u64 = 256 << 20;

/// Names of the known columns.
const COLUMNS: [&str; 14] = [
    "x", "y", "z", "rx_deg", "ry_deg", "rz_deg", "qx", "qy", "qz", "qw", "scale", "sx", "sy", "sz",
];
const ROTATION: usize = 3;
const QUATERNION: usize = 6;
const SCALE: usize = 10;
const SCALES: usize = 11;

/// Position in the file of each known column; `None` where the file lacks it.
type Places = [Option<usize>; COLUMNS.len()];

/// Transforms of all rows, and names of the unknown columns.
type Points = (Vec<Affine3A>, Vec<String>);

/// An error: its byte offset in the text, its message and its help.
struct Mistake(usize, String, &'static str);

impl Loader<'_> {
    /// The transforms of a file, or none after an error.
    pub fn points(&mut self, name: &At<String>) -> Vec<Affine3A> {
        match self.read_points(name) {
            Ok(points) => points,
            Err(error) => {
                self.errors.push(*error);
                Vec::new()
            }
        }
    }

    fn read_points(&mut self, name: &At<String>) -> Result<Vec<Affine3A>, Box<Diagnostic>> {
        let path = self.find(name)?;
        let at_name = |fault: Fault| Box::new(error_at(fault.name, &name.at, fault.message));
        let size = metadata(&path).map_or(0, |file| file.len());
        if size > MOST_BYTES {
            let most = MOST_BYTES >> 20;
            let message = format!("{} is larger than {most} MiB", quoted(&name.value));
            let help = "leave out what is not needed, or split it over several instances";
            return Err(Box::new(
                error_at("file-too-large", &name.at, message).help(help),
            ));
        }
        let bytes = self.sandbox.read(&path).map_err(at_name)?;
        self.add_files(std::slice::from_ref(&path));
        let text = String::from_utf8(bytes).map_err(|wrong| {
            let span = Span::not_utf8(&path, &wrong);
            let message = "a table of points must be UTF-8 text, and this byte is not";
            Box::new(Diagnostic::new("not-utf8", span, message))
        })?;
        let (points, unused) =
            read(&text).map_err(|mistake| diagnostic(&path, &text, mistake, name))?;
        if let Some(first) = unused.first() {
            let message = format!("column {} is unknown and ignored", quoted(first));
            let warning = *diagnostic(&path, &text, Mistake(0, message, HELP), name);
            self.world.warnings.push(warning.warning());
        }
        Ok(points)
    }
}

const HELP: &str =
    "columns are x, y, z; rx_deg, ry_deg, rz_deg or qx, qy, qz, qw; scale or sx, sy, sz";

fn quoted(text: &str) -> String {
    format!("\"{}\"", shorten(text))
}

/// Diagnostic at a place of the file; its copy of the text ends with the line of the error.
fn diagnostic(path: &Path, text: &str, mistake: Mistake, name: &At<String>) -> Box<Diagnostic> {
    let Mistake(start, message, help) = mistake;
    let start = text.floor_char_boundary(start);
    let line = text[start..]
        .find('\n')
        .map_or(text.len(), |end| start + end);
    let cell = text[start..line]
        .find([',', '\r'])
        .map_or(line, |end| start + end);
    let span = Span {
        source: Some(Arc::new(Source::new(path, &text[..line]))),
        range: start..cell,
    };
    let error = Diagnostic::new("wrong-points", span, message).help(help);
    Box::new(error.related(name.at.clone(), "named here"))
}

/// Byte offset of a cell of a record, or of the record if its line has quotes.
fn cell_at(text: &str, record: usize, index: usize) -> usize {
    let line = text[record..].lines().next().unwrap_or("");
    if line.contains('"') {
        return record;
    }
    let before: usize = line.split(',').take(index).map(|cell| cell.len() + 1).sum();
    record + before.min(line.len())
}

fn read(text: &str) -> Result<Points, Mistake> {
    let mut reader = csv::ReaderBuilder::new()
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let mark = text.len() - text.trim_start_matches('\u{feff}').len();
    let wrong = |error: csv::Error| {
        let byte = error.position().map_or(0, csv::Position::byte) as usize;
        Mistake(
            byte + mark,
            format!("this is not a CSV table: {error}"),
            HELP,
        )
    };
    let headers = reader.headers().map_err(wrong)?.clone();
    let (places, unused) = columns(&headers, text)?;
    let (mut points, mut record) = (Vec::new(), csv::StringRecord::new());
    while reader.read_record(&mut record).map_err(wrong)? {
        let start = record.position().map_or(0, csv::Position::byte) as usize + mark;
        // The reported position may precede line breaks, which are skipped.
        let blank = text[start..].len() - text[start..].trim_start_matches(['\r', '\n']).len();
        let start = start + blank;
        if points.len() == MOST_ROWS {
            let message = format!("a table of points may have at most {MOST_ROWS} rows");
            return Err(Mistake(
                start,
                message,
                "leave some out, or split it over several files",
            ));
        }
        points.push(point(&record, &places, |index| {
            cell_at(text, start, index)
        })?);
    }
    Ok((points, unused))
}

/// Positions of the known columns, and names of the others.
fn columns(headers: &csv::StringRecord, text: &str) -> Result<(Places, Vec<String>), Mistake> {
    let mut places: Places = [None; COLUMNS.len()];
    let mut unused = Vec::new();
    for (index, name) in headers.iter().enumerate() {
        let place = || cell_at(text, 0, index);
        let lower = name.to_ascii_lowercase();
        match COLUMNS.iter().position(|column| *column == lower) {
            Some(known) if places[known].is_some() => {
                let message = format!("two columns are named {}", quoted(name));
                return Err(Mistake(place(), message, "rename one of them"));
            }
            Some(known) => places[known] = Some(index),
            None => unused.push(name.to_owned()),
        }
    }
    let missing = |column: &str| {
        let first = text.lines().next().unwrap_or("");
        if let Some(sign) = [';', '\t'].into_iter().find(|sign| first.contains(*sign)) {
            let message = format!("columns are divided by {sign:?}, not by `,`");
            let help = "save the table with commas between the columns, and points in numbers";
            return Err(Mistake(first.find(sign).unwrap_or(0), message, help));
        }
        let message = format!("the first line names no column `{column}`");
        Err(Mistake(0, message, HELP))
    };
    let needed: [&[usize]; 3] = [&[0, 1, 2], &[3, 4, 5], &[6, 7, 8, 9]];
    for (group, all) in needed.iter().chain(&[&[11, 12, 13][..]]).enumerate() {
        let is_used = group == 0 || all.iter().any(|column| places[*column].is_some());
        if let Some(column) = all
            .iter()
            .find(|column| is_used && places[**column].is_none())
        {
            return missing(COLUMNS[*column]);
        }
    }
    for (a, b) in [(ROTATION, QUATERNION), (SCALE, SCALES)] {
        if places[a].is_some() && places[b].is_some() {
            let message = format!("`{}` cannot be combined with `{}`", COLUMNS[a], COLUMNS[b]);
            return Err(Mistake(0, message, HELP));
        }
    }
    Ok((places, unused))
}

/// The transform of a row.
fn point(
    record: &csv::StringRecord,
    places: &Places,
    place: impl Fn(usize) -> usize,
) -> Result<Affine3A, Mistake> {
    let number = |column: usize, default: f32| {
        let Some(index) = places[column] else {
            return Ok(default);
        };
        let key = COLUMNS[column];
        let refuse = |what: String| {
            let help = "each row has a number in each column";
            Err(Mistake(
                place(index),
                format!("`{key}` must be a number, {what}"),
                help,
            ))
        };
        match record.get(index) {
            None => refuse("and the row ends before it".to_owned()),
            Some("") => refuse("and is empty".to_owned()),
            Some(text) => match text.parse::<f32>() {
                Ok(x) if x.is_finite() && ANY.contains(f64::from(x)) => Ok(x),
                Ok(_) => refuse(format!("-1e12 to 1e12, not {}", quoted(text))),
                Err(_) => refuse(format!("not {}", quoted(text))),
            },
        }
    };
    let three = |first: usize, default: f32| {
        let [x, y, z] = [0, 1, 2].map(|i| number(first + i, default));
        Ok::<_, Mistake>(Vec3::new(x?, y?, z?))
    };
    let rotation = if places[QUATERNION].is_some() {
        let [x, y, z, w] = [0, 1, 2, 3].map(|i| number(QUATERNION + i, 0.0).map(f64::from));
        let turn = DVec4::new(x?, y?, z?, w?).try_normalize();
        let Some(turn) = turn else {
            let start = place(places[QUATERNION].unwrap_or(0));
            let message = "`qx`, `qy`, `qz` and `qw` must not all be 0".to_owned();
            return Err(Mistake(start, message, "write 0, 0, 0, 1 for no rotation"));
        };
        DQuat::from_vec4(turn).as_quat()
    } else if places[ROTATION].is_some() {
        turned(three(ROTATION, 0.0)?)
    } else {
        Quat::IDENTITY
    };
    let scale = match places[SCALES] {
        Some(_) => three(SCALES, 1.0)?,
        None => Vec3::splat(number(SCALE, 1.0)?),
    };
    let translation = three(0, 0.0)?;
    Ok(Affine3A::from_scale_rotation_translation(
        scale,
        rotation,
        translation,
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mistake(text: &str) -> (usize, String) {
        let Err(Mistake(at, message, _)) = read(text) else {
            panic!("{text:?} is right");
        };
        (at, message)
    }

    #[test]
    fn rows_become_transforms() {
        let text = "\u{feff}z, X,y,rx_deg,ry_deg,rz_deg,scale,id\r\n3,1,2,0,90,0,2,\"a, b\"\r\n\r\n6,4,5,0,0,0,1,c\r\n";
        let (points, unused) = read(text).unwrap_or_else(|m| panic!("{}", m.1));
        assert_eq!((points.len(), unused), (2, vec!["id".to_owned()]));
        let at = points[0].transform_point3(Vec3::X);
        assert!(at.distance(Vec3::new(1.0, 2.0, 1.0)) < 1e-5, "{at}");
        assert_eq!(points[1].translation, glam::Vec3A::new(4.0, 5.0, 6.0));
        let (points, _) = read("x,y,z,qx,qy,qz,qw,sx,sy,sz\n0,0,0,0,2,0,0,1,2,3\n")
            .unwrap_or_else(|m| panic!("{}", m.1));
        let at = points[0].transform_point3(Vec3::ONE);
        assert!(at.distance(Vec3::new(-1.0, 2.0, -3.0)) < 1e-5, "{at}");
        assert_eq!(read("x,y,z\n").map(|p| p.0.len()).ok(), Some(0));
    }

    /// Lines of `points.txt`: a table, and the place and a part of the message of its mistake.
    #[test]
    fn mistakes_are_at_their_cells() {
        for case in include_str!("points.txt").lines() {
            let (text, place) = case.split_once(" => ").expect(case);
            let (at, says) = place.split_once(' ').expect(case);
            let text = &text.replace("\\r", "\r").replace("\\n", "\n");
            let (found, message) = mistake(text);
            assert!(message.contains(says), "{text:?}: {message}");
            assert_eq!(found.to_string(), at, "{text:?}: {message}");
        }
    }

    #[test]
    fn too_many_rows_are_refused() {
        let text = format!("x,y,z\n{}", "1,2,3\n".repeat(MOST_ROWS + 1));
        let (at, message) = mistake(&text);
        assert_eq!(at, 6 + 6 * MOST_ROWS);
        assert!(message.contains("at most 1000000 rows"), "{message}");
    }
}
