//! Shares of the lights in the direct light on surfaces: lamps by their middle, materials that light by points spread over
//! them, and the environment by rays.

use std::{collections::HashMap, f64::consts::PI};

use glam::DVec3;

use super::{
    answer::{LightKind, LightShare},
    rounded,
    surfaces::{point_of, spread},
};
use crate::decide::{
    view_estimate::{ambient, environment, incoming},
    view_rays::{SurfacePoint, ViewRays, off_surface},
};
use reflet_base::math::LUMINANCE;
use reflet_world::{
    Light,
    bvh::{Ray, SHADOWLESS},
    emitters::Emitter,
};

/// Number of lamps of a scene that are looked at, brightest first.
const MOST_LAMPS: usize = 256;
/// Number of points of materials that light.
const EMITTER_POINTS: usize = 64;
/// Number of rays from each point to the environment.
const SKY_RAYS: usize = 32;
/// Least share that is listed.
const LEAST: f64 = 1e-3;

/// The lights of a world, ready to be asked about many points.
pub struct Lights<'a> {
    rays: ViewRays<'a>,
    lamps: Vec<&'a Light>,
    /// Number of lamps that are not looked at.
    pub left_out: usize,
    /// Points of materials that light, each with the normal of its front.
    emitters: Vec<SurfacePoint>,
    /// Power of a point of them, W as far as radiance is in W/m²/sr, over π.
    emitter_power: f64,
    /// Radiance of the environment above, at the horizon and below.
    sky: [DVec3; 3],
}

impl<'a> Lights<'a> {
    /// The lights of a world.
    pub fn new(rays: ViewRays<'a>) -> Self {
        let world = rays.world;
        let mut lamps: Vec<&Light> = world.all_lights().collect();
        let left_out = lamps.len().saturating_sub(MOST_LAMPS);
        if left_out > 0 {
            let power =
                |light: &Light| light.desc.kind.intensity() * light.desc.color.dot(LUMINANCE);
            lamps.sort_by(|a, b| power(b).total_cmp(&power(a)));
            lamps.truncate(MOST_LAMPS);
        }
        let all = world.emitters();
        let mut total = 0.0;
        let sum = |emitter: &Emitter| {
            total += f64::from(emitter.power);
            total
        };
        let until: Vec<f64> = all.iter().map(sum).collect();
        let point = |k: usize| {
            let at = (k as f64 + 0.5) / EMITTER_POINTS as f64 * total;
            let emitter = all.get(until.partition_point(|until| *until < at))?;
            let instance = emitter.instance as usize;
            Some(point_of(&rays, instance, emitter.triangle, spread(k)))
        };
        Self {
            lamps,
            left_out,
            emitters: (0..EMITTER_POINTS).filter_map(point).collect(),
            emitter_power: total / EMITTER_POINTS as f64,
            sky: world.environment.coarse_gradient(),
            rays,
        }
    }

    /// Shares of the lights in the light on these points, brightest first; `name_of` names the thing of an instance.
    pub fn shares(
        &self,
        points: &[SurfacePoint],
        name_of: impl Fn(usize) -> String,
    ) -> Vec<LightShare> {
        let luminance = |light: DVec3| light.dot(LUMINANCE.as_dvec3());
        let mut sums: HashMap<(LightKind, String), f64> = HashMap::new();
        for point in points {
            for lamp in &self.lamps {
                let light = luminance(incoming(self.rays.trees, lamp, point));
                let key = (LightKind::Lamp, lamp.name.clone());
                *sums.entry(key).or_default() += light;
            }
            for emitter in &self.emitters {
                let light = self.light_of_emitter(emitter, point);
                let key = (LightKind::Thing, name_of(emitter.instance));
                *sums.entry(key).or_default() += light;
            }
            let light = luminance(self.light_of_sky(point));
            let key = (LightKind::Environment, "environment".to_owned());
            *sums.entry(key).or_default() += light;
        }
        let total: f64 = sums.values().sum();
        let share = |((kind, name), sum)| LightShare {
            kind,
            name,
            share: rounded(sum / total),
        };
        let lights = sums.into_iter().map(share);
        let mut shares: Vec<_> = lights.filter(|s| s.share >= LEAST).collect();
        shares.sort_by(|a, b| {
            b.share
                .total_cmp(&a.share)
                .then_with(|| a.name.cmp(&b.name))
        });
        shares
    }

    /// Luminance of the irradiance from a point of a material that lights.
    fn light_of_emitter(&self, emitter: &SurfacePoint, point: &SurfacePoint) -> f64 {
        let world = self.rays.world;
        let material = &world.materials[world.instances[emitter.instance].material];
        let way = emitter.position - point.position;
        let cosines = [way.dot(point.normal), -way.dot(emitter.normal)];
        let [to, from] = cosines.map(|c| c / way.length().max(1e-9));
        let from = if material.double_sided {
            from.abs()
        } else {
            from
        };
        if to <= 0.0 || from <= 0.0 || emitter.instance == point.instance {
            return 0.0;
        }
        let start = off_surface(point, way);
        let ray = Ray {
            direction: emitter.position - start.origin,
            t_max: 0.9999,
            passes: SHADOWLESS,
            ..start
        };
        match self.rays.trees.any(&ray, |_, _, _| false) {
            true => 0.0,
            false => self.emitter_power * to * from / way.length_squared(),
        }
    }

    /// Irradiance from the environment.
    fn light_of_sky(&self, point: &SurfacePoint) -> DVec3 {
        if !self.rays.world.environment.casts_rays() {
            return ambient(&self.sky, point.normal) * PI;
        }
        let (u, v) = point.normal.any_orthonormal_pair();
        let light = (0..SKY_RAYS).map(|k| {
            let at = spread(k);
            let (sine, cosine) = (at.y * 2.0 * PI).sin_cos();
            let across = (u * cosine + v * sine) * at.x.sqrt();
            let direction = across + point.normal * (1.0 - at.x).sqrt();
            let ray = Ray {
                passes: SHADOWLESS,
                ..off_surface(point, direction)
            };
            match self.rays.trees.any(&ray, |_, _, _| false) {
                true => DVec3::ZERO,
                false => environment(&self.sky, direction),
            }
        });
        light.sum::<DVec3>() * (PI / SKY_RAYS as f64)
    }
}
