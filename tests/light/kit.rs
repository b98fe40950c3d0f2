//! Helpers of `tests/pictures` for rendering, and comparisons of numbers.

pub use crate::kit::*;

/// Asserts that a number is `expected` within `tolerance`.
pub fn assert_close(found: f32, expected: f32, tolerance: f32) {
    let error = (found - expected).abs();
    assert!(
        error <= tolerance * expected,
        "{found}, expected {expected}"
    );
}
