//! Points and lines as thin geometry, so that rays meet what rasterization shows: octahedra and
//! four-sided tubes.

use glam::{Vec2, Vec3, Vec4};

use super::{Fault, accessor::Data};
use crate::Mesh;
use reflet_base::math::Bounds;

/// Radius of a point, as a fraction of the diagonal of its primitive.
const POINT_RADIUS: f32 = 1.0 / 300.0;
/// Radius of a line, as a fraction of the diagonal of its primitive.
const LINE_RADIUS: f32 = 1.0 / 600.0;
/// Radius where a primitive has no size, meters.
const RADIUS_M: f32 = 0.01;
/// Bytes of a vertex and of its share of the triangles, all attributes included.
const VERTEX_BYTES: u64 = 128;

/// Replaces the vertices of a primitive of points (mode 0), or of lines (1 to 3: segments, a loop, a strip), by
/// thin geometry around them, which keeps their colors and texture coordinates.
///
/// # Errors
/// More geometry than the file's budget.
pub fn build(mesh: &mut Mesh, mode: u32, corners: &[u32], data: &Data<'_>) -> Result<(), Fault> {
    let finite = |i: &u32| mesh.positions[*i as usize].is_finite();
    let used = corners.iter().filter(|i| finite(i));
    let diagonal = Bounds::of(used.map(|i| mesh.positions[*i as usize])).diagonal();
    let fraction = if mode == 0 { POINT_RADIUS } else { LINE_RADIUS };
    let radius_m = match diagonal * fraction {
        size if size > 0.0 && size.is_finite() => size,
        _ => RADIUS_M,
    };
    let segments = segments(mode, corners);
    let num_vertices = num_vertices(mode, corners.len());
    data.spend(bytes(num_vertices))?;
    let mut out = Wire {
        from: mesh,
        positions: Vec::with_capacity(num_vertices),
        normals: Vec::with_capacity(num_vertices),
        source: Vec::with_capacity(num_vertices),
        triangles: Vec::new(),
    };
    match mode {
        0 => corners.iter().for_each(|i| out.point(*i, radius_m)),
        _ => segments.iter().for_each(|ends| out.line(*ends, radius_m)),
    }
    out.finish();
    Ok(())
}

/// Number of vertices of the geometry around so many corners.
pub fn num_vertices(mode: u32, num_corners: usize) -> usize {
    let num_segments = match mode {
        0 => return num_corners * 6,
        1 => num_corners / 2,
        2 if num_corners > 1 => num_corners,
        _ => num_corners.saturating_sub(1),
    };
    num_segments * 8
}

/// Memory of so many vertices and their triangles, bytes.
pub fn bytes(num_vertices: usize) -> u64 {
    num_vertices as u64 * VERTEX_BYTES
}

/// The two ends of each segment (glTF 2.0 §3.7.2.1).
fn segments(mode: u32, corners: &[u32]) -> Vec<[u32; 2]> {
    let strip = || corners.windows(2).map(|w| [w[0], w[1]]);
    match (mode, corners) {
        (1, _) => corners.chunks_exact(2).map(|c| [c[0], c[1]]).collect(),
        (2, [first, .., last]) => strip().chain([[*last, *first]]).collect(),
        (2 | 3, _) => strip().collect(),
        _ => Vec::new(),
    }
}

/// Geometry that is being built.
struct Wire<'a> {
    from: &'a mut Mesh,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// Original vertex of each vertex.
    source: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

impl Wire<'_> {
    fn vertex(&mut self, source: u32, normal: Vec3, radius_m: f32) {
        let center = self.from.positions[source as usize];
        self.positions.push(center + normal * radius_m);
        self.normals.push(normal);
        self.source.push(source);
    }

    fn point(&mut self, at: u32, radius_m: f32) {
        let first = self.positions.len() as u32;
        for normal in [
            Vec3::X,
            Vec3::Y,
            Vec3::NEG_X,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
        ] {
            self.vertex(at, normal, radius_m);
        }
        for k in 0..4 {
            let (a, b) = (first + k, first + (k + 1) % 4);
            self.triangles.push([a, b, first + 4]);
            self.triangles.push([b, a, first + 5]);
        }
    }

    fn line(&mut self, ends: [u32; 2], radius_m: f32) {
        let [from, to] = ends.map(|i| self.from.positions[i as usize]);
        let Some(along) = (to - from).try_normalize() else {
            return;
        };
        let (u, v) = along.any_orthonormal_pair();
        let first = self.positions.len() as u32;
        for end in ends {
            for normal in [u, v, -u, -v] {
                self.vertex(end, normal, radius_m);
            }
        }
        for k in 0..4 {
            let (a, b) = (first + k, first + (k + 1) % 4);
            self.triangles.push([a, b, b + 4]);
            self.triangles.push([a, b + 4, a + 4]);
        }
    }

    /// Replaces the original vertices and triangles of the mesh.
    fn finish(self) {
        fn pick<T: Copy>(values: &mut Vec<T>, source: &[u32]) {
            if !values.is_empty() {
                *values = source.iter().map(|&i| values[i as usize]).collect();
            }
        }
        let mesh = self.from;
        pick::<Vec2>(&mut mesh.uv0, &self.source);
        pick::<Vec2>(&mut mesh.uv1, &self.source);
        pick::<Vec4>(&mut mesh.colors, &self.source);
        mesh.tangents = Vec::new();
        (mesh.positions, mesh.normals) = (self.positions, self.normals);
        mesh.triangles = self.triangles;
    }
}
