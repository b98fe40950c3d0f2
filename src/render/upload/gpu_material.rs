//! Materials in their layout in shaders.

use glam::{Vec2, Vec3};

use crate::{
    buffers::textures::{Layers, PoolSlot},
    layout::{
        gpu_patterned::GpuPatterned,
        gpu_struct::{Shared as _, gpu_struct},
        types::{
            EDGE_TINT, GpuTextureUse, NONE, OF_INDEX, TEXTURE_NEAREST, TEXTURE_SIZE_SHIFT,
            TEXTURE_SRGB, TEXTURE_UV1, TEXTURE_WRAP_U_SHIFT, TEXTURE_WRAP_V_SHIFT, WRAP_CLAMP,
            WRAP_MIRROR, WRAP_REPEAT, flag,
        },
    },
    settings::cutoff::{has_specular, packed, packed_coat},
};
use reflet_scene::desc::{MOST_PATTERNED, reflectivity_of};
use reflet_world::{
    CORE_SLOTS, LAYER_SLOTS, LayerTexture, Material, TextureRef, World, Wrap,
    texture::pool_size::SMALLEST_POOL_PX,
};

/// Declares the shaders' struct of materials, with the value of each field for a material and its textures.
macro_rules! filled {
    ($(#[$meta:meta])* pub struct $name:ident = $wgsl:literal from |$m:ident, $textures:ident| {
        $($(#[$field_meta:meta])* $field:ident: $ty:ty = $value:expr,)*
    }) => {
        gpu_struct! {
            $(#[$meta])*
            pub struct $name = padded $wgsl {
                $($(#[$field_meta])* $field: $ty,)*
            }
        }

        /// GPU layout of a material of the world, whose textures lie in `layers`.
        pub fn gpu_material($m: &Material, world: &World, layers: &Layers) -> $name {
            let $textures = textures($m, world, layers);
            $name {
                $($field: $value,)*
                ..$name::ZERO
            }
        }
    };
}

filled! {
    /// A material; see `shaders/lib/scene.wgsl`.
    pub struct GpuMaterial = "Material" from |m, textures| {
        /// Linear base color, alpha in w.
        base_color: [f32; 4] = m.base_color.to_array(),
        /// Emitted linear radiance.
        emission: [f32; 3] = m.emission.to_array(),
        /// Metalness, 0 to 1.
        metallic: f32 = packed(m.metallic),
        /// Perceptual roughness, 0 to 1.
        roughness: f32 = packed(m.roughness),
        /// Reflectance of the dielectric at normal incidence.
        reflectivity: f32 = m.reflectivity,
        /// Strength of the normal map.
        normal_scale: f32 = m.normal_scale,
        /// Strength of the occlusion map.
        occlusion_strength: f32 = m.occlusion_strength,
        /// First checker color.
        checker_a: [f32; 3] = checker_color(m, 0),
        /// Size of a checker's cell, meters; 0: no checker.
        checker_size_m: f32 = m.checker.map_or(0.0, |c| c.size_m),
        /// Second checker color.
        checker_b: [f32; 3] = checker_color(m, 1),
        /// Alpha below which a cut-out is transparent; below 0: opaque.
        alpha_cutoff: f32 = m.alpha_cutoff.unwrap_or(-1.0),
        /// Reflection mode: 0 none, 1 auto, 2 mirror; with [`OF_INDEX`] and [`EDGE_TINT`].
        reflection: u32 = reflection_bits(m),
        /// 1: the base color is shown without lighting.
        unlit: u32 = m.unlit.into(),
        /// Share of the light that enters the surface and is transmitted.
        transmission: f32 = m.transmission.unwrap_or(0.0),
        /// Strength of the clear coat.
        clearcoat: f32 = packed_coat(m.clearcoat.unwrap_or(0.0)),
        /// Extinction coefficient inside a solid, per meter.
        extinction: [f32; 3] = m.extinction().to_array(),
        /// Index of refraction.
        ior: f32 = m.ior,
        /// Perceptual roughness of the clear coat.
        clearcoat_roughness: f32 = packed_coat(m.clearcoat_roughness),
        /// 1: transmitted light is refracted and absorbed.
        is_solid: u32 = m.solid.into(),
        /// 1: alpha is the surface's coverage.
        is_blended: u32 = m.blended.into(),
        /// [`PatternKind`](reflet_scene::desc::PatternKind) that uses the checker's colors and size.
        pattern: u32 = m.checker.map_or(0, |c| c.kind as u32),
        /// Color factor on the reflectivity.
        specular_color: [f32; 3] = m.specular_color.unwrap_or(Vec3::ONE).to_array(),
        /// Factor on the reflectivity and on the reflectance at grazing angles.
        specular: f32 = m.specular.unwrap_or(1.0),
        /// Color of the sheen; black: none.
        sheen_color: [f32; 3] = m.sheen_color.unwrap_or(Vec3::ZERO).to_array(),
        /// Perceptual roughness of the sheen.
        sheen_roughness: f32 = m.sheen_roughness,
        /// Color of the diffuse light that passes.
        diffuse_transmission_color: [f32; 3] = m.diffuse_transmission_color.to_array(),
        /// Share of the diffuse light that passes.
        diffuse_transmission: f32 = m.diffuse_transmission.unwrap_or(0.0),
        /// Strength of the thin film.
        iridescence: f32 = m.iridescence.unwrap_or(0.0),
        /// Index of refraction of the thin film.
        iridescence_ior: f32 = m.iridescence_ior,
        /// Thickness of the film where its texture is 0, nanometers.
        iridescence_least_nm: f32 = m.iridescence_least_nm,
        /// Thickness of the film where its texture is 1, nanometers.
        iridescence_thickness_nm: f32 = m.iridescence_thickness_nm,
        /// Cosine and sine of the anisotropy's angle from the tangent.
        anisotropy_turn: [f32; 2] = Vec2::from_angle(m.anisotropy_rotation_deg.to_radians()).to_array(),
        /// Strength of the anisotropy.
        anisotropy: f32 = m.anisotropy.unwrap_or(0.0),
        /// Dispersion: 20 over the Abbe number.
        dispersion: f32 = m.dispersion.unwrap_or(0.0),
        /// Textures of base color, metallic-roughness, normal, occlusion, emission.
        textures: [GpuTextureUse; CORE_SLOTS] = textures.0,
        /// Textures of layers, in the order of [`LayerTexture`](reflet_world::LayerTexture).
        layer_textures: [GpuTextureUse; LAYER_SLOTS] = textures.1,
        /// Numbers and colors that follow patterns.
        patterned: [GpuPatterned; MOST_PATTERNED] = std::array::from_fn(|i| GpuPatterned::from_pattern(m.patterned.get(i))),
        /// Albedo of the isotropic scattering inside a solid; 0: clear.
        scattering: [f32; 3] = m.single_scattering_albedo().to_array(),
        /// Roughness of the diffuse reflection.
        diffuse_roughness: f32 = m.diffuse_roughness.unwrap_or(0.0),
        /// Reflectance of the clear coat at normal incidence.
        coat_reflectivity: f32 = reflectivity_of(m.clearcoat_ior.unwrap_or(1.5)),
    }
}

/// Linear color of a material's checker.
fn checker_color(m: &Material, i: usize) -> [f32; 3] {
    m.checker.map_or([0.0; 3], |c| c.colors[i].to_array())
}

/// Value of [`GpuMaterial::reflection`].
fn reflection_bits(m: &Material) -> u32 {
    // Without a specular lobe there is no reflection, whatever the reflection mode.
    flag(m.has_index, OF_INDEX)
        | flag(m.edge_tint, EDGE_TINT)
        | if has_specular(m) {
            m.reflection as u32
        } else {
            0
        }
}

/// The core textures of a material, and the textures of its layers.
fn textures(
    m: &Material,
    world: &World,
    layers: &Layers,
) -> ([GpuTextureUse; CORE_SLOTS], [GpuTextureUse; LAYER_SLOTS]) {
    let slots = m.slots();
    let slot = |i: usize| {
        slots[i].map_or(NO_TEXTURE, |used| {
            let place = layers.slot(i, &used, &world.textures);
            // The pools are made for all materials of the world.
            place.map_or(NO_TEXTURE, |place| {
                texture_use(&used, m.uv_scale, world, place)
            })
        })
    };
    let mut of_layers: [_; LAYER_SLOTS] = std::array::from_fn(|i| slot(CORE_SLOTS + i));
    let coat = &mut of_layers[LayerTexture::ClearcoatNormal as usize];
    coat.signs = coat.signs.map(|sign| sign * m.clearcoat_normal_scale);
    (std::array::from_fn(slot), of_layers)
}

const NO_TEXTURE: GpuTextureUse = GpuTextureUse {
    layer: NONE,
    texels: [1.0; 2],
    signs: [1.0; 2],
    ..GpuTextureUse::ZERO
};

fn texture_use(
    slot: &TextureRef,
    uv_scale: [f32; 2],
    world: &World,
    place: PoolSlot,
) -> GpuTextureUse {
    let texture = &world.textures[slot.texture];
    let wrap = |w: Wrap| match w {
        Wrap::Repeat => WRAP_REPEAT,
        Wrap::Clamp => WRAP_CLAMP,
        Wrap::Mirror => WRAP_MIRROR,
    };
    GpuTextureUse {
        row_u: slot.transform[0].to_array(),
        layer: place.layer,
        row_v: slot.transform[1].to_array(),
        bits: place.pool
            | flag(texture.srgb, TEXTURE_SRGB)
            | flag(slot.uv_set & 1 == 1, TEXTURE_UV1)
            | wrap(slot.wrap[0]) << TEXTURE_WRAP_U_SHIFT
            | wrap(slot.wrap[1]) << TEXTURE_WRAP_V_SHIFT
            | flag(slot.nearest, TEXTURE_NEAREST)
            | (place.px / SMALLEST_POOL_PX).ilog2() << TEXTURE_SIZE_SHIFT,
        texels: [texture.width as f32, texture.height as f32],
        signs: uv_scale.map(|scale| if scale < 0.0 { -1.0 } else { 1.0 }),
        ..GpuTextureUse::ZERO
    }
}
