//! Whether a ray meets a box, for the reference traversal on the CPU.

use glam::DVec3;

/// The slab test of a ray, by its origin and direction, with the box between two corners, widened by the rounding that
/// boxes and triangles went through in f32.
pub fn overlaps(origin: DVec3, ray: DVec3, interval: [f64; 2], [min, max]: [DVec3; 2]) -> bool {
    let slack = (min.abs().max(max.abs()) + origin.abs()) * 4.0 * f64::from(f32::EPSILON);
    let (min, max) = (min - slack - origin, max + slack - origin);
    let [mut near, mut far] = interval;
    for axis in 0..3 {
        let direction = ray[axis];
        if direction == 0.0 {
            if min[axis] > 0.0 || max[axis] < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (min[axis] / direction, max[axis] / direction);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far
}
