//! A frame of `rt` against brute force in f64: at every reflective pixel the mirror ray is
//! recomputed from the camera and the normal AOV, and must hit the triangle of the hit AOV at its
//! distance.

use glam::{DVec2, DVec3};
use reflet::{
    render::settings::{offsets::jitter, view::View},
    world::{
        bvh::{Oracle, Ray, RayHit, UNREFLECTED, UNSEEN},
        load,
        load::LoadOptions,
    },
};

use crate::kit::*;

const ATRIUM: &str = include_str!("../../scenes/atrium.toml");
const NOTHING: u32 = u32::MAX;

/// A ray from the eye through the center of a pixel.
fn primary(view: &View, pixel: usize) -> Ray {
    let [width, height] = view.size.map(f64::from);
    let at = DVec2::new(
        (pixel % view.size[0] as usize) as f64,
        (pixel / view.size[0] as usize) as f64,
    );
    let ndc = (at + 0.5 + jitter(0, 1).as_dvec2()) / DVec2::new(width, height) * 2.0 - 1.0;
    let [forward, right, up] = [view.forward, view.right, view.up].map(|v| v.as_dvec3());
    Ray {
        origin: view.eye.as_dvec3(),
        direction: (forward + right * ndc.x - up * ndc.y).normalize(),
        t_min: 0.0,
        t_max: f64::INFINITY,
        passes: UNSEEN,
    }
}

/// Mirror ray at the hit of a primary ray, by the renderer's rules: it leaves the surface by at
/// least 1 % of its length, and starts a little above it.
fn mirrored(
    oracle: &Oracle,
    ray: &Ray,
    [instance, triangle]: [u32; 2],
    normal: DVec3,
    length_m: f64,
) -> Option<Ray> {
    let (t, ..) = oracle.plane_hit(ray, instance, triangle)?;
    let position = ray.origin + ray.direction * t;
    let [a, b, c] = [DVec2::ZERO, DVec2::X, DVec2::Y].map(|w| oracle.point(instance, triangle, w));
    let mut plane = (b - a).cross(c - a).normalize();
    plane *= -plane.dot(ray.direction).signum();
    let reflected = ray.direction - 2.0 * ray.direction.dot(normal) * normal;
    let lift = (0.01 - reflected.dot(plane)).max(0.0);
    let size = position.abs().max_element().max(t);
    Some(Ray {
        origin: position + plane * (size * 4e-5 + 1e-6),
        direction: (reflected + plane * lift).normalize(),
        t_min: 0.0,
        t_max: length_m,
        passes: UNREFLECTED,
    })
}

/// Whether the ray passes the triangle named by the frame within `tolerance_m`, so that rounding
/// decides between both hits.
fn is_near(oracle: &Oracle, ray: &Ray, [instance, triangle]: [u32; 2], tolerance_m: f64) -> bool {
    let Some((_, bary, cosine)) = oracle.plane_hit(ray, instance, triangle) else {
        return true;
    };
    let clamped = bary.max(DVec2::ZERO);
    let inside = clamped / clamped.element_sum().max(1.0);
    let [there, edge] = [bary, inside].map(|w| oracle.point(instance, triangle, w));
    there.distance(edge) * cosine.abs() <= tolerance_m
}

/// Compares the hit of the frame with brute force; returns the deviation of the distance.
fn check_pixel(oracle: &Oracle, ray: &Ray, said: Option<([u32; 2], f64)>) -> Result<f64, String> {
    let want = oracle.nearest(ray, |_, _, _| true);
    // Positions of the frame have 32 bits; the length of a ray magnifies their error.
    let tolerance = |t: f64| 2e-4 * (1.0 + t);
    match (said, want) {
        (None, None) => Ok(0.0),
        (Some((ids, t)), Some(hit)) if ids == [hit.instance, hit.triangle] => {
            let off = (t - hit.t).abs();
            let (.., cosine) = oracle
                .plane_hit(ray, ids[0], ids[1])
                .ok_or("it is seen edge-on")?;
            if off * cosine.abs() <= tolerance(hit.t) {
                Ok(off * cosine.abs())
            } else {
                Err(format!("{ids:?} is met after {t} m instead of {} m", hit.t))
            }
        }
        (Some((ids, t)), _) if is_near(oracle, ray, ids, tolerance(t)) => Ok(0.0),
        (
            _,
            Some(RayHit {
                instance,
                triangle,
                t,
                ..
            }),
        ) if is_near(oracle, ray, [instance, triangle], tolerance(t)) => Ok(0.0),
        (said, want) => Err(format!("{said:?} instead of {want:?}")),
    }
}

fn check(desc: &SceneDesc, world: &World) {
    let Some(gpu) = gpu() else { return };
    let mut renderer = renderer(gpu, desc, world, false);
    let camera = &world.cameras[0].value;
    let wanted = [
        Aov::Ids,
        Aov::Normal,
        Aov::Cause,
        Aov::HitIds,
        Aov::HitDistance,
    ];
    let picture = or_panic!(renderer.picture(gpu, camera, &wanted));
    let length_m = f64::from(desc.reflection.ray_length_u * renderer.unit_m());
    let oracle = Oracle::new(world);
    let view = View::new(camera, picture.size, world.unit_m());
    let pairs = |aov| -> Vec<[u32; 2]> {
        let ids = integers(&picture, aov).chunks_exact(2);
        ids.map(|pair| [pair[0], pair[1]]).collect()
    };
    let (ids, hits) = (pairs(Aov::Ids), pairs(Aov::HitIds));
    let normals = floats(&picture, Aov::Normal).chunks_exact(3);
    let distances = floats(&picture, Aov::HitDistance);
    let (mut tested, mut met, mut wrong, mut worst) = (0, 0, Vec::new(), 0.0_f64);
    for (pixel, normal) in normals.enumerate() {
        let cause = integers(&picture, Aov::Cause)[pixel];
        if [Cause::NotReflective, Cause::Rough]
            .map(|c| c as u32)
            .contains(&cause)
        {
            continue;
        }
        let normal = DVec3::new(normal[0].into(), normal[1].into(), normal[2].into());
        let ray = primary(&view, pixel);
        let Some(ray) = mirrored(&oracle, &ray, ids[pixel], normal, length_m) else {
            continue;
        };
        let said = (hits[pixel][0] != NOTHING).then(|| (hits[pixel], distances[pixel].into()));
        tested += 1;
        met += u32::from(said.is_some());
        match check_pixel(&oracle, &ray, said) {
            Ok(off) => worst = worst.max(off),
            Err(why) => wrong.push(format!("pixel {pixel}: {why}")),
        }
    }
    println!("{tested} pixels, {met} met something, worst {worst:.1e} m");
    assert!(
        tested > 2000 && met > 1000,
        "{tested} pixels, {met} met something"
    );
    assert_eq!(wrong, [] as [String; 0]);
}

const SETTINGS: &[&str] = &["image.size=[112, 63]", "reflection.method=\"rt\""];

#[test]
fn every_pixel_of_a_traced_frame_meets_what_brute_force_meets() {
    let (desc, world) = scene(ATRIUM, SETTINGS);
    check(&desc, &world);
}

/// Half of the rays go through the top level over moving instances.
#[test]
fn moving_instances_are_met_where_brute_force_meets_them() {
    let (mut desc, _) = scene(ATRIUM, SETTINGS);
    for instance in desc.instances.iter_mut().step_by(2) {
        instance.dynamic = true;
    }
    let world = load::load(&desc, &LoadOptions::default()).expect("valid");
    assert!(world.instances.iter().any(|i| i.dynamic));
    assert!(world.instances.iter().any(|i| !i.dynamic));
    check(&desc, &world);
}
