//! Whether a camera sees anything of a scene: some triangle faces it and may lie in its picture.

use glam::{Affine3A, Vec2, Vec3, Vec3A};

use reflet_base::math::Bounds;
use reflet_scene::desc::CameraDesc;

/// Triangles that are tried for all cameras together; what is left then is taken to be seen.
pub const MOST_TRIED: usize = 1 << 26;

/// View of a camera.
pub struct CameraFrustum {
    eye: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    /// Half of the picture's height at a distance of 1 m, and of the part that does not depend on the distance.
    half_height: [f32; 2],
    aspect: f32,
}

impl CameraFrustum {
    /// The view of a camera in a picture of the aspect ratio width to height.
    pub fn new(camera: &CameraDesc, aspect: f32) -> Self {
        let forward = (camera.target - camera.eye).normalize_or_zero();
        let right = forward.cross(camera.up).normalize_or_zero();
        let half_angle = camera.fov_deg.to_radians() * 0.5;
        Self {
            eye: camera.eye,
            forward,
            right,
            up: right.cross(forward),
            half_height: match camera.orthographic_height_m {
                Some(height) => [0.0, 0.5 * height],
                None => [half_angle.tan(), 0.0],
            },
            aspect,
        }
    }

    /// Signed distances to the five planes of the view frustum, positive inside; without unit of length.
    fn inside(&self, point: Vec3) -> [f32; 5] {
        let to = point - self.eye;
        let depth = to.dot(self.forward);
        let half_height = depth * self.half_height[0] + self.half_height[1];
        let half_width = half_height * self.aspect;
        let [x, y] = [to.dot(self.right), to.dot(self.up)];
        [
            depth,
            half_width - x,
            half_width + x,
            half_height - y,
            half_height + y,
        ]
    }

    /// Origin and direction of the ray through a place in the picture, -1 to 1 from left to right and from bottom to
    /// top.
    pub fn ray(&self, place: Vec2) -> [Vec3; 2] {
        let across = self.right * (place.x * self.aspect) + self.up * place.y;
        let [by_depth, fixed] = self.half_height;
        [self.eye + across * fixed, self.forward + across * by_depth]
    }

    /// Whether a convex hull is not wholly outside one plane of the view frustum; within `nearly` counts as inside.
    fn may_hold<const N: usize>(&self, corners: [Vec3; N], nearly: f32) -> bool {
        let corners = corners.map(|corner| self.inside(corner));
        (0..5).all(|plane| corners.iter().any(|inside| inside[plane] >= -nearly))
    }

    /// Whether a box may be in the picture; touching counts.
    pub fn may_hold_box(&self, bounds: &Bounds) -> bool {
        let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
            let pick = |k: usize| [bounds.min[k], bounds.max[k]][(i >> k) & 1];
            Vec3::new(pick(0), pick(1), pick(2))
        });
        self.may_hold(corners, 1e-4 * bounds.diagonal())
    }

    /// Whether a placed triangle may be in the picture, with its front towards the eye unless it has two; touching and
    /// edge-on count.
    pub fn may_hold_triangle(
        &self,
        corners: [Vec3; 3],
        place: &Affine3A,
        is_double_sided: bool,
    ) -> bool {
        let corners = corners.map(|corner| place.transform_point3(corner));
        let [a, b, c] = corners.map(Vec3A::from);
        let front = (b - a).cross(c - a) * place.matrix3.determinant().signum();
        let to_eye = match self.half_height[0] > 0.0 {
            true => Vec3A::from(self.eye) - a,
            false => -Vec3A::from(self.forward),
        };
        (is_double_sided || front.dot(to_eye) >= 0.0) && self.may_hold(corners, 0.0)
    }
}
