//! Structs shared with the shaders; a test compares each with naga's layout of the WGSL struct of
//! the same name.

use bytemuck::{Pod, Zeroable};

use crate::world::{CORE_SLOTS, LAYER_SLOTS};

/// Layout of a shared struct in Rust.
#[derive(Clone, Copy, Debug)]
pub struct StructSpec {
    /// Name of the WGSL struct.
    pub name: &'static str,
    /// Bytes.
    pub size: usize,
    /// Name, offset and bytes of each field, in order.
    pub fields: &'static [(&'static str, usize, usize)],
}

/// Declares a struct shared with the shaders: `repr(C)`, plain bytes, and its layout for the test.
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $vis:vis struct $name:ident = $wgsl:literal {
        $($(#[$field_meta:meta])* $field:ident: $ty:ty,)*
    }) => {
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        $vis struct $name {
            $($(#[$field_meta])* pub $field: $ty,)*
        }

        impl $name {
            /// The struct as the shaders must declare it.
            pub const LAYOUT: $crate::render::types::StructSpec = $crate::render::types::StructSpec {
                name: $wgsl,
                size: size_of::<$name>(),
                fields: &[$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$ty>()),)*],
            };
        }
    };
}
pub(crate) use gpu_struct;

gpu_struct! {
    /// Uniforms of a frame; see `shaders/lib/frame.wgsl`.
    pub struct Frame = "Frame" {
        /// World to clip, reversed depth, with this sub-frame's jitter.
        clip_from_world: [[f32; 4]; 4],
        /// Camera position, meters.
        eye: [f32; 3],
        /// Near plane, meters.
        near_m: f32,
        /// Unit view direction.
        forward: [f32; 3],
        /// Radians that one pixel spans; 0: orthographic.
        pixel_spread: f32,
        /// Half the picture's width, at distance 1 or, if orthographic, at any.
        right: [f32; 3],
        /// Longest reflection ray, meters.
        ray_length_m: f32,
        /// Half its height.
        up: [f32; 3],
        /// `auto` materials reflect below it.
        roughness_cutoff: f32,
        /// Pixels.
        size: [f32; 2],
        /// Sub-pixel shift, -0.5 to 0.5.
        jitter: [f32; 2],
        /// Radiance straight up.
        zenith: [f32; 3],
        /// Lights in use.
        light_count: u32,
        /// Radiance at the horizon.
        horizon: [f32; 3],
        /// Most reflections in a row.
        bounces: u32,
        /// Radiance straight down.
        ground: [f32; 3],
        /// 1: reflections fade along the ray.
        fade: u32,
        /// 1: hits take from the picture which lights reach them.
        reuse_light: u32,
        /// Share of light that a bounce must carry to be seen.
        dimmest: f32,
        /// Width of an orthographic pixel, meters; 0: perspective.
        pixel_m: f32,
        /// Depth where an orthographic clip space ends, meters; 0: perspective.
        far_m: f32,
        /// 1: rays on the screen may pass surfaces that are seen edge-on.
        has_edge_on: u32,
        /// Times that matte surfaces scatter along a path.
        diffuse_bounces: u32,
        /// Radiance that paths add past a chance; 0: no limit.
        glint_limit: f32,
        /// Lights without a size, the first ones.
        hard_lights: u32,
    }
}

gpu_struct! {
    /// Samples of a sub-frame, and the panorama; see `shaders/lib/sampling.wgsl`.
    pub struct Sampling = "Sampling" {
        /// Of this sub-frame's samples.
        first: u32,
        /// Of a pixel and sub-frame.
        rays: u32,
        /// Of the light that the panorama's density holds.
        panorama_share: f32,
        /// Levels of that density.
        density_levels: u32,
        /// Cosine and sine of the panorama's rotation.
        turn: [f32; 2],
        /// Radiance of a texel of 1.
        scale: f32,
        /// The sub-frame, from 0.
        sample: u32,
        /// Sub-frames of a picture.
        samples: u32,
        /// Triangles that light.
        emitters: u32,
        /// Of all of them: areas by the luminance that they emit.
        emitted_power: f32,
        /// Unused.
        pad0: u32,
    }
}

gpu_struct! {
    /// A light; see `shaders/lib/frame.wgsl`.
    pub struct GpuLight = "Light" {
        /// Meters.
        position: [f32; 3],
        /// `LIGHT_*`.
        kind: u32,
        /// Emission direction, unit length.
        direction: [f32; 3],
        /// `SHADOW_*`.
        shadow: u32,
        /// Candela or lux per channel.
        color: [f32; 3],
        /// Meters; 0 is endless.
        range_m: f32,
        /// Cone falloff: `saturate(cos * scale + offset)`.
        spot_scale: f32,
        /// See `spot_scale`.
        spot_offset: f32,
        /// Layer of its shadow map.
        layer: u32,
        /// World size of a shadow texel: at distance 1, or anywhere for directional lights.
        texel: f32,
        /// World to shadow map, for spot and directional lights.
        clip_from_world: [[f32; 4]; 4],
        /// From the middle of a flat light to its edge, across.
        half_u: [f32; 3],
        /// Radius, meters; of directional lights half the angle that they span, radians.
        extent: f32,
        /// From the middle of a flat light to its edge, along `up`.
        half_v: [f32; 3],
        /// Unused.
        pad0: u32,
    }
}

gpu_struct! {
    /// A placed mesh; see `shaders/lib/scene.wgsl`.
    pub struct GpuInstance = "Instance" {
        /// Three rows.
        world_from_object: [[f32; 4]; 3],
        /// Rows of the inverse's linear part; w: the translation of the placement.
        object_from_world: [[f32; 4]; 3],
        /// Root of its mesh's tree; `NONE` where it is part of the static tree.
        tree_root: u32,
        /// Traversal flags, from `world::bvh`.
        trace_flags: u32,
        /// First vertex.
        vertex_base: u32,
        /// First index in `mesh_data`.
        index_base: u32,
        /// First second texture coordinate in `mesh_data`; `NONE` without.
        uv1_base: u32,
        /// Index into the materials.
        material: u32,
        /// `FLAG_*`.
        flags: u32,
        /// Unused.
        pad: u32,
    }
}

/// [`GpuInstance::flags`]: the mesh has vertex colors.
pub const FLAG_COLORS: u32 = 1;
/// [`GpuInstance::flags`]: the transform mirrors.
pub const FLAG_MIRRORED: u32 = 2;
/// [`GpuInstance::flags`]: what it emits lights what is around.
pub const FLAG_EMITTER: u32 = 4;

gpu_struct! {
    /// A vertex, 32 bytes.
    pub struct GpuVertex = "Vertex" {
        /// Object space.
        position: [f32; 3],
        /// Octahedral, 2 × snorm16.
        normal: u32,
        /// First texture coordinates.
        uv: [f32; 2],
        /// Octahedral; lowest bit: handedness.
        tangent: u32,
        /// unorm8 × 4, linear.
        color: u32,
    }
}

gpu_struct! {
    /// How a material slot samples a texture.
    pub struct GpuTextureUse = "TextureUse" {
        /// u' = dot(row_u, (u, v, 1)).
        row_u: [f32; 3],
        /// Layer in its pool; `NONE` without a texture.
        layer: u32,
        /// v' likewise.
        row_v: [f32; 3],
        /// `TEXTURE_*`.
        bits: u32,
        /// Size of the source image.
        texels: [f32; 2],
        /// Signs of the material's `uv_scale`: which way its u and v run; of a clear coat's normals times their
        /// strength.
        signs: [f32; 2],
    }
}

/// [`GpuTextureUse::bits`]: the pool.
pub const TEXTURE_POOL_MASK: u32 = 3;
/// [`GpuTextureUse::bits`]: sampled as sRGB.
pub const TEXTURE_SRGB: u32 = 1 << 2;
/// [`GpuTextureUse::bits`]: by the second texture coordinates.
pub const TEXTURE_UV1: u32 = 1 << 3;
/// [`GpuTextureUse::bits`]: where the two bits of the wrap mode along u begin.
pub const TEXTURE_WRAP_U_SHIFT: u32 = 4;
/// [`GpuTextureUse::bits`]: where those along v begin.
pub const TEXTURE_WRAP_V_SHIFT: u32 = 6;
/// [`GpuTextureUse::bits`]: magnification takes the nearest texel.
pub const TEXTURE_NEAREST: u32 = 1 << 8;
/// Wrap mode in [`GpuTextureUse::bits`].
pub const WRAP_REPEAT: u32 = 0;
/// Wrap mode in [`GpuTextureUse::bits`].
pub const WRAP_CLAMP: u32 = 1;
/// Wrap mode in [`GpuTextureUse::bits`].
pub const WRAP_MIRROR: u32 = 2;

gpu_struct! {
    /// A material; see `shaders/lib/scene.wgsl`.
    pub struct GpuMaterial = "Material" {
        /// Linear, alpha in w.
        base_color: [f32; 4],
        /// Linear radiance.
        emission: [f32; 3],
        /// 0 to 1.
        metallic: f32,
        /// Perceptual.
        roughness: f32,
        /// At normal incidence.
        reflectivity: f32,
        /// Of the normal map.
        normal_scale: f32,
        /// Of the occlusion map.
        occlusion_strength: f32,
        /// First checker color.
        checker_a: [f32; 3],
        /// 0: no checker.
        checker_size_m: f32,
        /// Second checker color.
        checker_b: [f32; 3],
        /// Below 0: opaque.
        alpha_cutoff: f32,
        /// 0 none, 1 auto, 2 mirror.
        reflection: u32,
        /// 1: the base color is shown as it is.
        unlit: u32,
        /// Share of what is not reflected.
        transmission: f32,
        /// Strength of the clear coat.
        clearcoat: f32,
        /// Per meter inside of a solid.
        absorption: [f32; 3],
        /// Index of refraction.
        ior: f32,
        /// Perceptual.
        clearcoat_roughness: f32,
        /// 1: what passes is refracted and absorbed.
        is_solid: u32,
        /// 1: its alpha is the share of light that it stops.
        is_blended: u32,
        /// [`PatternKind`](crate::scene::desc::PatternKind) of the checker's colors and size.
        pattern: u32,
        /// Factor on the reflectivity.
        specular_color: [f32; 3],
        /// Factor on the reflectivity and on what is reflected at grazing angles.
        specular: f32,
        /// Of the sheen; black: none.
        sheen_color: [f32; 3],
        /// Perceptual.
        sheen_roughness: f32,
        /// Of the thin film.
        iridescence: f32,
        /// Its index of refraction.
        iridescence_ior: f32,
        /// Its thickness where a texture is 0, nanometers.
        iridescence_least_nm: f32,
        /// The same where it is 1.
        iridescence_thickness_nm: f32,
        /// Cosine and sine of the direction of the anisotropy, from the tangent.
        anisotropy_turn: [f32; 2],
        /// Strength.
        anisotropy: f32,
        /// 20 over the Abbe number.
        dispersion: f32,
        /// Base color, metallic-roughness, normal, occlusion, emission.
        textures: [GpuTextureUse; CORE_SLOTS],
        /// In the order of [`LayerTexture`](crate::world::LayerTexture).
        layer_textures: [GpuTextureUse; LAYER_SLOTS],
    }
}

/// By how many times the roughness up to which metals reflect is higher than that of dielectrics, less one.
pub const METAL_REACH: f32 = 4.0;

/// `bit` if set.
pub fn flag(on: bool, bit: u32) -> u32 {
    if on { bit } else { 0 }
}

/// Index value for none.
pub const NONE: u32 = u32::MAX;

/// Structs of the shared groups, for the layout test; each pass adds its own `Params`.
pub const SHARED: &[StructSpec] = &[
    Frame::LAYOUT,
    Sampling::LAYOUT,
    GpuLight::LAYOUT,
    GpuInstance::LAYOUT,
    GpuVertex::LAYOUT,
    GpuTextureUse::LAYOUT,
    GpuMaterial::LAYOUT,
];

const _: () = assert!(size_of::<GpuVertex>() == 32 && size_of::<GpuInstance>() == 128);

/// The lights' uniform block, always full size.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct LightBlock {
    /// Unused entries are zero.
    pub lights: [GpuLight; crate::world::MAX_LIGHTS],
}
