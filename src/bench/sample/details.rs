//! Columns of samples that follow from lists of passes and causes.

use reflet_render::{
    passes::{self, counted_passes},
    pipeline::{cause::Cause, instrument::Counts},
};

/// Causes whose refusals can be compared with a ray, because there is a crossing.
pub const REFUSALS: [Cause; 5] = [
    Cause::Hidden,
    Cause::Unconfirmed,
    Cause::BackFace,
    Cause::Reflector,
    Cause::Steps,
];

/// Causes whose answer is used without a ray.
pub const ACCEPTS: [Cause; 3] = [Cause::Hit, Cause::HitBehind, Cause::None];

/// Column of the time of a pass.
pub fn pass_column(pass: &str) -> String {
    format!("pass_{pass}_ms")
}

/// Column of the number of pixels whose ray went behind the first depth layer, where there is a second.
pub const BEHIND_COLUMN: &str = "behind_first_layer_px";

/// Columns after the fixed ones: `pass_NAME_ms`, `cause_NAME_px`, [`BEHIND_COLUMN`], `false_accept_NAME_px`,
/// `false_reject_NAME_px` and `PASS_COUNTED`, such as `trace_visited_nodes`.
pub fn detail_columns() -> Vec<String> {
    let passes = passes::ALL.iter().map(|pass| pass_column(pass.name));
    let causes = || {
        Cause::ALL
            .into_iter()
            .filter(|c| *c != Cause::NotReflective)
    };
    passes
        .chain(causes().map(|c| format!("cause_{}_px", c.name())))
        .chain([BEHIND_COLUMN.to_owned()])
        .chain(ACCEPTS.map(|c| format!("false_accept_{}_px", c.name())))
        .chain(REFUSALS.map(|c| format!("false_reject_{}_px", c.name())))
        .chain(counted_passes().flat_map(|pass| {
            let names = Counts::default().named();
            names.map(|(what, _)| format!("{}_{what}", pass.name))
        }))
        .collect()
}
