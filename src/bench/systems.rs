//! Systems that are compared with each other: each a method with its settings, as its authors would build it. A further
//! system is a row of [`SYSTEMS`].

use crate::pareto::{Spot, pareto_front};
use reflet_scene::desc::{Accept, Lookup, Method, ProbesDesc, ReflectionDesc, SelectBy, Trace};

pub mod chart;
pub mod frames;
pub mod overall;
pub mod table;

use frames::FrameRow;

/// Relation of a system to Reflet's own choices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Another way of finding reflections.
    Rival,
    /// Reflet's own rays, found or spared in another way.
    Variant,
    /// Reflet's own choice.
    Own,
}

/// A system: a method with its settings.
#[derive(Clone, Copy, Debug)]
pub struct System {
    /// Name in tables and charts.
    pub name: &'static str,
    /// Color in charts, sRGB.
    pub color: [u8; 3],
    /// Relation to Reflet's own choices.
    pub side: Side,
    /// Method of the system.
    pub method: Method,
    /// Changes settings that have what all systems share.
    change: fn(&mut ReflectionDesc),
}

impl System {
    /// The system of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SYSTEMS.iter().find(|system| system.name == name)
    }

    /// Changes the settings of a scene to the system's: every setting that is part of a system's name is set here, so
    /// that a scene's own settings cannot make its row of a table untrue.
    pub fn set(&self, settings: &mut ReflectionDesc) {
        let standard = ReflectionDesc::default();
        *settings = ReflectionDesc {
            method: self.method,
            marched: standard.marched,
            trace: Trace::Software,
            accept: Accept::Verified,
            layers: 1,
            rate: 1,
            skip_px: 0.0,
            probes: ProbesDesc {
                select: SelectBy::Pixel,
                ..settings.probes
            },
            ..*settings
        };
        (self.change)(settings);
    }
}

/// Sets how reflections are looked up.
fn look_up(r: &mut ReflectionDesc, lookup: Lookup, nearest: u32) {
    (r.probes.lookup, r.probes.nearest) = (lookup, nearest);
}

/// Declares systems, a row each.
macro_rules! systems {
    ($($side:ident $name:literal $color:expr, $method:ident, |$settings:pat_param| $change:expr;)*) => {
        &[$(System {
            name: $name,
            color: $color,
            side: Side::$side,
            method: Method::$method,
            change: |$settings| $change,
        }),*]
    };
}

/// All systems, in the order of tables.
pub const SYSTEMS: &[System] = systems! {
    Rival "ssr" [0, 114, 178], Ssr, |_| ();
    Rival "probe, infinity, K = 1" [150, 120, 0], Probe, |r| look_up(r, Lookup::Infinity, 1);
    Rival "probe, box, K = 1" [200, 170, 0], Probe, |r| look_up(r, Lookup::Box, 1);
    Rival "probe, box, K = 4" [240, 210, 40], Probe, |r| look_up(r, Lookup::Box, 4);
    Rival "probe, distance, K = 2" [120, 180, 60], Probe, |r| look_up(r, Lookup::Distance, 2);
    Rival "ssr+probe, box, K = 2" [120, 120, 120], SsrProbe, |r| look_up(r, Lookup::Box, 2);
    Rival "ssr+probe, distance, K = 2" [60, 60, 60], SsrProbe, |r| look_up(r, Lookup::Distance, 2);
    Rival "ssr+box" [120, 140, 60], SsrBox, |_| ();
    Rival "near-far" [90, 40, 140], NearFar, |_| ();
    Rival "near-far, 2 layers" [170, 110, 220], NearFar, |r| r.layers = 2;
    Rival "ssr, 2 layers" [86, 180, 233], Ssr, |r| r.layers = 2;
    Rival "rt, rate 4" [0, 90, 60], Rt, |r| r.rate = 4;
    Variant "rt, skip 1 px" [150, 200, 170], Rt, |r| r.skip_px = 1.0;
    Variant "hybrid, skip 1 px" [245, 180, 140], Hybrid, |r| r.skip_px = 1.0;
    Variant "rt by query" [0, 60, 160], Rt, |r| r.trace = Trace::Query;
    Rival "hybrid (threshold)" [230, 159, 0], Hybrid, |r| r.accept = Accept::Threshold;
    Own "hybrid" [213, 94, 0], Hybrid, |_| ();
    Own "hybrid, 2 layers" [150, 60, 60], Hybrid, |r| r.layers = 2;
    Own "rt" [0, 158, 115], Rt, |_| ();
};

/// Errors of a system inside the reflections, of a frame or over those frames of a scene that have enough of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SystemErrors {
    /// Mean FLIP against `rt`.
    pub flip: f64,
    /// Largest 99th percentile of FLIP of a frame.
    pub flip_p99: f64,
    /// Mean SSIM; none where no window of a frame lies inside.
    pub ssim: Option<f64>,
    /// Share of the pixels that show another instance than `rt`, or none, percent.
    pub wrong_percent: f64,
}

/// Measurements of a system in a scene, over all of its measured frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Name of the system.
    pub system: &'static str,
    /// Median time of the passes that find reflections, milliseconds: processor time on software adapters.
    pub ms: f64,
    /// Errors; none where no frame is scored.
    pub errors: Option<SystemErrors>,
    /// Largest change of one frame that `rt` does not have, over the largest change of `rt`; of films only.
    pub popping: Option<f64>,
    /// Tree nodes that the passes visit in the first picture.
    pub nodes: u64,
    /// Steps of marches, through pictures or maps, in the first picture.
    pub steps: u64,
    /// Bytes of all buffers and textures.
    pub bytes: u64,
    /// Bytes of structures that are made apart from the frame: the maps of probes and of far things, the structures of
    /// ray queries.
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
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneRows {
    /// Scene file.
    pub scene: String,
    /// Size of the pictures.
    pub size: [u32; 2],
    /// Number of measured frames.
    pub frames: usize,
    /// Number of reflective pixels of each frame that was scored; the others have too few.
    pub scored_px: Vec<usize>,
    /// Number of probes.
    pub probes: u32,
    /// Rows of systems of [`SYSTEMS`], in their order.
    pub rows: Vec<Row>,
    /// Systems that the adapter or the scene refuses.
    pub left_out: Vec<LeftOut>,
}

impl SceneRows {
    /// Rows with their systems; rows of no system of [`SYSTEMS`] are left out.
    pub fn of_systems(&self) -> impl Iterator<Item = (&Row, &'static System)> {
        self.rows
            .iter()
            .filter_map(|row| Some((row, System::named(row.system)?)))
    }

    /// Row of the system of this name.
    pub fn row(&self, system: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.system == system)
    }

    /// For each row whether it is on the Pareto front; none is where no frame is scored.
    pub fn on_front(&self) -> Vec<bool> {
        let spots: Option<Vec<Spot>> = self.rows.iter().map(Row::spot).collect();
        spots.map_or_else(
            || vec![false; self.rows.len()],
            |spots| pareto_front(&spots),
        )
    }
}

impl Row {
    /// Mean FLIP against `rt` inside the reflections; none where no frame is scored.
    pub fn flip(&self) -> Option<f64> {
        self.errors.map(|errors| errors.flip)
    }

    /// Time and error of the system; none where no frame is scored.
    pub fn spot(&self) -> Option<Spot> {
        Some(Spot {
            ms: self.ms,
            error: self.flip()?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::desc::Marched;

    #[test]
    fn systems_have_names_and_settings_of_their_own() {
        for (i, a) in SYSTEMS.iter().enumerate() {
            for b in &SYSTEMS[i + 1..] {
                assert_ne!(a.name, b.name);
                let [of_a, of_b] = [a, b].map(|system| {
                    let mut settings = ReflectionDesc::default();
                    system.set(&mut settings);
                    settings
                });
                assert_ne!(of_a, of_b, "{} and {}", a.name, b.name);
            }
        }
    }
    #[test]
    fn settings_of_a_scene_do_not_change_what_a_system_is() {
        let standard = ReflectionDesc::default();
        let of_scene = ReflectionDesc {
            method: Method::Path,
            marched: Marched::All,
            trace: Trace::Query,
            accept: Accept::Threshold,
            layers: 2,
            rate: 4,
            skip_px: 2.0,
            probes: ProbesDesc {
                select: SelectBy::Instance,
                ..standard.probes
            },
            ..standard
        };
        for system in SYSTEMS {
            let [of_standard, of_scene] = [standard, of_scene].map(|mut settings| {
                system.set(&mut settings);
                settings
            });
            assert_eq!(of_scene, of_standard, "{}", system.name);
        }
        // Settings that no system is named by stay the scene's.
        let mut settings = ReflectionDesc {
            threshold_u: 0.5,
            ..standard
        };
        SYSTEMS[0].set(&mut settings);
        assert_eq!(settings.threshold_u, 0.5);
    }
}
