//! The main camera's picture: empty, black or overexposed, or with reflectors that reflect nothing.

use super::{inside::shines_by_walks, overlap};
use crate::{
    render::{
        decide::{
            view_estimate::{Reach, ViewEstimate},
            view_rays::ViewRays,
        },
        settings::view::View,
    },
    runtime::empty_view::{self, rounded_down, shortened},
    scene::{
        desc::{CameraDesc, Entry, Exposure},
        diagnostic::{Diagnostic, Span},
        stages::Scene,
    },
    world::{
        World,
        bvh::{Ray, RayHit, Trees},
    },
};

/// Exposed radiance below which a pixel shows as black: a display value of 6 of 255.
const BLACK: f32 = 2e-3;
/// Exposed radiance above which a pixel shows as white, whatever its color.
const BLOWN: f32 = 4.0;
/// Size of a scene, m, from which on its lengths may be centimeters where lamps do not light it.
const CENTIMETERS: f32 = 300.0;
/// Share of white pixels that is worth a warning.
const MOSTLY: f32 = 0.9;
/// Share of the picture that is cut away by the near plane, from which on it is worth a warning.
const LEAST_CUT: f32 = 0.01;
/// Minimum number of mirror rays for a statement about a reflector.
const FEWEST: usize = 8;

/// Warnings about the main camera's picture.
pub fn lint(scene: &Scene, world: &World, trees: &Trees) -> Vec<Diagnostic> {
    let Some(camera) = world.cameras.get(world.main_camera()) else {
        return Vec::new();
    };
    let settings = &scene.reflection;
    let unit_m = settings.unit_m.unwrap_or_else(|| world.unit_m());
    let view = View::new(&camera.value, scene.image.size, unit_m);
    let (cutoff, length_m) = (settings.roughness_cutoff, settings.ray_length_u * unit_m);
    if let Some(found) = empty_view::warning(scene, world, world.main_camera()) {
        return vec![found];
    }
    let whole = View {
        near_m: 0.0,
        ..view
    };
    let rays = ViewRays {
        world,
        trees,
        view: &whole,
    };
    let hits = rays.hits();
    let mut found: Vec<_> = cut(&hits, camera, view.near_m).into_iter().collect();
    let estimate = ViewEstimate::new(world, trees, &view, cutoff, length_m);
    if estimate.surfaces == 0 {
        // Thin or small: a few pixels show it, between the rays.
        return found;
    }
    found.extend(overlap::lint(scene, &rays, &hits));
    // Automatic exposure adapts to the picture.
    if let Exposure::Ev(ev) = scene.image.exposure_ev {
        let is_missed =
            |it: &Diagnostic| it.name == "black-picture" && shines_by_walks(scene, world);
        found.extend(brightness(&estimate, ev, camera, world).filter(|it| !is_missed(it)));
    }
    if scene.is_still() && world.cameras.len() == 1 {
        found.extend(small_patterns(scene, world, &view, &hits));
    }
    for (material, reach) in &estimate.reflectors {
        found.extend(reflector(scene, world, *material, reach, unit_m));
    }
    found
}

/// Warning about a near plane that cuts away a part of the hits of a camera without one.
fn cut(
    hits: &[Option<(Ray, RayHit)>],
    camera: &Entry<CameraDesc>,
    near_m: f32,
) -> Option<Diagnostic> {
    let met = hits.iter().flatten().map(|(_, hit)| hit.t as f32);
    let cut: Vec<f32> = met.filter(|depth_m| *depth_m < near_m).collect();
    let share = cut.len() as f32 / hits.len() as f32;
    (share >= LEAST_CUT).then(|| {
        let percent = (share * 100.0).round();
        let name = &camera.name;
        let message = format!(
            "camera \"{name}\" cuts away {percent} % of what it would show: it is nearer than its near plane, {near_m} m"
        );
        let nearest_m = rounded_down(cut.into_iter().fold(near_m, f32::min));
        let help = format!("write `near_m = {nearest_m}` in its table");
        Diagnostic::new("cut-view", camera.at.clone(), message).help(help)
    })
}

/// Warnings about patterns whose cells are smaller than a pixel wherever rays of a view meet them.
fn small_patterns(
    scene: &Scene,
    world: &World,
    view: &View,
    hits: &[Option<(Ray, RayHit)>],
) -> Vec<Diagnostic> {
    let found = scene.materials.iter().filter_map(|entry| {
        let size_m = entry.value.checker?.size_m;
        let pixels_m = hits.iter().flatten().filter_map(|(_, hit)| {
            let instance = &world.instances[hit.instance as usize];
            let is_own = world.materials[instance.material].name == entry.name;
            let [x, y, z] = instance.world_from_object.matrix3.to_cols_array_2d();
            let scale = [x, y, z].map(|axis| glam::Vec3::from(axis).length());
            let scale = scale.into_iter().fold(0.0, f32::max);
            is_own.then(|| view.pixel_m().max(hit.t as f32 * view.pixel_spread()) / scale)
        });
        // Object-space size of a pixel where the pattern is nearest.
        let pixel_m = pixels_m
            .reduce(f32::min)
            .filter(|pixel_m| size_m < *pixel_m)?;
        let message = format!(
            "the cells of material \"{}\" are smaller than a pixel, so that their mean is seen",
            entry.name
        );
        let larger = 10f32.powf((20.0 * pixel_m).log10().ceil());
        let help = format!("write `size_m = {larger}`, in meters; it is {size_m}");
        Some(Diagnostic::new("small-pattern", entry.at.clone(), message).help(help))
    });
    found.collect()
}

/// Warning about a picture that is black or white nearly all over, at an exposure of `ev` stops.
fn brightness(
    estimate: &ViewEstimate,
    ev: f32,
    camera: &Entry<CameraDesc>,
    world: &World,
) -> Option<Diagnostic> {
    let radiance = &estimate.radiance;
    let (name, at) = (&camera.name, camera.at.clone());
    let exposed = || radiance.iter().map(|r| r * ev.exp2());
    let brightest = exposed().fold(estimate.highlight * ev.exp2(), f32::max);
    let blown = exposed().filter(|r| *r > BLOWN).count() as f32;
    if brightest < BLACK {
        let message = format!("the picture of camera \"{name}\" is black all over");
        let bounds = world.static_bounds();
        let size_m = (bounds.max - bounds.min).max_element();
        let has_lamps = world
            .all_lights()
            .any(|light| light.desc.kind.position().is_some());
        let help = if brightest > 0.0 {
            let stops = (0.5 / brightest).log2().round();
            let ev = shortened(ev + stops);
            let unit = match has_lamps && size_m > CENTIMETERS {
                true => format!(
                    "lengths are meters, and this scene is {} m wide: if they are centimeters, write `scale = 0.01` in a \
                     `[group.all]` that is the `parent` of everything; else ",
                    shortened(size_m).round()
                ),
                false => String::new(),
            };
            format!("{unit}write `exposure_ev = {ev}` or \"auto\" in `[image]`, or stronger lights")
        } else {
            "no light reaches what it sees: move a light, or write `[environment]`".to_owned()
        };
        return Some(Diagnostic::new("black-picture", at, message).help(help));
    }
    (blown > MOSTLY * radiance.len() as f32).then(|| {
        let mut sorted: Vec<f32> = exposed().collect();
        sorted.sort_by(f32::total_cmp);
        let stops = (sorted[sorted.len() / 2] / 0.5).log2().round();
        let (given, ev) = (ev, shortened(ev - stops));
        let message = format!("the picture of camera \"{name}\" is white nearly all over");
        let mut help =
            format!("write `exposure_ev = {ev}` or \"auto\" in `[image]`, or weaker lights");
        if given > 5.0 {
            help += "; it counts stops of brightness from 0, and is no value of a light meter";
        }
        Diagnostic::new("blown-picture", at, message).help(help)
    })
}

/// Warning about a material whose mirror rays hit nothing.
fn reflector(
    scene: &Scene,
    world: &World,
    material: usize,
    reach: &Reach,
    unit_m: f32,
) -> Option<Diagnostic> {
    if reach.rays < FEWEST || reach.met > 0 {
        return None;
    }
    let name = &world.materials[material].name;
    let entry = scene.materials.iter().find(|m| m.name == *name);
    let at = entry.map_or_else(Span::default, |m| m.at.clone());
    if let Some(beyond_m) = reach.beyond_m {
        let length_u = scene.reflection.ray_length_u;
        let needed = (beyond_m / f64::from(unit_m)).ceil();
        let message = format!(
            "material \"{name}\" reflects no surface: rays end after {} m, and the nearest one is \
             {} m away",
            shortened(length_u * unit_m),
            shortened(beyond_m as f32)
        );
        let help = format!(
            "write `ray_length_u = {needed}` or more in `[reflection]`; it is {length_u}, in U of {} m",
            shortened(unit_m)
        );
        return Some(Diagnostic::new("short-reflection", at, message).help(help));
    }
    let has_lamp =
        (world.all_lights()).any(|light| light.desc.in_reflections && light.desc.kind.has_size());
    let is_lit = has_lamp || reach.highlight > BLACK;
    (world.environment.is_black() && !is_lit).then(|| {
        let message = format!("material \"{name}\" reflects nothing but the black environment");
        let help = "write `[environment]`, or place what it shall show where its reflection falls";
        Diagnostic::new("black-reflector", at, message).help(help)
    })
}
