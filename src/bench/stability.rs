//! Scores of failure modes: what a scene's samples say of each method, as one cell of a table of modes
//! × methods.

pub mod document;
pub mod ratchet;

use std::fmt;

use super::{
    csv,
    metric::{mask::MIN_AREA_PX, temporal},
    run::FrameSeries,
    sample::Sample,
    summary::series,
};

/// Columns of the table of cells.
const HEADER: [&str; 15] = [
    "mode",
    "method",
    "against",
    "frames",
    "mask_px",
    "flip",
    "flip_p99",
    "worst",
    "ssim",
    "rel_mse",
    "false_accepts_px",
    "false_accepts_permille",
    "flicker",
    "traced_percent",
    "status",
];

/// What pictures are held against.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Against {
    /// `rt` with the same samples.
    Rt,
    /// `rt` with many samples and shadows by rays, at the origin: shows what `rt` has wrong, too.
    Truth,
}

/// A failure mode, or a user's own scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mode {
    /// Name of the scene file without its ending, such as `03-rails`.
    pub name: String,
    /// First comment of the scene: what fails, and how it is seen.
    pub about: String,
    /// What is measured for it.
    pub parts: Vec<Part>,
}

/// Measured frames that make a cell together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// What pictures are held against.
    pub against: Against,
    /// What samples call the scene.
    pub scene: String,
    /// What samples call its content.
    pub content: String,
    /// Size of the pictures.
    pub size: [u32; 2],
    /// Frames of its timeline.
    pub frames: Vec<u32>,
}

/// Scores of a method in a mode.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// [`Mode::name`]
    pub mode: String,
    /// Method, of [`SERIES`](super::parameter::SERIES).
    pub method: String,
    /// What its pictures were held against.
    pub against: Against,
    /// Scores, or why there are none.
    pub scores: Result<CellScores, String>,
}

/// Scores inside the reflective pixels, of all frames and sizes together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellScores {
    /// Pictures that were scored.
    pub frames: usize,
    /// Scored pixels of the picture that has the fewest.
    pub mask_px: u64,
    /// Mean FLIP, 0 to 1.
    pub flip: f64,
    /// The largest 99th percentile of FLIP of a picture, 0 to 1.
    pub flip_p99: f64,
    /// That picture.
    pub worst: Place,
    /// Mean SSIM; none where a picture is too small for it.
    pub ssim: Option<f64>,
    /// Mean relMSE.
    pub rel_mse: f64,
    /// Answers of the march that a ray contradicts, pixels; none where nothing marches.
    pub false_accepts_px: Option<u64>,
    /// The same over the reflective pixels, ‰.
    pub false_accepts_permille: Option<f64>,
    /// Σ |Δtest − Δrt| over Σ |Δrt| inside the masks of a film's frames.
    pub flicker: Option<f64>,
    /// Reflective pixels that were traced, percent.
    pub traced_percent: f64,
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

impl Mode {
    /// Title and words, from a comment `title: words`, else from its name.
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
    /// What will be measured of a scene; `size` is that of all pictures, where it is given.
    pub fn of(series: &FrameSeries, size: Option<[u32; 2]>, against: Against) -> Self {
        Self {
            against,
            scene: series.name().to_owned(),
            content: format!("{:016x}", series.content()),
            size: size.unwrap_or(series.size()),
            frames: series.frames().collect(),
        }
    }

    /// The sample of a frame; of several, the newest.
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

/// Cells of all modes, each with all methods, in their order; those against the truth come last.
pub fn cells(modes: &[Mode], methods: &[&str], samples: &[Sample]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for against in [Against::Rt, Against::Truth] {
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

/// Scores of a method over all frames of the parts.
///
/// # Errors
/// The first frame that has no score, and why: a mean without it would flatter.
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
    let all = || found.iter().map(|(_, sample, _)| *sample);
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / found.len() as f64;
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
        false_accepts_px: accepts,
        false_accepts_permille: accepts.map(|px| 1e3 * px as f64 / reflective.max(1) as f64),
        flicker: flicker(&all().collect::<Vec<_>>()),
        traced_percent: mean(&mut all().map(|s| s.traced_percent)),
    })
}

/// None of a still, and where a pair of frames shares too few reflective pixels.
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

/// The cells as comma-separated values.
pub fn table(cells: &[Cell]) -> String {
    let mut out = csv::line(HEADER);
    for cell in cells {
        let against = match cell.against {
            Against::Rt => "rt",
            Against::Truth => "truth",
        };
        let mut row = vec![cell.mode.clone(), cell.method.clone(), against.to_owned()];
        match &cell.scores {
            Ok(s) => {
                let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
                row.extend([s.frames.to_string(), s.mask_px.to_string()]);
                row.extend([s.flip.to_string(), s.flip_p99.to_string()]);
                row.extend([s.worst.to_string(), number(s.ssim), s.rel_mse.to_string()]);
                row.push(
                    s.false_accepts_px
                        .map_or(String::new(), |px| px.to_string()),
                );
                row.extend([number(s.false_accepts_permille), number(s.flicker)]);
                row.extend([s.traced_percent.to_string(), "ok".to_owned()]);
            }
            Err(why) => {
                row.resize(HEADER.len() - 1, String::new());
                row.push(why.clone());
            }
        }
        out += &csv::line(row);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(frames: u32) -> Part {
        Part {
            against: Against::Rt,
            scene: "a.toml".to_owned(),
            content: "7".to_owned(),
            size: [32, 18],
            frames: (0..frames).collect(),
        }
    }

    fn sample(frame: u32, flip: Option<f64>) -> Sample {
        Sample {
            scene: "a.toml".to_owned(),
            content: "7".to_owned(),
            turn: "rules".to_owned(),
            method: "hybrid".to_owned(),
            accept: "verified".to_owned(),
            frame,
            width: 32,
            height: 18,
            status: "ok".to_owned(),
            reflective_px: 500,
            mask_px: if flip.is_some() { 200 } else { 12 },
            mask_flip: flip,
            mask_flip_p99: flip.map(|f| 2.0 * f),
            mask_rel_mse: flip,
            false_accepts: Some(5),
            since_frame: frame.checked_sub(1),
            mask_temporal_difference: Some(3.0).filter(|_| frame > 0),
            mask_temporal_change: Some(6.0).filter(|_| frame > 0),
            ..Sample::default()
        }
    }

    fn of(frames: u32, samples: &[Sample]) -> Result<CellScores, String> {
        scores(&[&part(frames)], "hybrid", samples)
    }

    #[test]
    fn a_film_is_scored_by_its_means_and_its_worst_frame() {
        let samples = [
            sample(0, Some(0.1)),
            sample(1, Some(0.3)),
            sample(2, Some(0.2)),
        ];
        let s = of(3, &samples).expect("scores");
        assert!((s.flip - 0.2).abs() < 1e-12);
        assert_eq!(
            (s.flip_p99, s.worst.to_string().as_str()),
            (0.6, "frame 1, 32 x 18")
        );
        assert_eq!(
            (s.false_accepts_px, s.false_accepts_permille),
            (Some(15), Some(10.0))
        );
        assert_eq!((s.flicker, s.ssim), (Some(0.5), None));
        assert_eq!(of(1, &samples).expect("scores").flicker, None, "a still");
    }

    #[test]
    fn one_frame_without_a_score_leaves_the_cell_without_one() {
        let says = |samples: &[Sample]| of(2, samples).expect_err("no score");
        let first = sample(0, Some(0.1));
        assert_eq!(
            says(std::slice::from_ref(&first)),
            "frame 1, 32 x 18: not measured"
        );
        let empty = says(&[first.clone(), sample(1, None)]);
        assert!(empty.contains("frame 1, 32 x 18: 12 px inside"), "{empty}");
        let mut failed = sample(1, Some(0.1));
        failed.status = "pixel 3 is NaN".to_owned();
        assert_eq!(says(&[first, failed]), "frame 1, 32 x 18: pixel 3 is NaN");
    }

    #[test]
    fn the_newest_sample_of_the_same_content_counts() {
        let mut other = sample(0, Some(0.9));
        other.content = "8".to_owned();
        let mut threshold = sample(0, Some(0.8));
        threshold.accept = "threshold".to_owned();
        let samples = [sample(0, Some(0.5)), sample(0, Some(0.1)), other, threshold];
        assert_eq!(of(1, &samples).expect("scores").flip, 0.1);
    }

    #[test]
    fn every_row_has_all_columns() {
        let cell = |scores| Cell {
            mode: "03-rails".to_owned(),
            method: "ssr".to_owned(),
            against: Against::Truth,
            scores,
        };
        let cells = [
            cell(of(1, &[sample(0, Some(0.1))])),
            cell(Err("a, b".to_owned())),
        ];
        let table = csv::parse(&table(&cells)).expect("a table");
        assert_eq!(table.columns, HEADER);
        assert_eq!(table.rows[1][14], "a, b");
        assert_eq!(table.rows[0][2], "truth");
    }
}
