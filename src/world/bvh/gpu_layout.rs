//! Buffer layout of triangles and instances for traversal.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::capsule::Capsule;
use crate::{Instance, World};
use reflet_base::math::{Bounds, in_f64};

/// Flag: hits on cut-outs (`alpha_passes`) and transmissive materials are tested again after the traversal.
pub const ALPHA_TESTED: u32 = 1;
/// Flag: double-sided.
pub const DOUBLE_SIDED: u32 = 2;
/// Flag: clockwise is the front, because a mirroring transform was baked in.
pub const FLIPPED: u32 = 4;
/// Flag: camera rays pass through.
pub const UNSEEN: u32 = 8;
/// Flag: shadow rays pass through.
pub const SHADOWLESS: u32 = 16;
/// Flag: reflected rays, and rays that come through glass, pass through.
pub const UNREFLECTED: u32 = 32;

/// Flag of instances: the mesh is of capsules. They are never part of the static tree, so that placements may squeeze
/// them.
pub const CAPSULES: u32 = 64;

/// Flag of instances: they may move, so that probes do not see them. They are never part of the static tree.
pub const MOVES: u32 = 128;

/// Flag of instances: no reflection shows their light, which lights the matte part of surfaces alone.
pub const MATTE_LIGHT: u32 = 256;

/// A triangle, or in mesh trees a capsule, as traversal reads it, 48 bytes (3 × `vec4u`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TraceTriangle {
    /// Vertex 0; world space in the static tree, object space in mesh trees.
    pub base: [f32; 3],
    /// Index of the triangle's instance; [`NONE`](super::NONE) in mesh trees.
    pub instance: u32,
    /// Vertex 1 − vertex 0; the axis of a capsule.
    pub edge1: [f32; 3],
    /// Index of the triangle in its mesh.
    pub triangle: u32,
    /// Vertex 2 − vertex 0; the radius of a capsule, then zeros.
    pub edge2: [f32; 3],
    /// Flags [`ALPHA_TESTED`], [`DOUBLE_SIDED`], [`FLIPPED`], [`UNSEEN`], [`SHADOWLESS`], [`UNREFLECTED`]; 0 in
    /// mesh trees, where the instance has them.
    pub flags: u32,
}

/// Instance record that traversal reads, 64 bytes (4 × `vec4`).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TraceInstance {
    /// xyz: rows of the inverse's linear part L; w: the world translation T of the placement, by
    /// component. `object = L (world − T)`, which keeps its precision far from the origin.
    pub object_from_world: [[f32; 4]; 3],
    /// Node index of the root of its mesh tree; [`NONE`](super::NONE) where it is part of the static tree.
    pub tree_root: u32,
    /// Flags as in [`TraceTriangle::flags`]. Object space keeps the winding, so [`FLIPPED`] is never set.
    pub trace_flags: u32,
    /// Unused.
    pub padding: [u32; 2],
}

impl TraceInstance {
    /// Record of an instance of a world.
    pub(super) fn new(instance: &Instance, world: &World, tree_root: u32) -> Self {
        let world_from_object = &instance.world_from_object;
        // Inverted in f64, so that only the stored result is rounded.
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
            trace_flags: instance_flags(instance, world),
            padding: [0; 2],
        }
    }
}

/// Traversal flags of an instance, except [`FLIPPED`].
pub(super) fn instance_flags(instance: &Instance, world: &World) -> u32 {
    let (material, shown) = (&world.materials[instance.material], instance.shown);
    let are_capsules =
        (world.meshes.get(instance.mesh)).is_some_and(|m| m.capsule_radius_m.is_some());
    let flag = |set: bool, bit: u32| if set { bit } else { 0 };
    // Transmissive surfaces are tested after the traversal, like cut-outs.
    let tested = material.alpha_cutoff.is_some() || material.passes_light();
    flag(tested, ALPHA_TESTED)
        | flag(material.double_sided, DOUBLE_SIDED)
        | flag(are_capsules, CAPSULES)
        | flag(instance.dynamic, MOVES)
        | flag(!shown.visible, UNSEEN)
        | flag(!shown.casts_shadow, SHADOWLESS)
        | flag(!shown.in_reflections, UNREFLECTED | MATTE_LIGHT)
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

/// A capsule around the segment between two points.
pub(super) fn trace_capsule([a, b]: [Vec3; 2], radius: f32, capsule: u32) -> TraceTriangle {
    TraceTriangle {
        edge2: [radius, 0.0, 0.0],
        ..trace_triangle([a, b, a], super::NONE, capsule, 0)
    }
}

impl TraceTriangle {
    /// Box around the capsule that an instance marked [`CAPSULES`] has in place of a triangle, object space.
    pub fn capsule_box(&self) -> Bounds {
        let (base, radius) = (Vec3::from(self.base), Vec3::splat(self.edge2[0]));
        let end = base + Vec3::from(self.edge1);
        // The end is rounded: keep the box conservative.
        let around = radius + base.abs().max(end.abs()) * (4.0 * f32::EPSILON) + radius * 1e-5;
        Bounds {
            min: base.min(end) - around,
            max: base.max(end) + around,
        }
    }

    /// The capsule that an instance marked [`CAPSULES`] has in place of a triangle.
    pub(super) fn capsule(&self) -> Capsule {
        Capsule {
            base: Vec3::from(self.base).as_dvec3(),
            axis: Vec3::from(self.edge1).as_dvec3(),
            radius: self.edge2[0].into(),
        }
    }
}
