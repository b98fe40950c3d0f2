//! Mesh repair: establishes the invariants of [`Mesh`] (finite, no zero-area triangles, unit
//! normals, bounds) and warns about changes.

use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3, Vec4};

use super::Notes;
use crate::{Mesh, deform::pick};

/// Repairs a mesh in place. A deformed mesh keeps triangles without area, which may have some in another pose.
pub fn run(mesh: &mut Mesh, notes: &mut Notes) {
    drop_broken_triangles(mesh, notes);
    match (mesh.capsule_radius_m, mesh.normals.as_slice()) {
        (Some(_), []) => {}
        (None, []) => make_flat(mesh),
        _ => fix_normals(mesh, notes),
    }
    fix_tangents(mesh);
    fix_attributes(mesh, notes);
    mesh.bounds = mesh.bounds_at_rest();
    mesh.bind();
}

fn cross(positions: &[Vec3], [a, b, c]: [u32; 3]) -> DVec3 {
    let [a, b, c] = [a, b, c].map(|i| positions[i as usize].as_dvec3());
    (b - a).cross(c - a)
}

fn drop_broken_triangles(mesh: &mut Mesh, notes: &mut Notes) {
    let (positions, deforms) = (&mesh.positions, mesh.deformation.is_some());
    let are_capsules = mesh.capsule_radius_m.is_some();
    let (mut not_finite, mut flat) = (0, 0);
    mesh.triangles.retain(|&t| {
        if !t.iter().all(|&i| positions[i as usize].is_finite()) {
            not_finite += 1;
            return false;
        }
        let keep = deforms || are_capsules || cross(positions, t).length_squared() > 0.0;
        flat += u64::from(!keep);
        keep
    });
    let what = match are_capsules {
        true => "points and lines with NaN or infinite vertices are dropped",
        false => "triangles with NaN or infinite vertices are dropped",
    };
    notes.add("vertex-not-finite", not_finite, what, &mesh.name);
    let what = "triangles without area are dropped";
    notes.add("triangle-degenerate", flat, what, &mesh.name);
    if not_finite > 0 || mesh.positions.iter().any(|p| !p.is_finite()) {
        keep_used_vertices(mesh);
    }
}

/// Removes the vertices that no triangle uses.
fn keep_used_vertices(mesh: &mut Mesh) {
    const UNUSED: u32 = u32::MAX;
    let mut new_index = vec![UNUSED; mesh.positions.len()];
    let mut order = Vec::new();
    for corner in mesh.triangles.iter_mut().flatten() {
        let slot = &mut new_index[*corner as usize];
        if *slot == UNUSED {
            *slot = order.len() as u32;
            order.push(*corner);
        }
        *corner = *slot;
    }
    gather_vertices(mesh, &order);
}

/// Vertex `i` of the result is vertex `order[i]` of `mesh`; triangles are left alone.
pub fn gather_vertices(mesh: &mut Mesh, order: &[u32]) {
    pick(&mut mesh.positions, order);
    pick(&mut mesh.normals, order);
    pick(&mut mesh.tangents, order);
    pick(&mut mesh.uv0, order);
    pick(&mut mesh.uv1, order);
    pick(&mut mesh.colors, order);
    if let Some(deformation) = &mut mesh.deformation {
        Arc::make_mut(deformation).gather(order);
    }
}

/// Computes flat normals, as the specification demands where the file has none: each corner gets its own vertex.
fn make_flat(mesh: &mut Mesh) {
    let order: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
    gather_vertices(mesh, &order);
    for (t, triangle) in mesh.triangles.iter_mut().enumerate() {
        *triangle = std::array::from_fn(|corner| (t * 3 + corner) as u32);
    }
    let normal = |t: &[u32; 3]| {
        let normal = cross(&mesh.positions, *t).try_normalize();
        [normal.map_or(Vec3::Y, |n| n.as_vec3()); 3]
    };
    mesh.normals = mesh.triangles.iter().flat_map(normal).collect();
    if let Some(deformation) = &mut mesh.deformation {
        Arc::make_mut(deformation).has_flat_normals = true;
    }
}

/// Normalizes normals; one without a direction is replaced by the average of the faces around it.
fn fix_normals(mesh: &mut Mesh, notes: &mut Notes) {
    let usable = |n: &Vec3| n.is_finite() && n.length_squared() > 1e-12;
    let mut used = vec![false; mesh.normals.len()];
    mesh.triangles
        .iter()
        .flatten()
        .for_each(|&i| used[i as usize] = true);
    let bad = mesh
        .normals
        .iter()
        .zip(&used)
        .filter(|(n, used)| **used && !usable(n))
        .count();
    let mut faces = Vec::new();
    if bad > 0 {
        let what = match mesh.capsule_radius_m {
            Some(_) => "normals of points and lines have no direction; they point along +Y",
            None => "normals have no direction and are computed from the faces",
        };
        notes.add("normal-invalid", bad as u64, what, &mesh.name);
        faces = vec![DVec3::ZERO; mesh.normals.len()];
        for t in &mesh.triangles {
            let normal = cross(&mesh.positions, *t);
            t.iter().for_each(|&i| faces[i as usize] += normal);
        }
    }
    for (i, normal) in mesh.normals.iter_mut().enumerate() {
        *normal = if usable(normal) {
            normal.as_dvec3().normalize().as_vec3()
        } else {
            let face = faces.get(i).copied().unwrap_or_default();
            face.try_normalize().map_or(Vec3::Y, |n| n.as_vec3())
        };
    }
}

/// Normalizes tangents; if any has no direction, all are dropped and generated where needed.
fn fix_tangents(mesh: &mut Mesh) {
    for tangent in &mut mesh.tangents {
        let sign = if tangent.w < 0.0 { -1.0 } else { 1.0 };
        match tangent.truncate().as_dvec3().try_normalize() {
            Some(t) => *tangent = t.as_vec3().extend(sign),
            None => return mesh.tangents = Vec::new(),
        }
    }
}

fn fix_attributes(mesh: &mut Mesh, notes: &mut Notes) {
    let mut bad = 0;
    for uv in mesh
        .uv0
        .iter_mut()
        .chain(&mut mesh.uv1)
        .filter(|uv| !uv.is_finite())
    {
        *uv = Vec2::ZERO;
        bad += 1;
    }
    notes.add(
        "uv-not-finite",
        bad,
        "texture coordinates are NaN or infinite, 0 is used",
        &mesh.name,
    );
    bad = 0;
    for color in mesh.colors.iter_mut().filter(|c| !c.is_finite()) {
        *color = Vec4::ONE;
        bad += 1;
    }
    notes.add(
        "color-not-finite",
        bad,
        "vertex colors are NaN or infinite, white is used",
        &mesh.name,
    );
}
