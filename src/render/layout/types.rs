//! Structs shared with the shaders, which get them by `#import structs`.

use super::gpu_struct::gpu_struct;
use reflet_scene::desc::{MOST_CLIP_PLANES, ProbesDesc};

gpu_struct! {
    /// Uniforms of a frame; see `shaders/lib/frame.wgsl`.
    pub struct Frame = "Frame" {
        /// World to clip, reversed depth, with this sub-frame's jitter.
        clip_from_world: [[f32; 4]; 4],
        /// Planes of the camera, see `View::clip_planes`.
        clip_planes: [[f32; 4]; MOST_CLIP_PLANES],
        /// Camera position, meters.
        eye: [f32; 3],
        /// Near plane, meters.
        near_m: f32,
        /// Unit view direction.
        forward: [f32; 3],
        /// Angle of one pixel, radians; 0: orthographic.
        pixel_spread: f32,
        /// Half the picture's width at distance 1; orthographic: at any distance.
        right: [f32; 3],
        /// Maximum length of reflection rays, meters.
        ray_length_m: f32,
        /// Half the picture's height at distance 1; orthographic: at any distance.
        up: [f32; 3],
        /// Roughness below which `auto` materials reflect.
        roughness_cutoff: f32,
        /// Size of the picture, pixels.
        size: [f32; 2],
        /// Offset of this sub-frame in pixels, -0.5 to 0.5, plus the shifts of the lens.
        jitter: [f32; 2],
        /// Radiance straight up.
        zenith: [f32; 3],
        /// Number of lights in use.
        light_count: u32,
        /// Radiance at the horizon.
        horizon: [f32; 3],
        /// Maximum number of successive reflections.
        bounces: u32,
        /// Radiance straight down.
        ground: [f32; 3],
        /// 1: reflections fade along the ray.
        fade: u32,
        /// Left, top, right and bottom edge of the crop, pixels.
        crop: [f32; 4],
        /// 1: hits reuse the light visibility of the pixels that show them.
        reuse_light: u32,
        /// Minimum throughput of a path; below it the path ends.
        dimmest: f32,
        /// Width of an orthographic pixel, meters; 0: perspective.
        pixel_m: f32,
        /// Far plane of an orthographic camera, meters; 0: perspective.
        far_m: f32,
        /// 1: the march may miss surfaces that are seen edge-on.
        has_edge_on: u32,
        /// Maximum number of diffuse scatterings along a path.
        diffuse_bounces: u32,
        /// Maximum radiance that a path adds after a random choice; 0: no limit.
        glint_limit: f32,
        /// Number of lights without a size, which come first.
        hard_lights: u32,
        /// Number of moments of the sub-frame; 1: all pixels show it.
        moments: u32,
        /// Index of the moment that is rendered.
        moment: u32,
        /// 1: surfaces are resolved for the pixels of other moments too.
        whole_surfaces: u32,
        /// Number of sub-frames that show a pixel, by which the footprints of its textures are finer.
        sub_frames: f32,
        /// Extinction coefficient of the solid that the eye is in, per meter; 0: of none.
        eye_extinction: [f32; 3],
        /// Number of solids that the eye is in, 0 or 1.
        eye_solids: u32,
        /// Albedo of the isotropic scattering in the solid that the eye is in; 0: of none.
        eye_scattering: [f32; 3],
        /// Share of light samples of a point within that solid that counts; 0: none passes its surface.
        eye_lit_share: f32,
        /// Radiance that the camera sees in place of the environment.
        background: [f32; 3],
    }
}

gpu_struct! {
    /// Where the parts of a light tree begin; see `shaders/lib/light_tree.wgsl`.
    pub struct LightTree = "LightTree" {
        /// Vector of the first placed light.
        lights: u32,
        /// Vector of the first node.
        nodes: u32,
        /// Vector of the first words of triangles.
        places: u32,
        /// Link of the root; `NONE`: nothing emits light.
        root: u32,
    }
}

gpu_struct! {
    /// Sampling parameters of a sub-frame, and the panorama; see `shaders/lib/sampling.wgsl`.
    pub struct Sampling = "Sampling" {
        /// Index of the first sample of this sub-frame.
        first: u32,
        /// Number of rays towards lights per pixel and sub-frame.
        rays: u32,
        /// Cosine and sine of the panorama's rotation.
        turn: [f32; 2],
        /// Number of levels of the panorama's density table.
        density_levels: u32,
        /// Radiance of a panorama texel of 1.
        scale: f32,
        /// Index of the sub-frame, from 0.
        sample: u32,
        /// Number of sub-frames of the picture.
        samples: u32,
        /// Light tree of emissive triangles.
        light_tree: LightTree,
    }
}

gpu_struct! {
    /// A light; see `shaders/lib/frame.wgsl`.
    pub struct GpuLight = padded "Light" {
        /// Position, meters.
        position: [f32; 3],
        /// Kind of light: `LIGHT_*`.
        kind: u32,
        /// Emission direction, unit length.
        direction: [f32; 3],
        /// Shadow mode: `SHADOW_*`.
        shadow: u32,
        /// Intensity per channel, candela or lux.
        color: [f32; 3],
        /// Range, meters; 0: unlimited.
        range_m: f32,
        /// Scale of the cone falloff `saturate(cos * scale + offset)`.
        spot_scale: f32,
        /// Offset of the cone falloff; see `spot_scale`.
        spot_offset: f32,
        /// Layer of the light's shadow map.
        layer: u32,
        /// World size of a shadow texel, meters: at distance 1, or anywhere for directional lights.
        texel: f32,
        /// Transform from the world to the shadow map's clip space, for spot and directional lights.
        clip_from_world: [[f32; 4]; 4],
        /// Vector from the center of a flat light to its edge, across, meters.
        half_u: [f32; 3],
        /// Radius, meters; of directional lights half their angle, radians.
        extent: f32,
        /// Vector from the center of a flat light to its edge, along `up`, meters.
        half_v: [f32; 3],
        /// 1; 0 where the picture shows another light group.
        shown: f32,
        /// 1; 0 where reflections do not show the light.
        reflected: u32,
    }
}

gpu_struct! {
    /// An instance of a mesh; see `shaders/lib/scene.wgsl`.
    pub struct GpuInstance = padded "Instance" {
        /// Rows of the transform from object to world space.
        world_from_object: [[f32; 4]; 3],
        /// Rows of the inverse's linear part; w: translation of `world_from_object`.
        object_from_world: [[f32; 4]; 3],
        /// Root node of the mesh's BVH; `NONE` where the instance is part of the static tree.
        tree_root: u32,
        /// Traversal flags, from `world::bvh`.
        trace_flags: u32,
        /// First vertex of the mesh.
        vertex_base: u32,
        /// First index of the mesh in `mesh_data`.
        index_base: u32,
        /// Position of the first second texture coordinate in `mesh_data`; `NONE` without.
        uv1_base: u32,
        /// Index into the materials.
        material: u32,
        /// Flags: `FLAG_*`.
        flags: u32,
        /// Radius in object space of a mesh of capsules; else 0.
        capsule_radius_m: f32,
    }
}

/// Bit of [`GpuInstance::flags`]: the mesh has vertex colors.
pub const FLAG_COLORS: u32 = 1;
/// Bit of [`GpuInstance::flags`]: the transform mirrors the mesh.
pub const FLAG_MIRRORED: u32 = 2;
/// Bit of [`GpuInstance::flags`]: the surface is sampled as a light.
pub const FLAG_EMITTER: u32 = 4;
/// Bit of [`GpuInstance::flags`]: the surface's emission belongs to another light group than the shown one.
pub const FLAG_DARK: u32 = 32;
/// Bit of [`GpuInstance::flags`]: the mesh is of capsules, and its vertices have normals.
pub const FLAG_CAPSULE_NORMALS: u32 = 16;
/// Bit of [`GpuInstance::flags`]: the mesh is of capsules that are drawn at least a pixel wide.
pub const FLAG_AT_LEAST_A_PIXEL: u32 = 64;

gpu_struct! {
    /// A vertex, 32 bytes.
    pub struct GpuVertex = padded "Vertex" {
        /// Position in object space.
        position: [f32; 3],
        /// Normal, octahedral, 2 × snorm16.
        normal: u32,
        /// First texture coordinates.
        uv: [f32; 2],
        /// Tangent, octahedral; lowest bit: handedness.
        tangent: u32,
        /// Linear color, unorm8 × 4.
        color: u32,
    }
}

gpu_struct! {
    /// Settings by which a material slot samples a texture.
    pub struct GpuTextureUse = padded "TextureUse" {
        /// First row of the texture transform: u' = dot(row_u, (u, v, 1)).
        row_u: [f32; 3],
        /// Layer in its texture pool; `NONE` without a texture.
        layer: u32,
        /// Second row of the texture transform, for v'.
        row_v: [f32; 3],
        /// Pool, color space, coordinates, wrap modes and filter: `TEXTURE_*`.
        bits: u32,
        /// Width and height of the source image, pixels.
        texels: [f32; 2],
        /// Signs of the material's `uv_scale`, the directions in which u and v run; for clear coat normals times
        /// their strength.
        signs: [f32; 2],
    }
}

/// Bit of `GpuMaterial::reflection`: the reflectivity is of an index of refraction.
pub const OF_INDEX: u32 = 1 << 2;
/// Bit of `GpuMaterial::reflection`: the specular strength and color tint edges.
pub const EDGE_TINT: u32 = 1 << 3;
/// Mask of [`GpuTextureUse::bits`]: index of the pool.
pub const TEXTURE_POOL_MASK: u32 = 3;
/// Bit of [`GpuTextureUse::bits`]: the texture is sampled as sRGB.
pub const TEXTURE_SRGB: u32 = 1 << 2;
/// Bit of [`GpuTextureUse::bits`]: the second texture coordinates are used.
pub const TEXTURE_UV1: u32 = 1 << 3;
/// Position in [`GpuTextureUse::bits`] of the two bits of the wrap mode along u.
pub const TEXTURE_WRAP_U_SHIFT: u32 = 4;
/// Position in [`GpuTextureUse::bits`] of the two bits of the wrap mode along v.
pub const TEXTURE_WRAP_V_SHIFT: u32 = 6;
/// Mask of each wrap mode.
pub const TEXTURE_WRAP_MASK: u32 = 3;
/// Bit of [`GpuTextureUse::bits`]: magnification takes the nearest texel.
pub const TEXTURE_NEAREST: u32 = 1 << 8;
/// Position in [`GpuTextureUse::bits`] of the size of the pool's images, as a power of 2 times the smallest.
pub const TEXTURE_SIZE_SHIFT: u32 = 9;
/// Mask of that power.
pub const TEXTURE_SIZE_MASK: u32 = 7;
/// Bit of the wrap mode pairs in use: both axes repeat. `R` stands for repeating, `C` for clamping or mirroring.
pub const WRAPS_RR: u32 = 1;
/// Bit of the wrap mode pairs in use: only u repeats.
pub const WRAPS_RC: u32 = 2;
/// Bit of the wrap mode pairs in use: only v repeats.
pub const WRAPS_CR: u32 = 4;
/// Bit of the wrap mode pairs in use: no axis repeats.
pub const WRAPS_CC: u32 = 8;
/// Mask of all wrap mode pairs.
pub const WRAPS_ALL: u32 = WRAPS_RR | WRAPS_RC | WRAPS_CR | WRAPS_CC;
/// Wrap mode in [`GpuTextureUse::bits`]: repeat.
pub const WRAP_REPEAT: u32 = 0;
/// Wrap mode in [`GpuTextureUse::bits`]: clamp to the edge.
pub const WRAP_CLAMP: u32 = 1;
/// Wrap mode in [`GpuTextureUse::bits`]: mirrored repeat.
pub const WRAP_MIRROR: u32 = 2;

/// Maximum number of probes of a frame.
pub const MOST_PROBES: usize = ProbesDesc::MOST;
/// Share of a probe's half size within which a point lies on the border of its box.
pub const ON_BORDER: f32 = 1e-3;

/// Returns `bit` if `on`, else 0.
pub fn flag(on: bool, bit: u32) -> u32 {
    if on { bit } else { 0 }
}

/// Index value that stands for none.
pub const NONE: u32 = u32::MAX;

/// Kind of light that paths find: the light that mirror rays bring.
pub const MIRRORED_LIGHT: u32 = 0;
/// Kind of light that paths find: light behind transmissive surfaces.
pub const LIGHT_BEHIND: u32 = 1;
/// Kind of light that paths find: light that matte surfaces receive from other surfaces.
pub const RECEIVED_LIGHT: u32 = 2;
/// Kind of light that a ray of a path finds: mirrored, from behind or received, by the light that each returns.
pub const ANY_LIGHT: u32 = 3;

const _: () = assert!(size_of::<GpuVertex>() == 32 && size_of::<GpuInstance>() == 128);
