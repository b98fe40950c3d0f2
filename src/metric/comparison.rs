//! Result of `compare`, as a table for people and as JSON.

use std::fmt::{self, Write};

use serde::Serialize;

use crate::{
    Maps, Scores,
    mask::{MIN_AREA_PX, Mask},
    picture::{Encoding, Pair},
    read::Reading,
    table::METRICS,
};

/// Result of `compare`. Serializes to the JSON that `--json` prints; infinite numbers (the PSNR
/// of equal pictures) become null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// File of the tested picture.
    pub test: String,
    /// File of the reference.
    pub reference: String,
    /// Width, pixels.
    pub width: usize,
    /// Height, pixels.
    pub height: usize,
    /// Whether all pixels are equal.
    pub identical: bool,
    /// Scores of the whole frame.
    pub frame: Scores,
    /// Scores inside the mask; none without a mask.
    pub mask: Option<MaskReport>,
    /// Contrast gain of the difference picture; none when it was not requested.
    pub difference_gain: Option<u32>,
    /// Sentences on how the files were read.
    pub notes: Vec<String>,
    /// Sentences on thresholds that were crossed or could not be checked; empty when all hold.
    pub crossed: Vec<String>,
}

/// The mask and the scores inside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaskReport {
    /// Number of pixels left after erosion.
    pub area_px: usize,
    /// Share of these pixels in the frame, 0 to 1.
    pub area_share: f64,
    /// Scores, if the mask is large enough.
    #[serde(flatten)]
    pub scores: MaskScores,
}

/// Scores inside a mask, or the reason why there are none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MaskScores {
    /// Scores of a mask with enough pixels.
    Scored(Scores),
    /// Sentence on a mask with fewer than 100 pixels.
    TooSmall(String),
}

impl Comparison {
    /// Whether every threshold held.
    pub fn passed(&self) -> bool {
        self.crossed.is_empty()
    }

    /// Formats the result as one JSON object, indented, with a line break at its end.
    pub fn to_json(&self) -> String {
        let json = serde_json::to_string_pretty(self);
        json.expect("strings and numbers have a JSON form") + "\n"
    }

    fn columns(&self) -> Vec<(&'static str, &Scores)> {
        let mut columns = vec![("frame", &self.frame)];
        if let Some(MaskScores::Scored(scores)) = self.mask.as_ref().map(|m| &m.scores) {
            columns.push(("inside mask", scores));
        }
        columns
    }
}

/// Label of a row and the function that formats its cells.
type Row = (&'static str, fn(&Scores) -> String);

const AREA_ROWS: [Row; 2] = [
    ("area, px", |s| s.area_px.to_string()),
    ("area, % of the frame", |s| {
        format!("{:.2}", 100.0 * s.area_share)
    }),
];

/// Cells of one row.
fn row(
    table: &mut String,
    name: &str,
    columns: &[(&str, &Scores)],
    cell: impl Fn(&Scores) -> String,
) -> fmt::Result {
    write!(table, "\n{name:24}")?;
    columns
        .iter()
        .try_for_each(|(_, s)| write!(table, "{:>18}", cell(s)))
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "A  {}", self.test)?;
        writeln!(f, "B  {} (reference)", self.reference)?;
        let equal = if self.identical {
            ", equal in every pixel"
        } else {
            ""
        };
        writeln!(f, "   {} × {} px{equal}\n", self.width, self.height)?;
        let columns = self.columns();
        let mut table = String::new();
        write!(table, "{:24}", "")?;
        columns
            .iter()
            .try_for_each(|(name, _)| write!(table, "{name:>18}"))?;
        for (name, cell) in AREA_ROWS {
            row(&mut table, name, &columns, cell)?;
        }
        for metric in &METRICS {
            row(&mut table, metric.label, &columns, |s| {
                (metric.score)(s).map_or("needs 11 × 11 px".to_owned(), metric.text)
            })?;
        }
        writeln!(f, "{table}\n")?;
        if let Some(MaskScores::TooSmall(why)) = self.mask.as_ref().map(|m| &m.scores) {
            writeln!(f, "mask: {why}")?;
        }
        if let Some(gain) = self.difference_gain {
            writeln!(f, "difference picture: enlarged {gain} times")?;
        }
        self.notes
            .iter()
            .try_for_each(|note| writeln!(f, "note: {note}"))?;
        self.crossed
            .iter()
            .try_for_each(|line| writeln!(f, "FAILED: {line}"))
    }
}

/// Scores of a pair of pictures of the frame, and inside a mask if there is one; no names, notes and thresholds.
pub fn scored(pair: &Pair, maps: &Maps, mask: Option<&Mask>) -> Comparison {
    let frame = maps.scores(None);
    Comparison {
        test: String::new(),
        reference: String::new(),
        width: pair.test().width(),
        height: pair.test().height(),
        identical: frame.max_difference == 0.0 && frame.rel_mse == 0.0,
        crossed: Vec::new(),
        mask: mask.map(|mask| score_mask(maps, mask)),
        frame,
        difference_gain: None,
        notes: Vec::new(),
    }
}

fn score_mask(maps: &Maps, mask: &Mask) -> MaskReport {
    let area_px = mask.area();
    let area_share = area_px as f64 / mask.inside().len() as f64;
    let scores = if mask.is_scorable() {
        MaskScores::Scored(maps.scores(Some(mask)))
    } else {
        MaskScores::TooSmall(format!(
            "{area_px} px are left of the mask, under {MIN_AREA_PX}: too small to score"
        ))
    };
    MaskReport {
        area_px,
        area_share,
        scores,
    }
}

/// Sentences about how two pictures were read, and the meaning for their scores.
pub fn notes(test: &Reading, reference: &Reading) -> Vec<String> {
    let mut notes = [&test.notes[..], &reference.notes[..]].concat();
    let encodings = [test, reference].map(|r| r.picture.encoding());
    if encodings[0] != encodings[1] {
        let [linear, display] = if encodings[0] == Encoding::Linear {
            ["A", "B"]
        } else {
            ["B", "A"]
        };
        notes.push(format!(
            "{linear} is linear and {display} display-referred: exposure and tone mapping that \
             only {display} went through count as errors"
        ));
    }
    let over = [test, reference].map(|r| r.picture.over_white());
    if over != [0, 0] {
        notes.push(format!(
            "{} pixels of A and {} of B exceed display white; only relMSE sees by how much",
            over[0], over[1]
        ));
    }
    if [test, reference]
        .iter()
        .any(|r| r.picture.encoding() == Encoding::Display)
    {
        notes.push(
            "relMSE of PNG pictures is taken on their sRGB values decoded to linear light, which \
             end at 1"
                .to_owned(),
        );
    }
    notes.dedup();
    notes
}
