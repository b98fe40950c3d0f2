//! Collects the corners of a shape's triangles into a mesh.

use std::collections::HashMap;

use glam::{DVec2, DVec3, Vec2, Vec3};

use super::Fault;
use crate::Mesh;

/// Largest number of triangles of a shape made of outlines, text or other shapes.
pub const MOST_TRIANGLES: usize = 2_000_000;

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    /// Position, meters.
    pub at: Vec3,
    /// Direction out of the solid, of any length.
    pub normal: DVec3,
    /// Texture coordinates, v down.
    pub uv: DVec2,
}

impl Corner {
    /// A corner, its position rounded.
    pub fn new(at: DVec3, normal: DVec3, uv: DVec2) -> Self {
        let at = at.as_vec3();
        Self { at, normal, uv }
    }
}

/// A mesh that grows by triangles; equal corners are one vertex.
#[derive(Default)]
pub struct Solid {
    mesh: Mesh,
    vertices: HashMap<[u32; 8], u32>,
}

impl Solid {
    /// Adds a triangle, counter-clockwise seen from outside, but not one whose corners coincide: its neighbors then
    /// share their edges with each other.
    pub fn triangle(&mut self, corners: [Corner; 3]) {
        let [a, b, c] = corners.map(|corner| corner.at);
        if a != b && b != c && c != a {
            let indices = corners.map(|corner| self.vertex(&corner));
            self.mesh.triangles.push(indices);
        }
    }

    /// Adds a quadrilateral as two triangles; corners in order around it.
    pub fn quad(&mut self, [a, b, c, d]: [Corner; 4]) {
        self.triangle([a, b, c]);
        self.triangle([a, c, d]);
    }

    fn vertex(&mut self, corner: &Corner) -> u32 {
        // 0.0 and -0.0 are the same place.
        let at = corner.at + Vec3::ZERO;
        let normal = corner.normal.normalize_or(DVec3::Y).as_vec3() + Vec3::ZERO;
        let uv: Vec2 = corner.uv.clamp(DVec2::ZERO, DVec2::ONE).as_vec2();
        let key = [at.x, at.y, at.z, normal.x, normal.y, normal.z, uv.x, uv.y];
        let next = self.mesh.positions.len() as u32;
        *(self.vertices.entry(key.map(f32::to_bits))).or_insert_with(|| {
            self.mesh.positions.push(at);
            self.mesh.normals.push(normal);
            self.mesh.uv0.push(uv);
            next
        })
    }

    /// The mesh, without bounds and name.
    pub fn into_mesh(self) -> Mesh {
        self.mesh
    }
}

/// Refuses a shape of more triangles than [`MOST_TRIANGLES`], before they are made.
///
/// # Errors
/// `shape-too-large`, with advice to lower one of `keys`.
pub fn check_size(triangles: usize, keys: &str) -> Result<(), Fault> {
    if triangles <= MOST_TRIANGLES {
        return Ok(());
    }
    let message =
        format!("this shape would have {triangles} triangles, of at most {MOST_TRIANGLES}");
    Err(Fault::new("shape-too-large", message).help(format!("lower {keys}")))
}
