//! Moves worlds far from their origin close to it, relative to the camera, where floats are precise.
//!
//! Offsets that keep rays off the surface they start from grow with the coordinates, as rounding errors do. A
//! renderer therefore works in coordinates relative to a point near the camera, chosen when the renderer was made,
//! and converts each world and camera that it is given.

use std::borrow::Cow;

use glam::Vec3;

use reflet_scene::desc::CameraDesc;
use reflet_world::World;

use super::options::RenderOptions;

/// Grid width of origins, m: scenes near their origin are not moved at all, and moving others rounds as little as
/// possible.
const GRID_M: f32 = 128.0;

/// Best origin for a renderer: a grid point near the eye of the options' camera.
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
