//! Arguments: computes the workgroup counts of dispatches over lists.

use crate::pipeline::{
    pass::{ComputePass, Dispatch, Pass, PassGroup},
    shared_data::SharedData,
    sub_frame::SubFrame,
};

/// See `shaders/arguments.wgsl`.
pub const PASS: Pass = Pass {
    name: "arguments",
    group: PassGroup::Reflection,
    color: [178, 57, 122],
    needed: |plan, _| plan.features.lists,
    reads_shared: &[SharedData::Counters],
    writes_shared: &[SharedData::DispatchSizes],
    ..Pass::DEFAULT
};

/// Records the pass.
pub fn record(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    frame.dispatch(pass, &Dispatch::Groups(1));
}
