//! Scores of failure modes: summarizes a scene's samples by each method as one cell of a table of modes
//! × methods.

pub mod ratchet;
#[cfg(test)]
mod tests;
pub mod verdict;

use std::fmt;

use verdict::band;

use super::{
    cell::columns,
    csv,
    run::FrameSeries,
    sample::{Sample, curve::series},
};
use crate::report::chart::escape;
use reflet_metric::{mask::MIN_AREA_PX, temporal};

/// Reference of the pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReferenceKind {
    /// Method `rt` with the same samples.
    Rt,
    /// Method `rt` with many samples and shadows by rays, at the origin: shows the errors of `rt`, too.
    Truth,
}

/// A failure mode, or a user's own scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mode {
    /// Name of the scene file without its ending, such as `03-rails`.
    pub name: String,
    /// First comment of the scene: the failure and how it looks.
    pub about: String,
    /// Measurements of the mode.
    pub parts: Vec<Part>,
}

/// Measured frames that are pooled in a cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Reference of the pictures.
    pub against: ReferenceKind,
    /// Name of the scene in samples.
    pub scene: String,
    /// Hash of the scene's content in samples.
    pub content: String,
    /// Size of the pictures.
    pub size: [u32; 2],
    /// Numbers of the measured frames of its timeline.
    pub frames: Vec<u32>,
}

/// Scores of a method in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Name of the mode, [`Mode::name`].
    pub mode: String,
    /// Method, one of [`series_names`](super::sample::curve::series_names).
    pub method: String,
    /// Reference of its pictures.
    pub against: ReferenceKind,
    /// Scores, or the reason why there are none.
    pub scores: Result<CellScores, String>,
}

columns! {
    /// Scores inside the reflective pixels, pooled over all frames and sizes. Scores of the structure of errors are
    /// means over the pictures that have the score, none where no picture has it (see [`reflet_metric::structure`]).
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct CellScores {
        /// Number of scored pictures.
        pub frames: usize,
        /// Number of scored pixels of the picture that has the fewest.
        pub mask_px: u64,
        /// Mean FLIP, 0 to 1.
        pub flip: f64,
        /// Largest 99th percentile of FLIP of a picture, 0 to 1.
        pub flip_p99: f64,
        /// Picture with the largest 99th percentile of FLIP.
        pub worst: Place,
        /// Mean SSIM; none where a picture is too small for it.
        pub ssim: Option<f64>,
        /// Mean relMSE.
        pub rel_mse: f64,
        /// Number of specks, pixels; none in tables that lack the column.
        pub specks_px: Option<u64>,
        /// Number of answers of the march that a ray contradicts, pixels; none where nothing marches.
        pub false_accepts_px: Option<u64>,
        /// False accepts per reflective pixel, ‰.
        pub false_accepts_permille: Option<f64>,
        /// Flicker of an animation: Σ |Δtest − Δrt| over Σ |Δrt| inside the masks of its frames.
        pub flicker: Option<f64>,
        /// Popping of an animation: largest |Δtest − Δrt| of a frame over the largest |Δrt| of one, inside the masks.
        pub popping: Option<f64>,
        /// Reflective pixels that were traced, percent.
        pub traced_percent: f64,
        /// Mean FLIP within 3 px of edges in the reflections.
        pub edge_flip: Option<f64>,
        /// Mean FLIP elsewhere in the reflections.
        pub inner_flip: Option<f64>,
        /// Share of the pixels of objects 1 px thin that show the object, percent.
        pub recall_1px_percent: Option<f64>,
        /// Share of the pixels of objects 2 px thin that show the object, percent.
        pub recall_2px_percent: Option<f64>,
        /// Share of the pixels of objects 4 px thin that show the object, percent.
        pub recall_4px_percent: Option<f64>,
        /// Signed step between marched and traced pixels, display code values.
        pub seam_step: Option<f64>,
        /// Step along borders between probes, display code values; see [`seams`](super::seams).
        pub probe_seam_step: Option<f64>,
        /// Distance at which the autocorrelation of the error falls below 1 / e, pixels.
        pub error_length_px: Option<f64>,
        /// Largest autocorrelation beyond its first zero.
        pub stripes: Option<f64>,
        /// Share of pixels that change between march and ray as the camera moves by 1e-4 U, percent; of stills only.
        pub source_changes_percent: Option<f64>,
        /// Share of pixels whose ray then hits another instance, percent; of stills only.
        pub met_changes_percent: Option<f64>,
    }
}

/// One picture of a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Frame of the timeline.
    pub frame: u32,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { frame, size } = self;
        write!(f, "frame {frame}, {} x {}", size[0], size[1])
    }
}

impl crate::cell::Cell for Place {
    fn text(&self) -> String {
        self.to_string()
    }
}

impl Mode {
    /// Title and description, from a comment `title: words`, otherwise from its name.
    pub fn heading(&self) -> (String, String) {
        match self.about.split_once(": ") {
            Some((title, about)) if title.len() < 60 => {
                let mut letters = about.chars();
                let first = letters.next().map(|c| c.to_uppercase().to_string());
                let about = first.unwrap_or_default() + letters.as_str();
                (title.to_owned(), about)
            }
            _ => (self.name.clone(), self.about.clone()),
        }
    }
}

impl Part {
    /// Measurements of a scene; `size` is the size of all pictures, where it is given.
    pub fn from_series(
        series: &FrameSeries,
        size: Option<[u32; 2]>,
        against: ReferenceKind,
    ) -> Self {
        Self {
            against,
            scene: series.name().to_owned(),
            content: format!("{:016x}", series.content()),
            size: size.unwrap_or(series.size()),
            frames: series.frames().collect(),
        }
    }

    /// Sample of a frame; the newest of several.
    fn sample<'a>(&self, samples: &'a [Sample], method: &str, frame: u32) -> Option<&'a Sample> {
        samples.iter().rev().find(|s| {
            (s.frame, [s.width, s.height]) == (frame, self.size)
                && s.turn == "rules"
                && series(s) == method
                && s.scene == self.scene
                && s.content == self.content
        })
    }
}

/// Cells of all modes, each with all methods, in their order; cells against the truth come last.
pub fn cells(modes: &[Mode], methods: &[&str], samples: &[Sample]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for against in [ReferenceKind::Rt, ReferenceKind::Truth] {
        for mode in modes {
            let parts: Vec<&Part> = mode.parts.iter().filter(|p| p.against == against).collect();
            if parts.is_empty() {
                continue;
            }
            cells.extend(methods.iter().map(|method| Cell {
                mode: mode.name.clone(),
                method: (*method).to_owned(),
                against,
                scores: scores(&parts, method, samples),
            }));
        }
    }
    cells
}

/// Pooled scores of a method over all frames of the parts.
///
/// # Errors
/// The first frame without a score, and the reason: a mean without it would hide the failure.
fn scores(parts: &[&Part], method: &str, samples: &[Sample]) -> Result<CellScores, String> {
    let mut found = Vec::new();
    for part in parts {
        for frame in &part.frames {
            let (frame, size) = (*frame, part.size);
            let place = Place { frame, size };
            let sample = part.sample(samples, method, frame);
            let sample = sample.ok_or_else(|| format!("{place}: not measured"))?;
            if !sample.is_ok() {
                return Err(format!("{place}: {}", sample.status));
            }
            let (Some(flip), Some(p99), Some(rel_mse)) =
                (sample.mask_flip, sample.mask_flip_p99, sample.mask_rel_mse)
            else {
                return Err(format!(
                    "{place}: {} px inside the reflections, too few to score; {MIN_AREA_PX} are needed",
                    sample.mask_px
                ));
            };
            found.push((place, sample, [flip, p99, rel_mse]));
        }
    }
    let worst = found.iter().max_by(|a, b| a.2[1].total_cmp(&b.2[1]));
    let Some((place, _, [_, flip_p99, _])) = worst else {
        return Err("no frame".to_owned());
    };
    let samples: Vec<&Sample> = found.iter().map(|(_, sample, _)| *sample).collect();
    let all = || samples.iter().copied();
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / found.len() as f64;
    // Mean over the pictures that have a value.
    let some = |of: &dyn Fn(&Sample) -> Option<f64>| {
        let values: Vec<f64> = all().filter_map(of).collect();
        (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
    };
    let percent = |of: fn(&Sample) -> Option<u64>| {
        some(&|s| of(s).map(|px| 100.0 * px as f64 / s.mask_px.max(1) as f64))
    };
    let accepts: Option<u64> = all().map(|s| s.false_accepts).sum();
    let reflective: u64 = all().map(|s| s.reflective_px).sum();
    let ssim: Option<Vec<f64>> = all().map(|s| s.mask_ssim).collect();
    Ok(CellScores {
        frames: found.len(),
        mask_px: all().map(|s| s.mask_px).min().unwrap_or_default(),
        flip: mean(&mut found.iter().map(|f| f.2[0])),
        flip_p99: *flip_p99,
        worst: *place,
        ssim: ssim.map(|values| mean(&mut values.into_iter())),
        rel_mse: mean(&mut found.iter().map(|f| f.2[2])),
        specks_px: all().map(specks_px).sum(),
        false_accepts_px: accepts,
        false_accepts_permille: accepts.map(|px| 1e3 * px as f64 / reflective.max(1) as f64),
        flicker: flicker(&samples),
        popping: popping(&samples),
        traced_percent: mean(&mut all().map(|s| s.traced_percent)),
        edge_flip: some(&|s| s.edge_flip),
        inner_flip: some(&|s| s.inner_flip),
        recall_1px_percent: some(&|s| s.recall_1px_percent),
        recall_2px_percent: some(&|s| s.recall_2px_percent),
        recall_4px_percent: some(&|s| s.recall_4px_percent),
        seam_step: some(&|s| s.seam_step),
        probe_seam_step: some(&|s| s.probe_seam_step),
        error_length_px: some(&|s| s.error_length_px),
        stripes: some(&|s| s.stripes),
        source_changes_percent: percent(|s| s.source_changes_px),
        met_changes_percent: percent(|s| s.met_changes_px),
    })
}

/// Number of specks inside the mask of a picture.
fn specks_px(sample: &Sample) -> Option<u64> {
    let share = sample.mask_specks?;
    Some((share * sample.mask_px as f64).round() as u64)
}

/// Flicker of an animation; none for a still, and where a pair of frames shares too few reflective pixels.
fn flicker(samples: &[&Sample]) -> Option<f64> {
    let since: Vec<&&Sample> = samples.iter().filter(|s| s.since_frame.is_some()).collect();
    let sum = |of: fn(&Sample) -> Option<f64>| since.iter().map(|s| of(s)).sum::<Option<f64>>();
    let difference = sum(|s| s.mask_temporal_difference)?;
    let change = sum(|s| s.mask_temporal_change)?;
    // Every frame but the first has one before it, unless a run was resumed between them.
    let pairs = if since.len() + 1 == samples.len() {
        since.len()
    } else {
        0
    };
    temporal::ratio(pairs, difference, change)
}

/// Popping of an animation; none where [`flicker`] has no value.
fn popping(samples: &[&Sample]) -> Option<f64> {
    flicker(samples)?;
    let most = |of: fn(&Sample) -> Option<f64>| {
        let values = samples.iter().filter_map(|s| of(s));
        values.fold(0.0, f64::max)
    };
    let reference = most(|s| s.mask_temporal_change);
    let difference = most(|s| s.mask_temporal_difference);
    (reference > 0.0).then(|| difference / reference)
}

/// Columns of a cell, before its scores.
const OF_CELL: [&str; 3] = ["mode", "method", "against"];
/// Columns of a cell, after its scores.
const SAID: [&str; 4] = ["adapter", "band", "verdict", "status"];

/// Formats the cells as comma-separated values; `adapter` is the measurement's.
pub fn table(cells: &[Cell], adapter: &str) -> String {
    let columns = OF_CELL.iter().chain(CellScores::COLUMNS).chain(&SAID);
    let mut out = csv::line(columns);
    for cell in cells {
        let (against, verdict) = match cell.against {
            ReferenceKind::Rt => ("rt", verdict::verdict(cell, cells)),
            ReferenceKind::Truth => ("truth", String::new()),
        };
        let (scores, band, status) = match &cell.scores {
            Ok(scores) => (scores.cells(), verdict::band(scores.flip_p99).means, "ok"),
            Err(why) => (
                vec![String::new(); CellScores::COLUMNS.len()],
                "",
                why.as_str(),
            ),
        };
        let mut row = vec![cell.mode.clone(), cell.method.clone(), against.to_owned()];
        row.extend(scores);
        row.extend([adapter, band, &verdict, status].map(str::to_owned));
        out += &csv::line(row);
    }
    out
}

/// The cell of a mode and a method.
pub fn find<'a>(
    cells: &'a [Cell],
    mode: &str,
    method: &str,
    against: ReferenceKind,
) -> Option<&'a Cell> {
    let is_wanted = |c: &&Cell| c.mode == mode && c.method == method && c.against == against;
    cells.iter().find(is_wanted)
}

/// HTML table of the 99th percentile of FLIP against `rt`; rows whose mode is one of `anchors` link to it.
pub fn heat_map(modes: &[Mode], methods: &[&str], cells: &[Cell], anchors: &[&str]) -> String {
    let mut out =
        "<h2>99th percentile of FLIP against rt</h2>\n<table class=\"heat\"><tr><th>mode</th>"
            .to_owned();
    for method in methods {
        out += &format!("<th>{}</th>", escape(method));
    }
    out += "</tr>\n";
    for mode in modes {
        let (title, _) = mode.heading();
        let link = |text: &str| match anchors.contains(&mode.name.as_str()) {
            true => format!("<a href=\"#{}\">{}</a>", escape(&mode.name), escape(text)),
            false => escape(text),
        };
        out += &format!("<tr><td>{}</td>", link(&title));
        for method in methods {
            let cell = find(cells, &mode.name, method, ReferenceKind::Rt);
            out += &match cell.map(|cell| &cell.scores) {
                Some(Ok(scores)) => format!(
                    "<td style=\"background:{}\">{}</td>",
                    band(scores.flip_p99).color,
                    link(&format!("{:.3}", scores.flip_p99))
                ),
                Some(Err(why)) => format!("<td title=\"{}\">–</td>", escape(why)),
                None => "<td></td>".to_owned(),
            };
        }
        out += "</tr>\n";
    }
    out + "</table>\n"
}
