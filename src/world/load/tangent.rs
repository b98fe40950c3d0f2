//! Tangents by MikkTSpace, the algorithm that normal maps are baked against.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Mat2, Vec2, Vec4};

use crate::{Mesh, gltf::repair::gather_vertices, normal_uv::NormalUv};

struct Corners<'a> {
    mesh: &'a Mesh,
    uv: &'a [Vec2],
    turn: Mat2,
    /// Tangent of each corner of each triangle.
    tangents: Vec<Vec4>,
}

impl Corners<'_> {
    fn index(&self, face: usize, corner: usize) -> usize {
        self.mesh.triangles[face][corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangles.len()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.index(face, corner)].into()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.index(face, corner)].into()
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

/// Fills `mesh.tangents`; vertices whose corners disagree are split.
pub fn generate(mesh: &mut Mesh, normal_uv: &NormalUv) {
    let uv = if normal_uv.uv_set == 1 && !mesh.uv1.is_empty() {
        &mesh.uv1
    } else {
        &mesh.uv0
    };
    let tangents = vec![Vec4::ZERO; mesh.triangles.len() * 3];
    let mut corners = Corners {
        mesh,
        uv,
        turn: normal_uv.turn,
        tangents,
    };
    // The only error is having no faces: then there is nothing to fill.
    let _ = generate_tangents(&mut corners);
    let tangents = corners.tangents;
    split(mesh, tangents);
}

/// Gives every vertex one tangent: the first corner's; corners that differ get a copy of the vertex.
fn split(mesh: &mut Mesh, corners: Vec<Vec4>) {
    const NONE: u32 = u32::MAX;
    let count = mesh.positions.len();
    let mut order: Vec<u32> = (0..count as u32).collect();
    let mut tangents: Vec<Option<Vec4>> = vec![None; count];
    let mut next_copy = vec![NONE; count];
    for (corner, tangent) in mesh.triangles.iter_mut().flatten().zip(corners) {
        let mut at = *corner as usize;
        loop {
            match tangents[at] {
                None => tangents[at] = Some(tangent),
                Some(own) if own == tangent => {}
                Some(_) if next_copy[at] != NONE => {
                    at = next_copy[at] as usize;
                    continue;
                }
                Some(_) => {
                    next_copy[at] = order.len() as u32;
                    at = order.len();
                    order.push(*corner);
                    tangents.push(Some(tangent));
                    next_copy.push(NONE);
                }
            }
            break;
        }
        *corner = at as u32;
    }
    if order.len() > count {
        gather_vertices(mesh, &order);
    }
    let normals = mesh.normals.iter();
    mesh.tangents = tangents
        .into_iter()
        .zip(normals)
        .map(|(t, n)| usable(t, *n))
        .collect();
}

/// The normalized tangent; with degenerate texture coordinates any direction in the surface.
fn usable(tangent: Option<Vec4>, normal: glam::Vec3) -> Vec4 {
    let tangent = tangent.unwrap_or(Vec4::ZERO);
    let direction = tangent.truncate().try_normalize().filter(|d| d.is_finite());
    let direction = direction.unwrap_or_else(|| normal.any_orthonormal_vector());
    direction.extend(if tangent.w < 0.0 { -1.0 } else { 1.0 })
}
