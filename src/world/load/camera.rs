//! Default camera for scenes without one.

use glam::Vec3;

use crate::{
    math::Bounds,
    scene::{
        desc::{CameraDesc, Entry},
        diagnostic::Span,
    },
    world::World,
};

/// Maximum fraction of the picture that the scene fills.
const FILLED: f32 = 0.9;

/// Adds a camera `main` that frames the whole scene at `size` pixels, if there is no camera.
pub fn add_default(world: &mut World, size: [u32; 2]) {
    if !world.cameras.is_empty() {
        return;
    }
    let bounds = if world.moving.players.is_empty() {
        world.static_bounds()
    } else {
        world.bounds_over_time()
    };
    let radius = (bounds.diagonal() * 0.5).max(1e-3);
    let center = bounds.center();
    let defaults = CameraDesc::default();
    let to_eye = Vec3::new(0.5, 0.4, 1.0).normalize();
    let half_angle = defaults.fov_deg.to_radians() * 0.5;
    let distance = fitting_distance(&bounds, to_eye, half_angle, size[0] as f32 / size[1] as f32);
    let value = CameraDesc {
        eye: center + to_eye * distance.max(radius * 0.1),
        target: center,
        near_m: (radius * 1e-3).clamp(1e-5, defaults.near_m),
        ..defaults
    };
    world.cameras.push(Entry {
        name: "main".into(),
        at: Span::default(),
        value,
    });
}

/// Distance from the center of a box, in the direction `to_eye`, at which every corner is within
/// [`FILLED`] of the picture. `half_angle`: of the vertical field of view, radians.
fn fitting_distance(bounds: &Bounds, to_eye: Vec3, half_angle: f32, aspect: f32) -> f32 {
    let right = Vec3::Y.cross(to_eye).normalize();
    let up = to_eye.cross(right);
    let high = FILLED * half_angle.tan();
    let wide = high * aspect;
    let half = if bounds.is_empty() {
        Vec3::ZERO
    } else {
        (bounds.max - bounds.min) * 0.5
    };
    let needed = |index: u32| {
        let sign = |bit: u32| if index >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let corner = half * Vec3::new(sign(0), sign(1), sign(2));
        let sideways = (corner.dot(right).abs() / wide).max(corner.dot(up).abs() / high);
        sideways + corner.dot(to_eye)
    };
    (0..8).map(needed).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_fills_the_picture_and_stays_inside() {
        let bounds = Bounds {
            min: Vec3::new(-3.0, -1.0, -0.5),
            max: Vec3::new(3.0, 1.0, 0.5),
        };
        for (to_eye, aspect, want) in [
            // From the front: 3 m to the side at the front face, half a meter nearer.
            (Vec3::Z, 1.0, 0.5 + 3.0 / FILLED),
            (Vec3::Z, 4.0, 0.5 + 1.0 / FILLED),
            // From the side: half a meter to the side.
            (Vec3::X, 1.0, 3.0 + 1.0 / FILLED),
        ] {
            let quarter_turn = std::f32::consts::FRAC_PI_4;
            let got = fitting_distance(&bounds, to_eye, quarter_turn, aspect);
            assert!((got - want).abs() < 1e-5, "{to_eye} {aspect}: {got} {want}");
        }
    }
}
