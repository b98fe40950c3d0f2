//! The passes, one file each, named like their shaders.

pub mod blur;
pub mod compact;
pub mod compose;
pub mod light;
pub mod shadow;
pub mod ssr;
pub mod surface;
pub mod tone;
pub mod trace;
pub mod visibility;

use super::pass::Pass;

/// All passes in the order of the frame.
pub const ALL: [&Pass; 11] = [
    &shadow::PASS,
    &visibility::PASS,
    &surface::PASS,
    &light::PASS,
    &ssr::PASS,
    &compact::PASS,
    &compact::ARGUMENTS,
    &trace::PASS,
    &blur::PASS,
    &compose::PASS,
    &tone::PASS,
];
