//! Probe: looks reflections up in the cube maps of probes, where the method has them in place of traced rays.

use crate::pipeline::prelude::*;
use reflet_scene::desc::{Method, SelectBy};

use super::maps::ProbeMaps;

/// See `shaders/methods/probes/probe.wgsl`.
pub const PASS: Pass = Pass {
    name: "probe",
    group: PassGroup::Reflection,
    color: [58, 7, 79],
    reads_shared: &[Counters, PixelLists, DispatchSizes, MethodMaps],
    params: Some(Params::LAYOUT),
    needed: |plan, _| plan.maps.is_some_and(Method::looks_up),
    overrides: |options| {
        let probes = &options.reflection.probes;
        let by_instance = u8::from(probes.select == SelectBy::Instance);
        vec![
            ("LOOKUP", f64::from(probes.lookup as u32)),
            ("PROBES_BY_INSTANCE", by_instance.into()),
        ]
    },
    checks: Checks::TrustedBuiltin,
    ..Pass::DEFAULT
};

gpu_struct! {
    /// Uniforms of the look-up.
    pub struct Params = "Params" {
        /// Number of probes.
        count: u32,
        /// Maximum number of probes that are blended.
        nearest: u32,
        /// Number of levels of the maps.
        levels: u32,
    }
}

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    let Some(maps) = frame.resources.maps::<ProbeMaps>() else {
        return;
    };
    let count = maps.key.boxes.len() as u32;
    let params = Params {
        count,
        nearest: frame.options.reflection.probes.nearest.min(count),
        levels: maps.key.levels(),
    };
    let rays = Dispatch::Listed(List::Rays);
    frame.dispatch_with(pass, &params, rays);
}
