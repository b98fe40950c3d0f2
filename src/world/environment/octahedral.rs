//! The equal-area octahedral map between a square and the sphere (Clarberg 2008).

use std::f32::consts::FRAC_PI_4;

use glam::{Vec2, Vec3};

/// Unit direction of a point of the octahedral square, coordinates 0 to 1 (Clarberg 2008).
pub fn direction_of_square(place: Vec2) -> Vec3 {
    let p = place * 2.0 - 1.0;
    let size = p.abs();
    let to_fold = 1.0 - size.x - size.y;
    let r = 1.0 - to_fold.abs();
    let turn = if r == 0.0 {
        1.0
    } else {
        (size.y - size.x) / r + 1.0
    };
    let (sine, cosine) = (turn * FRAC_PI_4).sin_cos();
    let flat = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new(
        (flat * cosine).copysign(p.x),
        (flat * sine).copysign(p.y),
        (1.0 - r * r).copysign(to_fold),
    )
}
