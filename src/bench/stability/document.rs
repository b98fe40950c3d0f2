//! Tables of failure modes as Markdown.

use std::fmt::Write as _;

use super::{Cell, CellScores, Mode, ReferenceKind, find, rivals};
use reflet_metric::{
    mask::{ERODE_PX, MIN_AREA_PX},
    structure::EDGE_PX,
};
use reflet_render::passes::audit::{TOLERANCE_RELATIVE, TOLERANCE_U};

/// A band of the 99th percentile of FLIP.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    up_to: f64,
    mark: &'static str,
    /// CSS color of the band, light enough for black text.
    pub color: &'static str,
    means: &'static str,
}

/// Bands, from invisible to wrong.
const BANDS: [Band; 4] = [
    Band {
        up_to: 0.05,
        mark: "🟩",
        color: "#9bd89b",
        means: "not seen",
    },
    Band {
        up_to: 0.2,
        mark: "🟨",
        color: "#f3e48a",
        means: "seen in a direct comparison",
    },
    Band {
        up_to: 0.5,
        mark: "🟧",
        color: "#f2b661",
        means: "seen",
    },
    Band {
        up_to: f64::INFINITY,
        mark: "🟥",
        color: "#ee8277",
        means: "wrong",
    },
];

/// Score that one table of the document shows.
struct Score {
    title: &'static str,
    text: String,
    against: ReferenceKind,
    cell: fn(&CellScores) -> Option<String>,
    /// Whether this table names cells without a score.
    names_missing: bool,
}

/// Document with tables of all modes × methods, then each mode in words. `machine` names the adapter
/// of the measurement; the modes are in order.
pub fn document(modes: &[Mode], methods: &[&str], cells: &[Cell], machine: &str) -> String {
    let mut out = format!(
        "<!-- Written by `reflet bench stability --document`. -->\n# Where methods fail\n\n\
         {} modes in which reflections fail, each the smallest scene that provokes one failure, scored on {machine}. \
         Scores are those of `reflet compare` inside the reflective pixels, eroded by {ERODE_PX} px, \
         of at least {MIN_AREA_PX}. A film is scored by all of its frames: means, \
         and of the 99th percentile the worst frame's. `hybrid (threshold)` accepts by the paper's depth threshold, \
         `hybrid` verifies.\n",
        modes.len()
    );
    out += &rivals::section(modes, methods, cells);
    for score in scores() {
        let rows: Vec<&Mode> = modes
            .iter()
            .filter(|mode| {
                methods
                    .iter()
                    .any(|m| text(cells, mode, m, &score).is_some())
            })
            .collect();
        if rows.is_empty() {
            continue;
        }
        // Writing to a string cannot fail.
        let _ = write!(out, "\n## {}\n\n{}\n\n| mode |", score.title, score.text);
        for method in methods {
            let _ = write!(out, " {method} |");
        }
        let _ = writeln!(out, "\n|---|{}", "---|".repeat(methods.len()));
        for mode in rows {
            let _ = write!(out, "| {} |", mode.heading().0);
            for method in methods {
                let text = text(cells, mode, method, &score);
                let _ = write!(out, " {} |", text.unwrap_or_default());
            }
            out.push('\n');
        }
    }
    out.push_str("\n## What fails, and how it is seen\n");
    for mode in modes {
        let (title, about) = mode.heading();
        let _ = writeln!(out, "\n### {title}\n");
        if !about.is_empty() {
            let _ = writeln!(out, "{about}\n");
        }
        for sentence in verdicts(mode, methods, cells) {
            let _ = writeln!(out, "- {sentence}");
        }
    }
    out
}

fn scores() -> Vec<Score> {
    let bands = BANDS.map(|band| match band.up_to.is_finite() {
        true => format!("{} up to {}: {}", band.mark, band.up_to, band.means),
        false => format!("{} above: {}", band.mark, band.means),
    });
    let banded: fn(&CellScores) -> _ =
        |s| Some(format!("{} {:.3}", band(s.flip_p99).mark, s.flip_p99));
    let mut all = vec![
        Score {
            title: "99th percentile of FLIP against `rt`",
            text: format!(
                "The reference is `rt` with `bounces = \"auto\"` and the same samples. {}.",
                bands.join(", ")
            ),
            against: ReferenceKind::Rt,
            cell: banded,
            names_missing: true,
        },
        Score {
            title: "99th percentile of FLIP against the truth",
            text: "The truth of a still is `rt` with `bounces = \"auto\"`, 64 samples and shadows by rays, of mode 26 at the \
                   origin: what `rt` has wrong shows here too, as does all aliasing."
                .to_owned(),
            against: ReferenceKind::Truth,
            cell: banded,
            names_missing: true,
        },
        Score {
            title: "Mean FLIP and SSIM against `rt`",
            text: "Means hide small failures; they say how much of the picture is concerned.".to_owned(),
            against: ReferenceKind::Rt,
            cell: |s| {
                let ssim = s.ssim.map_or("–".to_owned(), |v| format!("{v:.3}"));
                Some(format!("{:.4} / {ssim}", s.flip))
            },
            names_missing: false,
        },
        Score {
            title: "Wrong answers of the march, ‰ of the reflective pixels",
            text: format!(
                "Answers that a ray contradicts: another instance, a distance off by more than {TOLERANCE_U} U \
                 and {} %, or nothing where there is something. Methods whose march of the picture, or of the faces of \
                 a box, does not answer have none: `probe` looks directions up, `rt` follows rays, and `near-far` \
                 follows rays to points on triangles of its map.",
                100.0 * TOLERANCE_RELATIVE
            ),
            against: ReferenceKind::Rt,
            cell: |s| s.false_accepts_permille.map(|v| format!("{v:.2}")),
            names_missing: false,
        },
        Score {
            title: "Flicker of films, %",
            text: "Σ |Δpicture − Δ`rt`| over Σ |Δ`rt`| from frame to frame inside the reflections: 0 where the picture \
                   changes exactly as the reference does, 100 also where it does not change at all."
                .to_owned(),
            against: ReferenceKind::Rt,
            cell: |s| s.flicker.map(|v| format!("{:.1}", 100.0 * v)),
            names_missing: false,
        },
        Score {
            title: "Popping of films, %",
            text: "The largest |Δpicture − Δ`rt`| from one frame to the next over the largest |Δ`rt`|, inside the \
                   reflections: 100 where one frame jumps as far as the reference ever changes."
                .to_owned(),
            against: ReferenceKind::Rt,
            cell: |s| s.popping.map(|v| format!("{:.1}", 100.0 * v)),
            names_missing: false,
        },
    ];
    all.extend(structure());
    all
}

/// Scores of the structure of errors.
fn structure() -> [Score; 6] {
    let score = |title, text: String, cell| Score {
        title,
        text,
        against: ReferenceKind::Rt,
        cell,
        names_missing: false,
    };
    [
        score(
            "Errors at edges",
            format!(
                "Mean FLIP within {EDGE_PX} px of where the rays of `rt` meet another instance than the ray beside, \
                 and elsewhere."
            ),
            |s| {
                let [edge, inner] = s.structure.flip_by_edges;
                Some(format!("{:.4} / {:.4}", edge?, inner?))
            },
        ),
        score(
            "Thin things",
            "Share of the pixels in which `rt` shows a thing at most 1, 2 and 4 px thin that show the same, %.".to_owned(),
            |s| joined(&s.structure.recall_percent, 1),
        ),
        score(
            "The seam",
            "Mean step from a pixel that the march answered to one beside it that it did not, beyond the step of `rt` there, \
             of 255 levels; both show the same instance, rightly."
                .to_owned(),
            |s| s.structure.seam_step.map(|v| format!("{v:+.2}")),
        ),
        score(
            "Seams between probes",
            "Mean step between neighboring pixels of one surface that take other probes, beyond the steps beside and beyond \
             that of `rt`, of 255 levels."
                .to_owned(),
            |s| s.structure.probe_seam_step.map(|v| format!("{v:+.1}")),
        ),
        score(
            "Streaks and stripes",
            "Of the signed error of luma along rows and columns: the distance in pixels at which its autocorrelation \
             falls below 1 / e (long: drawn out), and the largest value beyond its first zero (toward 1: stripes)."
                .to_owned(),
            |s| {
                let length_px = s.structure.error_length_px?;
                let stripes = s.structure.stripes.map_or("–".to_owned(), |v| format!("{v:.2}"));
                Some(format!("{length_px:.1} px / {stripes}"))
            },
        ),
        score(
            "A camera that moves by 0.0001 U",
            "Reflective pixels that change between march and ray, and those whose ray (of `rt`) then meets another \
             instance, %. Stills only."
                .to_owned(),
            |s| {
                let [source, met] = s.structure.changes_percent;
                Some(format!("{:.2} / {:.2}", source?, met?))
            },
        ),
    ]
}

/// Percentages with a dash for each missing one; none where all are missing.
fn joined(values: &[Option<f64>], digits: usize) -> Option<String> {
    values.iter().any(Option::is_some).then(|| {
        let text = |v: &Option<f64>| v.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
        values.iter().map(text).collect::<Vec<_>>().join(" / ")
    })
}

/// Score of a mode's cell as text, or the reason why it has none; none where the cell has no such score.
fn text(cells: &[Cell], mode: &Mode, method: &str, score: &Score) -> Option<String> {
    match &find(cells, mode, method, score.against)?.scores {
        Ok(scores) => (score.cell)(scores),
        Err(_) => score.names_missing.then(|| "not scored".to_owned()),
    }
}

/// Band of a score.
pub fn band(p99: f64) -> Band {
    let found = BANDS.into_iter().find(|band| p99 <= band.up_to);
    found.unwrap_or(BANDS[BANDS.len() - 1])
}

/// One sentence for each method: its error, and the frame with the largest.
pub fn verdicts(mode: &Mode, methods: &[&str], cells: &[Cell]) -> Vec<String> {
    let mut sentences = Vec::new();
    for method in methods {
        let Some(cell) = find(cells, mode, method, ReferenceKind::Rt) else {
            continue;
        };
        let s = match &cell.scores {
            Err(why) => {
                sentences.push(format!("{method}: not scored: {why}"));
                continue;
            }
            Ok(scores) => scores,
        };
        let mut sentence = format!(
            "{method}: {} (p99 {:.3}, mean {:.4}, relMSE {:.2e}",
            band(s.flip_p99).means,
            s.flip_p99,
            s.flip,
            s.rel_mse
        );
        if s.frames > 1 && s.flip_p99 > 0.0 {
            let _ = write!(sentence, ", worst at {}", s.worst);
        }
        sentence.push(')');
        if let Some(Cell {
            scores: Ok(truth), ..
        }) = find(cells, mode, method, ReferenceKind::Truth)
        {
            let _ = write!(
                sentence,
                "; against the truth {}",
                band(truth.flip_p99).means
            );
        }
        sentences.push(sentence);
    }
    sentences
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mode(name: &str, about: &str) -> Mode {
        Mode {
            name: name.to_owned(),
            about: about.to_owned(),
            parts: Vec::new(),
        }
    }

    #[test]
    fn every_cell_is_in_the_tables_and_what_has_no_score_is_named() {
        let modes = [
            mode("03-rails", "3 thin rails: rails that are thin."),
            mode("mine", ""),
        ];
        let cell = |mode: &str, method: &str, scores| Cell {
            mode: mode.to_owned(),
            method: method.to_owned(),
            against: ReferenceKind::Rt,
            scores,
        };
        let scores = CellScores {
            frames: 1,
            flip_p99: 0.31,
            ..CellScores::default()
        };
        let of_hybrid = CellScores {
            flip_p99: 0.32,
            ..scores.clone()
        };
        let cells = [
            cell("03-rails", "ssr", Ok(scores)),
            cell("03-rails", "rt", Ok(CellScores::default())),
            cell("mine", "ssr", Err("frame 0: 12 px".to_owned())),
            cell("03-rails", "hybrid", Ok(of_hybrid)),
        ];
        let text = document(&modes, &["ssr", "rt"], &cells, "a machine");
        assert!(!text.contains("rivals"), "{text}");
        let text = document(
            &modes,
            &["ssr", "near-far", "hybrid", "rt"],
            &cells,
            "a machine",
        );
        for part in [
            "\n- ssr: 3 thin rails (0.310, 0.320)\n- near-far: none\n",
            "| 3 thin rails | 🟧 0.310 |  | 🟧 0.320 | 🟩 0.000 |",
            "| mine | not scored |  |  |  |",
            "### 3 thin rails\n\nRails that are thin.\n",
            "- ssr: seen (p99 0.310,",
            "- ssr: not scored: frame 0: 12 px",
        ] {
            assert!(text.contains(part), "no {part:?} in {text}");
        }
        assert!(!text.contains("## Flicker"), "no film, no flicker: {text}");
    }

    #[test]
    fn bands_have_their_ends() {
        assert_eq!(band(0.05).means, "not seen");
        assert_eq!(band(0.0501).mark, "🟨");
        assert_eq!((band(0.9).means, band(f64::NAN).means), ("wrong", "wrong"));
    }
}
