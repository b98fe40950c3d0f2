//! Conversion of a camera to the frame's uniform block: projection, pixel rays, lens.

use glam::{DVec2, DVec3, Mat4, Vec2, Vec3, Vec4, camera::rh};

use reflet_base::math::Bounds;
use reflet_scene::desc::{CameraDesc, MOST_CLIP_PLANES};

use super::offsets::on_lens;

/// Kind of projection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Things farther away appear smaller.
    Perspective {
        /// Vertical field of view, radians.
        fov: f32,
    },
    /// All rays are parallel.
    Orthographic {
        /// View depth beyond all geometry, meters: clip-space depth is linear, so it must end somewhere.
        far_m: f32,
    },
}

/// View of a camera at a picture size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position of the camera, meters.
    pub eye: Vec3,
    /// Unit view direction.
    pub forward: Vec3,
    /// Half the picture's width at distance 1; orthographic: at any distance.
    pub right: Vec3,
    /// Half the picture's height, likewise.
    pub up: Vec3,
    /// Shift of the lens to the right and up, in halves of the picture's width and height.
    pub lens_shift: Vec2,
    /// Near plane, meters.
    pub near_m: f32,
    /// The kind of projection.
    pub projection: Projection,
    /// Whether the march may miss surfaces that are seen edge-on.
    pub has_edge_on: bool,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Radius of the lens, meters; 0: a pinhole.
    pub lens_m: f32,
    /// Distance in focus, meters.
    pub focus_m: f32,
    /// Planes `[a, b, c, d]` with unit normals, behind which, where a x + b y + c z + d < 0, the camera sees nothing.
    pub clip_planes: [[f32; 4]; MOST_CLIP_PLANES],
}

impl View {
    /// The view of a camera in a scene of unit `unit_m`. An `up` along the view direction is replaced by another axis.
    pub fn new(camera: &CameraDesc, size: [u32; 2], unit_m: f32) -> Self {
        let forward = (camera.target - camera.eye).normalize_or(Vec3::NEG_Z);
        let right = forward.cross(camera.up);
        let right = if right.length_squared() > 1e-12 * camera.up.length_squared().max(1e-30) {
            right.normalize()
        } else {
            forward.any_orthonormal_vector()
        };
        let half = camera.half_height_m(1.0);
        let projection = match camera.orthographic_height_m {
            Some(_) => Projection::Orthographic { far_m: FAR_M },
            None => Projection::Perspective {
                fov: camera.fov_deg.to_radians(),
            },
        };
        let aspect = size[0] as f32 / size[1] as f32;
        Self {
            eye: camera.eye,
            forward,
            right: right * half * aspect,
            up: right.cross(forward) * half,
            lens_shift: 2.0 * Vec2::from(camera.lens_shift) / Vec2::new(aspect, 1.0),
            near_m: camera.near_in(unit_m),
            projection,
            has_edge_on: false,
            size,
            lens_m: camera.lens_m(),
            focus_m: camera.focused_m(),
            clip_planes: std::array::from_fn(|i| {
                camera.clip_planes.get(i).map_or(CUTS_NOTHING, unit_plane)
            }),
        }
    }

    /// The view with its far plane behind `bounds`, if it is orthographic.
    pub fn reaching(self, bounds: &Bounds) -> Self {
        let Projection::Orthographic { .. } = self.projection else {
            return self;
        };
        let corners = bounds.corners();
        let depths = corners.map(|corner| (corner - self.eye).dot(self.forward));
        let farthest = depths.fold(self.near_m, f32::max);
        let far_m = self.near_m + (farthest - self.near_m) * 1.01 + 1e-3;
        Self {
            projection: Projection::Orthographic { far_m },
            ..self
        }
    }

    /// Origin and direction of the ray through a point of the picture, -1 to 1 right and up; the direction has a
    /// component of 1 along `forward`.
    pub fn ray(&self, ndc: DVec2) -> (DVec3, DVec3) {
        let (eye, forward) = (self.eye.as_dvec3(), self.forward.as_dvec3());
        let ndc = ndc + self.lens_shift.as_dvec2();
        let offset = self.right.as_dvec3() * ndc.x + self.up.as_dvec3() * ndc.y;
        match self.projection {
            Projection::Perspective { .. } => (eye, forward + offset),
            Projection::Orthographic { .. } => (eye + offset, forward),
        }
    }

    /// Least and largest t of the part of a [ray](Self::ray) that the camera sees: beyond the near plane, and before all
    /// clip planes.
    pub fn seen_part(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let [mut from, mut to] = [f64::from(self.near_m), f64::INFINITY];
        for plane in self.clip_planes.map(|plane| Vec4::from(plane).as_dvec4()) {
            let height = plane.dot(origin.extend(1.0));
            let climb = plane.truncate().dot(direction);
            if climb > 0.0 {
                from = from.max(-height / climb * (1.0 - ON_PLANE));
            } else if climb < 0.0 {
                to = to.min(-height / climb * (1.0 + ON_PLANE));
            } else if height < 0.0 {
                to = f64::NEG_INFINITY;
            }
        }
        [from, to]
    }

    /// Place of a point in the picture, -1 to 1 right and up, and its depth along the view in meters.
    pub fn place(&self, point: DVec3) -> (DVec2, f64) {
        let offset = point - self.eye.as_dvec3();
        let depth_m = offset.dot(self.forward.as_dvec3());
        let scale = match self.projection {
            Projection::Perspective { .. } => depth_m,
            Projection::Orthographic { .. } => 1.0,
        };
        let along = |axis: DVec3| offset.dot(axis) / axis.length_squared() / scale;
        let place = DVec2::new(along(self.right.as_dvec3()), along(self.up.as_dvec3()));
        (place - self.lens_shift.as_dvec2(), depth_m)
    }

    /// Shift of the lens in pixels to the right and down.
    pub fn shift_px(&self) -> Vec2 {
        let [width, height] = self.size.map(|pixels| pixels as f32);
        self.lens_shift * Vec2::new(0.5 * width, -0.5 * height)
    }

    /// Transform from the world to clip space, see [`Self::clip_from_view`].
    pub fn clip_from_world(&self, jitter: Vec2) -> Mat4 {
        self.clip_from_view(jitter) * self.view_from_world()
    }

    /// Transform from the world to view space: x to the right, y up, z against the view.
    pub fn view_from_world(&self) -> Mat4 {
        rh::view::look_to_mat4(self.eye, self.forward, self.up.normalize())
    }

    /// Transform from view space to clip space: reversed depth, infinite in perspective. A point at pixel + jitter is
    /// moved to the pixel.
    pub fn clip_from_view(&self, jitter: Vec2) -> Mat4 {
        let aspect = self.size[0] as f32 / self.size[1] as f32;
        let projection = match self.projection {
            Projection::Perspective { fov } => {
                rh::proj::directx::perspective_infinite_reverse(fov, aspect, self.near_m)
            }
            Projection::Orthographic { far_m } => {
                let (half, depth_m) = (self.up.length(), far_m - self.near_m);
                let scale = Vec3::new(1.0 / (half * aspect), 1.0 / half, 1.0 / depth_m);
                Mat4::from_translation(Vec3::Z * (far_m / depth_m)) * Mat4::from_scale(scale)
            }
        };
        let moved = (self.shift_px() + jitter) * Vec2::new(-2.0, 2.0);
        let shift = Vec3::new(
            moved.x / self.size[0] as f32,
            moved.y / self.size[1] as f32,
            0.0,
        );
        Mat4::from_translation(shift) * projection
    }

    /// The view from the point of the lens that sub-frame `index` of `count` uses, and the shift in pixels that
    /// keeps focused things in place.
    pub fn through_lens(&self, index: u32, count: u32) -> (Self, Vec2) {
        if self.lens_m <= 0.0 {
            return (*self, Vec2::ZERO);
        }
        let at = on_lens(index, count) * self.lens_m;
        let (right, up) = (self.right.length(), self.up.length());
        let eye = self.eye + self.right * (at.x / right) + self.up * (at.y / up);
        let half = Vec2::new(self.size[0] as f32, self.size[1] as f32) * 0.5;
        let shift = Vec2::new(-at.x / right, at.y / up) / self.focus_m * half;
        (Self { eye, ..*self }, shift)
    }

    /// Angle of one pixel in the center of the picture, radians; 0 if orthographic.
    pub fn pixel_spread(&self) -> f32 {
        match self.projection {
            Projection::Perspective { .. } => 2.0 * self.up.length() / self.size[1] as f32,
            Projection::Orthographic { .. } => 0.0,
        }
    }

    /// Most pixels that an angle of one radian may cover, in the corners of the picture; `None` if orthographic.
    pub fn pixels_per_radian(&self) -> Option<f32> {
        let farthest = Vec2::ONE + self.lens_shift.abs();
        let corner = Vec2::new(self.right.length(), self.up.length()) * farthest;
        let squared = corner.length_squared();
        match self.projection {
            // The derivative of the tangent, and pixels at its end.
            Projection::Perspective { .. } => Some((1.0 + squared) / self.pixel_spread()),
            Projection::Orthographic { .. } => None,
        }
    }

    /// Width of an orthographic pixel, meters; 0 if perspective.
    pub fn pixel_m(&self) -> f32 {
        match self.projection {
            Projection::Perspective { .. } => 0.0,
            Projection::Orthographic { .. } => 2.0 * self.up.length() / self.size[1] as f32,
        }
    }

    /// Far plane of an orthographic view, meters; 0 if perspective.
    pub fn far_m(&self) -> f32 {
        match self.projection {
            Projection::Perspective { .. } => 0.0,
            Projection::Orthographic { far_m } => far_m,
        }
    }
}

/// A plane with a normal of length 1; where it has none, a plane that cuts nothing.
fn unit_plane(plane: &[f32; 4]) -> [f32; 4] {
    let plane = Vec4::from(*plane).as_dvec4();
    let unit = (plane / plane.truncate().length()).as_vec4();
    match unit.is_finite() {
        true => unit.to_array(),
        false => CUTS_NOTHING,
    }
}

/// Relative distance along a ray within which a surface lies in a clip plane, which does not cut it off.
pub(crate) const ON_PLANE: f64 = 1e-5;

/// Plane that all points are in front of.
pub(crate) const CUTS_NOTHING: [f32; 4] = [0.0, 0.0, 0.0, 1.0];

/// Far plane of an orthographic view of a scene of unknown size, meters.
const FAR_M: f32 = 1e12;
