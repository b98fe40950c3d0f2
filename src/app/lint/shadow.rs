//! Shadow maps that are too coarse for what the main camera sees.

use crate::{
    math::Bounds,
    render::{
        RenderOptions,
        lights::{ShadowSizes, has_cube_map, map_texel_m},
        view::View,
        view_rays::{ViewRays, places},
    },
    scene::{desc::ShadowMode, diagnostic::Diagnostic, stages::Scene},
    world::{Light, World, bvh::Trees},
};

use rayon::prelude::*;

/// Pixels of the picture that a texel may span before shadows of small things are visibly lost.
const COARSE_PX: f32 = 16.0;

/// Warns of lights whose shadow maps have texels as large as many pixels, where half of what is seen lies.
pub fn lint(scene: &Scene, world: &World, trees: &Trees) -> Vec<Diagnostic> {
    let Some(camera) = world.cameras.get(world.main_camera()) else {
        return Vec::new();
    };
    let view = View::new(&camera.value, scene.image.size);
    let rays = ViewRays {
        world,
        trees,
        view: &view,
    };
    let seen = places().filter_map(|place| {
        let ray = rays.primary(place);
        let hit = trees.nearest_counted(&ray).0?;
        let point = rays.point(&hit, ray.direction).position.as_vec3();
        Some((point, hit.t as f32 * view.pixel_spread()))
    });
    let seen: Vec<_> = seen.collect();
    let sizes = ShadowSizes::of(&world.lights, &RenderOptions::of(&scene.desc));
    let casters = world.instances.iter().filter(|i| !i.is_hidden());
    let bounds = casters.fold(Bounds::EMPTY, |all, i| all.union(world.bounds_of(i)));
    let coarse = |light: &Light| {
        let px = if has_cube_map(&light.desc.kind) {
            sizes.cube_px
        } else {
            sizes.map_px
        };
        let texel_m = |point| map_texel_m(&light.desc.kind, px, &bounds, point);
        let spanned = seen
            .iter()
            .map(|(point, pixel_m)| texel_m(*point) / pixel_m);
        median(spanned.collect()).filter(|spanned| *spanned > COARSE_PX)
    };
    let mut found = Vec::new();
    for (entry, light) in scene.lights.iter().zip(&world.lights) {
        if light.desc.shadow != ShadowMode::Map {
            continue;
        }
        let Some(spanned) = coarse(light) else {
            continue;
        };
        let message = format!(
            "a texel of the shadow map of light \"{}\" spans {spanned:.0} pixels of what camera \"{}\" \
             sees, so shadows of small things are lost",
            entry.name, camera.name
        );
        let help = "write `shadow = \"ray\"`, or more `shadow_px`";
        let at = entry.at.clone();
        found.push(Diagnostic::at("coarse-shadow", at, message).help(help));
    }
    found
}

fn median(mut values: Vec<f32>) -> Option<f32> {
    values.sort_by(f32::total_cmp);
    values.get(values.len() / 2).copied()
}
