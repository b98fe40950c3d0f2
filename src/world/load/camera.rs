//! Default camera for scenes without one.

use glam::{Affine3A, Vec3, Vec4};

use super::one_color::{PlacedMesh, is_one_color, plain_color};
use crate::{Mesh, Posed, Shared, World, bvh::capsule::Capsule, sight::Sight};
use reflet_base::math::Bounds;
use reflet_scene::{
    desc::{CameraDesc, Entry, SceneDesc},
    diagnostic::{Diagnostic, Span},
    motion::Motion,
};

/// Fraction of the picture's width or height that the scene fills.
const FILLED: f32 = 0.8;
/// Maximum number of vertices that are framed; above it, the boxes of instances are.
const MOST_VERTICES: usize = 1 << 23;
/// Thickness of a flat scene, as a fraction of its second smallest extent.
const FLAT: f32 = 0.1;
/// Least radius of a scene, meters, far below any that is shown.
const LEAST_RADIUS_M: f32 = 1e-20;
/// Least net area that faces the back of a flat scene, as a fraction of its area, for the camera to stand there.
const LEAST_FACING: f32 = 1e-3;

/// Directions from a point of a capsule's axis to points of its surface.
const EXTREMES: [Vec3; 6] = [
    Vec3::X,
    Vec3::Y,
    Vec3::Z,
    Vec3::NEG_X,
    Vec3::NEG_Y,
    Vec3::NEG_Z,
];

/// Adds a camera `main` that frames the whole scene if there is no camera, or if all cameras come from files and see
/// nothing at any time, or one color of a still scene; returns whether it did. `meshes` are the world's, with their
/// vertices.
pub fn add_default(world: &mut World, meshes: &Shared<Mesh>, desc: &SceneDesc) -> bool {
    let size = desc.image.size;
    let is_moved = desc.has_frame_script() || world.instances.is_empty();
    if !world.cameras.is_empty() && (!desc.cameras.is_empty() || is_moved) {
        return false;
    }
    let framed = Framed::from_world(world, meshes);
    let bounds = framed.bounds();
    if !world.cameras.is_empty()
        && (bounds.is_empty() || is_something_seen(world, meshes, desc, &framed))
    {
        return false;
    }
    let aspect = size[0] as f32 / size[1] as f32;
    let radius = (bounds.diagonal() * 0.5).max(LEAST_RADIUS_M);
    let defaults = CameraDesc::default();
    let to_eye = framed.to_eye(&bounds);
    let half_angle = defaults.fov_deg.to_radians() * 0.5;
    let fit = Fit {
        to_eye,
        half_angle,
        aspect,
        origin: bounds.center(),
    };
    let (target, distance) = framed.fitted(&fit);
    let value = CameraDesc {
        eye: target + to_eye * distance.max(radius * 0.1),
        target,
        ..defaults
    };
    let main = Entry {
        name: "main".into(),
        at: Span::default(),
        value,
    };
    if !world.cameras.is_empty() {
        let message = "no camera of the files sees anything, or more than one color; a camera `main` that shows the whole scene is added";
        let note = Diagnostic::new("cameras-see-nothing", Span::default(), message).warning();
        world.warnings.push(note);
    }
    world.cameras.push(main);
    true
}

/// Whether some camera of the files sees a surface at one of some times of the timeline, and not one color alone.
fn is_something_seen(
    world: &World,
    meshes: &Shared<Mesh>,
    desc: &SceneDesc,
    framed: &Framed<'_>,
) -> bool {
    /// Number of times after the first.
    const TIMES: u32 = 8;
    let unit_m = desc.reflection.unit_m.unwrap_or_else(|| world.unit_m());
    let sight = |camera: &Entry<CameraDesc>| {
        Sight::new(&camera.value, camera.value.near_in(unit_m), desc.image.size)
    };
    let may_see = |camera| !framed.is_one_color(&sight(camera));
    let may_see: Vec<_> = world.cameras.iter().map(may_see).collect();
    let mut posed = world.clone();
    posed.meshes = meshes.clone();
    let motion = Motion::new(desc);
    let (first, last) = (desc.timeline.as_ref()).map_or((0, 0), |t| (t.start, t.end));
    let times = if desc.is_still() { 0 } else { TIMES };
    (0..=times).any(|time| {
        let frame = first + ((last - first) as f32 * time as f32 / TIMES as f32) as u32;
        if times > 0 && posed.apply(&motion.pose(frame, 0.0)).is_err() {
            return true; // reported where the frame is shown
        }
        let mut cameras = posed.cameras.iter().zip(&may_see);
        cameras.any(|(camera, may_see)| *may_see && sight(camera).unseen(&posed, meshes).is_none())
    })
}

/// A placed mesh that is framed.
struct Shown<'a> {
    posed: Posed<'a>,
    triangles: &'a [[u32; 3]],
    place: Affine3A,
    double_sided: bool,
    /// Exact surface, in place of the triangles.
    round: Option<Capsule>,
    /// Color, where no light changes it.
    color: Option<Vec4>,
    /// Radius of capsules, else 0, in object space, m.
    radius_m: f32,
}

/// Geometry that the camera frames.
struct Framed<'a> {
    meshes: Vec<Shown<'a>>,
    /// World boxes of animated instances over time; boxes of all where there are too many vertices.
    boxes: Vec<Bounds>,
}

impl<'a> Framed<'a> {
    /// Static instances, and boxes around animated instances over time; all instances if every one is animated.
    fn from_world(world: &'a World, meshes: &'a [Mesh]) -> Self {
        let mut boxes = world.animated_bounds();
        boxes.extend(world.deformed_bounds(meshes));
        let has_players = !world.moving.players.is_empty();
        let is_animated = world.animated_instances();
        let still = |i: usize| {
            if has_players {
                !is_animated[i] && !world.deformed.contains_key(&world.instances[i].mesh)
            } else {
                !world.instances[i].dynamic
            }
        };
        let seen = |i: &usize| {
            let instance = &world.instances[*i];
            instance.shown.visible && !instance.is_hidden()
        };
        let all = || (0..world.instances.len()).filter(seen);
        let mut shown: Vec<usize> = all().filter(|i| still(*i)).collect();
        if shown.is_empty() && boxes.is_empty() {
            shown = all().collect();
        }
        let of = |i: &usize| {
            let instance = &world.instances[*i];
            let mesh = &meshes[instance.mesh];
            let deformed = world.deformed.get(&instance.mesh);
            Shown {
                posed: deformed.map_or_else(|| mesh.at_rest(), |deformed| deformed.posed()),
                triangles: &mesh.triangles,
                place: instance.world_from_object,
                double_sided: world.materials[instance.material].double_sided,
                round: mesh.round.and_then(|_| Capsule::of_mesh(mesh, 0)),
                color: plain_color(&world.materials[instance.material], mesh),
                radius_m: mesh.capsule_radius_m.unwrap_or(0.0),
            }
        };
        let mut meshes: Vec<_> = shown.iter().map(of).collect();
        let vertices: usize = meshes.iter().map(|m| m.posed.positions.len()).sum();
        if vertices > MOST_VERTICES {
            let placed = meshes.iter().map(|m| m.posed.bounds.transformed(&m.place));
            boxes.extend(placed);
            meshes.clear();
        }
        Self { meshes, boxes }
    }

    /// All vertices and corners of boxes, in world space.
    fn points(&self) -> impl Iterator<Item = Vec3> {
        let corner = |bounds: &Bounds, index: u32| {
            let pick = |bit: u32| index >> bit & 1 == 1;
            Vec3::select(
                glam::BVec3::new(pick(0), pick(1), pick(2)),
                bounds.max,
                bounds.min,
            )
        };
        let boxes = self.boxes.iter().filter(|bounds| !bounds.is_empty());
        let corners = boxes.flat_map(move |bounds| (0..8).map(move |i| corner(bounds, i)));
        let vertices = self.meshes.iter().flat_map(|shown| {
            let offsets = match shown.radius_m {
                0.0 => &[Vec3::ZERO][..],
                _ => &EXTREMES,
            };
            let positions = shown.posed.positions.iter();
            positions.flat_map(move |position| {
                let extreme = move |offset: &Vec3| *position + *offset * shown.radius_m;
                let extremes = offsets.iter().map(extreme);
                extremes.map(|point| shown.place.transform_point3(point))
            })
        });
        vertices.chain(corners)
    }

    fn bounds(&self) -> Bounds {
        Bounds::around(self.points())
    }

    /// Whether a camera sees one color alone.
    fn is_one_color(&self, sight: &Sight) -> bool {
        let met = self.meshes.iter().map(|shown| PlacedMesh {
            triangles: (shown.triangles.iter()).map(|t| shown.posed.corners(*t)),
            place: &shown.place,
            double_sided: shown.double_sided,
            round: shown.round,
            color: shown.color,
            count: shown.triangles.len(),
        });
        self.boxes.is_empty() && is_one_color(sight, met)
    }

    /// Unit direction from the scene to the eye: slightly from the right and above; steeper onto a flat scene, from
    /// the side that its triangles face.
    fn to_eye(&self, bounds: &Bounds) -> Vec3 {
        let usual = Vec3::new(0.5, 0.4, 1.0).normalize();
        if bounds.is_empty() {
            return usual;
        }
        let extent = bounds.max - bounds.min;
        let thin = extent.min_position();
        let mut others = extent;
        others[thin] = f32::INFINITY;
        if extent[thin] > others.min_element() * FLAT {
            return usual;
        }
        let mut to_eye = usual;
        to_eye[thin] = 1.0;
        let (facing, area) = self.facing();
        // Closed meshes face all sides equally, except for rounding.
        if facing[thin] < -area * LEAST_FACING {
            to_eye[thin] = -1.0;
        }
        to_eye.normalize()
    }

    /// Sum of the area vectors of all single-sided triangles, and sum of their lengths.
    fn facing(&self) -> (Vec3, f32) {
        let single = self.meshes.iter().filter(|shown| !shown.double_sided);
        let area = |shown: &Shown<'_>| {
            let place = shown.place.matrix3;
            let triangle = |t: &[u32; 3]| {
                let corners = shown.posed.corners(*t);
                let [a, b, c] = corners.map(|p| place * glam::Vec3A::from(p));
                (b - a).cross(c - a)
            };
            let sum = |(sum, lengths): (glam::Vec3A, f32), area: glam::Vec3A| {
                (sum + area, lengths + area.length())
            };
            let areas = shown.triangles.iter().map(triangle);
            let (vectors, lengths) = areas.fold((glam::Vec3A::ZERO, 0.0), sum);
            // A mirroring transform reverses the winding, but not which side is the front.
            (Vec3::from(vectors) * place.determinant().signum(), lengths)
        };
        let add = |(a, b): (Vec3, f32), (c, d): (Vec3, f32)| (a + c, b + d);
        single.map(area).fold((Vec3::ZERO, 0.0), add)
    }

    /// Target and distance at which all points are within the picture and touch its borders on two
    /// opposite sides.
    fn fitted(&self, fit: &Fit) -> (Vec3, f32) {
        let right = Vec3::Y.cross(fit.to_eye).normalize();
        let up = fit.to_eye.cross(right);
        let high = FILLED * fit.half_angle.tan();
        let slopes = [high * fit.aspect, high];
        // Largest offset of each border at distance 0: right, left, up, down.
        let mut most = [f32::NEG_INFINITY; 4];
        for point in self.points() {
            let p = point - fit.origin;
            let near = p.dot(fit.to_eye);
            for (axis, (side, slope)) in [right, up].into_iter().zip(slopes).enumerate() {
                let along = p.dot(side);
                most[2 * axis] = most[2 * axis].max(along + slope * near);
                most[2 * axis + 1] = most[2 * axis + 1].max(-along + slope * near);
            }
        }
        if !most.iter().all(|m| m.is_finite()) {
            return (fit.origin, 0.0);
        }
        let needed = |axis: usize| (most[2 * axis] + most[2 * axis + 1]) * 0.5 / slopes[axis];
        let middle = |axis: usize| (most[2 * axis] - most[2 * axis + 1]) * 0.5;
        let distance = needed(0).max(needed(1));
        let mut target = fit.origin + right * middle(0) + up * middle(1);
        // The axis with room to spare was centered for its own, shorter distance; it is centered again for the
        // actual one.
        let (spare, side) = if needed(0) < needed(1) {
            (0, right)
        } else {
            (1, up)
        };
        if distance > needed(spare) {
            let mut range = [f32::INFINITY, f32::NEG_INFINITY];
            for point in self.points() {
                let p = point - target;
                let slope = p.dot(side) / (distance - p.dot(fit.to_eye));
                range = [range[0].min(slope), range[1].max(slope)];
            }
            // Near points shift by more of the picture than far ones; the clamp keeps them inside.
            let room = slopes[spare] * (distance - needed(spare));
            let shift = (range[0] + range[1]) * 0.5 * distance;
            target += side * shift.clamp(-room, room);
        }
        (target, distance)
    }
}

/// Parameters of the view that is fitted.
struct Fit {
    to_eye: Vec3,
    /// Half of the vertical field of view, radians.
    half_angle: f32,
    /// Width over height.
    aspect: f32,
    origin: Vec3,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_fills_the_picture_and_stays_inside() {
        let framed = Framed {
            meshes: Vec::new(),
            boxes: vec![Bounds {
                min: Vec3::new(-2.0, -1.0, -0.5),
                max: Vec3::new(4.0, 1.0, 0.5),
            }],
        };
        for (to_eye, aspect, want) in [
            // From the front: 3 m to the side at the front face, half a meter nearer.
            (Vec3::Z, 1.0, 0.5 + 3.0 / FILLED),
            (Vec3::Z, 4.0, 0.5 + 1.0 / FILLED),
            // From the side: half a meter to the side.
            (Vec3::X, 1.0, 3.0 + 1.0 / FILLED),
        ] {
            let fit = Fit {
                to_eye,
                half_angle: std::f32::consts::FRAC_PI_4,
                aspect,
                origin: Vec3::X,
            };
            let (target, distance) = framed.fitted(&fit);
            assert!(
                (distance - want).abs() < 1e-5,
                "{to_eye} {aspect}: {distance} {want}"
            );
            assert!(target.distance(Vec3::X) < 1e-5, "{target}");
        }
    }
}
