//! Worlds far from their origin, moved to where floats are fine: next to the camera.
//!
//! Offsets that keep rays off the surface they start from grow with the coordinates, for rounding
//! does. A renderer therefore works in coordinates relative to where the camera was when it was made,
//! and moves each world and camera that it is given there.

use std::borrow::Cow;

use glam::Vec3;

use crate::{scene::desc::CameraDesc, world::World};

use super::options::RenderOptions;

/// Origins lie on a grid of this width, so that nothing is moved in scenes near their origin, and moving
/// rounds as little as can be.
const GRID_M: f32 = 128.0;

/// Where the origin is best: near the eye of the options' camera.
pub fn origin_of(world: &World, options: &RenderOptions) -> Vec3 {
    let camera = options.camera.unwrap_or_else(|| world.main_camera());
    let eye = world
        .cameras
        .get(camera)
        .map_or(Vec3::ZERO, |c| c.value.eye);
    let origin = (eye / GRID_M).round() * GRID_M;
    if origin.is_finite() {
        origin
    } else {
        Vec3::ZERO
    }
}

/// A world in coordinates relative to an origin.
pub fn relative_world(world: &World, origin: Vec3) -> Cow<'_, World> {
    if origin == Vec3::ZERO {
        return Cow::Borrowed(world);
    }
    let mut moved = world.clone();
    for instance in &mut moved.instances {
        instance.world_from_object.translation -= glam::Vec3A::from(origin);
    }
    for light in &mut moved.lights {
        if let Some(position) = light.desc.kind.position_mut() {
            *position -= origin;
        }
    }
    for camera in &mut moved.cameras {
        camera.value = relative_camera(&camera.value, origin);
    }
    Cow::Owned(moved)
}

/// A camera in coordinates relative to an origin.
pub fn relative_camera(camera: &CameraDesc, origin: Vec3) -> CameraDesc {
    CameraDesc {
        eye: camera.eye - origin,
        target: camera.target - origin,
        ..camera.clone()
    }
}
