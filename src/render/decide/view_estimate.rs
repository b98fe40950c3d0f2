//! Estimate of a view on the CPU from a coarse grid of rays: its brightness, and the hits of its reflectors. Used
//! for warnings and automatic exposure, not for pictures: highlights of lights stand apart, a texture counts as its
//! mean, and cut-outs count as solid except for shadow rays, which pass them.

use std::{collections::BTreeMap, f64::consts::PI};

use glam::{DVec2, DVec3, Vec3};
use rayon::prelude::*;

use reflet_base::math::linear_from_srgb;
use reflet_scene::desc::ShadowMode;
use reflet_world::{
    Light, Material, TextureRef, World,
    bvh::{Ray, RayHit, SHADOWLESS, Trees},
    light_tree::{Chosen, LightTrees},
};

use super::view_rays::{SurfacePoint, ViewRays, mirror_ray, off_surface, places, towards};
use crate::{
    lighting::lobe_table::SMOOTH_ALPHA,
    settings::{cutoff::can_reflect, view::View},
};

/// Its multiples, less their whole parts, are spread evenly and in step with no width of a texture.
const GOLDEN_RATIO: f64 = 1.618_033_988_749_895;
/// Number of successive mirror reflections that are traced.
const BOUNCES: u32 = 2;
/// Maximum number of texels for the mean of a texture.
const MOST_TEXELS: usize = 1024;

/// Estimated brightness and reflections of a view.
#[derive(Clone, Debug, Default)]
pub struct ViewEstimate {
    /// Largest channel of the linear radiance at each sample, before exposure.
    pub radiance: Vec<f32>,
    /// Largest channel of the brightest highlight of a light, or reflection of a lamp, at a sample's surface; lamps of
    /// the light tree count as one, by the sum of their highlights.
    pub highlight: f32,
    /// Number of samples that show a surface.
    pub surfaces: usize,
    /// Hits of mirror rays, by index into [`World::materials`].
    pub reflectors: BTreeMap<usize, Reach>,
}

/// Hits of the mirror rays of one material.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reach {
    /// Number of mirror rays.
    pub rays: usize,
    /// Number of mirror rays that hit a surface within the ray length.
    pub met: usize,
    /// Distance of the nearest hit beyond the ray length, meters.
    pub beyond_m: Option<f64>,
    /// Largest channel of the brightest highlight on this material, as in [`ViewEstimate::highlight`].
    pub highlight: f32,
}

/// Result of one sampled pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Sample {
    radiance: f32,
    highlight: f32,
    surface: bool,
    /// Index of the reflecting material, and the distance of its mirror ray's hit.
    mirror: Option<(usize, Option<f64>)>,
}

impl ViewEstimate {
    /// Traces the rays of a view; materials with `auto` reflect below the roughness `cutoff`, and reflection rays
    /// are `ray_length_m` long.
    pub fn new(world: &World, trees: &Trees, view: &View, cutoff: f32, ray_length_m: f32) -> Self {
        let estimator = Estimator {
            rays: ViewRays { world, trees, view },
            lamps: (!world.lamps.is_empty()).then(|| LightTrees::new(world, None)),
            looks: (world.materials.iter())
                .map(|material| AverageColors::for_material(world, material))
                .collect(),
            sky: world.environment.coarse_gradient(),
            cutoff,
            ray_length_m: f64::from(ray_length_m),
        };
        let samples: Vec<Sample> = places().map(|place| estimator.sample(place)).collect();
        let mut estimate = Self::default();
        for sample in samples {
            estimate.radiance.push(sample.radiance);
            estimate.highlight = estimate.highlight.max(sample.highlight);
            estimate.surfaces += usize::from(sample.surface);
            let Some((material, distance_m)) = sample.mirror else {
                continue;
            };
            let reach = estimate.reflectors.entry(material).or_default();
            reach.rays += 1;
            reach.highlight = reach.highlight.max(sample.highlight);
            match distance_m {
                Some(distance_m) if distance_m <= f64::from(ray_length_m) => reach.met += 1,
                Some(distance_m) => {
                    let nearest = reach.beyond_m.map_or(distance_m, |old| old.min(distance_m));
                    reach.beyond_m = Some(nearest);
                }
                None => {}
            }
        }
        estimate
    }
}

/// Colors of a material, with textures averaged.
struct AverageColors {
    base_color: DVec3,
    emission: DVec3,
}

impl AverageColors {
    fn for_material(world: &World, material: &Material) -> Self {
        let checker = material.checker.as_ref();
        let checker = checker.map_or(Vec3::ONE, |c| (c.colors[0] + c.colors[1]) * 0.5);
        let base = material.base_color.truncate() * checker;
        Self {
            base_color: base.as_dvec3() * mean_of(world, material.base_color_texture),
            emission: material.emission.as_dvec3() * mean_of(world, material.emission_texture),
        }
    }
}

/// Mean linear color of an sRGB texture; white without one.
fn mean_of(world: &World, texture: Option<TextureRef>) -> DVec3 {
    let texture = texture.and_then(|t| world.textures.get(t.texture));
    let largest = texture.and_then(|t| t.levels().next());
    let rgba = largest.map_or(&[][..], |(_, rgba)| rgba);
    let texels = rgba.len() / 4;
    if texels == 0 {
        return DVec3::ONE;
    }
    let linear = |byte: u8| f64::from(linear_from_srgb(f32::from(byte) / 255.0));
    let count = texels.min(MOST_TEXELS);
    let sum: DVec3 = (0..count)
        .map(|k| {
            // An even stride would meet the same columns of every row, and only one color of stripes.
            let place = (k as f64 * GOLDEN_RATIO).fract() * texels as f64;
            let texel = if texels > count { place as usize } else { k };
            DVec3::from_array([0, 1, 2].map(|channel| linear(rgba[4 * texel + channel])))
        })
        .sum();
    sum / count as f64
}

/// Number of lamps that are chosen for each point.
const CHOSEN_LAMPS: u32 = 8;

struct Estimator<'a> {
    rays: ViewRays<'a>,
    /// Light trees that choose among the world's lamps, if it has any.
    lamps: Option<LightTrees>,
    /// Colors by index of the material.
    looks: Vec<AverageColors>,
    /// See [`Environment::coarse_gradient`](reflet_world::Environment::coarse_gradient).
    sky: [DVec3; 3],
    cutoff: f32,
    ray_length_m: f64,
}

impl Estimator<'_> {
    fn sample(&self, place: DVec2) -> Sample {
        let ray = self.rays.primary(place);
        let (hit, _) = self.rays.trees.nearest_counted(&ray);
        let direction = ray.direction.normalize();
        let radiance = self.radiance(hit, direction, BOUNCES).max_element() as f32;
        let Some(hit) = hit else {
            return Sample {
                radiance,
                ..Sample::default()
            };
        };
        let point = self.rays.point(&hit, direction);
        let material = self.rays.world.instances[point.instance].material;
        let reflects = can_reflect(&self.rays.world.materials[material], self.cutoff);
        let mirror = reflects.then(|| {
            let (met, _) = self
                .rays
                .trees
                .nearest_counted(&mirror_ray(&point, direction));
            (material, met.map(|hit| hit.t))
        });
        Sample {
            radiance,
            highlight: self.highlight(&point, direction),
            surface: true,
            mirror,
        }
    }

    /// Linear radiance that arrives along a ray of unit direction `direction`.
    fn radiance(&self, hit: Option<RayHit>, direction: DVec3, bounces: u32) -> DVec3 {
        let world = self.rays.world;
        let Some(hit) = hit else {
            return environment(&self.sky, direction);
        };
        let point = self.rays.point(&hit, direction);
        let index = world.instances[point.instance].material;
        let (material, look) = (&world.materials[index], &self.looks[index]);
        let metallic = f64::from(material.metallic);
        let reflectivity = f64::from(material.reflectivity);
        let diffuse = (1.0 - metallic) * (1.0 - reflectivity);
        let passed = f64::from(material.diffuse_transmission.unwrap_or(0.0));
        let around = ambient(&self.sky, point.normal);
        let mut light = look.emission;
        // A solid returns light that it scatters where it entered; other light passes from the other side.
        let scattered = material.scattering_color.filter(|_| material.scatters());
        let (passed_color, side) = match scattered {
            Some(color) => (color, point.normal),
            None => (material.diffuse_transmission_color, -point.normal),
        };
        for (color, share, normal) in [
            (look.base_color, 1.0 - passed, point.normal),
            (passed_color.as_dvec3(), passed, side),
        ] {
            if share > 0.0 {
                let point = SurfacePoint { normal, ..point };
                let of = |lamp: &Light| incoming(self.rays.trees, lamp, &point);
                let lamps: DVec3 = world.lights.iter().map(of).sum();
                let lamps = lamps + self.sum_of_lamps(&point, of);
                light += color * (diffuse * share) * (ambient(&self.sky, normal) + lamps / PI);
            }
        }
        let f0 = DVec3::splat(reflectivity).lerp(look.base_color, metallic);
        if bounces == 0 || !can_reflect(material, self.cutoff) {
            return light + f0 * around;
        }
        let ray = Ray {
            t_max: self.ray_length_m,
            ..mirror_ray(&point, direction)
        };
        let (met, _) = self.rays.trees.nearest_counted(&ray);
        light + f0 * self.radiance(met, ray.direction, bounces - 1)
    }

    /// Radiance of the brightest highlight of a light at a surface, seen along a unit direction: a GGX lobe by its
    /// roughness, or a lobe as wide as a lamp appears.
    fn highlight(&self, point: &SurfacePoint, direction: DVec3) -> f32 {
        let world = self.rays.world;
        let index = world.instances[point.instance].material;
        let material = &world.materials[index];
        let f0 = DVec3::splat(f64::from(material.reflectivity))
            .lerp(self.looks[index].base_color, f64::from(material.metallic));
        let alpha = f64::from(material.roughness).powi(2);
        // Sharp reflections show no light without a size.
        let alpha2 = if alpha > SMOOTH_ALPHA {
            alpha * alpha
        } else {
            0.0
        };
        let of = |light: &Light| {
            let kind = &light.desc.kind;
            let arrives = f0 * incoming(self.rays.trees, light, point);
            let offset = kind.position().map(|at| at.as_dvec3() - point.position);
            let away = kind.direction().map(|to| -to.as_dvec3());
            let to_light = offset.or(away).unwrap_or(DVec3::ZERO);
            let distance = offset.map_or(1.0, DVec3::length).max(1e-9);
            let half = (to_light.normalize_or_zero() - direction).normalize_or_zero();
            let cosine2 = half.dot(point.normal).powi(2).max(1e-9);
            let ggx = alpha2 / (PI * (cosine2 * (alpha2 - 1.0) + 1.0).powi(2)).max(1e-12);
            // The half vector turns by half of the lamp's angle.
            let radius2 = match kind.radiance() {
                0.0 => 0.0,
                radiance => f64::from(kind.intensity() / radiance) / PI,
            };
            let wide2 = (0.25 * radius2 / (distance * distance)).max(1e-12);
            let tangent2 = (1.0 - cosine2).max(0.0) / cosine2;
            let lamp = (-tangent2 / wide2).exp() / (PI * wide2 * cosine2 * cosine2);
            let lamp = if radius2 > 0.0 { lamp } else { 0.0 };
            let cosines =
                4.0 * to_light.normalize_or_zero().dot(point.normal) * -direction.dot(point.normal);
            arrives * (ggx.max(lamp) / cosines.max(1e-3))
        };
        let brightest = world.lights.iter().map(of).fold(DVec3::ZERO, DVec3::max);
        brightest.max(self.sum_of_lamps(point, of)).max_element() as f32
    }

    /// Sum over the lamps of their light at a surface, estimated from lamps that a light tree chooses.
    fn sum_of_lamps(&self, point: &SurfacePoint, of: impl Fn(&Light) -> DVec3) -> DVec3 {
        let mut light = DVec3::ZERO;
        let Some(trees) = &self.lamps else {
            return light;
        };
        let (position, normal) = (point.position.as_vec3(), point.normal.as_vec3());
        for k in 0..CHOSEN_LAMPS {
            let u = (k as f32 + 0.5) / CHOSEN_LAMPS as f32;
            let choice = trees.choose([u, u], false, position, normal);
            let Some((Chosen::Lamp(lamp), chance)) = choice.map(|c| (c.what, c.chances[0])) else {
                continue;
            };
            let lamp = &self.rays.world.lamps[lamp as usize];
            light += of(lamp) / f64::from(CHOSEN_LAMPS) / f64::from(chance);
        }
        light
    }
}

/// Irradiance of a light on a surface, by the light's middle.
pub fn incoming(trees: &Trees, light: &Light, point: &SurfacePoint) -> DVec3 {
    let Some((to_light, t_max)) = towards(light, point) else {
        return DVec3::ZERO;
    };
    let kind = &light.desc.kind;
    let facing = match kind.direction().filter(|_| kind.is_flat()) {
        Some(direction) => {
            let direction = direction.as_dvec3().normalize_or_zero();
            (-to_light.normalize_or_zero().dot(direction)).max(0.0)
        }
        None => 1.0,
    };
    let falloff = match kind.position() {
        Some(_) => facing / to_light.length_squared().max(1e-20),
        None => 1.0,
    };
    let cosine = to_light.normalize_or_zero().dot(point.normal);
    if cosine <= 0.0 {
        return DVec3::ZERO;
    }
    let ray = Ray {
        t_max,
        passes: SHADOWLESS,
        ..off_surface(point, to_light)
    };
    let has_shadow = light.desc.shadow != ShadowMode::None;
    if has_shadow && trees.any(&ray, |_, _, _| false) {
        return DVec3::ZERO;
    }
    light.desc.color.as_dvec3() * (f64::from(kind.intensity()) * falloff * cosine)
}

/// Radiance of a gradient, like `gradient` in `shaders/lib/environment.wgsl`.
pub fn environment(sky: &[DVec3; 3], direction: DVec3) -> DVec3 {
    gradient(sky, direction.y.max(0.0), (-direction.y).max(0.0))
}

/// Irradiance / π of a gradient, like `ambient` in `shaders/lib/ambient.wgsl`.
pub fn ambient(sky: &[DVec3; 3], normal: DVec3) -> DVec3 {
    let overlap = |c: f64| {
        let cosine = c.clamp(-1.0, 1.0);
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        (2.0 / (3.0 * PI)) * ((PI - cosine.acos()) * cosine + sine)
    };
    gradient(sky, overlap(normal.y), overlap(-normal.y))
}

fn gradient(&[zenith, horizon, ground]: &[DVec3; 3], up: f64, down: f64) -> DVec3 {
    horizon + (zenith - horizon) * up + (ground - horizon) * down
}
