//! Meaning of the scores of a mode: bands of the error, and a sentence for each method.

use super::{Cell, ReferenceKind, find};

/// A band of the 99th percentile of FLIP.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    up_to: f64,
    /// CSS color of the band, light enough for black text.
    pub color: &'static str,
    /// Meaning for the eye.
    pub means: &'static str,
}

/// Bands, from invisible to wrong.
const BANDS: [Band; 4] = [
    Band::new(0.05, "#9bd89b", "not seen"),
    Band::new(0.2, "#f3e48a", "seen in a direct comparison"),
    Band::new(0.5, "#f2b661", "seen"),
    Band::new(f64::INFINITY, "#ee8277", "wrong"),
];

impl Band {
    const fn new(up_to: f64, color: &'static str, means: &'static str) -> Self {
        Self {
            up_to,
            color,
            means,
        }
    }
}

/// Band of a score.
pub fn band(p99: f64) -> Band {
    let found = BANDS.into_iter().find(|band| p99 <= band.up_to);
    found.unwrap_or(BANDS[BANDS.len() - 1])
}

/// Words about a cell against `rt`: its error, and the frame with the largest.
pub fn verdict(cell: &Cell, cells: &[Cell]) -> String {
    let s = match &cell.scores {
        Err(why) => return format!("not scored: {why}"),
        Ok(scores) => scores,
    };
    let mut words = format!(
        "{} (p99 {:.3}, mean {:.4}, relMSE {:.2e}",
        band(s.flip_p99).means,
        s.flip_p99,
        s.flip,
        s.rel_mse
    );
    if s.frames > 1 && s.flip_p99 > 0.0 {
        words += &format!(", worst at {}", s.worst);
    }
    words.push(')');
    let truth = find(cells, &cell.mode, &cell.method, ReferenceKind::Truth);
    if let Some(Ok(truth)) = truth.map(|cell| &cell.scores) {
        words += &format!("; against the truth {}", band(truth.flip_p99).means);
    }
    words
}

#[cfg(test)]
mod tests {
    use super::{super::CellScores, *};

    #[test]
    fn bands_have_their_ends() {
        assert_eq!(band(0.05).means, "not seen");
        assert_eq!(band(0.0501).means, "seen in a direct comparison");
        assert_eq!((band(0.9).means, band(f64::NAN).means), ("wrong", "wrong"));
    }

    #[test]
    fn a_verdict_names_the_worst_frame_the_truth_and_why_there_is_no_score() {
        let cell = |against, scores| Cell {
            mode: "03-rails".to_owned(),
            method: "ssr".to_owned(),
            against,
            scores,
        };
        let scores = |frames, flip_p99| CellScores {
            frames,
            flip_p99,
            ..CellScores::default()
        };
        let film = cell(ReferenceKind::Rt, Ok(scores(3, 0.31)));
        let worst = "seen (p99 0.310, mean 0.0000, relMSE 0.00e0, worst at frame 0, 0 x 0)";
        assert_eq!(verdict(&film, &[]), worst);
        let equal = cell(ReferenceKind::Rt, Ok(scores(3, 0.0)));
        assert!(
            !verdict(&equal, &[]).contains("worst"),
            "no frame has an error"
        );
        let truth = cell(ReferenceKind::Truth, Ok(scores(1, 0.6)));
        let other = Cell {
            method: "hybrid".to_owned(),
            scores: Ok(scores(1, 0.0)),
            ..truth.clone()
        };
        let still = cell(ReferenceKind::Rt, Ok(scores(1, 0.31)));
        let says = verdict(&still, &[still.clone(), other, truth]);
        assert!(
            says.ends_with("relMSE 0.00e0); against the truth wrong"),
            "{says}"
        );
        let unscored = cell(ReferenceKind::Rt, Err("frame 0: 12 px".to_owned()));
        assert_eq!(verdict(&unscored, &[]), "not scored: frame 0: 12 px");
    }
}
