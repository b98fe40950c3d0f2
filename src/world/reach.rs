//! How far geometry may lie from the origin: further away, the areas and reciprocals of trees overflow.

use glam::{Affine3A, Vec3};

use super::World;
use reflet_base::math::Bounds;

/// Largest coordinate of a vertex, in the space of its mesh and in the world, meters, so that areas and reciprocals
/// are finite in f32.
pub const MAX_REACH_M: f32 = 1e15;

/// Whether every coordinate of the box is within [`MAX_REACH_M`]; true for an empty box, false for NaN.
pub fn is_within_reach(bounds: &Bounds) -> bool {
    let most = Vec3::splat(MAX_REACH_M);
    bounds.min.cmpge(-most).all() && bounds.max.cmple(most).all()
}

/// Name of the error about geometry that is too far away.
pub const TOO_FAR: &str = "too-far";

/// Message about geometry that is too far away; `what` reaches there.
pub fn too_far(what: &str) -> String {
    format!("{what} reaches further than {MAX_REACH_M:e} m from the origin")
}

/// Help text about geometry that is too far away.
pub const TOO_FAR_HELP: &str = "make its translation and scale smaller";

impl World {
    /// Whether an instance, by its index, would reach too far with this transform from its mesh's space.
    pub(super) fn is_too_far(&self, instance: usize, world_from_object: &Affine3A) -> bool {
        let mesh = self.meshes.get(self.instances[instance].mesh);
        mesh.is_some_and(|mesh| !is_within_reach(&mesh.bounds.transformed(world_from_object)))
    }
}
