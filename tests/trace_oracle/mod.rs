//! Ray traversal, on the GPU and over the packed trees on the CPU, against brute force in f64.

mod gpu;
mod scene;

use glam::{DVec2, DVec3, Vec3};
use gpu::{ALL, Answer, Gpu, Parts};
use reflet::world::{
    World,
    bvh::{Oracle, Ray, RayHit, Trees},
};
use scene::{ALPHA_EDGE, alpha_passes};

use crate::common::is_long;

const DEFAULT_BINDING_BYTES: u64 = 128 << 20;
/// Largest relative error of the distance.
const T_TOLERANCE: f64 = 1e-5;

/// Counts of the comparison with the oracle.
#[derive(Debug, Default)]
struct Score {
    rays: usize,
    hits: usize,
    /// Number of hits on another triangle at the same distance, or of rays through an edge.
    ties: usize,
    /// Number of hits on the same triangle at such a flat angle, or so near, that no f32 geometry places the hit
    /// within the tolerance.
    rounded: usize,
    blocked: usize,
    blocked_ties: usize,
    worst_t: f64,
}

struct Checker<'a> {
    oracle: &'a Oracle,
    /// Whether f32 positions resolve the tolerance; far from the origin they do not.
    exact_positions: bool,
    score: Score,
}

impl Checker<'_> {
    /// Error in meters along the ray that f32 geometry may have: positions are stored rounded, and a
    /// plane moved by the rounding meets the ray this much off.
    fn rounding_m(&self, ray: &Ray, t: f64, cosine: f64) -> f64 {
        let at = ray.origin + ray.direction * t;
        let position = at.abs().max_element().max(length_m(ray, t));
        2.0 * f64::from(f32::EPSILON) * position / cosine.abs()
    }

    /// Whether the ray passes a triangle so close to an edge, or to the edge of its cut-out, or to
    /// an end of the interval, that rounding decides.
    fn is_close_call(&self, ray: &Ray, instance: u32, triangle: u32) -> bool {
        let Some((t, bary, cosine)) = self.oracle.plane_hit(ray, instance, triangle) else {
            return true;
        };
        let close_m = self.rounding_m(ray, t, cosine);
        let [a, b, c] = [DVec2::ZERO, DVec2::X, DVec2::Y]
            .map(|corner| self.oracle.point(instance, triangle, corner));
        let twice_area = (b - a).cross(c - a).length();
        // A barycentric weight is the distance from the opposite edge over the height on that edge.
        let within = |weight: f64, edge: DVec3| weight.abs() * twice_area < close_m * edge.length();
        within(bary.x, c - a)
            || within(bary.x - ALPHA_EDGE, c - a)
            || within(bary.y, b - a)
            || within(1.0 - bary.x - bary.y, c - b)
            || length_m(ray, (t - ray.t_min).abs()) < close_m
            || length_m(ray, (t - ray.t_max).abs()) < close_m
    }

    fn nearest(&mut self, ray: &Ray, got: Option<RayHit>) {
        let expected = self.oracle.nearest(ray, alpha_passes);
        self.score.rays += 1;
        self.score.hits += usize::from(expected.is_some());
        let id = |hit: RayHit| (hit.instance, hit.triangle);
        match (expected, got) {
            (None, None) => {}
            (Some(e), Some(g)) if id(e) == id(g) => self.same_triangle(ray, e, g),
            (e, g) => {
                let slack_m = |hit: RayHit| {
                    let plane = self.oracle.plane_hit(ray, hit.instance, hit.triangle);
                    self.rounding_m(ray, hit.t, plane.map_or(0.0, |(.., cosine)| cosine))
                };
                let tie = e.zip(g).is_some_and(|(e, g)| {
                    length_m(ray, (e.t - g.t).abs()) <= slack_m(e) + slack_m(g)
                });
                let close = [e, g]
                    .into_iter()
                    .flatten()
                    .any(|h| self.is_close_call(ray, h.instance, h.triangle));
                assert!(tie || close, "{ray:?}: {e:?}, but traced {g:?}");
                self.score.ties += 1;
            }
        }
    }

    fn same_triangle(&mut self, ray: &Ray, expected: RayHit, got: RayHit) {
        let error = (got.t - expected.t).abs() / expected.t;
        let (.., cosine) = self
            .oracle
            .plane_hit(ray, got.instance, got.triangle)
            .expect("hit");
        let rounding_m = self.rounding_m(ray, expected.t, cosine);
        if error <= T_TOLERANCE {
            self.score.worst_t = self.score.worst_t.max(error);
        } else {
            assert!(
                error * length_m(ray, expected.t) < rounding_m,
                "{ray:?}: {expected:?}, but traced {got:?}, cosine {cosine}"
            );
            self.score.rounded += 1;
        }
        // The barycentric weights place the hit on the ray.
        let placed = self.oracle.point(got.instance, got.triangle, got.bary);
        let off_m = placed.distance(ray.origin + ray.direction * expected.t);
        let allowed_m = rounding_m + T_TOLERANCE * length_m(ray, expected.t);
        assert!(
            off_m < allowed_m,
            "{ray:?}: {expected:?} {got:?}: {off_m} m"
        );
    }

    fn any(&mut self, ray: &Ray, got: bool) {
        let expected = self.oracle.any(ray, alpha_passes);
        self.score.blocked += usize::from(expected);
        if expected != got {
            println!("any hit: expected {expected} for {ray:?}");
            self.score.blocked_ties += 1;
        }
    }

    /// Asserts that rounding decides at most one in a thousand.
    fn finish(self, what: &str) {
        println!("{what}: {:?}", self.score);
        let allowed = self.score.rays / 1000 + 1;
        assert!(
            self.score.hits * 8 > self.score.rays,
            "the rays must hit something"
        );
        assert!(self.score.ties <= allowed);
        assert!(self.score.rounded <= allowed || !self.exact_positions);
        assert!(self.score.blocked_ties <= allowed);
    }
}

/// Length of a ray up to `t`, meters.
fn length_m(ray: &Ray, t: f64) -> f64 {
    ray.direction.length() * t
}

fn answered(answer: &Answer) -> Option<RayHit> {
    (answer.instance != u32::MAX).then(|| RayHit {
        t: f64::from(answer.t),
        instance: answer.instance,
        triangle: answer.triangle,
        bary: DVec2::new(answer.bary[0].into(), answer.bary[1].into()),
    })
}

fn judge_cpu(world: &World, trees: &Trees, rays: &[Ray], what: &str) {
    let mut checker = Checker {
        oracle: &Oracle::new(world),
        exact_positions: true,
        score: Score::default(),
    };
    for ray in rays {
        checker.nearest(ray, trees.nearest(ray, alpha_passes));
        checker.any(ray, trees.any(ray, alpha_passes));
    }
    checker.finish(what);
}

fn judge_gpu(gpu: &Gpu, world: &World, trees: &Trees, rays: &[Ray], parts: Parts, what: &str) {
    let oracle = Oracle::new(world);
    let mut checker = Checker {
        oracle: &oracle,
        exact_positions: world.unit_m() > 1e-3 * world.static_bounds().center().length(),
        score: Score::default(),
    };
    for (ray, answer) in rays.iter().zip(gpu.trace(trees, rays, parts)) {
        assert!(answer.bary.iter().all(|w| (0.0..=1.0).contains(w)));
        assert!(answer.bary[0] + answer.bary[1] <= 1.0 + f32::EPSILON);
        checker.nearest(ray, answered(&answer));
        checker.any(ray, answer.blocked != 0);
    }
    checker.finish(what);
}

fn build(world: &World) -> Trees {
    Trees::build(world, DEFAULT_BINDING_BYTES).expect("a small scene")
}

#[test]
fn packed_trees_agree_with_brute_force() {
    let world = scene::world(Vec3::ZERO);
    let trees = build(&world);
    assert!(trees.static_triangles > 0 && !trees.top_instances.is_empty());
    let rays = scene::random_rays(&world, Vec3::ZERO, 1500);
    judge_cpu(&world, &trees, &rays, "CPU");
    let rays = scene::special_rays(&world, Vec3::ZERO);
    judge_cpu(&world, &trees, &rays, "CPU, special rays");
}

#[test]
fn rays_on_the_gpu_agree_with_brute_force() {
    let count = if is_long() { 10_000 } else { 1500 };
    let Some(gpu) = Gpu::new() else { return };
    let world = scene::world(Vec3::ZERO);
    let trees = build(&world);
    let rays = scene::random_rays(&world, Vec3::ZERO, count);
    judge_gpu(&gpu, &world, &trees, &rays, ALL, "GPU");
    let rays = scene::special_rays(&world, Vec3::ZERO);
    judge_gpu(&gpu, &world, &trees, &rays, ALL, "GPU, special rays");
}

#[test]
fn far_from_the_origin_rays_stay_as_exact_as_positions() {
    let Some(gpu) = Gpu::new() else { return };
    let offset = Vec3::new(1e4, -1e4, 1e4);
    let world = scene::world(offset);
    let rays = scene::random_rays(&world, offset, 1000);
    judge_gpu(&gpu, &world, &build(&world), &rays, ALL, "GPU, at 1e4 m");
}

#[test]
fn moved_instances_agree_with_brute_force() {
    let Some(gpu) = Gpu::new() else { return };
    let mut world = scene::world(Vec3::ZERO);
    let mut trees = build(&world);
    let mut random = scene::Random(17);
    for instance in world.instances.iter_mut().filter(|i| i.dynamic) {
        instance.world_from_object.translation += glam::Vec3A::from(random.point(4.0));
    }
    trees.update_top_level(&world).expect("shallow");
    let rays = scene::random_rays(&world, Vec3::ZERO, 2000);
    judge_gpu(&gpu, &world, &trees, &rays, ALL, "GPU, moved");
}

#[test]
fn parts_left_out_change_nothing_where_the_scene_has_none() {
    let Some(gpu) = Gpu::new() else { return };
    let opaque = |dynamic: bool| {
        let mut world = scene::world(Vec3::ZERO);
        world.instances.iter_mut().for_each(|i| i.dynamic = dynamic);
        world
            .materials
            .iter_mut()
            .for_each(|m| m.alpha_cutoff = None);
        world
    };
    for dynamic in [false, true] {
        let world = opaque(dynamic);
        let trees = build(&world);
        let parts = Parts {
            has_static: !dynamic,
            has_top_level: dynamic,
            has_cutout: false,
            ..ALL
        };
        let rays = scene::random_rays(&world, Vec3::ZERO, 2000);
        judge_gpu(
            &gpu,
            &world,
            &trees,
            &rays,
            parts,
            &format!("GPU, {parts:?}"),
        );
        let (some, all) = (
            gpu.trace(&trees, &rays, parts),
            gpu.trace(&trees, &rays, ALL),
        );
        for (some, all) in some.iter().zip(&all) {
            assert_eq!(answered(some), answered(all));
            assert_eq!(some.blocked, all.blocked);
            assert!(some.visited_nodes > 0);
        }
    }
    let nothing = Parts {
        has_static: false,
        has_top_level: false,
        has_cutout: false,
        ..ALL
    };
    let world = World::default();
    let mut random = scene::Random(19);
    let rays: Vec<_> = (0..64)
        .map(|_| scene::ray(random.point(1.0), random.direction(), 0.0, 1e30))
        .collect();
    for parts in [nothing, ALL] {
        for answer in gpu.trace(&build(&world), &rays, parts) {
            assert_eq!((answer.instance, answer.blocked), (u32::MAX, 0));
        }
    }
}

/// A ray that reaches the limit of visited nodes ends as a miss, and is counted; rays that need fewer visits
/// keep their hits.
#[test]
fn a_ray_without_visits_left_is_a_counted_miss() {
    let Some(gpu) = Gpu::new() else { return };
    let world = scene::closed_shape(Vec3::ZERO, true);
    let trees = build(&world);
    let rays = scene::random_rays(&world, Vec3::ZERO, 500);
    let free = gpu.trace(&trees, &rays, ALL);
    assert!(free.iter().all(|answer| answer.exhausted_rays == 0));
    assert!(free.iter().any(|answer| answer.instance != u32::MAX));
    let most = free.iter().map(|answer| answer.visited_nodes).max();
    let limit = most.expect("some rays") / 2;
    let max_visits = Some(limit);
    let bounded = gpu.trace(&trees, &rays, Parts { max_visits, ..ALL });
    let mut num_exhausted = 0;
    for (free, bounded) in free.iter().zip(&bounded) {
        assert!(bounded.visited_nodes <= limit, "a ray visits no more");
        if free.visited_nodes < limit {
            assert_eq!(answered(free), answered(bounded));
        } else {
            assert_eq!(bounded.instance, u32::MAX);
            assert!(bounded.exhausted_rays > 0);
            num_exhausted += 1;
        }
    }
    assert!(0 < num_exhausted && num_exhausted < rays.len());
}

/// Rays from inside closed, curved shapes at vertices and at points of edges, where two triangles
/// may both claim or both disown them.
#[test]
fn no_ray_passes_between_neighboring_triangles() {
    let Some(gpu) = Gpu::new() else { return };
    for (dynamic, offset) in [(false, 0.0), (true, 0.0), (false, 300.0), (true, 300.0)] {
        let world = scene::closed_shape(Vec3::splat(offset), dynamic);
        let rays = scene::rays_at_edges(&world, 8000);
        let answers = gpu.trace(&build(&world), &rays, ALL);
        let leaks = answers.iter().filter(|a| a.instance == u32::MAX).count();
        let open = answers.iter().filter(|a| a.blocked == 0).count();
        println!(
            "dynamic {dynamic}, at {offset} m: {leaks} of {} leaked",
            rays.len()
        );
        assert_eq!((leaks, open), (0, 0));
    }
}

/// Capsules are compared by themselves, as the tolerances above are for planes: rounding decides only for rays that
/// nearly touch a capsule.
#[test]
fn capsules_agree_with_brute_force() {
    let world = scene::capsules();
    let trees = build(&world);
    let oracle = Oracle::new(&world);
    let rays = scene::random_rays(&world, Vec3::ZERO, 1500);
    let judge = |what: &str, traced: &[(Option<RayHit>, bool)], allowed: usize| {
        let (mut on_capsules, mut ties) = (0, 0);
        for (ray, (got, blocked)) in rays.iter().zip(traced) {
            let expected = oracle.nearest(ray, alpha_passes);
            let id = |hit: &RayHit| (hit.instance, hit.triangle);
            if expected.as_ref().map(id) != got.as_ref().map(id)
                || oracle.any(ray, alpha_passes) != *blocked
            {
                ties += 1;
                continue;
            }
            let Some((expected, got)) = expected.zip(*got) else {
                continue;
            };
            if world.meshes[world.instances[got.instance as usize].mesh]
                .capsule_radius_m
                .is_none()
            {
                continue;
            }
            on_capsules += 1;
            let away_m = length_m(ray, (got.t - expected.t).abs());
            let placed = oracle.point(got.instance, got.triangle, got.bary);
            let off_m = placed.distance(ray.origin + ray.direction * got.t);
            // Where a ray nearly touches a capsule, its distance is the root of a small difference.
            ties += usize::from(away_m > 1e-4 || off_m > 1e-3);
        }
        println!("{what}: {on_capsules} hits on capsules, {ties} ties");
        assert!(on_capsules > 200, "{what}: {on_capsules}");
        assert!(ties <= allowed, "{what}: {ties}");
    };
    let cpu = rays.iter().map(|ray| {
        let nearest = trees.nearest(ray, alpha_passes);
        (nearest, trees.any(ray, alpha_passes))
    });
    judge("CPU", &cpu.collect::<Vec<_>>(), 2);
    let Some(gpu) = Gpu::new() else { return };
    let answers = gpu.trace(&trees, &rays, ALL);
    let of_gpu = answers.iter().map(|a| (answered(a), a.blocked != 0));
    judge("GPU", &of_gpu.collect::<Vec<_>>(), 3);
}
