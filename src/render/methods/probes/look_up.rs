//! Probe: looks reflections up in the cube maps of probes, where the method has them in place of traced rays.

use crate::{
    layout::gpu_struct::gpu_struct,
    pipeline::{
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        ray_list::List,
        shared_data::SharedData,
        sub_frame::SubFrame,
    },
};
use reflet_gpu::Checks;
use reflet_scene::desc::{Method, SelectBy};

use super::maps::ProbeMaps;

/// See `shaders/methods/probes/probe.wgsl`.
pub const PASS: Pass = Pass {
    name: "probe",
    group: PassGroup::Reflection,
    color: [58, 7, 79],
    reads_shared: &[
        SharedData::Counters,
        SharedData::PixelLists,
        SharedData::DispatchSizes,
        SharedData::MethodMaps,
    ],
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
    // The maps' ids come from traced rays, whose indices `check_world` and `Trees::build` validated.
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
    let rays = Dispatch::Listed(frame.resources.ray_list, List::Rays);
    frame.dispatch_with(pass, &params, &rays);
}
