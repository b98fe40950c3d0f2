//! Cameras as people write them, and what of them may change.

use glam::Vec3;

use super::Tracks;
use crate::scene::{
    number::{Field, plain},
    range::{ABOVE_0, ANY, range},
};

/// `[camera.NAME]`
///
/// - `parent`: `name` of an instance, or a `[group.NAME]`, that this hangs on: its positions and
///   directions are then relative to where that is, wherever it moves. Default: none.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraDesc {
    /// Position, meters.
    pub eye: Vec3,
    /// The point looked at, meters; must differ from `eye`.
    pub target: Vec3,
    /// Direction that is up in the picture.
    pub up: Vec3,
    /// Vertical field of view, degrees, 1 to 170. More shows more and shrinks everything.
    pub fov_deg: f32,
    /// Nearest visible distance, meters, above 0. There is no far plane.
    pub near_m: f32,
}

impl Default for CameraDesc {
    fn default() -> Self {
        Self {
            eye: Vec3::new(0.0, 1.0, 5.0),
            target: Vec3::ZERO,
            up: Vec3::Y,
            fov_deg: 60.0,
            near_m: 0.01,
        }
    }
}

/// What changes of a camera.
pub static CAMERA: [Field<CameraDesc>; 5] = [
    plain!(eye, Vector, ANY),
    plain!(target, Vector, ANY),
    plain!(up, Vector, ANY),
    plain!(fov_deg, Number, range(1.0, 170.0)),
    plain!(near_m, Number, ABOVE_0),
];

/// `[motion.camera.NAME]`
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraMotionDesc {
    /// - `eye`: track of the position, meters.
    /// - `target`: track of the point looked at, meters; `{ follow = { instance = "car" } }` looks
    ///   at an instance.
    /// - `up`: track of the direction that is up in the picture.
    /// - `fov_deg`: track of the vertical field of view, degrees, 1 to 170.
    /// - `near_m`: track of the nearest visible distance, meters, above 0.
    pub tracks: Tracks,
}
