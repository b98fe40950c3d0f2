//! Sentences about rivals that do something better than Reflet's own systems, one for each over all scenes.

use std::fmt::Write as _;

use super::{SYSTEMS, SceneRows, Side, System};

/// Least difference of two mean FLIPs that their digits in a sentence show.
const LEAST_DIFFERENCE: f64 = 1e-4;

/// A scene in which a rival takes less time than every own system.
struct Faster<'a> {
    scene: &'a str,
    /// Time over that of the fastest own system.
    share: f64,
    /// Mean FLIPs of the rival and of that system; none where the scene has none.
    flips: Option<[f64; 2]>,
}

/// A scene in which a rival errs less than `hybrid`.
struct Exacter<'a> {
    scene: &'a str,
    /// Mean FLIPs of the rival and of `hybrid`.
    flips: [f64; 2],
}

/// Lines of a list, one for each rival that does something better, or a sentence that none does. Variants of Reflet's own
/// rays are no rivals.
pub(super) fn section(scenes: &[SceneRows]) -> String {
    let rivals = SYSTEMS.iter().filter(|system| system.side == Side::Rival);
    let lines: Vec<String> = rivals.filter_map(|of| line(of, scenes)).collect();
    match lines.is_empty() {
        true => "Nothing in these scenes: no rival takes less time than both `hybrid` and `rt`, or errs less.\n".to_owned(),
        false => format!(
            "In how many scenes each system takes less time than `rt` and `hybrid`, or errs less than `hybrid`, and where it \
             does best. Each scene's own figures are below.{}\n\n{}",
            noise(scenes).map_or(String::new(), |share| format!(
                " Times of equal work (`rt` and `hybrid` where `skip_px` leaves the same nodes and steps) differ by up to \
                 {:.0} %.",
                100.0 * share
            )),
            lines.concat()
        ),
    }
}

/// Largest difference between the times of two systems that do the same work, as a share of the shorter one.
fn noise(scenes: &[SceneRows]) -> Option<f64> {
    let pairs = [("rt", "rt, skip 1 px"), ("hybrid", "hybrid, skip 1 px")];
    let of = scenes
        .iter()
        .flat_map(|scene| pairs.map(|pair| (scene, pair)));
    let differences = of.filter_map(|(scene, (own, other))| {
        let (own, other) = (scene.row(own)?, scene.row(other)?);
        let is_equal = [own.nodes, own.steps] == [other.nodes, other.steps];
        (is_equal && own.ms.min(other.ms) > 0.0)
            .then(|| (own.ms / other.ms).max(other.ms / own.ms) - 1.0)
    });
    differences.max_by(f64::total_cmp)
}

/// Line of a rival; none where it does nothing better.
fn line(rival: &System, scenes: &[SceneRows]) -> Option<String> {
    let measured = scenes.iter().filter(|s| s.row(rival.name).is_some());
    let (faster, exacter): (Vec<_>, Vec<_>) = (
        scenes.iter().filter_map(|s| faster(rival, s)).collect(),
        scenes.iter().filter_map(|s| exacter(rival, s)).collect(),
    );
    let count = measured.count();
    let mut parts = Vec::new();
    if let Some(best) = faster.iter().min_by(|a, b| a.share.total_cmp(&b.share)) {
        let share = median(faster.iter().map(|of| of.share));
        let mut text = format!(
            "less time than `rt` and `hybrid` in {} of {count}: {share:.2} of the faster one's in the median, {:.2} at best \
             ({})",
            faster.len(),
            best.share,
            best.scene
        );
        let flips: Vec<[f64; 2]> = faster.iter().filter_map(|of| of.flips).collect();
        if !flips.is_empty() {
            let [its, theirs] = [0, 1].map(|i| median(flips.iter().map(|pair| pair[i])));
            let _ = write!(
                text,
                ", with a mean FLIP of {its:.4} in the median of these, where that one has {theirs:.4}"
            );
        }
        parts.push(text);
    }
    let gain = |of: &&Exacter<'_>| of.flips[1] - of.flips[0];
    let best = exacter.iter().max_by(|a, b| gain(a).total_cmp(&gain(b)));
    if let Some(Exacter {
        scene,
        flips: [its, ours],
    }) = best
    {
        let count = scenes
            .iter()
            .filter_map(|s| flips_beside_hybrid(rival, s))
            .count();
        parts.push(format!(
            "a smaller mean FLIP than `hybrid` in {} of {count}: {its:.4} against {ours:.4} at best ({scene})",
            exacter.len()
        ));
    }
    (!parts.is_empty()).then(|| format!("- {}: {}.\n", rival.name, parts.join("; ")))
}

fn faster<'a>(rival: &System, scene: &'a SceneRows) -> Option<Faster<'a>> {
    let own = scene.of_systems().filter(|(_, s)| s.side == Side::Own);
    let fastest = own
        .map(|(row, _)| row)
        .min_by(|a, b| a.ms.total_cmp(&b.ms))?;
    let row = scene.row(rival.name)?;
    let flips = || Some([row.flip()?, fastest.flip()?]);
    (row.ms < fastest.ms).then(|| Faster {
        scene: &scene.scene,
        share: row.ms / fastest.ms,
        flips: flips(),
    })
}

/// Errors of a rival and of `hybrid`; none where a scene has no scored frame.
fn flips_beside_hybrid(rival: &System, scene: &SceneRows) -> Option<[f64; 2]> {
    Some([scene.row(rival.name)?.flip()?, scene.row("hybrid")?.flip()?])
}

fn exacter<'a>(rival: &System, scene: &'a SceneRows) -> Option<Exacter<'a>> {
    let flips = flips_beside_hybrid(rival, scene)?;
    (flips[1] - flips[0] >= LEAST_DIFFERENCE).then_some(Exacter {
        scene: &scene.scene,
        flips,
    })
}

/// The median, of an even number the mean of the two in the middle; 0 of none.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = |i: usize| values.get(i).copied().unwrap_or(0.0);
    let half = values.len() / 2;
    match values.len() % 2 {
        1 => middle(half),
        _ => 0.5 * (middle(half.saturating_sub(1)) + middle(half)),
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Row, SystemErrors},
        *,
    };

    fn scene(name: &str, rows: &[(&'static str, f64, Option<f64>)]) -> SceneRows {
        let row = |(system, ms, flip): &(&'static str, f64, Option<f64>)| Row {
            system,
            ms: *ms,
            errors: flip.map(|flip| SystemErrors {
                flip,
                ..SystemErrors::default()
            }),
            ..Row::default()
        };
        SceneRows {
            scene: name.to_owned(),
            size: [64, 36],
            frames: 1,
            scored_px: Vec::new(),
            probes: 0,
            rows: rows.iter().map(row).collect(),
            left_out: Vec::new(),
        }
    }

    #[test]
    fn each_rival_has_one_line_over_all_scenes() {
        let scenes = [
            scene(
                "hall",
                &[
                    ("ssr", 1.0, Some(0.3)),
                    ("rt by query", 0.1, Some(0.0)),
                    ("hybrid", 4.0, Some(0.02)),
                    ("rt", 2.0, Some(0.0)),
                ],
            ),
            scene(
                "yard",
                &[
                    ("ssr", 1.0, Some(0.1)),
                    ("near-far", 5.0, Some(0.01)),
                    ("hybrid", 3.0, Some(0.03)),
                    ("rt", 4.0, Some(0.0)),
                ],
            ),
            scene(
                "wall",
                &[("ssr", 1.0, None), ("hybrid", 2.0, None), ("rt", 1.0, None)],
            ),
        ];
        let text = section(&scenes);
        let lines: Vec<&str> = text.lines().filter(|line| line.starts_with('-')).collect();
        let expected = [
            "- ssr: less time than `rt` and `hybrid` in 2 of 3: 0.42 of the faster one's in the median, 0.33 at best (yard), \
             with a mean FLIP of 0.2000 in the median of these, where that one has 0.0150.",
            "- near-far: a smaller mean FLIP than `hybrid` in 1 of 1: 0.0100 against 0.0300 at best (yard).",
        ];
        assert_eq!(lines, expected);
        assert!(section(&scenes[2..]).starts_with("Nothing"));
    }
}
