//! Cones around the directions from which the light of a panorama's density comes: a surface is sent no samples of
//! light that shines behind it.

use std::f32::consts::PI;

use glam::{UVec2, Vec3, Vec4};

use super::octahedral::direction_of_square;

/// Maximum number of levels that have cones, down to the whole sphere.
pub const CONE_LEVELS: u32 = 4;

/// Maximum number of squares along an edge of the finest level that has cones.
const CONE_EDGE: usize = 1 << (CONE_LEVELS - 1);

/// Directions of a grid of points over the square of a density, so fine that the corners of each cell bound its
/// directions.
struct Lattice {
    /// Number of squares along an edge.
    edge: usize,
    /// Number of steps of the grid across a square.
    steps: usize,
    /// Unit directions of the points, row by row.
    directions: Vec<Vec3>,
}

impl Lattice {
    fn new(edge: usize) -> Self {
        // The corners of a small square are the farthest of it; a large one is looked at in steps.
        let steps = if edge >= 64 { 1 } else { 8 };
        let count = edge * steps;
        let row = |y: usize| {
            let at = move |x: usize| UVec2::new(x as u32, y as u32).as_vec2() / count as f32;
            (0..=count).map(move |x| direction_of_square(at(x)))
        };
        Self {
            edge,
            steps,
            directions: (0..=count).flat_map(row).collect(),
        }
    }

    /// Directions of the points of a square.
    fn of_square(&self, [x, y]: [usize; 2]) -> impl Iterator<Item = Vec3> {
        let across = self.edge * self.steps + 1;
        let rows = y * self.steps..=(y + 1) * self.steps;
        let columns = x * self.steps..=(x + 1) * self.steps;
        rows.flat_map(move |y| {
            columns
                .clone()
                .map(move |x| self.directions[y * across + x])
        })
    }

    /// Angle by which a cone around points of the grid is widened, radians: half their spacing, and rounding.
    fn margin(&self) -> f32 {
        let between = if self.steps == 1 {
            0.0
        } else {
            1.0 / self.edge as f32
        };
        between + 1e-3
    }
}

/// Cones of the squares of a density, from the finest level that has cones to the whole sphere. A texel is the axis of
/// the cone around all directions of its square where the density is above 0, and the cosine of its half angle, both
/// times the square's mean density. `finest` is the density of `edge` × `edge` squares.
pub fn cones(finest: &[f32], edge: usize) -> Vec<Vec<Vec4>> {
    let lattice = Lattice::new(edge);
    let levels = edge.min(CONE_EDGE).ilog2() + 1;
    let level = |k: u32| {
        let count = 1_usize << (levels - 1 - k);
        let cell = |i: usize| cone_of_cell(finest, &lattice, [i % count, i / count], edge / count);
        (0..count * count).map(cell).collect()
    };
    (0..levels).map(level).collect()
}

/// The cone of a cell of `side` × `side` squares, `at` cells from the corner.
fn cone_of_cell(finest: &[f32], lattice: &Lattice, at: [usize; 2], side: usize) -> Vec4 {
    let squares = (0..side * side).map(|k| [at[0] * side + k % side, at[1] * side + k / side]);
    let density = |[x, y]: [usize; 2]| finest[y * lattice.edge + x];
    let lit: Vec<_> = squares.filter(|at| density(*at) > 0.0).collect();
    let sum: f32 = lit.iter().map(|at| density(*at)).sum();
    let points = |at: &[usize; 2]| lattice.of_square(*at);
    let weighted = |at: &[usize; 2]| points(at).sum::<Vec3>() * (density(*at) / sum);
    let axis: Vec3 = lit.iter().map(weighted).sum();
    let axis = axis.try_normalize().unwrap_or(Vec3::Y);
    let cosines = lit.iter().flat_map(points).map(|d| axis.dot(d));
    let half_angle = cosines.fold(1.0, f32::min).clamp(-1.0, 1.0).acos() + lattice.margin();
    axis.extend(half_angle.min(PI).cos()) * (sum / (side * side) as f32)
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    #[test]
    fn a_cone_holds_all_lit_directions_of_its_square() {
        for (edge, lit) in [(64_usize, 7), (64, 501), (16, 3), (4, 2), (1, 1)] {
            // Every `lit`-th square shines, each otherwise.
            let finest: Vec<_> = (0..edge * edge)
                .map(|i| if i % lit == 0 { 1.0 + i as f32 } else { 0.0 })
                .collect();
            let levels = cones(&finest, edge);
            assert_eq!(levels.last().map(Vec::len), Some(1));
            for (k, level) in levels.iter().enumerate() {
                let across = edge.min(CONE_EDGE) >> k;
                let side = edge / across;
                for i in (0..edge * edge).filter(|i| finest[*i] > 0.0) {
                    let at = UVec2::new((i % edge) as u32, (i / edge) as u32);
                    let texel = level[at.y as usize / side * across + at.x as usize / side];
                    let (sum, density) = (texel.truncate(), texel.truncate().length());
                    let place = (at.as_vec2() + Vec2::new(0.9, 0.2)) / edge as f32;
                    let found = direction_of_square(place).dot(sum);
                    assert!(
                        density > 0.0 && found >= texel.w - 1e-4 * density,
                        "{edge} {k} {at}"
                    );
                }
            }
        }
    }

    #[test]
    fn one_bright_square_has_a_narrow_cone_on_every_level() {
        let mut finest = vec![0.0; 256 * 256];
        finest[70 * 256 + 9] = 4.0;
        for level in cones(&finest, 256) {
            let lit: Vec<_> = level.iter().filter(|c| **c != Vec4::ZERO).collect();
            assert_eq!(lit.len(), 1);
            assert!(lit[0].w / lit[0].truncate().length() > 0.999);
        }
    }
}
