//! Reference ray tracer on the CPU in f64, for tests of GPU traversal.
//!
//! Rules that this tracer and the GPU share: nearest hits ignore single-sided triangles from behind; shadow rays
//! ([`Oracle::any`]) are blocked by either side; triangles with cut-outs count where the alpha callback accepts
//! them. An interval is open: `t_min < t < t_max`.

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};

use super::{
    ALPHA_TESTED, CAPSULES, DOUBLE_SIDED, FLIPPED, NONE, STATIC_ROOT, TOP_LEVEL, TOP_ROOT,
    TraceTriangle, Trees, capsule::Capsule, gpu_layout::instance_flags, leaves::corners,
};
use crate::World;
use reflet_base::math::in_f64;

/// A ray; hits are at `origin + t * direction`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Origin in world space, meters.
    pub origin: DVec3,
    /// Direction of any length but 0.
    pub direction: DVec3,
    /// Start of the interval: hits at or before this t are ignored.
    pub t_min: f64,
    /// End of the interval: hits at or after this t are ignored.
    pub t_max: f64,
    /// Flags of the surfaces that the ray passes through: [`UNSEEN`](super::UNSEEN),
    /// [`SHADOWLESS`](super::SHADOWLESS) or [`UNREFLECTED`](super::UNREFLECTED); 0: none.
    pub passes: u32,
}

/// A hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// Distance, in lengths of the ray's direction.
    pub t: f64,
    /// Index into [`World::instances`].
    pub instance: u32,
    /// Index into the mesh's triangles.
    pub triangle: u32,
    /// Barycentric weights of vertex 1 and vertex 2; of a capsule the [place](Capsule::place) on its surface.
    pub bary: DVec2,
}

/// A triangle in world space, or a capsule in object space.
enum Shape {
    Triangle {
        base: DVec3,
        edge1: DVec3,
        edge2: DVec3,
    },
    Capsule(Capsule),
}

struct Surface {
    shape: Shape,
    flags: u32,
}

impl Surface {
    /// Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (1997): where the ray
    /// meets the plane, as (t, weights, whether from the front); the weights may be outside [0, 1]. `None` for a
    /// capsule.
    fn plane_hit(&self, ray: &Ray) -> Option<(f64, DVec2, bool)> {
        let Shape::Triangle { base, edge1, edge2 } = &self.shape else {
            return None;
        };
        let (o, d, a, e, f) = (&ray.origin, &ray.direction, base, edge1, edge2);
        // By component: tests call this for each ray and triangle without optimization, where each operator is a call.
        let p = [
            d.y * f.z - f.y * d.z,
            d.z * f.x - f.z * d.x,
            d.x * f.y - f.x * d.y,
        ];
        let det = e.x * p[0] + e.y * p[1] + e.z * p[2];
        if det == 0.0 {
            return None;
        }
        let s = [o.x - a.x, o.y - a.y, o.z - a.z];
        let q = [
            s[1] * e.z - e.y * s[2],
            s[2] * e.x - e.z * s[0],
            s[0] * e.y - e.x * s[1],
        ];
        let bary = DVec2 {
            x: (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / det,
            y: (d.x * q[0] + d.y * q[1] + d.z * q[2]) / det,
        };
        let front = (det > 0.0) != (self.flags & FLIPPED != 0);
        Some(((f.x * q[0] + f.y * q[1] + f.z * q[2]) / det, bary, front))
    }

    /// Hits along a ray in their order: one on a triangle, up to two on a capsule.
    fn hits(&self, ray: &Ray, cull: bool) -> [Option<(f64, DVec2)>; 2] {
        let is_met = |t: f64, front: bool| {
            let seen = front || !cull || self.flags & DOUBLE_SIDED != 0;
            seen && self.flags & ray.passes == 0 && ray.t_min < t && t < ray.t_max
        };
        if let Shape::Capsule(capsule) = &self.shape {
            let Some([enter, leave]) = capsule.span(ray.origin, ray.direction) else {
                return [None; 2];
            };
            let hit = |t: f64| (t, capsule.place(ray.origin + ray.direction * t));
            return [(enter, true), (leave, false)]
                .map(|(t, front)| is_met(t, front).then(|| hit(t)));
        }
        let Some((t, bary, front)) = self.plane_hit(ray) else {
            return [None; 2];
        };
        if !(bary.x >= 0.0 && bary.y >= 0.0 && bary.x + bary.y <= 1.0 && is_met(t, front)) {
            return [None; 2];
        }
        [Some((t, bary)), None]
    }
}

/// Brute force over all triangles and capsules of a world, in f64.
pub struct Oracle {
    surfaces: Vec<Surface>,
    /// World-to-object transform of each instance of capsules, and its inverse.
    spaces: Vec<Option<[DAffine3; 2]>>,
    /// Index of the first surface of each instance.
    first: Vec<usize>,
}

impl Oracle {
    /// Places every triangle and capsule.
    pub fn new(world: &World) -> Self {
        let mut oracle = Self {
            surfaces: Vec::new(),
            spaces: Vec::new(),
            first: Vec::new(),
        };
        for instance in &world.instances {
            oracle.first.push(oracle.surfaces.len());
            let mesh = &world.meshes[instance.mesh];
            let transform = in_f64(&instance.world_from_object);
            let mirrors = transform.matrix3.determinant() < 0.0;
            let flags = instance_flags(instance, world) | if mirrors { FLIPPED } else { 0 };
            let spaces = || [transform.inverse(), transform];
            (oracle.spaces).push(mesh.capsule_radius_m.map(|_| spaces()));
            for t in 0..mesh.triangles.len() as u32 {
                let shape = match Capsule::of_mesh(mesh, t) {
                    Some(capsule) => Shape::Capsule(capsule),
                    None => {
                        let corners = corners(world, instance.mesh, t).map(|p| p.as_dvec3());
                        let [base, b, c] = corners.map(|p| transform.transform_point3(p));
                        let (edge1, edge2) = (b - base, c - base);
                        Shape::Triangle { base, edge1, edge2 }
                    }
                };
                oracle.surfaces.push(Surface { shape, flags });
            }
        }
        oracle
    }

    /// The ray in the space of an instance's surfaces.
    fn in_space_of(&self, instance: u32, ray: &Ray) -> Ray {
        let Some([object_from_world, _]) = &self.spaces[instance as usize] else {
            return *ray;
        };
        Ray {
            origin: object_from_world.transform_point3(ray.origin),
            direction: object_from_world.transform_vector3(ray.direction),
            ..*ray
        }
    }

    /// The nearest hit. `alpha_passes(instance, triangle, weights)` decides for cut-outs.
    pub fn nearest(
        &self,
        ray: &Ray,
        alpha_passes: impl Fn(u32, u32, DVec2) -> bool,
    ) -> Option<RayHit> {
        let (mut nearest, mut t_max) = (None, ray.t_max);
        for instance in 0..self.first.len() as u32 {
            let mut ray = self.in_space_of(instance, ray);
            for (surface, triangle) in self.surfaces_of(instance).iter().zip(0..) {
                ray.t_max = t_max;
                let hits = surface.hits(&ray, true);
                if let [None, None] = hits {
                    continue;
                }
                let passes = |(_, bary): &(f64, DVec2)| {
                    surface.flags & ALPHA_TESTED == 0 || alpha_passes(instance, triangle, *bary)
                };
                if let Some((t, bary)) = hits.into_iter().flatten().find(passes) {
                    t_max = t;
                    nearest = Some(RayHit {
                        t,
                        instance,
                        triangle,
                        bary,
                    });
                }
            }
        }
        nearest
    }

    /// Whether anything blocks the ray, from either side.
    pub fn any(&self, ray: &Ray, alpha_passes: impl Fn(u32, u32, DVec2) -> bool) -> bool {
        (0..self.first.len() as u32).any(|instance| {
            let ray = self.in_space_of(instance, ray);
            let mut surfaces = self.surfaces_of(instance).iter().zip(0..);
            surfaces.any(|(surface, triangle)| {
                let hits = surface.hits(&ray, false);
                if let [None, None] = hits {
                    return false;
                }
                hits.into_iter().flatten().any(|(_, bary)| {
                    surface.flags & ALPHA_TESTED == 0 || alpha_passes(instance, triangle, bary)
                })
            })
        })
    }

    fn surfaces_of(&self, instance: u32) -> &[Surface] {
        let first = self.first[instance as usize];
        let end = self.first.get(instance as usize + 1);
        &self.surfaces[first..end.copied().unwrap_or(self.surfaces.len())]
    }

    /// World-space point of barycentric weights in a triangle, or of a place on a capsule.
    pub fn point(&self, instance: u32, triangle: u32, bary: DVec2) -> DVec3 {
        match (
            &self.surface(instance, triangle).shape,
            &self.spaces[instance as usize],
        ) {
            (Shape::Capsule(capsule), Some([_, world_from_object])) => {
                let (share, normal) = capsule.point(bary);
                let point = capsule.base + capsule.axis * share + normal * capsule.radius;
                world_from_object.transform_point3(point)
            }
            (Shape::Triangle { base, edge1, edge2 }, _) => {
                *base + *edge1 * bary.x + *edge2 * bary.y
            }
            (Shape::Capsule(capsule), None) => capsule.base,
        }
    }

    fn surface(&self, instance: u32, triangle: u32) -> &Surface {
        &self.surfaces[self.first[instance as usize] + triangle as usize]
    }

    /// Hit of the ray with the plane of one triangle: t, the weights (outside [0, 1] where it passes the triangle),
    /// and the cosine between ray and normal, negative from the front. `None` where they are parallel.
    pub fn plane_hit(&self, ray: &Ray, instance: u32, triangle: u32) -> Option<(f64, DVec2, f64)> {
        let surface = self.surface(instance, triangle);
        let (t, bary, front) = surface.plane_hit(ray)?;
        let Shape::Triangle { edge1, edge2, .. } = &surface.shape else {
            return None;
        };
        let normal = edge1.cross(*edge2);
        let cosine = ray.direction.normalize().dot(normal.normalize()).abs();
        Some((t, bary, if front { -cosine } else { cosine }))
    }
}

/// Maximum number of nodes that a ray visits; `reflet check` visits at most 52 for a ray of a shipped scene. Where a
/// million surfaces lie over one another, each ray would else test all of them.
pub(super) const MOST_VISITS: u32 = 4096;

/// Traversal of the packed trees on the CPU, for scenes too large for brute force. A ray that has visited
/// `MOST_VISITS` nodes ends with the nearest of the hits so far.
impl Trees {
    /// The nearest hit, as [`Oracle::nearest`].
    pub fn nearest(
        &self,
        ray: &Ray,
        alpha_passes: impl Fn(u32, u32, DVec2) -> bool,
    ) -> Option<RayHit> {
        self.traverse(ray, true, &alpha_passes).0
    }

    /// The nearest hit with cut-outs as solid, and the number of nodes that the ray visits.
    pub fn nearest_counted(&self, ray: &Ray) -> (Option<RayHit>, u32) {
        self.traverse(ray, true, &|_, _, _| true)
    }

    /// A hit that blocks the ray, with cut-outs as solid, and the number of nodes that the ray visits.
    pub fn any_counted(&self, ray: &Ray) -> (Option<RayHit>, u32) {
        self.traverse(ray, false, &|_, _, _| true)
    }

    /// Whether anything blocks the ray, as [`Oracle::any`].
    pub fn any(&self, ray: &Ray, alpha_passes: impl Fn(u32, u32, DVec2) -> bool) -> bool {
        self.traverse(ray, false, &alpha_passes).0.is_some()
    }

    fn traverse(
        &self,
        world_ray: &Ray,
        nearest: bool,
        alpha_passes: &impl Fn(u32, u32, DVec2) -> bool,
    ) -> (Option<RayHit>, u32) {
        let words: &[u32] = bytemuck::cast_slice(&self.nodes);
        let mut best: Option<RayHit> = None;
        let mut visits = 0;
        // Nodes still to visit, each with the instance whose object space it is in.
        let roots = [
            (!self.top_instances.is_empty()).then_some((TOP_ROOT, NONE)),
            (self.static_triangles > 0).then_some((STATIC_ROOT, NONE)),
        ];
        let mut stack: Vec<_> = roots.into_iter().flatten().collect();
        while let Some((index, inside)) = stack.pop().filter(|_| visits < MOST_VISITS) {
            visits += 1;
            let mut ray = self.in_space_of(inside, world_ray);
            ray.t_max = best.map_or(ray.t_max, |hit| hit.t);
            let node = &self.nodes[index as usize];
            // Child slots are by octant: in this order the nearest child is pushed last, so that it is visited
            // first, as in the shader.
            let flip = |axis: usize, bit: usize| usize::from(ray.direction[axis] >= 0.0) * bit;
            let flip = flip(0, 4) | flip(1, 2) | flip(2, 1);
            let children = (0..8).map(|child| child ^ flip);
            for child in children.filter(|c| !node.is_child_empty(*c)) {
                let bounds = node.child_aabb(child);
                let corners = [bounds.min, bounds.max].map(|p| Vec3::from(p).as_dvec3());
                if !overlaps(ray.origin, ray.direction, [ray.t_min, ray.t_max], corners) {
                    continue;
                }
                if !node.is_leaf(child) {
                    stack.push((node.child_node_index(child), inside));
                    continue;
                }
                let (first, count) = node.child_primitives(child);
                for primitive in first..first + count {
                    if primitive & TOP_LEVEL != 0 {
                        let id = words[(primitive & !TOP_LEVEL) as usize];
                        stack.push((self.instances[id as usize].tree_root, id));
                        continue;
                    }
                    let triangle = &self.triangles[primitive as usize];
                    if let Some(hit) = self.test(triangle, inside, &ray, nearest, alpha_passes) {
                        if !nearest {
                            return (Some(hit), visits);
                        }
                        ray.t_max = hit.t;
                        best = Some(hit);
                    }
                }
            }
        }
        (best, visits)
    }

    fn test(
        &self,
        triangle: &TraceTriangle,
        inside: u32,
        ray: &Ray,
        cull: bool,
        alpha_passes: &impl Fn(u32, u32, DVec2) -> bool,
    ) -> Option<RayHit> {
        let (instance, flags) = match inside {
            NONE => (triangle.instance, triangle.flags),
            id => (id, self.instances[id as usize].trace_flags),
        };
        let shape = match flags & CAPSULES {
            0 => Shape::Triangle {
                base: Vec3::from(triangle.base).as_dvec3(),
                edge1: Vec3::from(triangle.edge1).as_dvec3(),
                edge2: Vec3::from(triangle.edge2).as_dvec3(),
            },
            _ => Shape::Capsule(triangle.capsule()),
        };
        let passes = |bary: DVec2| {
            flags & ALPHA_TESTED == 0 || alpha_passes(instance, triangle.triangle, bary)
        };
        let surface = Surface { shape, flags };
        let mut hits = surface.hits(ray, cull).into_iter().flatten();
        let (t, bary) = hits.find(|(_, bary)| passes(*bary))?;
        Some(RayHit {
            t,
            instance,
            triangle: triangle.triangle,
            bary,
        })
    }

    fn in_space_of(&self, instance: u32, ray: &Ray) -> Ray {
        if instance == NONE {
            return *ray;
        }
        let rows = &self.instances[instance as usize].object_from_world;
        let row = |k: usize| Vec3::new(rows[k][0], rows[k][1], rows[k][2]).as_dvec3();
        let linear = DMat3::from_cols(row(0), row(1), row(2)).transpose();
        let translation = Vec3::new(rows[0][3], rows[1][3], rows[2][3]).as_dvec3();
        Ray {
            origin: linear * (ray.origin - translation),
            direction: linear * ray.direction,
            ..*ray
        }
    }
}

/// The slab test of a ray, by its origin and direction, with the box between two corners, widened by the rounding that
/// boxes and triangles went through in f32.
pub fn overlaps(origin: DVec3, ray: DVec3, interval: [f64; 2], [min, max]: [DVec3; 2]) -> bool {
    let slack = (min.abs().max(max.abs()) + origin.abs()) * 4.0 * f64::from(f32::EPSILON);
    let (min, max) = (min - slack - origin, max + slack - origin);
    let [mut near, mut far] = interval;
    for axis in 0..3 {
        let direction = ray[axis];
        if direction == 0.0 {
            if min[axis] > 0.0 || max[axis] < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (min[axis] / direction, max[axis] / direction);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    near <= far
}
