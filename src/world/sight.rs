//! Whether a camera's picture shows any surface, and why it shows none: as rasterization finds the ids of pixels, from
//! triangles whose fronts cover the center of a pixel beyond the near plane, and points and lines in the picture.

use glam::{DMat4, DVec2, DVec3, DVec4, Vec2, Vec3};

use super::{Instance, Mesh, World};
use reflet_scene::desc::CameraDesc;

/// Number of triangles that are looked at; of more, the picture is taken to show some.
const MOST_TRIED: usize = 1 << 26;

/// Half the least width of points and lines, pixels.
const LEAST_PX: f64 = 0.72;

/// Why a picture is empty, by the surface that is nearest to being seen: later reasons win.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub enum Unseen {
    /// Nothing is placed.
    Nothing,
    /// All is hidden, or scaled to 0.
    Hidden,
    /// All is behind the camera, or beside its picture.
    Outside,
    /// All in the picture is nearer than the near plane; the farthest depth, meters.
    TooNear(f64),
    /// All in the picture is behind a clip plane.
    CutAway,
    /// The camera sees only surfaces whose alpha is 0 or below their cut-off.
    Transparent,
    /// The camera sees only backs of single-sided surfaces.
    Backs,
    /// All is smaller than a pixel, or between the centers of pixels.
    Small,
}

/// View of a camera with the pixels of its picture.
pub struct Sight {
    /// World to x and y of a pixel from the upper left corner, times w; depth, m; w.
    pixel_from_world: DMat4,
    eye: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    is_perspective: bool,
    near_m: f64,
    /// Pixels of a meter at a depth of 1 m, or at any depth.
    px_per_m: f64,
    /// Pixel that the view direction meets.
    middle: DVec2,
    size: DVec2,
    clip_planes: Vec<DVec4>,
}

impl Sight {
    /// The view of a camera with this near plane, m, in a picture of `size` pixels.
    pub fn new(camera: &CameraDesc, near_m: f32, size: [u32; 2]) -> Self {
        let [eye, target, up] = [camera.eye, camera.target, camera.up].map(|v| v.as_dvec3());
        let forward = (target - eye).normalize_or_zero();
        let right = forward.cross(up).normalize_or_zero();
        let up = right.cross(forward);
        let half_m = match camera.orthographic_height_m {
            Some(height_m) => 0.5 * f64::from(height_m),
            None => (0.5 * f64::from(camera.fov_deg).to_radians()).tan(),
        };
        let size = DVec2::new(size[0].into(), size[1].into());
        let px_per_m = 0.5 * size.y / half_m;
        let is_perspective = camera.orthographic_height_m.is_none();
        let along = |axis: DVec3| axis.extend(-axis.dot(eye));
        let depth = along(forward);
        let w = if is_perspective { depth } else { DVec4::W };
        let across = |axis: DVec3, middle: f64| along(axis * px_per_m) + w * middle;
        let shift = camera.lens_shift.map(f64::from);
        let middle = 0.5 * size + DVec2::new(-shift[0], shift[1]) * size.y;
        let rows = [across(right, middle.x), across(-up, middle.y), depth, w];
        Self {
            pixel_from_world: DMat4::from_cols_array_2d(&rows.map(|r| r.to_array())).transpose(),
            eye,
            forward,
            right,
            up,
            is_perspective,
            near_m: near_m.into(),
            px_per_m,
            middle,
            size,
            clip_planes: (camera.clip_planes.iter())
                .map(|plane| DVec4::from(plane.map(f64::from)))
                .collect(),
        }
    }

    /// Origin and direction of the ray through a place in the picture, -1 to 1 from left to right and from bottom to
    /// top.
    pub fn ray(&self, place: Vec2) -> [Vec3; 2] {
        let pixel = (DVec2::new(place.x.into(), (-place.y).into()) + 1.0) * 0.5 * self.size;
        let place = (pixel - self.middle) / self.px_per_m;
        let across = self.right * place.x - self.up * place.y;
        let ray = match self.is_perspective {
            true => [self.eye, self.forward + across],
            false => [self.eye + across, self.forward],
        };
        ray.map(|v| v.as_vec3())
    }

    /// Why the picture shows no surface of a world, whose meshes are `meshes`; `None` where it shows some.
    pub fn unseen(&self, world: &World, meshes: &[Mesh]) -> Option<Unseen> {
        let mut why = Unseen::Nothing;
        let mut tried = 0;
        for instance in &world.instances {
            let mesh = &meshes[instance.mesh];
            tried += mesh.triangles.len();
            if tried > MOST_TRIED {
                return None;
            }
            why = later(why, self.unseen_instance(world, mesh, instance)?);
        }
        Some(why)
    }

    /// Why the picture would show no surface of an instance of this mesh that nothing hides; `None` where it would.
    /// Alpha is the material's factor, which textures and colors of vertices do not raise.
    pub fn unseen_instance(
        &self,
        world: &World,
        mesh: &Mesh,
        instance: &Instance,
    ) -> Option<Unseen> {
        if !instance.shown.visible || instance.is_hidden() {
            return Some(Unseen::Hidden);
        }
        let deformed = world.deformed.get(&instance.mesh);
        let posed = deformed.map_or_else(|| mesh.at_rest(), |deformed| deformed.posed());
        let place = instance.world_from_object;
        let front = f64::from(place.matrix3.determinant().signum());
        let round = mesh.placed_radius_m(&place).map(|radius_m| Thickness {
            radius_m: radius_m.into(),
            least_px: if mesh.at_least_a_pixel { LEAST_PX } else { 0.0 },
        });
        let material = &world.materials[instance.material];
        let has_back = round.is_none() && !material.double_sided;
        let is_transparent = match material.alpha_cutoff {
            Some(cutoff) => material.base_color.w < cutoff,
            None => material.blended && material.base_color.w <= 0.0,
        };
        let is_transparent = is_transparent && material.patterned.is_empty();
        let mut why = Unseen::Nothing;
        for triangle in &mesh.triangles {
            let corners = posed.corners(*triangle);
            let [a, b, c] = corners.map(|p| place.transform_point3(p).as_dvec3());
            let to_eye = match self.is_perspective {
                true => self.eye - a,
                false => -self.forward,
            };
            let is_back = has_back && (b - a).cross(c - a).dot(to_eye) * front < 0.0;
            let unseen = self.unseen_triangle([a, b, c], is_back, round);
            let unseen = unseen.or(is_transparent.then_some(Unseen::Transparent));
            why = later(why, unseen?);
        }
        Some(why)
    }

    /// Why a triangle, or a capsule of some thickness, is not seen.
    fn unseen_triangle(
        &self,
        corners: [DVec3; 3],
        is_back: bool,
        round: Option<Thickness>,
    ) -> Option<Unseen> {
        let radius_m = round.map_or(0.0, |round| round.radius_m);
        let corners = corners.map(|p| p.extend(1.0));
        let kept = self
            .clip_planes
            .iter()
            .fold(corners.to_vec(), |kept, plane| {
                let reach = radius_m * plane.truncate().length();
                cut(&kept, |p| plane.dot(*p) + reach)
            });
        let corners = corners.map(|p| self.pixel_from_world * p);
        let beyond = |corners: &[DVec4], near_m: f64| {
            let cut = cut(corners, |p| p.z - near_m);
            let points = cut.iter().map(|p| p.truncate().truncate() / p.w);
            match round {
                Some(round) => {
                    let w = cut.iter().map(|p| p.w).fold(f64::MAX, f64::min);
                    widened(points, (radius_m * self.px_per_m / w).max(round.least_px))
                }
                None => points.collect(),
            }
        };
        let farthest = corners.iter().map(|p| p.z).fold(f64::MIN, f64::max);
        let farthest = farthest + radius_m;
        let least_m = if self.is_perspective {
            self.near_m * 1e-6
        } else {
            -radius_m
        };
        if !self.is_in_picture(&beyond(&corners, least_m)) {
            return Some(Unseen::Outside);
        }
        if farthest < self.near_m {
            return Some(Unseen::TooNear(farthest));
        }
        if kept.is_empty() {
            return Some(Unseen::CutAway);
        }
        if is_back {
            return Some(Unseen::Backs);
        }
        let kept: Vec<_> = kept.iter().map(|p| self.pixel_from_world * *p).collect();
        let polygon = beyond(&kept, self.near_m - radius_m);
        (!self.covers_a_center(&polygon)).then_some(match self.is_in_picture(&polygon) {
            true => Unseen::Small,
            false => Unseen::Outside,
        })
    }

    /// Whether the box around a polygon, in pixels, meets the picture.
    fn is_in_picture(&self, polygon: &[DVec2]) -> bool {
        let [low, high] = box_around(polygon);
        low.cmple(self.size).all() && high.cmpge(DVec2::ZERO).all()
    }

    /// Whether the center of some pixel is in a convex polygon.
    fn covers_a_center(&self, polygon: &[DVec2]) -> bool {
        let [low, high] = box_around(polygon);
        let first = (low.y - 0.5).ceil().max(0.0);
        let last = (high.y - 0.5).floor().min(self.size.y - 1.0);
        let mut row = first;
        while row <= last {
            let y = row + 0.5;
            let (mut left, mut right) = (f64::MAX, f64::MIN);
            for (k, a) in polygon.iter().enumerate() {
                let b = polygon[(k + 1) % polygon.len()];
                if (a.y <= y) != (b.y <= y) {
                    let x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let column = (left - 0.5).ceil().max(0.0);
            if column <= (right - 0.5).floor().min(self.size.x - 1.0) {
                return true;
            }
            row += 1.0;
        }
        false
    }
}

/// Thickness of a capsule.
#[derive(Clone, Copy)]
struct Thickness {
    /// Radius in the world, m.
    radius_m: f64,
    /// Least radius in the picture, pixels.
    least_px: f64,
}

/// The reason that wins; of two depths the farther one.
fn later(a: Unseen, b: Unseen) -> Unseen {
    if a > b { a } else { b }
}

/// Part of a convex polygon on the positive side of a plane, from which `height` is the distance.
fn cut(corners: &[DVec4], height: impl Fn(&DVec4) -> f64) -> Vec<DVec4> {
    let mut kept = Vec::with_capacity(corners.len() + 1);
    for (k, a) in corners.iter().enumerate() {
        let b = corners[(k + 1) % corners.len()];
        let [from, to] = [height(a), height(&b)];
        if from >= 0.0 {
            kept.push(*a);
        }
        if (from >= 0.0) != (to >= 0.0) {
            kept.push(a.lerp(b, from / (from - to)));
        }
    }
    kept
}

/// Polygon of the points of a line or of one point, so many pixels wide to each side.
fn widened(points: impl Iterator<Item = DVec2>, px: f64) -> Vec<DVec2> {
    let points: Vec<_> = points.collect();
    let (Some(a), Some(b)) = (points.first(), points.get(1)) else {
        return points;
    };
    let along = (b - a).normalize_or(DVec2::X);
    let side = along.perp() * px;
    let ends = along * px;
    vec![
        a - ends - side,
        b + ends - side,
        b + ends + side,
        a - ends + side,
    ]
}

fn box_around(polygon: &[DVec2]) -> [DVec2; 2] {
    let low = polygon.iter().fold(DVec2::MAX, |low, p| low.min(*p));
    let high = polygon.iter().fold(DVec2::MIN, |high, p| high.max(*p));
    [low, high]
}
