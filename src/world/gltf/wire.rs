//! Points and lines as spheres and capsules, so that rays meet what rasterization shows.

use glam::Vec3;
use xxhash_rust::xxh3::xxh3_64;

use super::{Fault, accessor::Data};
use crate::Mesh;
use reflet_base::math::Bounds;

/// Radius of a point, as a fraction of the diagonal of its primitive.
const POINT_RADIUS: f32 = 1.0 / 300.0;
/// Radius of a line, as a fraction of the diagonal of its primitive.
const LINE_RADIUS: f32 = 1.0 / 600.0;
/// Radius where a primitive has no size, meters.
const RADIUS_M: f32 = 0.01;

/// Makes capsules of the vertices of a primitive of points (mode 0), or of lines (1 to 3: segments, a loop, a strip),
/// as wide as `width_m` where it is given, else thin beside the primitive. Lines without length have none.
///
/// # Errors
/// More geometry than the file's budget.
pub fn build(
    mesh: &mut Mesh,
    mode: u32,
    corners: &[u32],
    width_m: Option<f64>,
    data: &Data<'_>,
) -> Result<(), Fault> {
    let position = |i: u32| mesh.positions[i as usize];
    let used = corners.iter().map(|i| position(*i));
    let diagonal = Bounds::around(used.filter(|p| p.is_finite())).diagonal();
    let fraction = if mode == 0 { POINT_RADIUS } else { LINE_RADIUS };
    let thin_m = match diagonal * fraction {
        size if size > 0.0 && size.is_finite() => size,
        _ => RADIUS_M,
    };
    // A width of 0 is widened to a pixel later.
    let wide_m = |width: f64| (0.5 * width as f32).min(1e9).max(1e-6 * thin_m);
    let radius_m = width_m.map_or(thin_m, wide_m);
    data.spend(bytes(mode, corners.len()))?;
    let line = |[a, b]: [u32; 2]| (position(a) != position(b)).then_some([a, b, b]);
    let pairs = || corners.windows(2).map(|w| [w[0], w[1]]);
    mesh.triangles = match (mode, corners) {
        (0, _) => corners.iter().map(|i| [*i; 3]).collect(),
        (1, _) => {
            let segments = corners.chunks_exact(2).map(|c| [c[0], c[1]]);
            segments.filter_map(line).collect()
        }
        (2, [first, .., last]) => {
            let whole = pairs().chain([[*last, *first]]);
            whole.filter_map(line).collect()
        }
        _ => pairs().filter_map(line).collect(),
    };
    keep_apart(&mut mesh.triangles, &mesh.positions);
    mesh.capsule_radius_m = Some(radius_m);
    mesh.at_least_a_pixel = true;
    mesh.tangents = Vec::new();
    Ok(())
}

/// Keeps one capsule of all that have the same ends: others hide behind it, and a ray would meet all of them.
fn keep_apart(capsules: &mut Vec<[u32; 3]>, positions: &[Vec3]) {
    let place = |i: u32| (positions[i as usize] + Vec3::ZERO).to_array();
    let hash = |[a, b, _]: &[u32; 3]| {
        let mut ends = [*a, *b].map(|end| place(end).map(f32::to_bits));
        ends.sort_unstable();
        xxh3_64(bytemuck::bytes_of(&ends))
    };
    // Sorted hashes take a fifteenth of the time of a set of ten million.
    let mut hashes: Vec<_> = capsules.iter().map(hash).zip(0_usize..).collect();
    hashes.sort_unstable();
    let mut is_kept = vec![true; capsules.len()];
    for [first, next] in hashes.array_windows() {
        is_kept[next.1] = first.0 != next.0;
    }
    let mut kept = is_kept.into_iter();
    capsules.retain(|_| kept.next() == Some(true));
}

/// Memory of the capsules of so many corners, and of their hashes while they are compared, bytes.
pub fn bytes(mode: u32, num_corners: usize) -> u64 {
    let count = match mode {
        1 => num_corners / 2,
        _ => num_corners,
    };
    (count * (size_of::<[u32; 3]>() + size_of::<(u64, usize)>() + 1)) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capsules_of_the_same_ends_are_one() {
        let positions = [Vec3::X, Vec3::ZERO, Vec3::X, -Vec3::ZERO, Vec3::Y];
        let points = [[0; 3], [1; 3], [2; 3], [3; 3], [4; 3], [4; 3]];
        let lines = [[0, 1, 1], [3, 2, 2], [1, 4, 4]];
        let mut kept = [points.to_vec(), lines.to_vec()].concat();
        keep_apart(&mut kept, &positions);
        assert_eq!(kept, [[0; 3], [1; 3], [4; 3], [0, 1, 1], [1, 4, 4]]);
    }
}
