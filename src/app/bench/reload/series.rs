//! Saves of one kind of edit, their statistics, and the table of all kinds.

use std::collections::BTreeMap;

use serde::Serialize;

use super::copy::Edit;
use crate::bench::summary::{Spread, digits};

/// Times of one save by the names of its parts, milliseconds, and counts.
pub type Sample = BTreeMap<&'static str, f64>;

/// Parts of a save that are told.
#[derive(Debug)]
pub struct Measurement {
    /// Columns of the table.
    pub parts: &'static [&'static str],
    /// Name of the part that has a target.
    pub judged: &'static str,
    /// Target of that part in 95 of 100 saves of texts, and of shaders, milliseconds.
    pub target_ms: [f64; 2],
    /// Explanation of the columns.
    pub legend: &'static str,
}

/// Saves of one kind of edit.
#[derive(Debug, Serialize)]
pub struct Series {
    /// Kind of the edit.
    pub edit: &'static str,
    /// Path of the edited file, below the copy's folder.
    pub file: String,
    /// Target of the judged part in 95 of 100 saves, milliseconds.
    pub target_ms: f64,
    /// Name, median and 95th percentile of each part, milliseconds; no percentile below 20 saves.
    pub parts: Vec<Part>,
    /// Every save.
    pub samples: Vec<Sample>,
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

impl Series {
    /// Saves of this kind of edit of a file.
    pub fn new(edit: Edit, file: String, samples: Vec<Sample>, what: &Measurement) -> Self {
        let part = |name: &&'static str| {
            let values = samples
                .iter()
                .filter_map(|sample| sample.get(name).copied());
            let spread = Spread::from_values(values.collect())?;
            Some(Part {
                name,
                p50: spread.median,
                p95: spread.p5_p95.map(|[_, p95]| p95),
            })
        };
        let is_shader = matches!(edit, Edit::Shader(_));
        Self {
            edit: edit.name(),
            file,
            target_ms: what.target_ms[usize::from(is_shader)],
            parts: what.parts.iter().filter_map(part).collect(),
            samples,
        }
    }
}

/// Table for people: a row for each percentile of each kind of edit.
pub fn table(series: &[Series], what: &Measurement) -> String {
    let mut text = format!("{:<22}{:>5}", "milliseconds", "");
    for name in what.parts {
        text += &format!("{:>9}", name.trim_end_matches("_ms"));
    }
    text.push('\n');
    for one in series {
        for is_p95 in [false, true] {
            let (what, percentile) = match is_p95 {
                false => (format!("{} edit", one.edit), "p50"),
                true => (one.file.clone(), "p95"),
            };
            text += &format!("{what:<22}{percentile:>5}");
            for part in &one.parts {
                let value = if is_p95 { part.p95 } else { Some(part.p50) };
                let value = value.map_or("–".to_owned(), digits);
                text += &format!("{value:>9}");
            }
            text.push('\n');
        }
        let judged = one.parts.iter().find(|part| part.name == what.judged);
        if let Some(p95) = judged.and_then(|part| part.p95) {
            let word = if p95 < one.target_ms { "met" } else { "missed" };
            let name = what.judged.trim_end_matches("_ms");
            text += &format!("{:>27} {name} below {} ms: {word}\n", "", one.target_ms);
        }
    }
    text.push('\n');
    text.push_str(what.legend);
    text
}

#[cfg(test)]
mod tests {
    use super::{super::measure::PREVIEW, *};

    #[test]
    fn the_table_names_the_target_where_there_is_a_percentile() {
        let series = |saves: usize, ready_ms: f64| {
            let samples = vec![Sample::from([("ready_ms", ready_ms)]); saves];
            let one = Series::new(Edit::Text, "scene.toml".to_owned(), samples, &PREVIEW);
            table(&[one], &PREVIEW)
        };
        assert!(series(20, 99.0).contains("ready below 100 ms: met"));
        assert!(series(20, 101.0).contains("ready below 100 ms: missed"));
        let few = series(1, 16.0);
        assert!(!few.contains("ready below") && few.contains("–"), "{few}");
    }
}
