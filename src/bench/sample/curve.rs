//! Curves of charts: one per method, and curves of their own for `PARTS` of the samples of some methods.

use super::Sample;
use crate::system::SYSTEMS;
use reflet_scene::desc::Method;

/// Name of the curve of `hybrid` with `accept = "threshold"`.
pub const THRESHOLD_SERIES: &str = "hybrid (threshold)";
/// Color of a quantity without a color of its own.
const OTHER: [u8; 3] = [0, 158, 115];

/// Curves of methods that several systems use, and of parts of the samples of a method, each with its sRGB color, from
/// colors that stay apart for color-blind readers (Okabe and Ito 2008), as the colors of systems are.
const FURTHER: [(&str, [u8; 3]); 9] = [
    (Method::Probe.name(), [240, 228, 66]),
    (Method::SsrProbe.name(), [110, 110, 110]),
    ("ssr (2 layers)", [0, 0, 0]),
    (THRESHOLD_SERIES, [230, 159, 0]),
    ("hybrid (2 layers)", [150, 60, 60]),
    ("hybrid (undersampled)", [120, 120, 0]),
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

/// The curves in the order of charts, each with its sRGB color: a system whose name is its method's name is that
/// method's curve.
fn curves() -> impl Iterator<Item = (&'static str, [u8; 3])> {
    let plain = SYSTEMS.iter().filter(|of| of.name == of.method.name());
    plain.map(|of| (of.name, of.color)).chain(FURTHER)
}

/// Names of the curves, in the order of charts.
pub fn series_names() -> impl Iterator<Item = &'static str> {
    curves().map(|(name, _)| name)
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
    let found = curves().chain(beside).find(|(known, _)| *known == name);
    found.map_or(OTHER, |(_, color)| color)
}
