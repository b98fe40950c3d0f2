//! Curves of charts: one per method, and curves of their own for [`PARTS`] of the samples of some methods.

use super::Sample;
use reflet_scene::desc::Method;

/// Name of the curve of `hybrid` with `accept = "threshold"`.
pub const THRESHOLD_SERIES: &str = "hybrid (threshold)";
/// Color of the curve of method `rt`.
const RT: [u8; 3] = [0, 158, 115];

/// The curves in the order of charts, each with its sRGB color, from colors that stay apart for color-blind readers
/// (Okabe and Ito 2008).
const CURVES: [(&str, [u8; 3]); 14] = [
    (Method::Ssr.name(), [0, 114, 178]),
    ("ssr (2 layers)", [0, 0, 0]),
    (Method::Probe.name(), [240, 228, 66]),
    (Method::SsrProbe.name(), [110, 110, 110]),
    (Method::SsrBox.name(), [120, 140, 60]),
    (Method::NearFar.name(), [90, 40, 140]),
    (THRESHOLD_SERIES, [230, 159, 0]),
    (Method::Hybrid.name(), [213, 94, 0]),
    ("hybrid (2 layers)", [150, 60, 60]),
    ("hybrid (undersampled)", [120, 120, 0]),
    (Method::Rt.name(), RT),
    ("rt (undersampled)", [0, 90, 60]),
    ("hybrid (no light reuse)", [204, 121, 167]),
    ("rt (no light reuse)", [86, 180, 233]),
];

/// Whether a sample is in a part.
type IsIn = fn(&Sample) -> bool;

/// Parts of the samples of a method, by their names in curves, and which samples they have; the first part with a curve
/// has a sample.
const PARTS: [(&str, IsIn); 4] = [
    ("threshold", |sample| sample.accept == "threshold"),
    ("2 layers", |sample| sample.layers > Some(1)),
    ("undersampled", |sample| sample.rate > Some(1)),
    ("no light reuse", |sample| sample.reuse_light == Some(false)),
];

/// Names of the curves, in the order of charts.
pub fn series_names() -> impl Iterator<Item = &'static str> {
    CURVES.iter().map(|(name, _)| *name)
}

/// Names of the methods that benchmarks compare: `auto` chooses among them, and `path` is a reference.
pub fn compared_methods() -> impl Iterator<Item = &'static str> {
    series_names().filter(|name| Method::from_name(name).is_some())
}

/// Curve that a sample belongs to, one of [`series_names`].
pub fn series(sample: &Sample) -> &str {
    let curve = |(part, is_in): &(&str, IsIn)| {
        let name = is_in(sample).then(|| format!("{} ({part})", sample.method))?;
        series_names().find(|known| *known == name)
    };
    PARTS.iter().find_map(curve).unwrap_or(&sample.method)
}

/// Color of a curve, or of a bound or an estimate drawn beside them, sRGB.
pub fn color(name: &str) -> [u8; 3] {
    let beside = [("bound", [140, 140, 140]), ("estimated", [230, 159, 0])];
    let mut known = CURVES.iter().chain(&beside);
    known
        .find(|(known, _)| *known == name)
        .map_or(RT, |(_, color)| *color)
}
