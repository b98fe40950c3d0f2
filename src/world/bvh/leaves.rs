//! Triangles and capsules as the leaves of trees: in world space in the static tree, in object space in mesh trees.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use rayon::prelude::*;

use super::{
    FLIPPED, NONE, STACK_SIZE, TraceTriangle,
    gpu_layout::{instance_flags, trace_capsule, trace_triangle},
    placement::error,
    tree::Tree,
};
use crate::{Mesh, World, reach};
use reflet_base::math::{Bounds, in_f64};
use reflet_scene::diagnostic::Diagnostic;

/// The tree of a mesh, below the top level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshTree {
    /// Index into [`World::meshes`](crate::World::meshes).
    pub mesh: usize,
    /// Range in [`Trees::triangles`](super::Trees::triangles).
    pub triangles: Range<usize>,
    /// Whether animations deform the mesh.
    pub is_deformed: bool,
}

impl MeshTree {
    pub(super) fn new(mesh: usize, triangles: Range<usize>, is_deformed: bool) -> Self {
        Self {
            mesh,
            triangles,
            is_deformed,
        }
    }
}

/// Corners of a triangle in the current pose of its mesh, object space.
pub(super) fn corners(world: &World, mesh: usize, triangle: u32) -> [Vec3; 3] {
    let corners = world.meshes[mesh].triangles[triangle as usize];
    world.posed(mesh).corners(corners)
}

/// Corners in world space: transformed in f64 and rounded once, so that triangles which share a
/// vertex still share it.
pub(super) fn world_corners(world: &World, instance: u32, triangle: u32) -> [Vec3; 3] {
    let placed = &world.instances[instance as usize];
    let transform = in_f64(&placed.world_from_object);
    corners(world, placed.mesh, triangle)
        .map(|p| transform.transform_point3(p.as_dvec3()).as_vec3())
}

/// Corners of a triangle of [`Trees::triangles`](super::Trees::triangles): in world space in the static tree, in object
/// space in the tree of a mesh. Unlike the sum of a corner and an edge they are equal where triangles share them.
pub fn leaf_corners(world: &World, mesh: Option<usize>, leaf: &TraceTriangle) -> [Vec3; 3] {
    match mesh {
        Some(mesh) => corners(world, mesh, leaf.triangle),
        None => world_corners(world, leaf.instance, leaf.triangle),
    }
}

pub(super) fn bounding_box(corners: [Vec3; 3]) -> Aabb {
    Aabb::from_points(&corners.map(Into::into))
}

/// Whether a triangle has an area, so that a ray can hit it.
pub(super) fn has_area([a, b, c]: [Vec3; 3]) -> bool {
    (b - a).cross(c - a) != Vec3::ZERO
}

pub(super) fn too_far(what: &str) -> Box<Diagnostic> {
    error(reach::TOO_FAR, &reach::too_far(what), reach::TOO_FAR_HELP)
}

fn is_far(tree_box: &Aabb) -> bool {
    let (min, max) = (tree_box.min.into(), tree_box.max.into());
    !reach::is_within_reach(&Bounds { min, max })
}

/// The tree of a mesh whose traversal needs no more than `stack` entries, and its triangles in leaf order.
pub(super) fn mesh_tree(
    mesh: &Mesh,
    stack: u32,
) -> Result<(Tree, Vec<TraceTriangle>), Box<Diagnostic>> {
    let corners = |t: u32| mesh.at_rest().corners(mesh.triangles[t as usize]);
    let radius = mesh.capsule_radius_m;
    let ids: Vec<u32> = (0..mesh.triangles.len() as u32)
        .filter(|t| radius.is_some() || has_area(corners(*t)))
        .collect();
    let around = Vec3A::splat(radius.unwrap_or(0.0));
    let boxes = ids.iter().map(|t| bounding_box(corners(*t)));
    let boxes: Vec<_> = boxes
        .map(|b| Aabb::new(b.min - around, b.max + around))
        .collect();
    if boxes.iter().any(is_far) {
        return Err(too_far(&format!("mesh \"{}\"", mesh.name)));
    }
    let tree = Tree::within(&boxes, stack);
    let triangles = tree
        .order
        .iter()
        .map(|p| ids[*p as usize])
        .map(|t| match (radius, corners(t)) {
            (Some(radius), [a, b, _]) => trace_capsule([a, b], radius, t),
            (None, corners) => trace_triangle(corners, NONE, t, 0),
        })
        .collect();
    Ok((tree, triangles))
}

pub(super) fn static_tree(
    world: &World,
    baked: &[u32],
) -> Result<(Tree, Vec<TraceTriangle>), Box<Diagnostic>> {
    let (ids, boxes): (Vec<_>, Vec<_>) = baked
        .par_iter()
        .flat_map(|i| {
            let mesh = &world.meshes[world.instances[*i as usize].mesh];
            (0..mesh.triangles.len() as u32)
                .into_par_iter()
                .map(move |t| ((*i, t), world_corners(world, *i, t)))
        })
        .filter(|(_, corners)| has_area(*corners))
        .map(|(id, corners)| (id, bounding_box(corners)))
        .unzip();
    if let Some(bad) = boxes.par_iter().position_first(is_far) {
        let name = &world.instances[ids[bad].0 as usize].name;
        return Err(too_far(&format!("instance \"{name}\"")));
    }
    let tree = Tree::within(&boxes, STACK_SIZE);
    drop(boxes);
    let flags: Vec<u32> = world
        .instances
        .iter()
        .map(|i| {
            let mirrors = in_f64(&i.world_from_object).matrix3.determinant() < 0.0;
            instance_flags(i, world) | if mirrors { FLIPPED } else { 0 }
        })
        .collect();
    let triangles = tree
        .order
        .par_iter()
        .map(|p| {
            let (i, t) = ids[*p as usize];
            trace_triangle(world_corners(world, i, t), i, t, flags[i as usize])
        })
        .collect();
    Ok((tree, triangles))
}
