//! Systems that are compared with each other: each a method with its settings, as its authors would build it. A further
//! system is a row of [`SYSTEMS`].

use crate::pareto::{Spot, pareto_front};
use reflet_scene::desc::{Accept, Lookup, Method, ProbesDesc, ReflectionDesc, Trace};

pub mod chart;
pub mod document;
pub mod frames;
pub mod probe_seams;

use frames::FrameRow;

/// A system: a method with its settings.
#[derive(Clone, Copy, Debug)]
pub struct System {
    /// Name in tables and charts.
    pub name: &'static str,
    /// Color in charts, sRGB.
    pub color: [u8; 3],
    /// Whether it is Reflet's own choice rather than a rival.
    pub is_own: bool,
    /// Changes the settings of a scene to those of the system.
    pub set: fn(&mut ReflectionDesc),
}

impl System {
    /// The system of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SYSTEMS.iter().find(|system| system.name == name)
    }

    /// Method of the system.
    pub fn method(&self) -> Method {
        let mut settings = ReflectionDesc::default();
        (self.set)(&mut settings);
        settings.method
    }
}

/// Sets a method that looks reflections up.
fn look_up(r: &mut ReflectionDesc, method: Method, lookup: Lookup, nearest: u32) {
    r.method = method;
    r.probes = ProbesDesc {
        lookup,
        nearest,
        ..r.probes
    };
}

/// A rival in these colors.
const fn rival(name: &'static str, color: [u8; 3], set: fn(&mut ReflectionDesc)) -> System {
    System {
        name,
        color,
        is_own: false,
        set,
    }
}

/// All systems, in the order of tables.
pub const SYSTEMS: &[System] = &[
    rival("ssr", [0, 114, 178], |r| r.method = Method::Ssr),
    rival("probe, infinity, K = 1", [150, 120, 0], |r| {
        look_up(r, Method::Probe, Lookup::Infinity, 1);
    }),
    rival("probe, box, K = 1", [200, 170, 0], |r| {
        look_up(r, Method::Probe, Lookup::Box, 1);
    }),
    rival("probe, box, K = 4", [240, 210, 40], |r| {
        look_up(r, Method::Probe, Lookup::Box, 4);
    }),
    rival("probe, distance, K = 2", [120, 180, 60], |r| {
        look_up(r, Method::Probe, Lookup::Distance, 2);
    }),
    rival("ssr+probe, box, K = 2", [120, 120, 120], |r| {
        look_up(r, Method::SsrProbe, Lookup::Box, 2);
    }),
    rival("ssr+probe, distance, K = 2", [60, 60, 60], |r| {
        look_up(r, Method::SsrProbe, Lookup::Distance, 2);
    }),
    rival("ssr+box", [120, 140, 60], |r| r.method = Method::SsrBox),
    rival("near-far", [90, 40, 140], |r| r.method = Method::NearFar),
    rival("near-far, 2 layers", [170, 110, 220], |r| {
        r.method = Method::NearFar;
        r.layers = 2;
    }),
    rival("ssr, 2 layers", [86, 180, 233], |r| {
        r.method = Method::Ssr;
        r.layers = 2;
    }),
    rival("rt, rate 4", [0, 90, 60], |r| {
        r.method = Method::Rt;
        r.rate = 4;
    }),
    rival("rt, skip 1 px", [150, 200, 170], |r| {
        r.method = Method::Rt;
        r.skip_px = 1.0;
    }),
    rival("hybrid, skip 1 px", [245, 180, 140], |r| {
        r.method = Method::Hybrid;
        r.accept = Accept::Verified;
        r.skip_px = 1.0;
    }),
    rival("rt by query", [0, 60, 160], |r| {
        r.method = Method::Rt;
        r.trace = Trace::Query;
    }),
    rival("hybrid (threshold)", [230, 159, 0], |r| {
        r.method = Method::Hybrid;
        r.accept = Accept::Threshold;
    }),
    System {
        name: "hybrid",
        color: [213, 94, 0],
        is_own: true,
        set: |r| {
            r.method = Method::Hybrid;
            r.accept = Accept::Verified;
        },
    },
    System {
        name: "hybrid, 2 layers",
        color: [150, 60, 60],
        is_own: true,
        set: |r| {
            r.method = Method::Hybrid;
            r.accept = Accept::Verified;
            r.layers = 2;
        },
    },
    System {
        name: "rt",
        color: [0, 158, 115],
        is_own: true,
        set: |r| r.method = Method::Rt,
    },
];

/// Measurements of a system in a scene, over all of its measured frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Name of the system.
    pub system: &'static str,
    /// Median time of the passes that find reflections, milliseconds: processor time on software adapters.
    pub ms: f64,
    /// Mean FLIP against `rt` inside the reflections.
    pub flip: f64,
    /// Largest 99th percentile of FLIP of a frame.
    pub flip_p99: f64,
    /// Mean SSIM; none where the reflections are too few.
    pub ssim: Option<f64>,
    /// Share of the pixels that show another instance than `rt`, or none, percent.
    pub wrong_percent: f64,
    /// Largest change of one frame that `rt` does not have, over the largest change of `rt`; of films only.
    pub popping: Option<f64>,
    /// Tree nodes that the passes visit in the first picture.
    pub nodes: u64,
    /// Steps of marches, through pictures or maps, in the first picture.
    pub steps: u64,
    /// Bytes of all buffers and textures.
    pub bytes: u64,
    /// Bytes of what is made apart from the frame: the maps of probes and of far things, the structures of ray queries.
    pub prepared_bytes: u64,
    /// Time of a capture of these maps, or of building these structures, milliseconds; it is not part of `ms`.
    pub prepare_ms: f64,
    /// Median time in which they were made anew for a frame of a film, milliseconds; it is not part of `ms`.
    pub update_ms: f64,
    /// Measurements of each frame, in their order.
    pub frames: Vec<FrameRow>,
}

/// A system without measurements in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the system.
    pub system: &'static str,
    /// Reason, such as a feature that the adapter lacks: a sentence without its end.
    pub why: String,
}

/// Measured systems of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRows {
    /// Scene file.
    pub scene: String,
    /// Number of measured frames.
    pub frames: usize,
    /// Number of reflective pixels that were scored, in the frame with the fewest.
    pub mask_px: usize,
    /// Number of probes.
    pub probes: u32,
    /// Rows of systems of [`SYSTEMS`], in their order.
    pub rows: Vec<Row>,
    /// Systems that the adapter or the scene refuses.
    pub left_out: Vec<LeftOut>,
}

impl SceneRows {
    /// Rows with their systems; those of no system of [`SYSTEMS`] are left out.
    pub fn of_systems(&self) -> impl Iterator<Item = (&Row, &'static System)> {
        self.rows
            .iter()
            .filter_map(|row| Some((row, System::named(row.system)?)))
    }
}

impl Row {
    /// Time and error of the system.
    pub fn spot(&self) -> Spot {
        Spot {
            ms: self.ms,
            error: self.flip,
        }
    }
}

/// A system over several scenes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overall {
    /// Name of the system.
    pub system: &'static str,
    /// Geometric mean over the scenes of the time over that of `rt`.
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

/// Systems that were measured in all scenes, in the order of [`SYSTEMS`].
fn overall(scenes: &[SceneRows]) -> Vec<Overall> {
    let of_scene = |scene: &SceneRows, system: &System| {
        let row = |name| scene.rows.iter().find(|row| row.system == name);
        let (own, rt) = (row(system.name)?, row("rt")?);
        (rt.ms > 0.0).then_some((own.ms / rt.ms, own.flip))
    };
    let of_all = |system: &'static System| {
        let each: Option<Vec<_>> = scenes.iter().map(|s| of_scene(s, system)).collect();
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

/// The best methods over several scenes, at most `count`, fastest first: those on the Pareto front of time against error,
/// then those on the front of the rest, and so on; of a front that is too large, those that err least. Of a method's
/// settings, the one that errs least on the method's first front stands for all.
pub fn best(scenes: &[SceneRows], count: usize) -> Vec<Overall> {
    let mut left = overall(scenes);
    let mut found: Vec<Overall> = Vec::new();
    let method = |of: &Overall| System::named(of.system).map(System::method);
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
    use super::*;

    #[test]
    fn systems_have_names_and_settings_of_their_own() {
        for (i, a) in SYSTEMS.iter().enumerate() {
            for b in &SYSTEMS[i + 1..] {
                assert_ne!(a.name, b.name);
                let [of_a, of_b] = [a, b].map(|system| {
                    let mut settings = ReflectionDesc::default();
                    (system.set)(&mut settings);
                    settings
                });
                assert_ne!(of_a, of_b, "{} and {}", a.name, b.name);
            }
        }
    }

    #[test]
    fn the_best_are_on_the_fronts_of_all_scenes() {
        let row = |system, ms, flip| Row {
            system,
            ms,
            flip,
            ..Row::default()
        };
        let scene = |rows: Vec<Row>| SceneRows {
            scene: String::new(),
            frames: 1,
            mask_px: 500,
            probes: 0,
            rows,
            left_out: Vec::new(),
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
        // `hybrid` is the front of what is left without `rt`, `ssr` and the probes, of which one setting stands for
        // all; two layers miss in a scene.
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
