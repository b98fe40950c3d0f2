//! Meshes that are written as numbers.

use glam::{Vec2, Vec3, Vec4};
use reflet_scene::desc::ShapeDesc;

use crate::{
    Mesh,
    deform::{smooth_normals, vectors},
};

/// The mesh of a description that its reader has checked; an empty one for any other shape.
pub fn mesh(shape: &ShapeDesc) -> Mesh {
    let ShapeDesc::Mesh {
        positions,
        indices,
        normals,
        uv,
        colors,
        ..
    } = shape
    else {
        return Mesh::default();
    };
    let triangle = |corners: &[f32]| [corners[0] as u32, corners[1] as u32, corners[2] as u32];
    let mut mesh = Mesh {
        positions: vectors(positions),
        triangles: indices.chunks_exact(3).map(triangle).collect(),
        uv0: uv.chunks_exact(2).map(Vec2::from_slice).collect(),
        colors: vectors(colors)
            .iter()
            .map(|c| c.extend(1.0))
            .collect::<Vec<Vec4>>(),
        ..Mesh::default()
    };
    let own = vectors(normals);
    let smooth = if own.is_empty() {
        smooth_normals(&mesh.positions, &mesh.triangles)
    } else {
        own
    };
    mesh.normals = smooth
        .into_iter()
        .map(|n| n.normalize_or(Vec3::Y))
        .collect();
    mesh.uv0.resize(mesh.positions.len(), Vec2::ZERO);
    mesh
}
