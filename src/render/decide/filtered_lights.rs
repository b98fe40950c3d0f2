//! Lights that may shine on something that lets light pass.

use reflet_base::math::Bounds;
use reflet_scene::desc::LightKind;
use reflet_world::{Instance, Light, MAX_LIGHTS, World};

use super::cull::is_outside;
use crate::lighting::lights::flat_view;

const _: () = assert!(MAX_LIGHTS <= u64::BITS as usize, "a bit for each light");

/// Lights, a bit for each by its index in [`World::lights`], that may in some frame shine on an instance that lets light
/// pass and casts a shadow. Lights and instances that may move are taken to meet all others.
pub fn filtered_lights(world: &World) -> u64 {
    let filters =
        |i: &&Instance| i.shown.casts_shadow && world.materials[i.material].passes_light();
    let panes = world.instances.iter().filter(filters);
    let panes: Vec<_> = panes.map(|i| (i.dynamic, world.bounds_of(i))).collect();
    let is_filtered = |light: &Light| {
        let mut panes = panes.iter();
        panes.any(|(moves, bounds)| *moves || light.moves || may_reach(light, bounds))
    };
    let lights = world.lights.iter().enumerate();
    lights.fold(0, |mask, (i, light)| {
        mask | u64::from(is_filtered(light)) << i
    })
}

/// Whether a light may shine into a box, by its range and its cone.
fn may_reach(light: &Light, bounds: &Bounds) -> bool {
    let kind = &light.desc.kind;
    let is_in_range = |(range_m, from): (f32, glam::Vec3)| {
        from.distance(from.max(bounds.min).min(bounds.max)) <= range_m
    };
    let is_in_cone = !matches!(kind, LightKind::Spot { .. })
        || !is_outside(&flat_view(kind, 1, bounds, 0.0).0, bounds);
    is_in_cone && light.range_m.zip(kind.position()).is_none_or(is_in_range)
}
