//! Buffer layout of triangles and instances for traversal.

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Vec3};

use crate::{math::in_f64, world::Material};

/// Flag: hits ask `alpha_passes` first.
pub const ALPHA_TESTED: u32 = 1;
/// Flag: double-sided.
pub const DOUBLE_SIDED: u32 = 2;
/// Flag: clockwise is the front, because a mirroring transform was baked in.
pub const FLIPPED: u32 = 4;

/// A triangle as traversal reads it, 48 bytes (3 × `vec4u`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TraceTriangle {
    /// Vertex 0; world space in the static tree, object space in mesh trees.
    pub base: [f32; 3],
    /// Index of its instance; [`NONE`](super::NONE) in mesh trees.
    pub instance: u32,
    /// Vertex 1 − vertex 0.
    pub edge1: [f32; 3],
    /// Index in its mesh.
    pub triangle: u32,
    /// Vertex 2 − vertex 0.
    pub edge2: [f32; 3],
    /// [`ALPHA_TESTED`], [`DOUBLE_SIDED`], [`FLIPPED`]; 0 in mesh trees, where the instance decides.
    pub flags: u32,
}

/// What traversal reads of an instance, 64 bytes (4 × `vec4`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TraceInstance {
    /// xyz: rows of the inverse's linear part L; w: the world translation T of the placement, by
    /// component. `object = L (world − T)`, which keeps its precision far from the origin.
    pub object_from_world: [[f32; 4]; 3],
    /// Root of its mesh tree; [`NONE`](super::NONE) where it is part of the static tree.
    pub tree_root: u32,
    /// [`ALPHA_TESTED`] and [`DOUBLE_SIDED`] of its material. Object space keeps its winding, so
    /// [`FLIPPED`] is never set.
    pub trace_flags: u32,
    /// Unused.
    pub padding: [u32; 2],
}

impl TraceInstance {
    /// Record of an instance with this transform.
    pub(super) fn new(world_from_object: &Affine3A, material: &Material, tree_root: u32) -> Self {
        // Inverted in f64, so that only its storage rounds.
        let inverse = in_f64(world_from_object).matrix3.inverse().as_mat3();
        let row = |k: usize| {
            inverse
                .row(k)
                .extend(world_from_object.translation[k])
                .to_array()
        };
        Self {
            object_from_world: [row(0), row(1), row(2)],
            tree_root,
            trace_flags: material_flags(material),
            padding: [0; 2],
        }
    }
}

pub(super) fn material_flags(material: &Material) -> u32 {
    let flag = |set: bool, bit: u32| if set { bit } else { 0 };
    // Light that passes is asked for like cut-outs, behind the traversal.
    let tested = material.alpha_cutoff.is_some() || material.passes_light();
    flag(tested, ALPHA_TESTED) | flag(material.double_sided, DOUBLE_SIDED)
}

pub(super) fn trace_triangle(
    [a, b, c]: [Vec3; 3],
    instance: u32,
    triangle: u32,
    flags: u32,
) -> TraceTriangle {
    TraceTriangle {
        base: a.to_array(),
        instance,
        edge1: (b - a).to_array(),
        triangle,
        edge2: (c - a).to_array(),
        flags,
    }
}
