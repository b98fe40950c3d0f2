//! Modes in which another method than Reflet's own comes closer to `rt`.

use std::fmt::Write as _;

use super::{Cell, Mode, ReferenceKind, find};

/// Difference of two 99th percentiles of FLIP that counts.
const DIFFERENCE: f64 = 0.005;

/// Section with a line for each method whose 99th percentile of FLIP is below that of `hybrid` in some mode; empty
/// where none is measured.
pub fn section(modes: &[Mode], methods: &[&str], cells: &[Cell]) -> String {
    let p99 = |mode: &Mode, method: &str| {
        let scores = find(cells, mode, method, ReferenceKind::Rt)?
            .scores
            .as_ref();
        scores.ok().map(|scores| scores.flip_p99)
    };
    let is_rival = |method: &&&str| **method != "rt" && !method.starts_with("hybrid");
    let rivals: Vec<_> = methods.iter().filter(is_rival).collect();
    if rivals.is_empty() || !methods.contains(&"hybrid") {
        return String::new();
    }
    let mut out = "\n## What rivals do better\n\nModes in which a method is closer to `rt` than `hybrid` is, by the \
                   99th percentile of FLIP (that of `hybrid` behind it).\n\n"
        .to_owned();
    for method in rivals {
        let ahead = modes.iter().filter_map(|mode| {
            let (of_rival, of_hybrid) = (p99(mode, method)?, p99(mode, "hybrid")?);
            let is_ahead = of_rival < of_hybrid - DIFFERENCE;
            is_ahead.then(|| format!("{} ({of_rival:.3}, {of_hybrid:.3})", mode.heading().0))
        });
        let ahead: Vec<_> = ahead.collect();
        let names = match ahead.is_empty() {
            true => "none".to_owned(),
            false => ahead.join(", "),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(out, "- {method}: {names}");
    }
    out
}
