//! Shadow maps that are too coarse for the main camera, take much memory or give way to rays, and lamps of the light
//! tree that have none.

use crate::{
    render::{
        RenderOptions,
        decide::{
            decide,
            map_work::MAP_BUDGET_BYTES,
            shadow_texels::{COARSE_PX, SeenSurfaces},
            with_filtered,
        },
        lighting::lights::ShadowSizes,
        settings::view::View,
    },
    scene::{
        desc::{Entry, LightDesc, ShadowMode},
        diagnostic::Diagnostic,
        stages::Scene,
    },
    world::{Light, MAX_LIGHTS, World, bvh::Trees},
};

/// Warns of shadow maps whose texels span many pixels (the median over the visible surfaces), and of the `shadow_px` of
/// lights whose maps give way to rays.
pub fn lint(scene: &Scene, world: &World, trees: &Trees) -> Vec<Diagnostic> {
    let may_have_map = |shadow| matches!(shadow, ShadowMode::Default | ShadowMode::Map);
    let Some(camera) = world.cameras.get(world.main_camera()) else {
        return Vec::new();
    };
    if !world.lights.iter().any(|l| may_have_map(l.desc.shadow)) {
        return Vec::new();
    }
    let unit_m = (scene.reflection.unit_m).unwrap_or_else(|| world.unit_m());
    let view = View::new(&camera.value, scene.image.size, unit_m);
    let seen = SeenSurfaces::new(world, trees, &view);
    let asked = with_filtered(world, &RenderOptions::for_scene(&scene.desc));
    let decided = decide(world, trees, &asked, true).options;
    let sizes = ShadowSizes::for_lights(&world.lights, &decided);
    let mut found = Vec::new();
    for (entry, light) in scene.lights.iter().zip(world.all_lights()) {
        if !may_have_map(light.desc.shadow) {
            continue;
        }
        if !has_map(world, &decided, light) {
            let is_written = entry.at.source.as_ref().is_some_and(|s| !s.generated);
            let says_px = is_written && light.desc.shadow_px != LightDesc::SHADOW_PX;
            if says_px && has_map(world, &asked, light) {
                found.push(unused_px(entry));
            }
            continue;
        }
        let px = sizes.px_of(&light.desc.kind);
        let Some(span) = seen.texel_px(light, px).filter(|span| *span > COARSE_PX) else {
            continue;
        };
        let message = format!(
            "a texel of the shadow map of light \"{}\" spans {span:.0} pixels of what camera \"{}\" \
             sees, so shadows of small things are lost",
            entry.name, camera.name
        );
        let help = "write `shadow = \"ray\"`, or more `shadow_px`";
        let at = entry.at.clone();
        found.push(Diagnostic::new("coarse-shadow", at, message).help(help));
    }
    found
}

/// Warning of the `shadow_px` of a light whose map gives way to rays.
fn unused_px(entry: &Entry<LightDesc>) -> Diagnostic {
    let message = format!(
        "`shadow_px` of light \"{}\" changes nothing: its shadow is found by rays, as the shadow maps of the scene \
         would take too much time or memory",
        entry.name
    );
    let help = "write `shadow = \"map\"` for the map, whatever it takes, or remove `shadow_px`";
    Diagnostic::new("ignored-key", entry.at.clone(), message).help(help)
}

/// Whether a light of a world has a shadow map, by options without `auto`.
fn has_map(world: &World, options: &RenderOptions, light: &Light) -> bool {
    let mut lights = world.lights.iter().enumerate();
    lights.any(|(i, l)| std::ptr::eq(l, light) && options.shadow_of(i, l) == ShadowMode::Map)
}

/// Warns, once, of lights of the scene text whose `shadow = "map"` is a shadow by rays, as they are lamps of the light
/// tree.
pub fn lamps(scene: &Scene, world: &World) -> Option<Diagnostic> {
    let (first, count) = asked_maps(scene, world, |light| world.has_lamp(light))?;
    let all = world.lights.len() + world.lamps.len();
    let message = format!(
        "the scene has {all} lights, and shadow maps are for at most {MAX_LIGHTS}: of {count} with \
         `shadow = \"map\"`, \"{}\" the first, shadows are found by rays",
        first.name
    );
    let help = format!(
        "write `shadow = \"ray\"` for these, which is the same picture, or no more than {MAX_LIGHTS} lights"
    );
    Some(Diagnostic::new("lamp-shadow", first.at.clone(), message).help(help))
}

/// Warns, once, of the memory of the maps of lights of the scene text with `shadow = "map"`, which have no budget.
pub fn memory(scene: &Scene, world: &World) -> Option<Diagnostic> {
    let options = with_filtered(world, &RenderOptions::for_scene(&scene.desc));
    let (first, count) = asked_maps(scene, world, |light| has_map(world, &options, light))?;
    let undecided = options.undecided_lights(world);
    let asked = RenderOptions {
        rays_for_maps: undecided.fold(options.rays_for_maps, |rays, (i, _)| rays | 1 << i),
        ..options
    };
    let bytes = ShadowSizes::for_lights(&world.lights, &asked).bytes();
    if bytes <= MAP_BUDGET_BYTES {
        return None;
    }
    let message = format!(
        "the shadow maps of {count} lights with `shadow = \"map\"`, \"{}\" the first, take {} MiB",
        first.name,
        bytes >> 20
    );
    let help = format!(
        "leave out `shadow`, so that maps take at most {} MiB and other lights have shadows by rays, \
         or write less `shadow_px`",
        MAP_BUDGET_BYTES >> 20
    );
    Some(Diagnostic::new("map-memory", first.at.clone(), message).help(help))
}

/// First light of the scene text with `shadow = "map"` for which a condition holds, and the number of such lights.
fn asked_maps<'a>(
    scene: &'a Scene,
    world: &World,
    holds: impl Fn(&Light) -> bool,
) -> Option<(&'a Entry<LightDesc>, usize)> {
    let lights = scene.lights.iter().zip(world.all_lights());
    let mut mapped =
        lights.filter(|(_, light)| light.desc.shadow == ShadowMode::Map && holds(light));
    let (first, _) = mapped.next()?;
    Some((first, 1 + mapped.count()))
}
