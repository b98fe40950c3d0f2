//! Static instances that reflection rays skip, because no reflector could show them larger than `reflection.skip_px`.
//!
//! Between two rays that leave the eye at an angle ω and are reflected by flat or convex mirrors, there is at least the
//! distance L ω once each has gone the way L: such mirrors only add to the curvature of a wave front, which is 1 / L in
//! free space (Igehy 1999, "Tracing Ray Differentials"; Hecht, "Optics", 5.4.3: convex mirrors only diminish). A sphere
//! around a thing of diameter 2 r is therefore seen under an angle of at most 2 r / L, in each mirror and in mirrors in
//! mirrors. The way is at least as long as the straight line from the eye to the thing, and as the distances from the
//! eye to the last reflector R and from there to the thing:
//!
//! L ≥ max(d(eye, thing), d(eye, R) + d(R, thing))
//!
//! Facets of a rough reflector may be tilted so that they cancel the way from the eye, so only d(R, thing) counts
//! there. Hollow reflectors, normal maps and glass may magnify: with them nothing is skipped, nor from inside of a
//! reflector that is seen from both sides.

use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;

use reflet_base::math::Bounds;
use reflet_scene::{
    desc::{Method, PatternedKey, ReflectionDesc},
    words,
};
use reflet_world::{Curvature, Instance, Material, World};

use crate::{
    decide::view_of,
    plan::{is_rough_reflector, may_reflect, passes_light},
    settings::{options::RenderOptions, view::View},
};

/// Multiple of the way to the farthest corner of the scene up to which instances are kept apart from the static tree,
/// because rays may skip them: cameras move away.
const MARGIN: f32 = 2.0;

/// Instances that a scene's reflection rays may skip; decided anew only where the scene or its settings change.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skipping {
    /// Whether an instance may be skipped, by index; empty where none may.
    pub apart: Vec<bool>,
    /// Reason why rays skip nothing, as text for users; `None` where they may skip something.
    pub refused: Option<String>,
    things: Vec<Thing>,
    reflectors: Vec<Reflector>,
}

/// Static instance that may be skipped.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Thing {
    instance: usize,
    bounds: Bounds,
    diameter_m: f32,
}

/// Instance that reflects.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reflector {
    instance: usize,
    is_rough: bool,
    /// Whether it is seen from inside too, where a convex surface is hollow.
    has_inside: bool,
}

/// Reflector in the pose of a frame.
struct Placed {
    bounds: Bounds,
    eye_m: f32,
    is_rough: bool,
}

words! {
    /// Reason why rays do not skip an instance, though they skip others, with its text for users.
    #[derive(PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "snake_case")]
    pub enum Kept {
        /// Its image may be larger than `skip_px`.
        Large = "could be larger",
        /// It may move or change.
        Moves = "may move or change",
        /// It emits light.
        Emits = "emit light",
        /// No reflection shows it anyway.
        Unseen = "are in no reflection anyway",
    }
}

impl Skipping {
    /// Instances that the rays of a scene may skip with these options; the world is posed at the first frame.
    pub fn for_world(world: &World, options: &RenderOptions) -> Self {
        let settings = &options.reflection;
        if settings.skip_px <= 0.0 {
            return Self::default();
        }
        let cutoff = settings.reflects_below();
        let instances = world.instances.iter().enumerate();
        let reflectors: Vec<_> = (instances.clone())
            .filter(|(_, i)| may_reflect(world, i.material, cutoff))
            .map(|(instance, i)| Reflector {
                instance,
                is_rough: is_rough_reflector(world, i.material, cutoff),
                has_inside: world.materials[i.material].double_sided
                    && world.meshes[i.mesh].curvature() != Curvature::Flat,
            })
            .collect();
        let refused = of_settings(settings).or_else(|| of_world(world, &reflectors));
        if refused.is_some() {
            return Self {
                refused,
                ..Self::default()
            };
        }
        let view = view_of(world, options);
        let limit_m = MARGIN * largest_m(&view, settings.skip_px, farthest_m(world, &view));
        let may_be_skipped = |(index, i): (usize, &Instance)| {
            let bounds = world.bounds_of(i);
            // A sphere's box is √3 times as long across as the sphere.
            let is_small = kept(world, i).is_none() && bounds.diagonal() <= 2.0 * limit_m;
            is_small.then(|| Thing {
                instance: index,
                bounds,
                diameter_m: diameter_m(world, i, &bounds),
            })
        };
        let things: Vec<Thing> = (world.instances.par_iter().enumerate())
            .filter_map(may_be_skipped)
            .filter(|thing| thing.diameter_m <= limit_m)
            .collect();
        let count = if things.is_empty() {
            0
        } else {
            world.instances.len()
        };
        let mut apart = vec![false; count];
        for thing in &things {
            apart[thing.instance] = true;
        }
        Self {
            apart,
            refused,
            things,
            reflectors,
        }
    }

    /// Instances that the reflection rays of a picture skip, ascending.
    pub fn skipped(&self, world: &World, view: &View, settings: &ReflectionDesc) -> Vec<usize> {
        if self.things.is_empty() || settings.skip_px <= 0.0 || of_method(settings.method).is_some()
        {
            return Vec::new();
        }
        let holds_eye = |r: &Reflector| {
            let bounds = world.bounds_of(&world.instances[r.instance]);
            r.has_inside && distance_m(view.eye, &bounds) <= view.lens_m
        };
        if self.reflectors.iter().any(holds_eye) {
            return Vec::new();
        }
        let reflector = |r: &Reflector| {
            let bounds = world.bounds_of(&world.instances[r.instance]);
            Placed {
                eye_m: if r.is_rough {
                    0.0
                } else {
                    distance_m(view.eye, &bounds)
                },
                bounds,
                is_rough: r.is_rough,
            }
        };
        let mut reflectors: Vec<_> = self.reflectors.iter().map(reflector).collect();
        reflectors.retain(|r| !r.bounds.is_empty());
        reflectors.sort_by(|a, b| a.eye_m.total_cmp(&b.eye_m));
        let is_skipped =
            |thing: &&Thing| is_small_everywhere(thing, &reflectors, view, settings.skip_px);
        let skipped = self.things.iter().filter(is_skipped);
        skipped.map(|thing| thing.instance).collect()
    }

    /// Numbers of the instances that are not skipped, by reason.
    pub fn kept(&self, world: &World, skipped: &[usize]) -> Vec<(Kept, usize)> {
        let mut reasons: Vec<_> = (world.instances.iter().enumerate())
            .filter(|(index, _)| skipped.binary_search(index).is_err())
            .map(|(_, i)| kept(world, i).unwrap_or(Kept::Large))
            .collect();
        reasons.sort_unstable();
        let same = reasons.chunk_by(|a, b| a == b);
        same.map(|same| (same[0], same.len())).collect()
    }
}

/// Whether every image of a thing is smaller than so many pixels.
fn is_small_everywhere(thing: &Thing, reflectors: &[Placed], view: &View, skip_px: f32) -> bool {
    let Some(way_m) = needed_m(view, thing.diameter_m, skip_px) else {
        return thing.diameter_m < skip_px * view.pixel_m();
    };
    // Rays start at any point of the lens.
    let way_m = way_m + view.lens_m;
    let is_far = distance_m(view.eye, &thing.bounds) > way_m;
    let mut nearer = reflectors.iter().take_while(|r| r.eye_m <= way_m);
    nearer.all(|r| is_far && !r.is_rough || r.eye_m + gap_m(&r.bounds, &thing.bounds) > way_m)
}

/// Length of a way past which a thing of this diameter is smaller than so many pixels, meters; `None` for parallel
/// rays, with which it has one size everywhere.
fn needed_m(view: &View, diameter_m: f32, skip_px: f32) -> Option<f32> {
    let per_radian = view.pixels_per_radian()?;
    Some(diameter_m * per_radian / skip_px)
}

/// Diameter of things that are so many pixels large at the end of a way, meters.
fn largest_m(view: &View, skip_px: f32, way_m: f32) -> f32 {
    let per_radian = view.pixels_per_radian();
    per_radian.map_or(skip_px * view.pixel_m(), |p| skip_px * way_m / p)
}

/// Distance from the eye to the farthest corner of a scene, meters.
fn farthest_m(world: &World, view: &View) -> f32 {
    let corners = world.bounds().corners();
    corners.map(|c| c.distance(view.eye)).fold(0.0, f32::max)
}

/// Reason why a method or its settings skip nothing.
fn of_settings(settings: &ReflectionDesc) -> Option<String> {
    let scatters = settings.settled().diffuse_bounces > 0;
    let why = "`diffuse_bounces` is above 0: the rays of light that matte surfaces scatter are those of reflections";
    of_method(settings.method).or_else(|| scatters.then(|| why.to_owned()))
}

/// Reason why a method skips nothing.
fn of_method(method: Method) -> Option<String> {
    let skips = matches!(method, Method::Rt | Method::Hybrid | Method::Auto);
    (!skips).then(|| {
        let name = method.name();
        format!("only methods \"rt\" and \"hybrid\" skip, not \"{name}\"")
    })
}

/// Reason why the rays of a world skip nothing.
fn of_world(world: &World, reflectors: &[Reflector]) -> Option<String> {
    if reflectors.is_empty() {
        return Some("nothing reflects".to_owned());
    }
    if passes_light(world) {
        let glass = |i: &&Instance| world.materials[i.material].passes_light();
        let name = world.instances.iter().find(glass).map_or("", |i| &i.name);
        return Some(format!("\"{name}\" lets light through, and may magnify"));
    }
    reflectors.iter().find_map(|r| {
        let instance = &world.instances[r.instance];
        let (mesh, material) = (
            &world.meshes[instance.mesh],
            &world.materials[instance.material],
        );
        let has_bumps =
            |of: &Material| of.normal_texture.is_some() || of.has_coat_normals() || of.has_relief();
        let mut decals = world.decals.over(instance.material);
        let why = if has_bumps(material) || decals.any(|d| has_bumps(&world.materials[d.material]))
        {
            "has a normal map or a relief"
        } else if mesh.deformation.is_some() {
            "is deformed"
        } else if mesh.may_magnify(material.double_sided) {
            "is not shown to be flat or convex"
        } else {
            return None;
        };
        Some(format!(
            "\"{}\" reflects and {why}, so that it may magnify",
            instance.name
        ))
    })
}

/// Reason why an instance is never skipped.
fn kept(world: &World, instance: &Instance) -> Option<Kept> {
    let is_shown =
        instance.shown.in_reflections && !world.meshes[instance.mesh].triangles.is_empty();
    if !is_shown {
        return Some(Kept::Unseen);
    }
    if instance.dynamic || world.may_change(instance.material) {
        return Some(Kept::Moves);
    }
    let decals = world.decals.over(instance.material).map(|d| d.material);
    let mut shown = decals.chain([instance.material]);
    shown
        .any(|m| emits(&world.materials[m]))
        .then_some(Kept::Emits)
}

/// Whether a material emits light somewhere.
fn emits(material: &Material) -> bool {
    let [_, most] = material.extremes(PatternedKey::Emission);
    most > 0.0
}

/// Diameter of a sphere around an instance, meters.
fn diameter_m(world: &World, instance: &Instance, bounds: &Bounds) -> f32 {
    let mesh = &world.meshes[instance.mesh];
    let (center, place) = (bounds.center(), &instance.world_from_object);
    let corners = mesh.positions.iter().map(|p| place.transform_point3(*p));
    let square = corners
        .map(|p| p.distance_squared(center))
        .fold(0.0, f32::max);
    2.0 * (square.sqrt() + mesh.placed_radius_m(place).unwrap_or(0.0))
}

/// Distance from a point to a box, meters; infinite for an empty box.
fn distance_m(point: Vec3, bounds: &Bounds) -> f32 {
    gap_m(
        &Bounds {
            min: point,
            max: point,
        },
        bounds,
    )
}

/// Distance between two boxes, meters.
fn gap_m(a: &Bounds, b: &Bounds) -> f32 {
    (a.min - b.max).max(b.min - a.max).max(Vec3::ZERO).length()
}
