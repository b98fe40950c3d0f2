//! Secondary rays of mirror rays: onward from their hits, mirrored or scattered, and towards lights. Counted on the
//! CPU, for the cost model.

use glam::DVec3;
use reflet_base::pcg::Pcg;

use reflet_scene::desc::ShadowMode;
use reflet_world::{
    Light, World,
    bvh::{Ray, SHADOWLESS},
    emitters::Emitter,
};

use super::view_rays::{SurfacePoint, ViewRays, is_in_reach, off_surface};
use crate::{plan::environment_casts_rays, settings::options::RenderOptions};

/// Number of rays, and of nodes that they visit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayCount {
    /// Number of rays.
    pub rays: u32,
    /// Number of nodes that they visit.
    pub visits: u32,
}

impl RayCount {
    /// Adds a ray that visits `visits` nodes.
    pub fn add(&mut self, visits: u32) {
        self.rays += 1;
        self.visits += visits;
    }

    /// Sums of the counts of both.
    pub fn plus(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            visits: self.visits + other.visits,
        }
    }
}

/// Rays that mirror rays bring, however their first hit is found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SecondaryRays {
    /// Rays onward from the hits, mirrored again or scattered by matte surfaces.
    pub onward: RayCount,
    /// Shadow rays towards lamps without a size.
    pub shadow: RayCount,
    /// Light rays: towards points that are sampled on emitters, on lamps with a size, and in the environment.
    pub light: RayCount,
}

impl SecondaryRays {
    /// Sums of the counts of both.
    pub fn plus(self, other: Self) -> Self {
        Self {
            onward: self.onward.plus(other.onward),
            shadow: self.shadow.plus(other.shadow),
            light: self.light.plus(other.light),
        }
    }
}

/// Lights that hits send rays to.
#[derive(Debug)]
pub struct LightsOfHits<'a> {
    /// Lamps without a size whose shadows are traced.
    hard: Vec<&'a Light>,
    /// Lamps with a size whose shadows are traced: each hit samples one sun and one other sized lamp.
    sized: [Vec<&'a Light>; 2],
    /// Whether light rays are sent into the environment.
    environment: bool,
    /// Emissive triangles, with the sum of the power up to each.
    emitters: Vec<(Emitter, f64)>,
    /// Places of lamps that a light tree chooses, with the sum of the intensity up to each.
    lamps: Vec<(DVec3, f64)>,
    /// Number of light rays to each kind of light.
    rays: u32,
}

impl<'a> LightsOfHits<'a> {
    /// Lights of a world. Lamps whose shadow is still to be decided count as lamps with maps.
    pub fn new(world: &'a World, options: &RenderOptions) -> Self {
        let traced = || (world.lights.iter()).filter(|l| l.desc.shadow == ShadowMode::Ray);
        let sized = |is_sun: bool| {
            let is_one =
                |l: &&Light| l.desc.kind.has_size() && l.desc.kind.position().is_none() == is_sun;
            traced().filter(is_one).collect()
        };
        let mut sum = 0.0;
        let emitters = world.emitters().into_iter().map(|emitter| {
            sum += f64::from(emitter.power);
            (emitter, sum)
        });
        let mut intensities = 0.0;
        let lamps = world.lamps.iter().filter_map(|lamp| {
            let kind = &lamp.desc.kind;
            intensities += f64::from(kind.intensity() * lamp.desc.color.max_element());
            Some((kind.position()?.as_dvec3(), intensities))
        });
        Self {
            hard: traced().filter(|l| !l.desc.kind.has_size()).collect(),
            sized: [true, false].map(sized),
            environment: environment_casts_rays(world, options),
            emitters: emitters.collect(),
            lamps: lamps.collect(),
            rays: options.image.light_rays(),
        }
    }

    /// Counts the rays towards the lights of a point.
    pub fn count(
        &self,
        rays: &ViewRays<'_>,
        point: &SurfacePoint,
        chance: &mut Chance,
        sum: &mut SecondaryRays,
    ) {
        let visits = |to: Option<(DVec3, f64)>| {
            let to = to.filter(|(direction, _)| direction.dot(point.normal) > 0.0)?;
            let ray = Ray {
                t_max: to.1,
                passes: SHADOWLESS,
                ..off_surface(point, to.0)
            };
            Some(rays.trees.any_counted(&ray).1)
        };
        for light in &self.hard {
            if let Some(visits) = visits(towards(light, point)) {
                sum.shadow.add(visits);
            }
        }
        for _ in 0..self.rays {
            for lamps in self.sized.iter().filter(|lamps| !lamps.is_empty()) {
                let lamp = lamps[chance.below(lamps.len())];
                sum.light.add(visits(towards(lamp, point)).unwrap_or(0));
            }
            if self.environment {
                let direction = chance.scattered(point.normal);
                sum.light
                    .add(visits(Some((direction, f64::INFINITY))).unwrap_or(0));
            }
            // One shadow ray goes to all that light trees choose.
            let lamp = self.lamp_place(chance);
            if let Some(place) = lamp.or_else(|| self.emitter_point(rays.world, chance)) {
                let to = (place - point.position, NEARLY);
                sum.light.add(visits(Some(to)).unwrap_or(0));
            }
        }
    }

    /// Place of a lamp, which is chosen by its intensity.
    fn lamp_place(&self, chance: &mut Chance) -> Option<DVec3> {
        let up_to = self.lamps.last()?.1 * chance.next();
        let index = self.lamps.partition_point(|(_, sum)| *sum < up_to);
        self.lamps.get(index).map(|(place, _)| *place)
    }

    /// A random point of an emitter, which is chosen by its power.
    fn emitter_point(&self, world: &World, chance: &mut Chance) -> Option<DVec3> {
        let power = self.emitters.last()?.1 * chance.next();
        let index = self.emitters.partition_point(|(_, sum)| *sum < power);
        let (emitter, _) = self.emitters.get(index)?;
        let instance = &world.instances[emitter.instance as usize];
        let corners = world.meshes[instance.mesh].triangles[emitter.triangle as usize];
        let [a, b, c] = world.posed(instance.mesh).corners(corners);
        let (u, v) = (chance.next() as f32, chance.next() as f32);
        let (u, v) = if u + v > 1.0 {
            (1.0 - u, 1.0 - v)
        } else {
            (u, v)
        };
        let place = a + (b - a) * u + (c - a) * v;
        Some(
            instance
                .world_from_object
                .transform_point3(place)
                .as_dvec3(),
        )
    }
}

/// Share of the way to a light that its ray takes, so that it does not meet the light itself.
const NEARLY: f64 = 0.9999;

/// Direction towards a light, whose length is the way to it, and the share of the way that its ray takes; `None` out
/// of its reach.
pub fn towards(light: &Light, point: &SurfacePoint) -> Option<(DVec3, f64)> {
    let kind = &light.desc.kind;
    let (direction, t_max) = match (kind.position(), kind.direction()) {
        (Some(position), _) => (position.as_dvec3() - point.position, NEARLY),
        (None, Some(direction)) => (-direction.as_dvec3(), f64::INFINITY),
        (None, None) => return None,
    };
    is_in_reach(light, direction).then_some((direction, t_max))
}

/// Numbers that look random and are the same on all machines.
#[derive(Debug)]
pub struct Chance(Pcg);

impl Chance {
    /// The numbers of one sample of a view.
    pub fn for_sample(sample: u32) -> Self {
        Self(Pcg::new(sample.wrapping_mul(0x9e37_79b9)))
    }

    /// A number from 0 to below 1.
    fn next(&mut self) -> f64 {
        self.0.unit()
    }

    fn below(&mut self, count: usize) -> usize {
        ((self.next() * count as f64) as usize).min(count - 1)
    }

    /// A direction that a matte surface scatters: the normal and a point on the unit sphere. Made without sines, which
    /// differ between machines.
    pub fn scattered(&mut self, normal: DVec3) -> DVec3 {
        let mut cube = || DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0;
        let candidates = [cube(), cube(), cube(), cube()];
        let is_inside = |p: &&DVec3| (1e-6..=1.0).contains(&p.length_squared());
        let ball = candidates.iter().find(is_inside).unwrap_or(&candidates[0]);
        (normal + ball.normalize_or(normal)).normalize_or(normal)
    }
}
