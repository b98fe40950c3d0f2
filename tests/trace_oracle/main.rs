//! Ray traversal, on the GPU and over the packed trees on the CPU, against brute force in f64.

mod gpu;
mod scene;

use glam::{DVec2, Vec3};
use gpu::{ALL, Answer, Gpu, Parts};
use reflet::world::{
    World,
    bvh::{Oracle, Ray, RayHit, Trees},
};
use scene::{ALPHA_EDGE, alpha_passes, edge_distance};

const DEFAULT_BINDING_BYTES: u64 = 128 << 20;
/// Of the distance.
const T_TOLERANCE: f64 = 1e-5;

/// How answers compare with the oracle's.
#[derive(Debug, Default)]
struct Score {
    rays: usize,
    hits: usize,
    /// Another triangle at the same distance, or a ray through an edge.
    ties: usize,
    /// The same triangle at such a flat angle, or so near, that no f32 geometry places the hit
    /// within the tolerance.
    rounded: usize,
    blocked: usize,
    blocked_ties: usize,
    worst_t: f64,
}

struct Judge<'a> {
    oracle: &'a Oracle,
    score: Score,
}

impl Judge<'_> {
    /// Whether the ray passes a triangle so close to an edge, or to the edge of its cut-out, or to
    /// an end of the interval, that rounding decides.
    fn is_close_call(&self, ray: &Ray, instance: u32, triangle: u32) -> bool {
        let Some((t, bary, cosine)) = self.oracle.plane_hit(ray, instance, triangle) else {
            return true;
        };
        let close = 1e-4 / cosine.abs().max(1e-3);
        edge_distance(bary) < close
            || (bary.x - ALPHA_EDGE).abs() < close
            || (t - ray.t_min).abs() < close * t.abs()
            || (t - ray.t_max).abs() < close * t.abs()
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
                let tie = e
                    .zip(g)
                    .is_some_and(|(e, g)| (e.t - g.t).abs() <= T_TOLERANCE * e.t);
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
        // Positions are stored in f32; a plane moved by their rounding meets the ray this much off.
        let position = (ray.origin + ray.direction * expected.t)
            .abs()
            .max_element();
        let rounding = 8.0 * f64::from(f32::EPSILON) * position.max(scene::length(ray, expected.t));
        let unavoidable = rounding / cosine.abs() / scene::length(ray, expected.t);
        if error > T_TOLERANCE && error < unavoidable {
            self.score.rounded += 1;
            return;
        }
        self.score.worst_t = self.score.worst_t.max(error);
        assert!(
            error <= T_TOLERANCE,
            "{ray:?}: {expected:?}, but traced {got:?}, cosine {cosine}"
        );
        let off = (got.bary - expected.bary).abs().max_element();
        assert!(off < 1e-3 / cosine.abs(), "{ray:?}: {expected:?} {got:?}");
    }

    fn any(&mut self, ray: &Ray, got: bool) {
        let expected = self.oracle.any(ray, alpha_passes);
        self.score.blocked += usize::from(expected);
        if expected != got {
            println!("any hit: expected {expected} for {ray:?}");
            self.score.blocked_ties += 1;
        }
    }

    /// At most one in a thousand may be left to rounding.
    fn finish(self, what: &str) {
        println!("{what}: {:?}", self.score);
        let allowed = self.score.rays / 1000 + 1;
        assert!(
            self.score.hits * 8 > self.score.rays,
            "the rays must hit something"
        );
        assert!(self.score.ties <= allowed);
        assert!(self.score.rounded <= allowed * 5);
        assert!(self.score.blocked_ties <= allowed);
    }
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
    let mut judge = Judge {
        oracle: &Oracle::new(world),
        score: Score::default(),
    };
    for ray in rays {
        judge.nearest(ray, trees.nearest(ray, alpha_passes));
        judge.any(ray, trees.any(ray, alpha_passes));
    }
    judge.finish(what);
}

fn judge_gpu(gpu: &Gpu, world: &World, trees: &Trees, rays: &[Ray], parts: Parts, what: &str) {
    let oracle = Oracle::new(world);
    let mut judge = Judge {
        oracle: &oracle,
        score: Score::default(),
    };
    for (ray, answer) in rays.iter().zip(gpu.trace(trees, rays, parts)) {
        assert!(answer.bary.iter().all(|w| (0.0..=1.0).contains(w)));
        assert!(answer.bary[0] + answer.bary[1] <= 1.0 + f32::EPSILON);
        judge.nearest(ray, answered(&answer));
        judge.any(ray, answer.blocked != 0);
    }
    judge.finish(what);
}

fn build(world: &World) -> Trees {
    Trees::build(world, DEFAULT_BINDING_BYTES).expect("a small scene")
}

#[test]
fn packed_trees_agree_with_brute_force() {
    let world = scene::world(Vec3::ZERO);
    let trees = build(&world);
    assert!(trees.static_triangles > 0 && !trees.top_instances.is_empty());
    let rays = scene::random_rays(&world, Vec3::ZERO, 2000);
    judge_cpu(&world, &trees, &rays, "CPU");
    let rays = scene::special_rays(&world, Vec3::ZERO);
    judge_cpu(&world, &trees, &rays, "CPU, special rays");
}

#[test]
fn ten_thousand_rays_agree_with_brute_force() {
    let Some(gpu) = Gpu::new() else { return };
    let world = scene::world(Vec3::ZERO);
    let trees = build(&world);
    let rays = scene::random_rays(&world, Vec3::ZERO, 10_000);
    judge_gpu(&gpu, &world, &trees, &rays, ALL, "GPU");
    let rays = scene::special_rays(&world, Vec3::ZERO);
    judge_gpu(&gpu, &world, &trees, &rays, ALL, "GPU, special rays");
}
