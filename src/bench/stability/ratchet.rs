//! Ratchet file: the worst score that each cell may have, which is only ever tightened.

use std::{io, path::Path};

use serde::Deserialize;

use super::{Cell, CellScores, ReferenceKind, find};
use crate::sample::curve::series_names;
use reflet_base::files::{open_regular, read_at_most};
use reflet_metric::file_error;
use reflet_scene::diagnostic::Diagnostic;

/// Tolerance of a score for other drivers, as a share of the allowed score; the largest tolerance applies.
const SLACK: f64 = 0.05;
/// Tolerance of a score, as a number of pixels.
const SLACK_PX: f64 = 3.0;
/// Tolerance of the 99th percentile of FLIP, absolute, since no number of pixels bounds it.
const SLACK_P99: f64 = 0.02;
/// Largest size of a file that is read, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Comment at the top of every ratchet file.
const HEAD: &str = "\
# The worst scores that stills of the failure modes may have. `reflet bench stability --ratchet FILE`
# fails where one is worse by more than 5 % or 3 pixels (of flip_p99: 0.02); with --tighten it writes
# better ones. Loosen a number only with the reason in the commit.
";

/// A ratchet file.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Ratchet {
    /// Width and height of the stills, pixels.
    pub size: [u32; 2],
    /// Cells, in the order of the file.
    #[serde(default, rename = "cell")]
    pub cells: Vec<Allowed>,
}

/// Worst allowed scores of a cell, for stills against `rt`.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Allowed {
    /// Mode, such as `03-rails`.
    pub mode: String,
    /// Method, one of [`series_names`].
    pub method: String,
    /// Mean FLIP inside the reflections.
    pub flip: f64,
    /// 99th percentile of FLIP inside the reflections.
    pub flip_p99: f64,
    /// Number of answers of the march that a ray contradicts, pixels.
    pub false_accepts_px: Option<u64>,
    /// Number of specks inside the reflections, pixels.
    pub specks_px: Option<u64>,
}

impl Ratchet {
    /// Reads a file; none where there is no such file.
    ///
    /// # Errors
    /// A file that cannot be read or is no ratchet, with the line.
    pub fn read(path: &Path) -> Result<Option<Self>, Box<Diagnostic>> {
        let read = open_regular(path, false).and_then(|file| read_at_most(&file, MAX_BYTES));
        let bytes = match read {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            read => read.map_err(|error| {
                let message = format!("cannot be read: {error}");
                file_error("unreadable-ratchet", path, message, "check the path")
            })?,
        };
        let text = String::from_utf8_lossy(&bytes);
        let ratchet = toml::from_str(&text).map_err(|error: toml::de::Error| {
            let start = error.span().map_or(0, |span| span.start.min(text.len()));
            let before = &text.as_bytes()[..start];
            let line = 1 + before.iter().filter(|b| **b == b'\n').count();
            let message = format!("line {line}: {}", error.message());
            let help = "write it with `reflet bench stability --ratchet FILE --tighten`";
            file_error("bad-ratchet", path, message, help)
        })?;
        Ok(Some(ratchet))
    }

    /// Text of the file.
    pub fn text(&self) -> String {
        let [width, height] = self.size;
        let mut out = format!("{HEAD}size = [{width}, {height}]\n\ncell = [\n");
        for cell in &self.cells {
            out += &format!(
                "    {{ mode = \"{}\", method = \"{}\", flip = {:?}, flip_p99 = {:?}",
                cell.mode, cell.method, cell.flip, cell.flip_p99
            );
            for (name, pixels) in [
                ("false_accepts_px", cell.false_accepts_px),
                ("specks_px", cell.specks_px),
            ] {
                if let Some(pixels) = pixels {
                    out += &format!(", {name} = {pixels}");
                }
            }
            out += " },\n";
        }
        out + "]\n"
    }

    /// Names of the modes of its cells, each once.
    pub fn modes(&self) -> Vec<String> {
        let mut modes: Vec<String> = self.cells.iter().map(|c| c.mode.clone()).collect();
        modes.sort();
        modes.dedup();
        modes
    }

    /// Sentences on everything worse than allowed: scores of the measured modes and methods, and cells of these
    /// that were not measured, as when a method was renamed.
    pub fn regressions(&self, modes: &[&str], methods: &[&str], cells: &[Cell]) -> Vec<String> {
        let mut worse = Vec::new();
        let is_asked = |cell: &&Allowed| {
            let method = cell.method.as_str();
            let is_left_out =
                series_names().any(|name| name == method) && !methods.contains(&method);
            modes.contains(&cell.mode.as_str()) && !is_left_out
        };
        for allowed in self.cells.iter().filter(is_asked) {
            let name = format!("{}, {}", allowed.mode, allowed.method);
            let cell = find(cells, &allowed.mode, &allowed.method, ReferenceKind::Rt);
            match cell.map(|cell| &cell.scores) {
                None => worse.push(format!("{name}: not measured any more")),
                Some(Err(why)) => worse.push(format!("{name}: no score: {why}")),
                Some(Ok(scores)) => {
                    let over = allowed.over(scores);
                    worse.extend(over.into_iter().map(|what| format!("{name}: {what}")));
                }
            }
        }
        worse
    }

    /// Replaces scores by better ones and adds missing cells; returns the number of changed
    /// numbers and cells.
    pub fn tighten(&mut self, cells: &[Cell]) -> usize {
        let mut changed = 0;
        for cell in cells
            .iter()
            .filter(|cell| cell.against == ReferenceKind::Rt)
        {
            let Ok(scores) = &cell.scores else { continue };
            let measured = Allowed {
                mode: cell.mode.clone(),
                method: cell.method.clone(),
                flip: rounded_up(scores.flip),
                flip_p99: rounded_up(scores.flip_p99),
                false_accepts_px: scores.false_accepts_px,
                specks_px: scores.specks_px,
            };
            let is_known = |a: &&mut Allowed| (&a.mode, &a.method) == (&cell.mode, &cell.method);
            match self.cells.iter_mut().find(is_known) {
                Some(allowed) => changed += allowed.lower(&measured),
                None => {
                    self.cells.push(measured);
                    changed += 1;
                }
            }
        }
        self.cells.sort_by(|a, b| a.mode.cmp(&b.mode)); // methods keep their order
        changed
    }
}

impl Allowed {
    /// Names of the scores that are worse than allowed; a score that is NaN or missing counts as worse.
    fn over(&self, scores: &CellScores) -> Vec<String> {
        let slack_share = SLACK_PX / scores.mask_px.max(1) as f64;
        let count = |pixels: Option<u64>| pixels.map(|px| px as f64);
        let (accepts, specks) = (scores.false_accepts_px, scores.specks_px);
        let checks = [
            ("flip", Some(scores.flip), Some(self.flip), slack_share),
            (
                "flip_p99",
                Some(scores.flip_p99),
                Some(self.flip_p99),
                SLACK_P99,
            ),
            (
                "false_accepts_px",
                count(accepts),
                count(self.false_accepts_px),
                SLACK_PX,
            ),
            ("specks_px", count(specks), count(self.specks_px), SLACK_PX),
        ];
        let mut over = Vec::new();
        for (what, measured, allowed, slack) in checks {
            let Some(allowed) = allowed else { continue };
            let limit = (allowed * (1.0 + SLACK)).max(allowed + slack);
            match measured {
                Some(measured) if measured <= limit => {}
                Some(measured) => over.push(format!(
                    "{what} is {measured:.4}, allowed is {allowed:.4}, with slack {limit:.4}"
                )),
                None => over.push(format!("{what} has no value")),
            }
        }
        over
    }

    /// Lowers scores to better measured ones; returns the number of changed numbers.
    fn lower(&mut self, measured: &Self) -> usize {
        fn lower<T: Copy>(allowed: &mut T, measured: T, is_better: impl Fn(T, T) -> bool) -> usize {
            let is_changed = is_better(measured, *allowed);
            if is_changed {
                *allowed = measured;
            }
            usize::from(is_changed)
        }
        let less = |measured: f64, allowed: f64| measured < allowed;
        let fewer = |measured: Option<u64>, allowed: Option<u64>| {
            measured.is_some_and(|px| allowed.is_none_or(|allowed| px < allowed))
        };
        lower(&mut self.flip, measured.flip, less)
            + lower(&mut self.flip_p99, measured.flip_p99, less)
            + lower(&mut self.false_accepts_px, measured.false_accepts_px, fewer)
            + lower(&mut self.specks_px, measured.specks_px, fewer)
    }
}

/// Rounds up to five decimals, so that files stay short.
fn rounded_up(value: f64) -> f64 {
    (value * 1e5).ceil() / 1e5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(flip: f64, accepts: u64) -> Cell {
        Cell {
            mode: "03-rails".to_owned(),
            method: "hybrid".to_owned(),
            against: ReferenceKind::Rt,
            scores: Ok(CellScores {
                frames: 1,
                mask_px: 1000,
                flip,
                flip_p99: 0.5,
                false_accepts_px: Some(accepts),
                specks_px: Some(2),
                ..CellScores::default()
            }),
        }
    }

    fn ratchet(flip: f64, accepts: u64) -> Ratchet {
        let mut ratchet = Ratchet {
            size: [160, 90],
            cells: Vec::new(),
        };
        assert_eq!(ratchet.tighten(&[cell(flip, accepts)]), 1);
        ratchet
    }

    #[test]
    fn the_slack_is_five_percent_or_three_pixels() {
        let worse = |ratchet: &Ratchet, cell| {
            ratchet
                .regressions(&["03-rails"], &["hybrid"], &[cell])
                .len()
        };
        let coarse = ratchet(0.1, 100);
        assert_eq!(worse(&coarse, cell(0.1049, 105)), 0);
        assert_eq!(worse(&coarse, cell(0.1051, 106)), 2);
        let fine = ratchet(0.001, 1);
        assert_eq!(worse(&fine, cell(0.0039, 4)), 0);
        assert_eq!(worse(&fine, cell(0.0041, 5)), 2);
        assert_eq!(worse(&fine, cell(f64::NAN, 0)), 1);
        let mut specked = cell(0.001, 1);
        if let Ok(scores) = &mut specked.scores {
            scores.specks_px = Some(6);
        }
        assert_eq!(worse(&fine, specked), 1);
    }

    #[test]
    fn what_is_not_scored_is_a_regression() {
        let ratchet = ratchet(0.1, 0);
        let says = |cells: &[Cell]| {
            ratchet
                .regressions(&["03-rails"], &["hybrid"], cells)
                .join("; ")
        };
        assert_eq!(says(&[]), "03-rails, hybrid: not measured any more");
        let mut failed = cell(0.0, 0);
        failed.scores = Err("frame 0: not measured".to_owned());
        let expected = "03-rails, hybrid: no score: frame 0: not measured";
        assert_eq!(says(&[failed]), expected);
        let others = [
            ratchet.regressions(&["04-grazing"], &["hybrid"], &[]),
            ratchet.regressions(&["03-rails"], &["ssr", "rt"], &[]),
        ];
        assert!(others.concat().is_empty(), "{others:?}");
        let mut renamed = ratchet.clone();
        renamed.cells[0].method = "hybird".to_owned();
        assert_eq!(renamed.regressions(&["03-rails"], &["ssr"], &[]).len(), 1);
    }

    #[test]
    fn tightening_never_loosens_and_survives_the_file() {
        let mut ratchet = ratchet(0.1, 10);
        assert_eq!(ratchet.tighten(&[cell(0.2, 20)]), 0);
        assert_eq!(ratchet.tighten(&[cell(0.05, 20)]), 1);
        let allowed = &ratchet.cells[0];
        assert_eq!((allowed.flip, allowed.false_accepts_px), (0.05, Some(10)));
        assert_eq!(toml::from_str::<Ratchet>(&ratchet.text()), Ok(ratchet));
    }
}
