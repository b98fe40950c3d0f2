//! Helpers of `tests/pictures` for rendering, and comparisons of numbers.

#[expect(dead_code, reason = "a part of it is used here")]
#[path = "../pictures/kit.rs"]
mod pictures;

pub use pictures::*;

/// Asserts that a number is `expected` within `tolerance`.
pub fn assert_close(found: f32, expected: f32, tolerance: f32) {
    let error = (found - expected).abs();
    assert!(
        error <= tolerance * expected,
        "{found}, expected {expected}"
    );
}
