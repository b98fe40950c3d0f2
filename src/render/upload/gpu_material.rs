//! Conversion of materials to their layout in shaders.

use glam::{Vec2, Vec3};

use crate::{
    buffers::textures::{Layers, PoolSlot},
    layout::{
        gpu_patterned::GpuPatterned,
        gpu_struct::Shared as _,
        types::{
            GpuMaterial, GpuTextureUse, NONE, OF_INDEX, TEXTURE_NEAREST, TEXTURE_SIZE_SHIFT,
            TEXTURE_SRGB, TEXTURE_UV1, TEXTURE_WRAP_U_SHIFT, TEXTURE_WRAP_V_SHIFT, WRAP_CLAMP,
            WRAP_MIRROR, WRAP_REPEAT, flag,
        },
    },
    settings::cutoff::{has_specular, packed, packed_coat},
};
use reflet_world::{
    CORE_SLOTS, LAYER_SLOTS, LayerTexture, Material, TextureRef, World, Wrap,
    texture::pool_size::SMALLEST_POOL_PX,
};

/// GPU layout of a material of the world, whose textures lie in `layers`.
pub fn gpu_material(m: &Material, world: &World, layers: &Layers) -> GpuMaterial {
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
    let checker = m.checker;
    let color = |i: usize| checker.map_or([0.0; 3], |c| c.colors[i].to_array());
    let mut layer_textures: [_; LAYER_SLOTS] = std::array::from_fn(|i| slot(CORE_SLOTS + i));
    let coat = &mut layer_textures[LayerTexture::ClearcoatNormal as usize];
    coat.signs = coat.signs.map(|sign| sign * m.clearcoat_normal_scale);
    GpuMaterial {
        base_color: m.base_color.to_array(),
        emission: m.emission.to_array(),
        metallic: packed(m.metallic),
        roughness: packed(m.roughness),
        reflectivity: m.reflectivity,
        normal_scale: m.normal_scale,
        occlusion_strength: m.occlusion_strength,
        checker_a: color(0),
        checker_size_m: checker.map_or(0.0, |c| c.size_m),
        checker_b: color(1),
        pattern: checker.map_or(0, |c| c.kind as u32),
        alpha_cutoff: m.alpha_cutoff.unwrap_or(-1.0),
        // Without a specular lobe there is no reflection, whatever the reflection mode.
        reflection: flag(m.has_index, OF_INDEX)
            | match has_specular(m) {
                true => m.reflection as u32,
                false => 0,
            },
        unlit: m.unlit.into(),
        transmission: m.transmission.unwrap_or(0.0),
        clearcoat: packed_coat(m.clearcoat.unwrap_or(0.0)),
        absorption: m.absorption().to_array(),
        ior: m.ior,
        clearcoat_roughness: packed_coat(m.clearcoat_roughness),
        is_solid: m.solid.into(),
        is_blended: m.blended.into(),
        specular_color: m.specular_color.unwrap_or(Vec3::ONE).to_array(),
        specular: m.specular.unwrap_or(1.0),
        sheen_color: m.sheen_color.unwrap_or(Vec3::ZERO).to_array(),
        sheen_roughness: m.sheen_roughness,
        iridescence: m.iridescence.unwrap_or(0.0),
        iridescence_ior: m.iridescence_ior,
        iridescence_least_nm: m.iridescence_least_nm,
        iridescence_thickness_nm: m.iridescence_thickness_nm,
        anisotropy_turn: Vec2::from_angle(m.anisotropy_rotation_deg.to_radians()).to_array(),
        anisotropy: m.anisotropy.unwrap_or(0.0),
        dispersion: m.dispersion.unwrap_or(0.0),
        textures: std::array::from_fn(slot),
        layer_textures,
        patterned: std::array::from_fn(|i| GpuPatterned::from_pattern(m.patterned.get(i))),
        ..GpuMaterial::ZERO
    }
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
