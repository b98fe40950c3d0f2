//! Checks of posed cameras and lights.

use glam::Vec3;

use crate::desc::{CameraDesc, LIGHT, LightDesc};

/// Kind of a thing that a script has set, so that tracks leave it alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A camera.
    Camera,
    /// A light.
    Light,
}

/// Reason why a camera can show nothing, as the end of a sentence; `None` if it can.
pub fn wrong_with_camera(camera: &CameraDesc) -> Option<&'static str> {
    let (forward, up) = (camera.target - camera.eye, camera.up);
    if !(camera.eye.is_finite() && camera.target.is_finite() && up.is_finite()) {
        return Some("has a number that is not finite");
    }
    let (Some(forward), Some(up)) = (
        forward.as_dvec3().try_normalize(),
        up.as_dvec3().try_normalize(),
    ) else {
        return Some("has `eye` and `target` in the same place, or no `up`");
    };
    (forward.cross(up).length() < 1e-6).then_some("has its view direction along `up`")
}

/// Reason why a light cannot shine, as the end of a sentence; `None` if it can.
pub fn wrong_with_light(light: &LightDesc) -> Option<&'static str> {
    let usable = |v: Option<Vec3>| v.is_none_or(Vec3::is_finite);
    let stands = LIGHT.iter().all(|field| usable((field.get)(light)));
    if !stands {
        return Some("has a number that is not finite");
    }
    let direction = light.kind.direction();
    direction
        .is_some_and(|d| d == Vec3::ZERO)
        .then_some("has no direction")
}
