//! Plan of a frame: the features and passes that a scene needs; all others are left out.

mod feature_table;
mod features;
mod mutual_reflections;
mod planned_scene;
mod shader_choice;
mod uses;

use std::collections::BTreeSet;

use reflet_scene::desc::{Method, PatternedKey, ReflectionMode, Visibility};
use reflet_world::{CORE_SLOTS, LayerTexture, Material, World, Wrap, bvh::Trees};

use self::planned_scene::PlannedScene;
pub use self::{
    feature_table::{Dropped, FeatureRow, FileChoice},
    features::Features,
    uses::passes_light,
};
use super::{
    buffers::textures::{Layers, POOL_BITS},
    layout::types::{WRAPS_ALL, WRAPS_CC, WRAPS_CR, WRAPS_RC, WRAPS_RR},
    lighting::{
        lights::{LightNeeds, has_shadow_rays},
        lobe_table::SMOOTH_ALPHA,
    },
    settings::{
        cutoff::{can_reflect, can_reflect_under, is_base_below, packed_coat},
        options::RenderOptions,
        precision::Precision,
    },
};

/// Features of a frame, and the numbers that shaders are specialized with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Features that the scene needs.
    pub features: Features,
    /// Features that were left out.
    pub dropped: Vec<Dropped>,
    /// Method whose maps answer reflections, if maps do.
    pub maps: Option<Method>,
    /// Precision of stored light.
    pub precision: Precision,
    /// Maximum number of successive reflections.
    pub bounces: u32,
    /// Node at which reflection rays enter the top level.
    pub reflected_root: u32,
    /// Texture pools in use, [`POOL_BITS`] for each slot of a material.
    pub slot_pools: u32,
    /// Texture pools that textures of layers use, [`POOL_BITS`] for all of them together.
    pub layer_pools: u32,
    /// Wrap mode pairs in use, as a mask of [`WRAPS_ALL`].
    pub wraps: u32,
}

/// Whether a material reflects now or may do so in another frame.
pub fn may_reflect(world: &World, material: usize, cutoff: f32) -> bool {
    let own = &world.materials[material];
    let mut decals = world.decals.over(material);
    can_reflect(own, cutoff)
        || world.may_change(material)
        || decals.any(|d| can_reflect_under(own, d, &world.materials[d.material], cutoff))
}

/// Whether a reflection of this roughness takes more than a single sharp ray.
fn is_spread(roughness: f32) -> bool {
    roughness * roughness > SMOOTH_ALPHA as f32
}

/// Whether a material that reflects depending on its roughness, or transmits light, is in some frame too rough for a
/// single sharp ray.
pub fn is_rough_reflector(world: &World, index: usize, cutoff: f32) -> bool {
    let material = &world.materials[index];
    let [_, roughness] = material.extremes(PatternedKey::Roughness);
    let [_, coat_roughness] = material.extremes(PatternedKey::ClearcoatRoughness);
    let spread = material.metallic_roughness_texture.is_some()
        || material.anisotropy.is_some()
        || (is_spread(roughness) && is_base_below(material, cutoff))
        || (material.clearcoat.is_some() && is_spread(coat_roughness));
    material.reflection == ReflectionMode::Auto
        && may_reflect(world, index, cutoff)
        && (spread || world.may_change(index) || world.decals.over(index).next().is_some())
        && is_spread(cutoff)
        || transmits_roughly(material)
}

/// Whether a sharp clear coat covers all of a material: smoothing goes by the roughness of the coat there
/// (`reflected_roughness` in `shaders/lib/layers.wgsl`), and leaves its pixels as they are.
fn has_sharp_coat(world: &World, index: usize, cutoff: f32) -> bool {
    let material = &world.materials[index];
    let [coat, _] = material.extremes(PatternedKey::Clearcoat);
    let [_, roughness] = material.extremes(PatternedKey::ClearcoatRoughness);
    let maps = [LayerTexture::Clearcoat, LayerTexture::ClearcoatRoughness];
    let is_constant = !world.may_change(index)
        && world.decals.over(index).next().is_none()
        && maps
            .iter()
            .all(|map| material.layer_texture(*map).is_none());
    let roughness = packed_coat(roughness);
    is_constant && packed_coat(coat) > 0.0 && roughness < cutoff && !is_spread(roughness)
}

/// Whether smoothing changes the reflections of some instance's own pixels.
fn smooths_some_reflection(world: &World, cutoff: f32) -> bool {
    (world.instances.iter()).any(|i| {
        is_rough_reflector(world, i.material, cutoff) && !has_sharp_coat(world, i.material, cutoff)
    })
}

/// Whether a material transmits light, by more than a single sharp ray.
pub fn transmits_roughly(material: &Material) -> bool {
    let [_, roughness] = material.extremes(PatternedKey::Roughness);
    material.transmission.is_some()
        && (material.metallic_roughness_texture.is_some()
            || material.anisotropy.is_some()
            || is_spread(roughness))
}

/// Whether [`is_rough_reflector`] holds for some material.
pub fn reflects_roughly(world: &World, cutoff: f32) -> bool {
    (world.instances.iter()).any(|i| is_rough_reflector(world, i.material, cutoff))
}

/// Whether some material reflects in some frame.
pub fn reflects(world: &World, cutoff: f32) -> bool {
    (world.instances.iter()).any(|i| may_reflect(world, i.material, cutoff))
}

/// Whether the surfaces of pixels are found by rays rather than by rasterization.
pub fn has_primary_rays(options: &RenderOptions) -> bool {
    options.image.visibility == Visibility::Rays
}

/// Whether a frame traces rays, so that it needs BVHs: for reflections, primary visibility, shadows, indirect light
/// or transmission.
pub fn traces_rays(world: &World, options: &RenderOptions) -> bool {
    let cutoff = options.reflection.reflects_below();
    // The maps of probes are captured by rays.
    let reflections = options.reflection.method != Method::Ssr && reflects(world, cutoff);
    reflections
        || has_primary_rays(options)
        || has_shadow_rays(&world.lights, options)
        || environment_casts_rays(world, options)
        || scatters(options)
        || world.has_emitters()
        || passes_light(world)
}

/// Whether diffuse surfaces light each other.
fn scatters(options: &RenderOptions) -> bool {
    options.reflection.settled().diffuse_bounces > 0
}

/// Whether shadow rays are traced for the environment's light. With diffuse interreflection they are, as surfaces
/// that block the environment reflect light themselves, and it must not shine through them too.
pub fn environment_casts_rays(world: &World, options: &RenderOptions) -> bool {
    world.environment.casts_rays() || (scatters(options) && !world.environment.is_black())
}

/// Whether the frame marches with verified hits only: the march then stops at surfaces that the camera culls.
pub fn may_meet_culled(world: &World, options: &RenderOptions) -> bool {
    options.reflection.method.marches()
        && options.reflection.verifies()
        && (options.general || reflects(world, options.reflection.reflects_below()))
}

/// The method, if something reflects and its reflections are answered by maps.
pub fn mapped_method(world: &World, options: &RenderOptions) -> Option<Method> {
    let method = options.reflection.method;
    let is_mapped = method.maps().is_some()
        && (options.general || reflects(world, options.reflection.reflects_below()));
    is_mapped.then_some(method)
}

impl Plan {
    /// Number of layers of the details of surfaces: colors, the details, and layers of further ones.
    pub fn detail_layers(&self) -> u32 {
        let features = &self.features;
        2 + u32::from(features.further_details) + u32::from(features.diffuse_transmission)
    }

    /// The plan of a scene; with [`RenderOptions::general`], the plan that drops no feature.
    pub fn for_world(
        world: &World,
        trees: &Trees,
        layers: &Layers,
        options: &RenderOptions,
    ) -> Self {
        let precision = Precision::for_world(world, options);
        let used: BTreeSet<usize> = world.instances.iter().map(|i| i.material).collect();
        let (features, dropped) = Features::for_scene(&PlannedScene {
            world,
            materials: used.iter().map(|&m| &world.materials[m]).collect(),
            trees,
            options,
            precision,
        });
        let decals = world.decals.list.iter().map(|d| d.material);
        let used: BTreeSet<usize> = used.into_iter().chain(decals).collect();
        let (slot_pools, layer_pools, wraps) = match options.general {
            true => (
                mask(POOL_BITS * CORE_SLOTS as u32),
                mask(POOL_BITS),
                WRAPS_ALL,
            ),
            false => samplers(world, &used, layers),
        };
        Self {
            features,
            dropped,
            maps: mapped_method(world, options),
            precision,
            reflected_root: trees.reflected_root(),
            bounces: match features.further_bounces {
                true => options.reflection.bounces.most(),
                false => 1,
            },
            slot_pools,
            layer_pools,
            wraps,
        }
    }

    /// Values for the shaders' overrides, by name.
    pub fn overrides(&self) -> Vec<(&'static str, f64)> {
        let numbers = [
            ("EMISSION_SCALE", self.precision.emission_scale().into()),
            ("SLOT_POOLS", self.slot_pools.into()),
            ("LAYER_POOLS", self.layer_pools.into()),
            ("WRAPS", self.wraps.into()),
            ("REFLECTED_ROOT", self.reflected_root.into()),
        ];
        self.features.constants().chain(numbers).collect()
    }

    /// Light features that the plan's passes support.
    pub fn light_needs(&self) -> LightNeeds {
        LightNeeds {
            rays: self.features.shadow_rays,
            hard_rays: self.features.hard_shadow_rays,
            hard: usize::from(self.features.hard_lights)
                + usize::from(self.features.several_hard_lights),
            sized: usize::from(self.features.sized_lights)
                + usize::from(self.features.several_sized_lights),
            sized_suns: self.features.sized_suns,
        }
    }
}

/// The lowest bits of a word.
const fn mask(bits: u32) -> u32 {
    (1 << bits) - 1
}

/// Bit masks for shaders: pools that each slot samples, pools of layer textures, and wrap pairs of the used
/// materials.
fn samplers(world: &World, used: &BTreeSet<usize>, layers: &Layers) -> (u32, u32, u32) {
    let (mut slot_pools, mut layer_pools, mut wraps) = (0, 0, 0);
    for &m in used {
        let slots_of = world.materials[m].slots().into_iter().enumerate();
        for (index, slot) in slots_of.filter_map(|(i, slot)| Some((i, slot?))) {
            let srgb = u32::from(world.textures[slot.texture].srgb);
            let pool = layers
                .slot(index, &slot, &world.textures)
                .map_or(0, |s| s.pool);
            let bit = 2 * pool + srgb;
            match index < CORE_SLOTS {
                true => slot_pools |= 1 << (POOL_BITS * index as u32 + bit),
                false => layer_pools |= 1 << bit,
            }
            let clamps = slot.wrap.map(|w| w != Wrap::Repeat);
            wraps |= match clamps {
                [false, false] => WRAPS_RR,
                [false, true] => WRAPS_RC,
                [true, false] => WRAPS_CR,
                [true, true] => WRAPS_CC,
            };
        }
    }
    (slot_pools, layer_pools, wraps)
}
