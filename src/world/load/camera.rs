//! The camera of a scene that has none.

use glam::Vec3;

use crate::{
    scene::{
        desc::{CameraDesc, Entry},
        diagnostic::Span,
    },
    world::World,
};

/// Adds a camera `main` that sees the whole scene, if there is no camera at all.
pub fn add_default(world: &mut World) {
    if !world.cameras.is_empty() {
        return;
    }
    let bounds = if world.moving.players.is_empty() {
        world.static_bounds()
    } else {
        world.bounds_over_time()
    };
    let radius = (bounds.diagonal() * 0.5).max(1e-3);
    let center = bounds.center();
    let defaults = CameraDesc::default();
    // The bounding sphere touches the picture's upper and lower edge, less a small margin.
    let distance = 1.1 * radius / (defaults.fov_deg.to_radians() * 0.5).sin();
    let value = CameraDesc {
        eye: center + Vec3::new(0.5, 0.4, 1.0).normalize() * distance,
        target: center,
        near_m: (radius * 1e-3).clamp(1e-5, defaults.near_m),
        ..defaults
    };
    world.cameras.push(Entry {
        name: "main".into(),
        at: Span::default(),
        value,
    });
}
