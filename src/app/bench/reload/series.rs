//! Saves of one kind of edit, their statistics, and the table of all kinds.

use std::fmt::Write as _;

use serde::Serialize;

use super::copy::Edit;
use crate::bench::summary::{Spread, digits};

/// Name of a part of a save's time and the function that takes it from a sample, milliseconds.
pub type NamedPart<S> = (&'static str, fn(&S) -> f64);

/// Times of one save.
pub trait Timed: Sized + Serialize + 'static {
    /// Columns of the table.
    const PARTS: &'static [NamedPart<Self>];
    /// Name of the part that has a target.
    const JUDGED: &'static str;
    /// Explanation of the columns.
    const LEGEND: &'static str;

    /// Target of that part in 95 of 100 saves, milliseconds.
    fn target_ms(edit: Edit) -> f64;
}

/// Saves of one kind of edit.
#[derive(Debug, Serialize)]
pub struct Series<S> {
    /// Kind of the edit.
    pub edit: &'static str,
    /// Path of the edited file, below the copy's folder.
    pub file: String,
    /// Target of the judged part in 95 of 100 saves, milliseconds.
    pub target_ms: f64,
    /// Name, median and 95th percentile of each part, milliseconds; no percentile below 20 saves.
    pub parts: Vec<Part>,
    /// Times of every save.
    pub samples: Vec<S>,
}

/// Statistics of one part over all saves.
#[derive(Debug, Serialize)]
pub struct Part {
    /// Name, such as `notice_ms`.
    pub name: &'static str,
    /// Median, milliseconds.
    pub p50: f64,
    /// 95th percentile, milliseconds.
    pub p95: Option<f64>,
}

impl<S: Timed> Series<S> {
    /// Saves of this kind of edit of a file.
    pub fn new(edit: Edit, file: String, samples: Vec<S>) -> Self {
        let part = |(name, of): &NamedPart<S>| {
            let spread = Spread::from_values(samples.iter().map(of).collect())?;
            Some(Part {
                name,
                p50: spread.median,
                p95: spread.p5_p95.map(|[_, p95]| p95),
            })
        };
        Self {
            edit: edit.name(),
            file,
            target_ms: S::target_ms(edit),
            parts: S::PARTS.iter().filter_map(part).collect(),
            samples,
        }
    }
}

/// Table for people: a row for each percentile of each kind of edit.
pub fn table<S: Timed>(series: &[Series<S>]) -> String {
    let mut text = format!("{:<22}{:>5}", "milliseconds", "");
    // Writing to a string cannot fail.
    for (name, _) in S::PARTS {
        let _ = write!(text, "{:>9}", name.trim_end_matches("_ms"));
    }
    text.push('\n');
    for one in series {
        for is_p95 in [false, true] {
            let (what, percentile) = match is_p95 {
                false => (format!("{} edit", one.edit), "p50"),
                true => (one.file.clone(), "p95"),
            };
            let _ = write!(text, "{what:<22}{percentile:>5}");
            for part in &one.parts {
                let value = if is_p95 { part.p95 } else { Some(part.p50) };
                let value = value.map_or("–".to_owned(), digits);
                let _ = write!(text, "{value:>9}");
            }
            text.push('\n');
        }
        let judged = one.parts.iter().find(|part| part.name == S::JUDGED);
        if let Some(p95) = judged.and_then(|part| part.p95) {
            let word = if p95 < one.target_ms { "met" } else { "missed" };
            let name = S::JUDGED.trim_end_matches("_ms");
            let _ = writeln!(text, "{:>27} {name} below {} ms: {word}", "", one.target_ms);
        }
    }
    text.push('\n');
    text.push_str(S::LEGEND);
    text
}

#[cfg(test)]
mod tests {
    use super::{super::measure::Sample, *};

    #[test]
    fn the_table_names_the_target_where_there_is_a_percentile() {
        let sample = Sample {
            notice_ms: 11.0,
            parse_ms: 2.0,
            build_ms: 3.0,
            driver_ms: 40.0,
            frame_ms: 500.0,
            pipelines: 1,
        };
        assert!((sample.ready_ms() - 16.0).abs() < 1e-9);
        assert!((sample.total_ms() - 556.0).abs() < 1e-9);
        let part = |p95| Part {
            name: "ready_ms",
            p50: 16.0,
            p95,
        };
        let mut series = vec![Series {
            edit: "text",
            file: "scene.toml".to_owned(),
            target_ms: 100.0,
            parts: vec![part(Some(99.0))],
            samples: vec![sample],
        }];
        assert!(table(&series).contains("ready below 100 ms: met"));
        series[0].parts[0] = part(Some(101.0));
        assert!(table(&series).contains("ready below 100 ms: missed"));
        series[0].parts[0] = part(None);
        assert!(!table(&series).contains("ready below") && table(&series).contains("–"));
    }
}
