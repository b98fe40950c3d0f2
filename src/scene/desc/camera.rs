//! Cameras of scene text, and the table of their values that may change over time.

use glam::Vec3;

use super::{Tracks, hierarchy::declare_parent, track::tracks};
use crate::{
    number::Lanes,
    range::{ABOVE_0, range},
    table::{Table, points::List},
};

declared! {
    /// `[camera.NAME]`: a viewpoint with its lens.
    ///
    /// - `parent`: `name` of an instance, or of a `[group.NAME]`, to which the camera is attached: its
    ///   positions and directions are then relative to the parent and move with it. Default: none.
    #[derive(Clone, Debug, PartialEq)]
    #[defaults]
    #[table("[camera.NAME]", before(declare_parent), check(Self::check))]
    #[tracks(CAMERA)]
    pub struct CameraDesc {
        /// Position of the camera, meters.
        #[track(Vector, "position, meters")]
        pub eye: Vec3 = Vec3::new(0.0, 1.0, 5.0),
        /// Point that the camera looks at, meters; must differ from `eye`.
        #[track(Vector, "point that the camera looks at, meters; `{ follow = { instance = \"car\" } }` looks at an instance")]
        pub target: Vec3 = Vec3::ZERO,
        /// Direction that points up in the picture; must not be along the view.
        #[track(Vector, "direction that points up in the picture")]
        pub up: Vec3 = Vec3::Y,
        /// Vertical field of view, degrees, 1 to 170. More shows more of the scene, and everything smaller.
        #[track(Number, "vertical field of view, degrees")]
        pub fov_deg: f32 [range(1.0, 170.0)] = 60.0,
        /// Height of the part of the scene that the picture shows, meters, above 0: makes the camera
        /// orthographic. Its rays are parallel, so nothing shrinks with distance, and `fov_deg` has no effect.
        /// Surfaces that such a camera sees edge-on, as walls from straight above, are on no pixel: if they
        /// have the area of more than 16 × 16 pixels, `hybrid` traces every reflection. Default: perspective.
        #[track(Number, "height of an orthographic camera's view, meters")]
        pub orthographic_height_m: Option<f32> [ABOVE_0],
        /// Shift of the lens to the right and up, in heights of the picture, -10 to 10: moves the picture over the
        /// scene without turning the camera, so vertical lines stay parallel. With [0, 0.5] the view direction
        /// meets the lower edge of the picture.
        #[track(Pair, "shift of the lens to the right and up, in heights of the picture")]
        pub lens_shift: [f32; 2] [range(-10.0, 10.0)] = [0.0, 0.0],
        /// Near plane: surfaces closer to the camera than this are not seen, meters, above 0. There is no far
        /// plane. Default 0.01, or a hundredth of U where that is less.
        #[track(Number, "distance of the near plane, meters", |it| Some(it.near_m.unwrap_or(NEAR_M).lanes()))]
        pub near_m: Option<f32> [ABOVE_0],
        /// Aperture as an f-number, 0.1 to 1000: less blurs things out of focus more. The diameter of the lens
        /// follows from it for this field of view on a sensor of 24 mm height; an orthographic camera has no lens. Each
        /// sub-frame looks through one point of the lens, so it takes many `image.samples`. Default: a pinhole,
        /// everything is sharp.
        #[track(Number, "f-number")]
        pub aperture_f: Option<f32> [range(0.1, 1000.0)],
        /// Distance along the view that is in focus, meters, above 0. Default: the distance of `target`, so
        /// that the thing that a camera looks at or follows is sharp.
        #[track(Number, "distance in focus, meters", |it| Some(it.focused_m().lanes()))]
        pub focus_m: Option<f32> [ABOVE_0],
        /// Planes that cut the view open, as sections of buildings and machines: at most 6, each `[a, b, c, d]`, meters.
        /// The camera sees no point (x, y, z) for which a x + b y + c z + d < 0, in the space of `eye`. As behind the
        /// near plane, only the view is cut: shadows are cast and mirrors and glass show things whole, so that a closed
        /// house is as dark inside as it was. A surface in a plane is seen. Planes do not move. Default: none.
        pub clip_planes: Vec<[f32; 4]> as List = Vec::new(),
    }
}

/// Maximum number of clip planes of a camera.
pub const MOST_CLIP_PLANES: usize = 6;

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

    fn check(&self, t: &mut Table) {
        if !t.clean() {
            return;
        }
        let no_normal = |p: &[f32; 4]| p[..3].iter().all(|part| *part == 0.0);
        if let Some(index) = self.clip_planes.iter().position(no_normal) {
            let message =
                format!("`clip_planes[{index}]` has no direction: its first three numbers are 0");
            let help =
                "write the direction of the part that stays: of `[0, -1, 0, 2]` all below y = 2 m";
            t.refuse("zero-direction", "clip_planes", &message, help);
        }
        if self.clip_planes.len() > MOST_CLIP_PLANES {
            let count = self.clip_planes.len();
            let message =
                format!("a camera has at most {MOST_CLIP_PLANES} clip planes, not {count}");
            let help = "leave out planes that cut nothing off";
            t.refuse("too-many", "clip_planes", &message, help);
        }
        if self.orthographic_height_m.is_some() && self.aperture_f.is_some() {
            let message = "an orthographic camera has no aperture";
            let help =
                "leave out `aperture_f`, or `orthographic_height_m` for a perspective camera";
            t.refuse("orthographic-aperture", "aperture_f", message, help);
        }
        let forward = (self.target - self.eye).as_dvec3();
        let up = self.up.as_dvec3();
        let key = ["target", "eye"]
            .into_iter()
            .find(|k| t.has(k))
            .unwrap_or("target");
        if forward.length() == 0.0 {
            let help = "move `eye` or `target`: the camera looks from one to the other";
            t.refuse(
                "zero-direction",
                key,
                "`target` must differ from `eye`",
                help,
            );
        } else if up.length() == 0.0 {
            t.refuse(
                "zero-direction",
                "up",
                "`up` must not be zero",
                "write `up = [0, 1, 0]`",
            );
        } else if forward.normalize().cross(up.normalize()).length() < 1e-6 {
            let key = if t.has("up") { "up" } else { key };
            let message = "`up` must not point along the view, from `eye` to `target`";
            let help = "for a view straight down or up, write `up = [0, 0, -1]`";
            t.refuse("zero-direction", key, message, help);
        }
    }
}

declared! {
    /// `[motion.camera.NAME]`: tracks that move a camera and change its lens.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("[motion.camera.NAME]")]
    pub struct CameraMotionDesc {
        /// Tracks of the values of [`CAMERA`].
        #[by(|t| Some(tracks(t, &CAMERA)))]
        pub tracks: Tracks,
    }
}
