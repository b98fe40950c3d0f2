//! Transforms of placements and rotations at rest.

use glam::{Affine3A, DQuat, EulerRot, Quat, Vec3};

use crate::desc::PlacementDesc;

/// Transform of a placement at rest, from model space to the space of its parent.
pub fn transform(placement: &PlacementDesc) -> Affine3A {
    match *placement {
        PlacementDesc::Trs {
            translation,
            rotation,
            scale,
        } => Affine3A::from_scale_rotation_translation(scale, rotation, translation),
        PlacementDesc::Matrix(matrix) => Affine3A::from_mat4(matrix),
    }
}

/// Rotation by angles about X, then Y, then Z, all fixed axes; degrees.
pub fn turned(euler_deg: Vec3) -> Quat {
    // Whole turns are subtracted before the conversion to radians, while the number is still exact.
    let reduced = euler_deg.as_dvec3() % 360.0;
    let [x, y, z] = reduced.to_array().map(f64::to_radians);
    DQuat::from_euler(EulerRot::ZYX, z, y, x).as_quat()
}
