//! Table of the steps along seams between probes, by how many are blended and by what chooses them.

use std::fmt::Write as _;

use reflet_render::maps::probe_choice::MOST_BLENDED;
use reflet_scene::desc::SelectBy;

/// Steps along the seams of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SeamRow {
    /// Scene file.
    pub scene: String,
    /// Point by which probes are chosen.
    pub select: SelectBy,
    /// Mean step over the frames with 1, 2, … blended probes, display code values; none where no surface has a border.
    pub steps: [Option<f64>; MOST_BLENDED],
}

/// Section with the table; empty without rows.
pub fn section(rows: &[SeamRow]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut out = "\n## Seams between probes\n\nMean step between neighboring pixels of one surface that take other probes, \
                   beyond the steps beside and beyond that of `rt`, of 255 levels; of a film the mean of its frames. `probe`, by `lookup = \"box\"`. \
                   `reflet bench stability` has the same of any scene (`probe_seam_step`).\n\n| scene | `select` |"
        .to_owned();
    // Writing to a string cannot fail.
    for nearest in 1..=MOST_BLENDED {
        let _ = write!(out, " K = {nearest} |");
    }
    let _ = writeln!(out, "\n|---|---|{}", "---|".repeat(MOST_BLENDED));
    for row in rows {
        let select = match row.select {
            SelectBy::Pixel => "pixel",
            SelectBy::Instance => "instance",
        };
        let _ = write!(out, "| {} | `\"{select}\"` |", row.scene);
        for step in row.steps {
            let text = step.map_or("–".to_owned(), |step| format!("{step:+.1}"));
            let _ = write!(out, " {text} |");
        }
        out.push('\n');
    }
    out + "\nOne probe alone steps where another is nearer. Blended by pixel the step shrinks with each further probe: with two or \
           three, one is dropped that may weigh as much as the last. Where objects choose, it remains at their joints however \
           many are blended; a single object has no joint, and pops in time instead.\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_signed_and_a_scene_without_borders_has_dashes() {
        assert_eq!(section(&[]), "");
        let row = |select, steps| SeamRow {
            scene: "hall.toml".to_owned(),
            select,
            steps,
        };
        let text = section(&[
            row(SelectBy::Pixel, [Some(18.37), Some(-0.04), None, Some(2.0)]),
            row(SelectBy::Instance, [None; MOST_BLENDED]),
        ]);
        for part in [
            "| scene | `select` | K = 1 | K = 2 | K = 3 | K = 4 |\n|---|---|---|---|---|---|\n",
            "| hall.toml | `\"pixel\"` | +18.4 | -0.0 | – | +2.0 |\n",
            "| hall.toml | `\"instance\"` | – | – | – | – |\n",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
    }
}
