//! Surfaces that an orthographic camera sees edge-on: no pixel shows them, wherever they are in the picture.

use glam::Vec3;
use rayon::prelude::*;

use reflet_world::{Instance, World};

use crate::settings::view::{Projection, View};

/// Cosine between normal and view direction up to which a triangle is seen edge-on.
const EDGE_ON: f32 = 1e-3;
/// Side of a square, pixels, whose area edge-on triangles must exceed to matter: curved surfaces always have a few
/// at their outline.
const SIDE_PX: f32 = 16.0;

/// Whether screen-space rays of a view may miss a surface that is seen edge-on. In perspective this happens only for
/// surfaces exactly in a plane with the eye, and is neglected.
pub fn has_edge_on_surfaces(world: &World, view: &View) -> bool {
    if matches!(view.projection, Projection::Perspective { .. }) {
        return false;
    }
    let seen = |i: &&Instance| !i.is_hidden() && i.shown.in_reflections;
    let instances = world.instances.par_iter().filter(seen);
    let area_m2: f32 = instances.map(|i| edge_on_m2(world, i, view.forward)).sum();
    area_m2 > (SIDE_PX * view.pixel_m()).powi(2)
}

/// Area of an instance's triangles that are seen edge-on, m².
fn edge_on_m2(world: &World, instance: &Instance, forward: Vec3) -> f32 {
    let posed = world.posed(instance.mesh);
    let place = instance.world_from_object.matrix3;
    let area = |triangle: &[u32; 3]| {
        let [a, b, c] = posed
            .corners(*triangle)
            .map(|p| place * glam::Vec3A::from(p));
        let double = Vec3::from((b - a).cross(c - a));
        let length = double.length();
        let is_edge_on = double.dot(forward).abs() < EDGE_ON * length;
        if is_edge_on { 0.5 * length } else { 0.0 }
    };
    world.meshes[instance.mesh].triangles.iter().map(area).sum()
}
