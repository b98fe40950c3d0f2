//! Tangents by MikkTSpace, the algorithm that normal maps are baked against.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Mat2, Vec2, Vec3, Vec4};

use super::{Mesh, normal_uv::NormalUv};

struct Corners<'a> {
    triangles: &'a [[u32; 3]],
    positions: &'a [Vec3],
    normals: &'a [Vec3],
    uv: &'a [Vec2],
    turn: Mat2,
    /// Tangent of each corner of each triangle.
    tangents: Vec<Vec4>,
}

impl<'a> Corners<'a> {
    fn new(mesh: &'a Mesh, [positions, normals]: [&'a [Vec3]; 2], normal_uv: &NormalUv) -> Self {
        let has_second = normal_uv.uv_set == 1 && !mesh.uv1.is_empty();
        Self {
            triangles: &mesh.triangles,
            positions,
            normals,
            uv: if has_second { &mesh.uv1 } else { &mesh.uv0 },
            turn: normal_uv.turn,
            tangents: vec![Vec4::ZERO; mesh.triangles.len() * 3],
        }
    }

    fn index(&self, face: usize, corner: usize) -> usize {
        self.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.positions[self.index(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.normals[self.index(face, corner)].into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.turn * self.uv[self.index(face, corner)];
        // MikkTSpace thinks of v as pointing up, glTF's points down.
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            self.tangents[face * 3 + corner] = space.tangent_encoded().into();
        }
    }
}

/// The tangent of each corner of each triangle of a mesh with these positions and normals; zeros where texture
/// coordinates give none.
pub fn of_corners(mesh: &Mesh, streams: [&[Vec3]; 2], normal_uv: &NormalUv) -> Vec<Vec4> {
    let mut corners = Corners::new(mesh, streams, normal_uv);
    // The only error is having no faces: then there is nothing to fill.
    let _ = generate_tangents(&mut corners);
    corners.tangents
}

/// Tangents of a posed mesh whose vertices were split by loading: each vertex has the tangent of its first corner.
pub fn of_vertices(mesh: &Mesh, posed: [&[Vec3]; 2], normal_uv: &NormalUv) -> Vec<Vec4> {
    let corners = of_corners(mesh, posed, normal_uv);
    let [positions, normals] = posed;
    let mut tangents = vec![None; positions.len()];
    for (vertex, corner) in mesh.triangles.iter().flatten().zip(corners) {
        tangents[*vertex as usize].get_or_insert(corner);
    }
    let each = tangents.into_iter().zip(normals);
    each.map(|(tangent, normal)| usable(tangent, *normal))
        .collect()
}

/// The normalized tangent; with degenerate texture coordinates any direction in the surface.
pub fn usable(tangent: Option<Vec4>, normal: Vec3) -> Vec4 {
    let tangent = tangent.unwrap_or(Vec4::ZERO);
    let direction = tangent.truncate().try_normalize().filter(|d| d.is_finite());
    let direction = direction.unwrap_or_else(|| normal.any_orthonormal_vector());
    direction.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}
