//! Contacts of two instances: whether their surfaces touch or cut through each other, by their triangles and capsules.

use std::{collections::BTreeSet, f64::consts::TAU};

use glam::{DAffine3, DVec3};

use super::{Mesh, World, bvh::capsule::Capsule, shape::crossing::visit_near};
use reflet_base::math::in_f64;

/// Distance up to which surfaces touch, as a share of the diagonal of the smaller instance.
const NEAR: f64 = 1e-4;
/// The same as a share of the coordinates, which are rounded: some steps of a 32-bit float.
const ROUNDED: f64 = 1e-6;
/// Number of crossed faces by which the depth of a cut is measured.
const MOST_FACES: usize = 64;
/// Number of triangles that are looked at to find an overlap of two instances whose surfaces only touch.
const MOST_SOLID_WORK: usize = 50_000;

/// Least number of windings around the inside of a closed surface; an open one has about 0.5 beside it.
const SOLID: f64 = 0.75;

/// Contact of two instances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Least distance by which one of the two must be moved out of the other through a face where they cross, until it
    /// is beyond the outside of that face of a solid, or beyond either side of an open surface, m; 0 where they only touch.
    pub depth_m: f64,
    /// A point of the contact.
    pub at: DVec3,
}

/// A face that is crossed: its unit normal, and which of the two instances has it.
type Crossed = (DVec3, usize);

/// A point at which two triangles or capsules meet, and the face that is crossed there; `None` where they only touch.
type Meeting = (DVec3, Option<Crossed>);

/// Contact of two instances, by their indices. Each triangle, and each pair of near ones, takes 1 from `work_left`.
///
/// # Errors
/// The work that is left does not suffice.
pub fn contact(
    world: &World,
    pair: [usize; 2],
    work_left: &mut usize,
) -> Result<Option<Contact>, OutOfWork> {
    let boxes = pair.map(|i| world.bounds_of(&world.instances[i]));
    let smaller_m = f64::from(boxes[0].diagonal().min(boxes[1].diagonal()));
    let reach = (boxes.iter()).map(|b| b.min.abs().max(b.max.abs()).max_element());
    let near_m = (smaller_m * NEAR).max(f64::from(reach.fold(0.0, f32::max)) * ROUNDED);
    let min = boxes[0].min.max(boxes[1].min).as_dvec3() - near_m;
    let max = boxes[0].max.min(boxes[1].max).as_dvec3() + near_m;
    if min.cmpgt(max).any() {
        return Ok(None);
    }
    let placed = pair.map(|i| Placed::new(world, i));
    let triangles = placed.each_ref().map(|p| p.mesh.triangles.len());
    *work_left = (work_left.checked_sub(triangles[0] + triangles[1])).ok_or(OutOfWork)?;
    let radii = DVec3::AXES.map(|axis| placed.each_ref().map(|p| p.radius_along(axis)));
    let parts = [0, 1].map(|k| {
        let radius = DVec3::from_array(radii.map(|of_axis| of_axis[k]));
        placed[k].parts().filter(move |[a, b, c]: &[DVec3; 3]| {
            let is_before = (a.max(*b).max(*c) + radius).cmplt(min).any();
            !is_before && !(a.min(*b).min(*c) - radius).cmpgt(max).any()
        })
    });
    let margin = DVec3::from_array(radii.map(|[a, b]| a + b)) + near_m;
    let (mut touched, mut crossed) = (None, Vec::new());
    visit_near(parts, margin, |a, b| {
        match meeting([&placed[0], &placed[1]], [a, b], near_m) {
            Some((at, Some(face))) => crossed.push((at, face)),
            Some((at, None)) => touched = touched.or(Some(at)),
            None => {}
        }
        *work_left = work_left.saturating_sub(1);
        *work_left > 0
    });
    if *work_left == 0 {
        return Err(OutOfWork);
    }
    // Faces of one plane are one.
    let mut known = BTreeSet::new();
    crossed.retain(|(at, (normal, _))| {
        let plane = normal.extend(normal.dot(*at) / smaller_m.max(near_m));
        known.insert(plane.to_array().map(|x| (x * 1e4).round() as i64))
    });
    let outward = [0, 1].map(|k| {
        let (at, (normal, _)) = crossed.iter().find(|(_, (_, owner))| *owner == k)?;
        placed[k].outward(*at, *normal, near_m)
    });
    let depth_m = |(at, (normal, owner)): &(DVec3, Crossed)| {
        let at = normal.dot(*at);
        let [low, high] = placed[1 - owner].extent(*normal);
        match outward[*owner] {
            Some(true) => at - low,
            Some(false) => high - at,
            None => (high - at).min(at - low),
        }
    };
    let step = crossed.len().div_ceil(MOST_FACES).max(1);
    let cuts = crossed.iter().step_by(step).map(|cut| Contact {
        depth_m: depth_m(cut),
        at: cut.0,
    });
    let cut = cuts.min_by(|a, b| a.depth_m.total_cmp(&b.depth_m));
    let touch = touched
        .map(|at| overlap(&placed, [min, max], near_m).unwrap_or(Contact { depth_m: 0.0, at }));
    Ok(cut.or(touch))
}

/// Overlap of two solids whose faces touch and do not cross, such as aligned boxes, if a point is found that is inside
/// both; `[min, max]` is the box that both are in.
fn overlap(placed: &[Placed<'_>; 2], [min, max]: [DVec3; 2], near_m: f64) -> Option<Contact> {
    let is_inside = |k: usize, at: DVec3| placed[k].is_inside(at, near_m);
    let middle = (min + max) * 0.5;
    let mut inner = (is_inside(0, middle) && is_inside(1, middle)).then_some(middle);
    let triangles = placed.each_ref().map(|p| p.mesh.triangles.len());
    let most = (MOST_SOLID_WORK / (triangles[0] + triangles[1])).min(MOST_FACES);
    for k in [0, 1] {
        let middles = placed[k].parts().filter_map(|part| {
            let middle = part.iter().sum::<DVec3>() / 3.0;
            let is_near = middle.cmpge(min).all() && middle.cmple(max).all();
            is_near.then_some((middle, normal(&part)?))
        });
        let middles: Vec<_> = middles.collect();
        let step = middles.len().div_ceil(most.max(1)).max(1);
        // A face of one is inside the other, or the space behind faces that lie on each other.
        let points = middles
            .iter()
            .step_by(step)
            .take(most)
            .flat_map(|(middle, normal)| {
                let behind = [1.0, -1.0].map(|side| *middle - *normal * (side * 2.0 * near_m));
                [*middle, behind[0], behind[1]].into_iter().enumerate()
            });
        inner = inner.or_else(|| {
            let mut points = points;
            let is_found = |(place, at): &(usize, DVec3)| {
                is_inside(1 - k, *at) && (*place == 0 || is_inside(k, *at))
            };
            points.find(is_found).map(|(_, at)| at)
        });
    }
    let at = inner?;
    let mut ways = DVec3::AXES.to_vec();
    for one in placed {
        let step = one.mesh.triangles.len().div_ceil(MOST_FACES).max(1);
        ways.extend(one.parts().step_by(step).filter_map(|part| normal(&part)));
    }
    let depths = ways.into_iter().map(|way| {
        let [a, b] = placed.each_ref().map(|p| p.extent(way));
        (a[1] - b[0]).min(b[1] - a[0])
    });
    let depth_m = depths.fold(f64::MAX, f64::min);
    (depth_m > near_m).then_some(Contact { depth_m, at })
}

/// The work that a search for contacts may take does not suffice.
#[derive(Clone, Copy, Debug)]
pub struct OutOfWork;

/// A mesh with the transform of its instance in f64.
struct Placed<'a> {
    mesh: &'a Mesh,
    positions: &'a [glam::Vec3],
    to_world: DAffine3,
}

impl<'a> Placed<'a> {
    fn new(world: &'a World, instance: usize) -> Self {
        let instance = &world.instances[instance];
        Self {
            mesh: &world.meshes[instance.mesh],
            positions: world.posed(instance.mesh).positions,
            to_world: in_f64(&instance.world_from_object),
        }
    }

    /// Corners of its triangles in world space; of capsules the ends of their segments.
    fn parts(&self) -> impl Iterator<Item = [DVec3; 3]> {
        let corner = |i: u32| self.positions[i as usize].as_dvec3();
        let triangles = self.mesh.triangles.iter();
        triangles.map(move |t| t.map(|i| self.to_world.transform_point3(corner(i))))
    }

    /// Radius of its capsules along a unit vector of the world; 0 for triangles.
    fn radius_along(&self, normal: DVec3) -> f64 {
        let radius = f64::from(self.mesh.capsule_radius_m.unwrap_or(0.0));
        (self.to_world.matrix3.transpose() * normal).length() * radius
    }

    /// Times that its surface goes around a point: 1 in a closed one, -1 if its fronts are inside as in a room, 0 outside
    /// (van Oosterom, Strackee, "The Solid Angle of a Plane Triangle", 1983).
    fn windings(&self, at: DVec3) -> f64 {
        let angles = self.parts().map(|part| {
            let [a, b, c] = part.map(|p| p - at);
            let lengths = [a.length(), b.length(), c.length()];
            let below = lengths.iter().product::<f64>()
                + a.dot(b) * lengths[2]
                + b.dot(c) * lengths[0]
                + c.dot(a) * lengths[1];
            a.dot(b.cross(c)).atan2(below)
        });
        angles.sum::<f64>() / TAU * self.to_world.matrix3.determinant().signum()
    }

    /// Whether a point is inside its capsules, or its closed surface, by more than `near_m`.
    fn is_inside(&self, at: DVec3, near_m: f64) -> bool {
        match self.mesh.capsule_radius_m {
            Some(radius) => {
                let at = self.to_world.inverse().transform_point3(at);
                let is_inside = |triangle: &[u32; 3]| {
                    let [base, end] =
                        [triangle[0], triangle[1]].map(|i| self.positions[i as usize].as_dvec3());
                    let capsule = Capsule {
                        base,
                        axis: end - base,
                        radius: radius.into(),
                    };
                    capsule.height(at).0 < -near_m
                };
                self.mesh.triangles.iter().any(is_inside)
            }
            None => {
                self.windings(at) > SOLID
                    && self.parts().all(|part| {
                        let (nearest, ..) = segment_to_triangle([at, at], &part, 0.0);
                        nearest.distance(at) > near_m
                    })
            }
        }
    }

    /// Whether the normal of a face at a point points out of a closed surface; `None` for an open one.
    fn outward(&self, at: DVec3, normal: DVec3, near_m: f64) -> Option<bool> {
        if self.mesh.capsule_radius_m.is_some() {
            return Some(true);
        }
        let is_solid = |side: f64| self.windings(at + normal * (side * near_m)) > SOLID;
        match [is_solid(-1.0), is_solid(1.0)] {
            [true, false] => Some(true),
            [false, true] => Some(false),
            _ => None,
        }
    }

    /// Least and largest coordinate along a unit vector.
    fn extent(&self, normal: DVec3) -> [f64; 2] {
        let along = self.to_world.matrix3.transpose() * normal;
        let offset = self.to_world.translation.dot(normal);
        let heights = (self.positions.iter()).map(|p| p.as_dvec3().dot(along) + offset);
        let ends = heights.fold([f64::MAX, f64::MIN], |[low, high], at| {
            [low.min(at), high.max(at)]
        });
        let radius = self.radius_along(normal);
        [ends[0] - radius, ends[1] + radius]
    }
}

/// How parts of two instances meet, if they are within `near_m`.
fn meeting(placed: [&Placed<'_>; 2], [a, b]: [&[DVec3; 3]; 2], near_m: f64) -> Option<Meeting> {
    match placed.map(|p| p.mesh.capsule_radius_m) {
        [None, None] => of_triangles(a, b, near_m),
        [Some(radius), None] => {
            of_capsule(placed[0], a, radius, b, near_m).map(|(at, cut)| (at, cut.map(|n| (n, 1))))
        }
        [None, Some(radius)] => {
            of_capsule(placed[1], b, radius, a, near_m).map(|(at, cut)| (at, cut.map(|n| (n, 0))))
        }
        [Some(_), Some(_)] => {
            let [from, to] = nearest_of_segments([a[0], a[1]], [b[0], b[1]]);
            let normal = (to - from).normalize_or(DVec3::Y);
            // A stretched capsule counts by its extent towards the other.
            let [first, second] = placed.map(|placed| placed.radius_along(normal));
            let (apart, inner) = (from.distance(to), (first - second).abs());
            let outer = first + second;
            let is_cut = (inner + near_m..outer - near_m).contains(&apart);
            let is_near = (inner - near_m..=outer + near_m).contains(&apart);
            is_near.then_some((from + normal * first, is_cut.then_some((normal, 0))))
        }
    }
}

fn of_capsule(
    placed: &Placed<'_>,
    segment: &[DVec3; 3],
    radius: f32,
    triangle: &[DVec3; 3],
    near_m: f64,
) -> Option<(DVec3, Option<DVec3>)> {
    // In the object's space the capsule is round.
    let to_object = placed.to_world.inverse();
    let [base, end, _] = segment.map(|p| to_object.transform_point3(p));
    let corners = triangle.map(|p| to_object.transform_point3(p));
    let capsule = Capsule {
        base,
        axis: end - base,
        radius: radius.into(),
    };
    let scale = DVec3::AXES.map(|axis| placed.radius_along(axis));
    let near = near_m * capsule.radius / scale.into_iter().fold(1e-300, f64::max);
    let (nearest, on_axis, _) = segment_to_triangle([base, end], &corners, 0.0);
    let least = nearest.distance(on_axis) - capsule.radius;
    let most = corners.map(|corner| capsule.height(corner).0);
    let most = most.into_iter().fold(f64::MIN, f64::max);
    let is_cut = least < -near && most > near;
    let at = placed.to_world.transform_point3(nearest);
    let across = normal(triangle).filter(|_| is_cut);
    (least <= near && most >= -near).then_some((at, across))
}

fn of_triangles(a: &[DVec3; 3], b: &[DVec3; 3], near_m: f64) -> Option<Meeting> {
    let is_beside = |triangle: &[DVec3; 3], other: &[DVec3; 3]| {
        let normal = normal(triangle)?;
        let heights = other.map(|p| (p - triangle[0]).dot(normal));
        let is_apart = |side: f64| heights.iter().all(|h| h * side > near_m);
        (is_apart(1.0) || is_apart(-1.0)).then_some(())
    };
    if is_beside(a, b).or_else(|| is_beside(b, a)).is_some() {
        return None;
    }
    let mut touched = None;
    for (edges_of, face, owner) in [(a, b, 1), (b, a, 0)] {
        for k in 0..3 {
            let edge = [edges_of[k], edges_of[(k + 1) % 3]];
            let (on_face, on_edge, crosses) = segment_to_triangle(edge, face, near_m);
            if crosses {
                return Some((on_face, normal(face).map(|normal| (normal, owner))));
            }
            let touches = on_face.distance(on_edge) <= near_m;
            touched = touched.or(touches.then_some((on_face, None)));
        }
    }
    touched
}

fn normal([a, b, c]: &[DVec3; 3]) -> Option<DVec3> {
    (b - a).cross(c - a).try_normalize()
}

/// Nearest points of a triangle and of a segment, and whether the segment passes through the triangle, more than `near_m`
/// away from its ends and from the triangle's edges.
fn segment_to_triangle(
    ends: [DVec3; 2],
    triangle: &[DVec3; 3],
    near_m: f64,
) -> (DVec3, DVec3, bool) {
    let edges = [0, 1, 2].map(|k| [triangle[k], triangle[(k + 1) % 3]]);
    let mut pairs = edges.map(|edge| nearest_of_segments(edge, ends)).to_vec();
    let mut crosses = false;
    if let Some(normal) = normal(triangle) {
        // Distance by which a point of the plane is within the triangle; negative outside.
        let inside = |p: DVec3| {
            let within = edges.map(|[a, b]| normal.cross(b - a).normalize_or_zero().dot(p - a));
            within.into_iter().fold(f64::MAX, f64::min)
        };
        let heights = ends.map(|p| (p - triangle[0]).dot(normal));
        let feet = [0, 1].map(|k| [ends[k] - normal * heights[k], ends[k]]);
        pairs.extend(feet.into_iter().filter(|[foot, _]| inside(*foot) >= 0.0));
        if heights[0] * heights[1] < 0.0 {
            let at = ends[0].lerp(ends[1], heights[0] / (heights[0] - heights[1]));
            let within = inside(at);
            crosses = within > near_m && heights.iter().all(|h| h.abs() > near_m);
            pairs.extend((within >= 0.0).then_some([at, at]));
        }
    }
    let apart = |[a, b]: &[DVec3; 2]| a.distance_squared(*b);
    let nearest = pairs
        .into_iter()
        .min_by(|a, b| apart(a).total_cmp(&apart(b)));
    let [on_face, on_segment] = nearest.unwrap_or([triangle[0], ends[0]]);
    (on_face, on_segment, crosses)
}

/// Nearest points of two segments (Ericson, "Real-Time Collision Detection", 5.1.9).
fn nearest_of_segments(a: [DVec3; 2], b: [DVec3; 2]) -> [DVec3; 2] {
    let (u, v, w) = (a[1] - a[0], b[1] - b[0], a[0] - b[0]);
    let (uu, vv, uv) = (u.length_squared(), v.length_squared(), u.dot(v));
    let (uw, vw) = (u.dot(w), v.dot(w));
    let share = |x: f64, of: f64| (x / of.max(1e-300)).clamp(0.0, 1.0);
    let s = share(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = share(uv * s + vw, vv);
    let s = share(uv * t - uw, uu);
    [a[0] + u * s, b[0] + v * t]
}
