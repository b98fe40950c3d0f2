//! Tangents of meshes as they are loaded, whose vertices are split where tangents differ.

use glam::Vec4;

use crate::{
    Mesh,
    corner_tangents::{of_corners, usable},
    gltf::repair::gather_vertices,
    normal_uv::NormalUv,
};

/// Fills `mesh.tangents`; vertices whose corners disagree are split.
pub fn generate(mesh: &mut Mesh, normal_uv: &NormalUv) {
    let tangents = of_corners(mesh, [&mesh.positions, &mesh.normals], normal_uv);
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
