//! Cameras of scene text, and the table of their values that may change over time.

use glam::Vec3;

use super::Tracks;
use crate::{
    number::{Field, Form, Lanes, plain},
    range::{ABOVE_0, ANY, APERTURE_F, range},
};

declared! {
    /// `[camera.NAME]`: a viewpoint with its lens.
    ///
    /// - `parent`: `name` of an instance, or of a `[group.NAME]`, to which the camera is attached: its
    ///   positions and directions are then relative to the parent and move with it. Default: none.
    #[derive(Clone, Debug, PartialEq)]
    #[defaults]
    pub struct CameraDesc {
        /// Position of the camera, meters.
        pub eye: Vec3 = Vec3::new(0.0, 1.0, 5.0),
        /// Point that the camera looks at, meters; must differ from `eye`.
        pub target: Vec3,
        /// Direction that points up in the picture; must not be along the view.
        pub up: Vec3 = Vec3::Y,
        /// Vertical field of view, degrees, 1 to 170. More shows more of the scene, and everything smaller.
        pub fov_deg: f32 = 60.0,
        /// Height of the part of the scene that the picture shows, meters, above 0: makes the camera
        /// orthographic. Its rays are parallel, so nothing shrinks with distance, and `fov_deg` has no effect.
        /// Surfaces that such a camera sees edge-on, as walls from straight above, are on no pixel: if they
        /// have the area of more than 16 × 16 pixels, `hybrid` traces every reflection. Default: perspective.
        pub orthographic_height_m: Option<f32>,
        /// Near plane: surfaces closer to the camera than this are not seen, meters, above 0. There is no far
        /// plane. Default 0.01, or a hundredth of U where that is less.
        pub near_m: Option<f32>,
        /// Aperture as an f-number, 0.1 to 1000: less blurs things out of focus more. The diameter of the lens
        /// follows from it for this field of view on a sensor of 24 mm height; an orthographic camera has no lens. Each
        /// sub-frame looks through one point of the lens, so it takes many `image.samples`. Default: a pinhole,
        /// everything is sharp.
        pub aperture_f: Option<f32>,
        /// Distance along the view that is in focus, meters, above 0. Default: the distance of `target`, so
        /// that the thing that a camera looks at or follows is sharp.
        pub focus_m: Option<f32>,
    }
}

/// Near plane where none is given, meters, but in small scenes.
const NEAR_M: f32 = 0.01;
/// Near plane where none is given, relative to U, in small scenes.
const NEAR_U: f32 = 0.01;

/// Height of the sensor that `aperture_f` assumes, meters.
const SENSOR_M: f32 = 0.024;

impl CameraDesc {
    /// Half the height of the view at a distance along the view direction, meters.
    pub fn half_height_m(&self, distance_m: f32) -> f32 {
        let slope = (0.5 * self.fov_deg.to_radians()).tan();
        self.orthographic_height_m
            .map_or(slope * distance_m, |height_m| 0.5 * height_m)
    }

    /// Near plane in a scene of this unit U, meters.
    pub fn near_in(&self, unit_m: f32) -> f32 {
        self.near_m.unwrap_or_else(|| (unit_m * NEAR_U).min(NEAR_M))
    }

    /// Radius of the lens, meters; 0 is a pinhole.
    pub fn lens_m(&self) -> f32 {
        if self.orthographic_height_m.is_some() {
            return 0.0;
        }
        let focal_m = 0.5 * SENSOR_M / (0.5 * self.fov_deg.to_radians()).tan();
        self.aperture_f.map_or(0.0, |f| 0.5 * focal_m / f)
    }

    /// Distance along the view that is in focus, meters.
    pub fn focused_m(&self) -> f32 {
        self.focus_m
            .unwrap_or_else(|| self.target.distance(self.eye))
    }
}

/// Values of a camera that tracks and scripts may change.
pub static CAMERA: [Field<CameraDesc>; 8] = [
    plain!(eye, Vector, ANY),
    plain!(target, Vector, ANY),
    plain!(up, Vector, ANY),
    plain!(fov_deg, Number, range(1.0, 170.0)),
    Field {
        key: "orthographic_height_m",
        form: Form::Number,
        range: ABOVE_0,
        get: |camera| camera.orthographic_height_m.map(Lanes::lanes),
        put: |camera, value| camera.orthographic_height_m = Some(Lanes::from_lanes(value)),
    },
    Field {
        key: "near_m",
        form: Form::Number,
        range: ABOVE_0,
        get: |camera| Some(camera.near_m.unwrap_or(NEAR_M).lanes()),
        put: |camera, value| camera.near_m = Some(Lanes::from_lanes(value)),
    },
    Field {
        key: "aperture_f",
        form: Form::Number,
        range: APERTURE_F,
        get: |camera| camera.aperture_f.map(Lanes::lanes),
        put: |camera, value| camera.aperture_f = Some(Lanes::from_lanes(value)),
    },
    Field {
        key: "focus_m",
        form: Form::Number,
        range: ABOVE_0,
        get: |camera| Some(camera.focused_m().lanes()),
        put: |camera, value| camera.focus_m = Some(Lanes::from_lanes(value)),
    },
];

declared! {
    /// `[motion.camera.NAME]`: tracks that move a camera and change its lens.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct CameraMotionDesc {
        /// - `eye`: track of the position, meters.
        /// - `target`: track of the point that the camera looks at, meters; `{ follow = { instance = "car" } }`
        ///   looks at an instance.
        /// - `up`: track of the direction that points up in the picture.
        /// - `fov_deg`: track of the vertical field of view, degrees, 1 to 170.
        /// - `orthographic_height_m`: track of the height of an orthographic camera's view, meters, above 0.
        /// - `near_m`: track of the distance of the near plane, meters, above 0.
        /// - `aperture_f`: track of the f-number, 0.1 to 1000.
        /// - `focus_m`: track of the distance in focus, meters, above 0.
        pub tracks: Tracks,
    }
}
