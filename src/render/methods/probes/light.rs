//! Light of the maps of probes: the lights that they are captured with, and a hash of all that their content depends
//! on.

use reflet_world::{Decal, DecalMask, World};
use xxhash_rust::xxh3::Xxh3Default;

use crate::{
    layout::{
        fog::GpuFog,
        types::{Frame, Sampling},
    },
    lighting::lights::{LightBlock, SHADOW_MAP, SHADOW_RAY},
    upload::emitters::lamp_record,
};

/// Hash of the light, the environment, the decals and the materials that maps show, with blocks that do not depend on
/// the camera.
pub fn hash_of_light(
    world: &World,
    frame: &Frame,
    lights: &LightBlock,
    sampling: &Sampling,
    fog: Option<&GpuFog>,
) -> u64 {
    let mut hash = Xxh3Default::new();
    hash.update(bytemuck::bytes_of(frame));
    hash.update(bytemuck::bytes_of(lights));
    hash.update(bytemuck::bytes_of(sampling));
    let decals = decals_at_rest(world);
    for decal in &decals {
        hash.update(format!("{decal:?}").as_bytes());
    }
    // Moving things are on no map, but as lights.
    let is_shown = |material: usize| {
        let mut shown = world.instances.iter().filter(|i| i.material == material);
        world.materials[material].light
            || decals.iter().any(|decal| decal.material == material)
            || shown.any(|instance| !instance.dynamic)
    };
    let changing = world.moving.materials.iter();
    for moving in changing.filter(|moving| is_shown(moving.material)) {
        hash.update(format!("{:?}", world.materials[moving.material]).as_bytes());
    }
    if world.has_moving_emitters() {
        for (_, instance) in world.lighting_instances() {
            hash.update(format!("{:?}", instance.world_from_object).as_bytes());
            if let Some(deformed) = world.deformed.get(&instance.mesh) {
                hash.update(&deformed.hash.to_le_bytes());
            }
        }
    }
    for lamp in &world.lamps {
        hash.update(bytemuck::bytes_of(&lamp_record(lamp, 0)));
    }
    if let Some(fog) = fog {
        hash.update(bytemuck::bytes_of(fog));
    }
    hash.digest()
}

/// Decals that static instances may show, wherever they are now.
fn decals_at_rest(world: &World) -> Vec<&Decal> {
    let decals = &world.decals;
    let mut shown = DecalMask::default();
    let still = (world.instances.iter().enumerate()).filter(|(_, instance)| !instance.dynamic);
    for (index, _) in still {
        let set = decals.sets.get(usize::from(decals.set_of(index)));
        for (all, word) in shown.iter_mut().zip(set.into_iter().flatten()) {
            *all |= word;
        }
    }
    let has = |index: usize| shown[index / 32] >> (index % 32) & 1 != 0;
    let listed = decals.list.iter().enumerate();
    listed
        .filter_map(|(index, decal)| has(index).then_some(decal))
        .collect()
}

/// The lights with shadows by rays, so that moving things cast none.
pub fn by_rays(lights: &LightBlock) -> LightBlock {
    let mut lights = *lights;
    for light in &mut lights.lights {
        if light.shadow == SHADOW_MAP {
            light.shadow = SHADOW_RAY;
        }
        // Places in shadow maps, which may follow what moves.
        light.clip_from_world = [[0.0; 4]; 4];
        light.texel = 0.0;
        light.layer = 0;
    }
    lights
}
