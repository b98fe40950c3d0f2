//! Systems over several scenes, and the best of them.

use super::{SYSTEMS, SceneRows, System};
use crate::pareto::{Spot, pareto_front};

/// A system over several scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overall {
    /// Name of the system.
    pub system: &'static str,
    /// Geometric mean over the scenes of the time divided by `rt`'s.
    pub time_ratio: f64,
    /// Mean over the scenes of the mean FLIP.
    pub flip: f64,
}

impl Overall {
    /// Time ratio and error of the system.
    pub fn spot(&self) -> Spot {
        Spot {
            ms: self.time_ratio,
            error: self.flip,
        }
    }
}

/// Systems that were scored in all scenes that have frames to score, in the order of [`SYSTEMS`].
fn overall(scenes: &[SceneRows]) -> Vec<Overall> {
    let scored = || scenes.iter().filter(|scene| !scene.scored_px.is_empty());
    let of_scene = |scene: &SceneRows, system: &System| {
        let (own, rt) = (scene.row(system.name)?, scene.row("rt")?);
        let flip = own.flip()?;
        (rt.ms > 0.0).then_some((own.ms / rt.ms, flip))
    };
    let of_all = |system: &'static System| {
        let each: Option<Vec<_>> = scored().map(|s| of_scene(s, system)).collect();
        let each = each.filter(|each| !each.is_empty())?;
        let mean =
            |of: fn(&(f64, f64)) -> f64| each.iter().map(of).sum::<f64>() / each.len() as f64;
        Some(Overall {
            system: system.name,
            time_ratio: mean(|(ratio, _)| ratio.max(1e-9).ln()).exp(),
            flip: mean(|(_, flip)| *flip),
        })
    };
    SYSTEMS.iter().filter_map(of_all).collect()
}

/// The best methods over several scenes, at most `count`, fastest first: methods on the Pareto front of time against
/// error, then on the front of the rest, and so on; of a front that is too large, the most accurate. The most accurate
/// setting on a method's own first front stands for the method.
pub fn best(scenes: &[SceneRows], count: usize) -> Vec<Overall> {
    let mut left = overall(scenes);
    let mut found: Vec<Overall> = Vec::new();
    let method = |of: &Overall| System::named(of.system).map(|system| system.method);
    while found.len() < count && !left.is_empty() {
        let spots: Vec<Spot> = left.iter().map(Overall::spot).collect();
        let on_front = pareto_front(&spots);
        let (mut front, rest): (Vec<_>, Vec<_>) = left
            .into_iter()
            .zip(on_front)
            .partition(|(_, is_on)| *is_on);
        front.sort_by(|(a, _), (b, _)| a.flip.total_cmp(&b.flip));
        for (system, _) in front {
            if found.len() < count && found.iter().all(|other| method(other) != method(&system)) {
                found.push(system);
            }
        }
        let systems = rest.into_iter().map(|(system, _)| system);
        left = systems
            .filter(|system| found.iter().all(|other| method(other) != method(system)))
            .collect();
    }
    found.sort_by(|a, b| a.time_ratio.total_cmp(&b.time_ratio));
    found
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Row, SystemErrors},
        *,
    };

    #[test]
    fn the_best_are_on_the_fronts_of_all_scenes() {
        let row = |system, ms, flip| Row {
            system,
            ms,
            errors: Some(SystemErrors {
                flip,
                ..SystemErrors::default()
            }),
            ..Row::default()
        };
        let scene = |rows: Vec<Row>| SceneRows {
            scored_px: vec![500],
            rows,
            ..SceneRows::default()
        };
        let scenes = [
            scene(vec![
                row("rt", 2.0, 0.0),
                row("ssr", 1.0, 0.5),
                row("near-far", 8.0, 0.1),
                row("hybrid", 4.0, 0.01),
                row("ssr, 2 layers", 0.1, 0.1),
                row("probe, box, K = 1", 0.2, 0.8),
                row("probe, box, K = 4", 0.3, 0.7),
                row("probe, distance, K = 2", 4.0, 0.7),
            ]),
            scene(vec![
                row("rt", 1.0, 0.0),
                row("ssr", 1.0, 0.3),
                row("near-far", 9.0, 0.2),
                row("hybrid", 2.0, 0.03),
                row("probe, box, K = 1", 0.1, 0.8),
                row("probe, box, K = 4", 0.2, 0.7),
                row("probe, distance, K = 2", 2.0, 0.7),
            ]),
        ];
        let names = |count| {
            best(&scenes, count)
                .iter()
                .map(|o| o.system)
                .collect::<Vec<_>>()
        };
        // `hybrid` is the front of the methods without `rt`, `ssr` and the probes, of which one setting stands for all;
        // two layers miss in a scene.
        assert_eq!(
            names(5),
            ["probe, box, K = 4", "ssr", "rt", "hybrid", "near-far"]
        );
        assert_eq!(names(4), ["probe, box, K = 4", "ssr", "rt", "hybrid"]);
        assert_eq!(names(1), ["rt"]);
        let ssr = best(&scenes, 5)[1];
        assert!((ssr.time_ratio - 0.5_f64.sqrt()).abs() < 1e-12 && (ssr.flip - 0.4).abs() < 1e-12);
        assert_eq!(best(&[], 5), []);
    }
}
