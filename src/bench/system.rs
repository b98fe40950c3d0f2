//! Systems that are compared with each other: each a method with its settings, as its authors would build it. A further
//! system is a row of [`SYSTEMS`].

use reflet_scene::{
    desc::{Accept, Lookup, Method, ProbesDesc, ReflectionDesc, SelectBy, Trace},
    words,
};

words! {
    /// Relation of a system to Reflet's own choices.
    pub enum Side {
        /// Another way of finding reflections.
        Rival = "rival",
        /// Reflet's own rays, found or spared in another way.
        Variant = "variant",
        /// Reflet's own choice.
        Own = "own",
    }
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
        *settings = ReflectionDesc {
            method: self.method,
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
