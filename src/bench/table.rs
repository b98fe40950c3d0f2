//! The result of `compare` as a table for people and as JSON.

use std::fmt::{self, Write};

use serde::Serialize;

use super::metric::{Scores, table::METRICS};

/// What `compare` found. Serializes to the JSON that `--json` prints; infinite numbers (the PSNR
/// of equal pictures) become null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// The judged picture's file.
    pub test: String,
    /// The reference's file.
    pub reference: String,
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Whether no pixel differs at all.
    pub identical: bool,
    /// Scores of the whole frame.
    pub frame: Scores,
    /// Scores inside the mask; none without a mask.
    pub mask: Option<MaskReport>,
    /// The factor of the difference picture; none when it was not asked for.
    pub difference_gain: Option<u32>,
    /// How the files were read, in sentences.
    pub notes: Vec<String>,
    /// A sentence per threshold that was crossed or could not be judged; empty is a pass.
    pub crossed: Vec<String>,
}

/// The mask and the scores inside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MaskReport {
    /// Pixels left after erosion.
    pub area_px: usize,
    /// The same over the frame, 0 to 1.
    pub area_share: f64,
    /// The scores, if there are.
    #[serde(flatten)]
    pub scores: MaskScores,
}

/// Scores, or why there are none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MaskScores {
    /// Enough pixels: their scores.
    Scored(Scores),
    /// Under 100 pixels: a sentence.
    TooSmall(String),
}

impl Comparison {
    /// Whether every threshold held.
    pub fn passed(&self) -> bool {
        self.crossed.is_empty()
    }

    /// One JSON object, indented, with a line break at its end.
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

/// A row of the table.
type Row = (&'static str, fn(&Scores) -> String);

const AREA_ROWS: [Row; 2] = [
    ("area, px", |s| s.area_px.to_string()),
    ("area, % of the frame", |s| {
        format!("{:.2}", 100.0 * s.area_share)
    }),
];

/// The cells of one row.
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
