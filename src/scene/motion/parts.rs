//! Cameras and lights by their numbers, and what makes them useless.

use glam::Vec3;

use crate::scene::desc::{CameraDesc, LightKind};

/// What a script has set, so that tracks leave it alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A camera.
    Camera,
    /// A light.
    Light,
}

/// Why nothing could be seen through a camera.
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
    (forward.cross(up).length() < 1e-6).then_some("looks along its `up`")
}

/// The numbers of all kinds of lights.
#[derive(Clone, Copy, Debug)]
pub struct LightParts {
    /// Zero for directional lights.
    pub position: Vec3,
    /// Down for point lights.
    pub direction: Vec3,
    /// Candela or lux.
    pub intensity: f32,
}

impl LightParts {
    /// What a light has of them.
    pub fn of(kind: &LightKind) -> Self {
        let (position, direction, intensity) = match *kind {
            LightKind::Point {
                position,
                intensity_cd,
            } => (position, Vec3::NEG_Y, intensity_cd),
            LightKind::Spot {
                position,
                direction,
                intensity_cd,
                ..
            } => (position, direction, intensity_cd),
            LightKind::Directional {
                direction,
                intensity_lux,
            } => (Vec3::ZERO, direction, intensity_lux),
        };
        Self {
            position,
            direction,
            intensity,
        }
    }

    /// Writes back what this kind of light has.
    pub fn put(self, kind: &mut LightKind) {
        match kind {
            LightKind::Point {
                position,
                intensity_cd,
            } => (*position, *intensity_cd) = (self.position, self.intensity),
            LightKind::Spot {
                position,
                direction,
                intensity_cd,
                ..
            } => {
                (*position, *intensity_cd) = (self.position, self.intensity);
                *direction = self.direction.try_normalize().unwrap_or(Vec3::ZERO);
            }
            LightKind::Directional {
                direction,
                intensity_lux,
            } => {
                *intensity_lux = self.intensity;
                *direction = self.direction.try_normalize().unwrap_or(Vec3::ZERO);
            }
        }
    }
}
