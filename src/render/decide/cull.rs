//! Frustum culling of draw calls.

use glam::{Mat4, Vec3};

use reflet_base::math::Bounds;

/// Whether a box lies outside one of the clip planes (left, right, top, bottom, near). There is no
/// far plane: depth is reversed and may be infinite.
pub fn is_outside(clip_from_world: &Mat4, bounds: &Bounds) -> bool {
    if bounds.is_empty() {
        return true;
    }
    let corners: [_; 8] = std::array::from_fn(|i| {
        let pick = |bit: usize, low: f32, high: f32| if i & bit == 0 { low } else { high };
        let corner = Vec3::new(
            pick(1, bounds.min.x, bounds.max.x),
            pick(2, bounds.min.y, bounds.max.y),
            pick(4, bounds.min.z, bounds.max.z),
        );
        *clip_from_world * corner.extend(1.0)
    });
    corners.iter().all(|c| c.x > c.w)
        || corners.iter().all(|c| c.x < -c.w)
        || corners.iter().all(|c| c.y > c.w)
        || corners.iter().all(|c| c.y < -c.w)
        || corners.iter().all(|c| c.z > c.w)
}
