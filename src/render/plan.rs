//! Plan of a frame: the features and passes that a scene needs; all others are left out.

mod dropped;
mod mutual_reflections;
mod overrides;
mod uses;

use serde::Serialize;

use crate::{
    scene::desc::{Method, PatternKind, ReflectionMode, ShownDesc, Visibility},
    world::{CORE_SLOTS, LayerTexture, Material, World, Wrap, bvh::Trees},
};

pub use self::{dropped::Dropped, uses::passes_light};
use self::{
    mutual_reflections::reflectors_see_each_other,
    uses::{SurfaceUses, scatters_twice},
};
use super::{
    lights::{LightNeeds, ShadowSizes, has_shadow_rays},
    options::RenderOptions,
    precision::Precision,
    shader_variant::ShaderVariant,
    textures::Layers,
    types::METAL_REACH,
};

/// Features of the frame; each flag is a pipeline constant, or says whether a pass is recorded.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Plan {
    /// Whether some material can reflect: march, trace and blur passes exist.
    pub reflections: bool,
    /// Whether rays are traced: see [`traces_rays`].
    pub traced: bool,
    /// Whether some geometry is in the static tree.
    pub static_tree: bool,
    /// Whether some instance is traced through the top level.
    pub top_level: bool,
    /// Whether surfaces that the camera culls but reflection rays meet stop the march.
    pub culled_surfaces: bool,
    /// Precision of stored light.
    pub precision: Precision,
    /// Whether some instance is hidden from a kind of ray.
    pub unshown: bool,
    /// Whether some material is cut out.
    pub cutouts: bool,
    /// Whether some material has a normal map.
    pub normal_maps: bool,
    /// Whether some material has a texture.
    pub textures: bool,
    /// Whether some material has a checker or another pattern.
    pub checkers: bool,
    /// Whether some material has a pattern other than a checker.
    pub patterns: bool,
    /// Whether some light casts its shadow by rays.
    pub shadow_rays: bool,
    /// Whether some light without a size casts its shadow by rays.
    pub hard_shadow_rays: bool,
    /// Whether some light has a cube map.
    pub cube_maps: bool,
    /// Whether some light has a flat shadow map.
    pub flat_maps: bool,
    /// Whether reflections may reuse the light pass's results of shadow rays.
    pub lends_light: bool,
    /// Whether the environment's light is sampled rather than computed in closed form.
    pub sampled_environment: bool,
    /// Whether some light has a size.
    pub sized_lights: bool,
    /// Whether some directional light has a size.
    pub sized_suns: bool,
    /// Whether some emissive surface is sampled as a light.
    pub emitters: bool,
    /// Whether diffuse surfaces light each other: diffuse interreflection.
    pub indirect: bool,
    /// Whether all light is path traced without bias.
    pub unbiased: bool,
    /// Features of the surfaces.
    #[serde(flatten)]
    pub surfaces: SurfaceUses,
    /// Whether some reflection is rough.
    pub rough_reflections: bool,
    /// Whether the specular lobe is compensated for multiple scattering between facets.
    pub multiple_scattering: bool,
    /// Whether the environment is a panorama.
    pub panorama: bool,
    /// Whether shadow rays are traced for the environment's light.
    pub environment_rays: bool,
    /// Whether the camera sees the environment.
    pub shows_environment: bool,
    /// Maximum number of successive reflections.
    pub bounces: u32,
    /// Texture pools in use, six bits for each slot of a material: a bit for each linear and sRGB
    /// view.
    pub slot_pools: u32,
    /// Texture pools that textures of layers use, six bits for all of them together.
    pub layer_pools: u32,
    /// Wrap mode pairs in use.
    pub wraps: u32,
    /// Features that were left out.
    pub dropped: Vec<Dropped>,
}

/// Whether a material has a specular lobe that a reflection could replace.
pub fn has_specular(material: &Material) -> bool {
    // Glass reflects internally whatever its specular strength.
    let is_dimmed = material.specular == Some(0.0) && !material.passes_light();
    let dielectric = material.reflectivity > 0.0 && !is_dimmed;
    dielectric || material.metallic > 0.0 || material.clearcoat.is_some()
}

/// Roughness below which a material reflects; higher for metals, which show nothing else.
fn reflects_below(material: &Material, cutoff: f32) -> f32 {
    cutoff.max((cutoff * (1.0 + METAL_REACH * material.metallic)).min(1.0))
}

/// Whether a material can reflect at all, so that its pixels are worth marching.
pub fn can_reflect(material: &Material, cutoff: f32) -> bool {
    let has_map = material
        .layer_texture(LayerTexture::ClearcoatRoughness)
        .is_some();
    let coat_roughness = if has_map {
        0.0
    } else {
        material.clearcoat_roughness
    };
    let smooth = material.metallic_roughness_texture.is_some()
        || material.roughness < reflects_below(material, cutoff)
        || (material.clearcoat.is_some() && coat_roughness < cutoff);
    has_specular(material)
        && match material.reflection {
            ReflectionMode::None => false,
            ReflectionMode::Mirror => true,
            ReflectionMode::Auto => smooth,
        }
}

/// Whether a material reflects now or may do so in another frame.
pub fn may_reflect(world: &World, material: usize, cutoff: f32) -> bool {
    can_reflect(&world.materials[material], cutoff) || world.may_change(material)
}

/// Roughness up to which a reflection is sharp; its square is `SMOOTH_ALPHA` in the shaders.
const SHARP_ROUGHNESS: f32 = 0.044_72;

/// Whether some material that reflects depending on its roughness, or transmits light, is in some frame too rough
/// for a single sharp ray.
pub fn reflects_roughly(world: &World, cutoff: f32) -> bool {
    let is_rough = |index: usize| {
        let material = &world.materials[index];
        let spread = material.metallic_roughness_texture.is_some()
            || material.anisotropy.is_some()
            || (SHARP_ROUGHNESS..reflects_below(material, cutoff)).contains(&material.roughness)
            || (material.clearcoat.is_some() && material.clearcoat_roughness >= SHARP_ROUGHNESS);
        let scatters = material.transmission.is_some()
            && (material.metallic_roughness_texture.is_some()
                || material.anisotropy.is_some()
                || material.roughness >= SHARP_ROUGHNESS);
        material.reflection == ReflectionMode::Auto
            && may_reflect(world, index, cutoff)
            && (spread || world.may_change(index))
            && cutoff > SHARP_ROUGHNESS
            || scatters
    };
    world.instances.iter().any(|i| is_rough(i.material))
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
fn environment_casts_rays(world: &World, options: &RenderOptions) -> bool {
    world.environment.casts_rays() || (scatters(options) && !world.environment.is_black())
}

/// Whether the frame marches with verified hits only: the march then stops at surfaces that the camera culls.
pub fn may_meet_culled(world: &World, options: &RenderOptions) -> bool {
    options.reflection.method.marches()
        && options.reflection.verifies()
        && (options.general || reflects(world, options.reflection.reflects_below()))
}

impl Plan {
    /// The plan that drops no feature, to compare against. Lights and their sampling stay as in the scene, since
    /// samples differ from closed forms until they converge.
    pub fn general(world: &World, options: &RenderOptions) -> Self {
        let settings = &options.reflection;
        Self {
            sampled_environment: world.environment.is_sampled()
                || environment_casts_rays(world, options),
            indirect: scatters(options),
            unbiased: options.is_unbiased(),
            sized_lights: world.lights.iter().any(|l| l.desc.kind.has_size()),
            sized_suns: true,
            emitters: world.has_emitters(),
            rough_reflections: reflects_roughly(world, settings.reflects_below()),
            surfaces: SurfaceUses::of(world),
            multiple_scattering: settings.multiple_scattering && scatters_twice(world),
            panorama: world.environment.panorama.is_some(),
            environment_rays: environment_casts_rays(world, options),
            shows_environment: world.environment.desc.visible && !options.image.alpha,
            reflections: true,
            traced: true,
            static_tree: true,
            top_level: true,
            culled_surfaces: may_meet_culled(world, options),
            precision: Precision::of(world, options),
            unshown: true,
            cutouts: true,
            normal_maps: true,
            textures: true,
            checkers: true,
            patterns: true,
            shadow_rays: true,
            hard_shadow_rays: true,
            cube_maps: true,
            flat_maps: true,
            lends_light: true,
            bounces: settings.bounces,
            slot_pools: (1 << 30) - 1,
            layer_pools: (1 << 6) - 1,
            wraps: 15,
            dropped: Vec::new(),
        }
    }

    /// The plan of a scene: the features that it needs.
    pub fn of(world: &World, trees: &Trees, layers: &Layers, options: &RenderOptions) -> Self {
        let settings = &options.reflection;
        let mut used: Vec<usize> = world.instances.iter().map(|i| i.material).collect();
        used.sort_unstable();
        used.dedup();
        let materials = || used.iter().map(|&m| &world.materials[m]);
        let (slot_pools, layer_pools, wraps) = samplers(world, &used, layers);
        let cutoff = settings.reflects_below();
        let reflections = reflects(world, cutoff);
        // Transmissive surfaces also show the backs of reflectors.
        let single_bounce = reflections
            && !passes_light(world)
            && !scatters(options)
            && !reflectors_see_each_other(world, cutoff);
        let traced = traces_rays(world, options);
        let lights = LightNeeds::of(&world.lights, options);
        let shadows = ShadowSizes::of(&world.lights, options);
        let mut plan = Self {
            reflections,
            traced,
            static_tree: trees.static_triangles > 0,
            top_level: trees.is_built() && !trees.top_instances.is_empty(),
            culled_surfaces: may_meet_culled(world, options)
                && world.instances.iter().any(|i| world.hides_from_camera(i)),
            precision: Precision::of(world, options),
            unshown: (world.instances.iter()).any(|i| i.shown != ShownDesc::default()),
            cutouts: materials().any(|m| m.alpha_cutoff.is_some()),
            normal_maps: materials().any(|m| m.normal_texture.is_some()),
            textures: materials().any(|m| m.slots().iter().any(Option::is_some)),
            checkers: materials().any(|m| m.checker.is_some()),
            patterns: materials()
                .any(|m| m.checker.is_some_and(|c| c.kind != PatternKind::Checker)),
            shadow_rays: lights.rays,
            hard_shadow_rays: lights.hard_rays,
            cube_maps: shadows.cubes > 0,
            flat_maps: shadows.maps > 0,
            lends_light: reflections && lights.hard_rays,
            sampled_environment: world.environment.is_sampled()
                || environment_casts_rays(world, options),
            indirect: scatters(options),
            unbiased: options.is_unbiased(),
            sized_lights: lights.sized,
            sized_suns: lights.sized_suns,
            emitters: world.has_emitters(),
            rough_reflections: reflects_roughly(world, cutoff),
            surfaces: SurfaceUses::of(world),
            multiple_scattering: settings.multiple_scattering && scatters_twice(world),
            panorama: world.environment.panorama.is_some(),
            environment_rays: environment_casts_rays(world, options),
            shows_environment: world.environment.desc.visible && !options.image.alpha,
            bounces: if single_bounce { 1 } else { settings.bounces },
            slot_pools,
            layer_pools,
            wraps,
            dropped: Vec::new(),
        };
        plan.list_dropped(settings);
        plan
    }

    /// The shader files that the plan needs.
    pub fn variant(&self) -> ShaderVariant {
        ShaderVariant {
            extent: self.sampled_environment
                || self.sized_lights
                || self.emitters
                || self.indirect
                || self.rough_reflections
                || self.has_layers(),
            emitters: self.emitters,
            indirect: self.indirect,
            ambient: self.sampled_environment,
            panorama: self.panorama,
            layers: self.has_layers(),
            details: self.has_details(),
            sheen: self.surfaces.sheen,
            film: self.surfaces.iridescence,
            full: self.precision.full,
            conserved: self.multiple_scattering,
            ..ShaderVariant::default()
        }
    }

    /// Whether some surface is transmissive or has a clear coat.
    fn has_layers(&self) -> bool {
        self.surfaces.transmission || self.surfaces.coats
    }

    /// Whether passes run over lists of pixels.
    pub fn has_lists(&self) -> bool {
        self.reflections || self.surfaces.transmission
    }

    /// Whether some surface has values that the G-buffer has no bits for.
    pub fn has_details(&self) -> bool {
        let uses = &self.surfaces;
        uses.has_tints() || uses.sheen || uses.has_frames()
    }

    /// Light features that the plan's passes support.
    pub fn light_needs(&self) -> LightNeeds {
        LightNeeds {
            rays: self.shadow_rays,
            hard_rays: self.hard_shadow_rays,
            sized: self.sized_lights,
            sized_suns: self.sized_suns,
        }
    }
}

/// Bit masks for shaders: pools that each slot samples, pools of layer textures, and wrap pairs of the used
/// materials.
fn samplers(world: &World, used: &[usize], layers: &Layers) -> (u32, u32, u32) {
    let (mut slot_pools, mut layer_pools, mut wraps) = (0, 0, 0);
    for &m in used {
        let slots_of = world.materials[m].slots().into_iter().enumerate();
        for (index, slot) in slots_of.filter_map(|(i, slot)| Some((i, slot?))) {
            let srgb = u32::from(world.textures[slot.texture].srgb);
            let pool = layers.slot(&slot, &world.textures).map_or(0, |s| s.pool);
            let bit = 2 * pool + srgb;
            match index < CORE_SLOTS {
                true => slot_pools |= 1 << (6 * index as u32 + bit),
                false => layer_pools |= 1 << bit,
            }
            let clamps = slot.wrap.map(|w| w != Wrap::Repeat);
            wraps |= match clamps {
                [false, false] => 1,
                [false, true] => 2,
                [true, false] => 4,
                [true, true] => 8,
            };
        }
    }
    (slot_pools, layer_pools, wraps)
}
