//! Ranges of the cells of a table of samples: a table that was edited or damaged must not become a
//! chart.

use std::collections::HashMap;

use super::{Sample, curve::compared_methods};
use crate::{csv::CsvError, parameter::Parameter};
use reflet_metric::{
    mask::MIN_AREA_PX,
    table::{self, ROUNDING},
};

/// Checks the text of a cell; an empty one is a missing value.
///
/// # Errors
/// Message with the expected value.
pub fn cell(column: &str, text: &str) -> Result<(), String> {
    if text.is_empty() {
        return Ok(());
    }
    match column {
        "method" => named(text, &compared_methods().collect::<Vec<_>>()),
        "parameter" => named(text, &Parameter::ALL.map(Parameter::name)),
        _ => match (range(column), text.parse::<f64>()) {
            (Some((low, high, words)), Ok(value)) if !(low..=high).contains(&value) => {
                Err(words.to_owned())
            }
            _ => Ok(()),
        },
    }
}

fn named(text: &str, names: &[&str]) -> Result<(), String> {
    if names.contains(&text) {
        Ok(())
    } else {
        Err(names.join(", "))
    }
}

/// Least and most value of a column, and the name of the range in messages. NaN is in no range.
fn range(column: &str) -> Option<(f64, f64, &'static str)> {
    const MOST: (f64, f64, &str) = (0.0, f64::MAX, "a finite number, 0 or more");
    let in_mask = column.strip_prefix("mask_").unwrap_or(column);
    if let Some((_, metric)) = table::columns().find(|(name, _)| *name == in_mask) {
        return Some(metric.range);
    }
    Some(match in_mask {
        "width" | "height" => (1.0, f64::MAX, "1 or more"),
        "scale" => (f64::MIN_POSITIVE, 1.0, "above 0, up to 1"),
        "exposure_ev" | "value" => (f64::MIN, f64::MAX, "a finite number"),
        "temporal_difference" | "temporal_change" => MOST,
        "edge_flip" | "inner_flip" => (0.0, 1.0, "0 to 1"),
        "seam_step" | "probe_seam_step" => (-255.0, 255.0, "-255 to 255"),
        "stripes" => (-1.0, 1.0 + ROUNDING, "-1 to 1"),
        _ if column.ends_with("_percent") => (0.0, 100.0 + ROUNDING, "0 to 100"),
        _ if ["_ms", "_px", "_u", "_m"]
            .iter()
            .any(|unit| column.ends_with(unit)) =>
        {
            MOST
        }
        _ if super::detail_columns().iter().any(|name| name == column) => MOST,
        "roughness_cutoff" => MOST,
        _ => return None,
    })
}

/// Columns of texts that older tables lack; their cells are then empty.
pub const NEWER: [&str; 3] = ["accept", "content", "turn"];

/// Checks that cells of a sample agree with each other.
///
/// # Errors
/// Message with the column.
pub fn whole(s: &Sample) -> Result<(), String> {
    let mut columns = table::columns().map(|(name, _)| format!("mask_{name}"));
    let scored = columns.find(|column| s.number(column).is_some_and(Option::is_some));
    match scored {
        Some(column) if s.mask_px < MIN_AREA_PX as u64 => Err(format!(
            "column {column} holds a score, but column mask_px is {}: under {MIN_AREA_PX} px are \
             not scored",
            s.mask_px
        )),
        _ => Ok(()),
    }
}

/// Checks that no frame is listed twice; the first sample is on line 2 of the file.
///
/// # Errors
/// Line of the repeated sample.
pub fn repeated(samples: &[Sample]) -> Result<(), CsvError> {
    let mut known = HashMap::new();
    for (line, s) in samples.iter().enumerate().map(|(index, s)| (index + 2, s)) {
        if let Some(first) = known.insert((&s.fingerprint, s.repetition), line) {
            let message = format!(
                "columns fingerprint and repetition name the same frame as line {first}: {}, {}",
                s.fingerprint, s.repetition
            );
            return Err(CsvError { line, message });
        }
    }
    Ok(())
}
