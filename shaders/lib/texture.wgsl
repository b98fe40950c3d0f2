// Texture look-ups by material slot: pools of layers of one size, wrap modes, level of detail.

#import scene

// Pools that each slot of a material samples, POOL_BITS per slot in their order: bit 2k for pool k linear, bit 2k + 1
// for pool k as sRGB. Some drivers sample every texture that a branch might, so each pool that is left out saves time.
override SLOT_POOLS: u32 = 0x3fffffffu;
// Pools that layer textures sample: POOL_BITS for all of them together.
override LAYER_POOLS: u32 = 63u;
override WRAPS: u32 = WRAPS_ALL; // bit per sampler, WRAPS_*

fn fold_mirror(x: f32) -> f32 {
    let m = abs(x) % 2.0;
    return select(m, 2.0 - m, m > 1.0);
}

// Samples a `texture_2d_array` with the sampler of the requested wrap modes. A mirrored axis was folded into [0, 1]
// before; there clamping equals mirroring, texel for texel.
fn sample_wrapped(t: texture_2d_array<f32>, uv: vec2f, layer: u32, lod: f32, clamps: u32) -> vec4f {
    if ((WRAPS & WRAPS_RR) != 0u && clamps == 0u) {
        return textureSampleLevel(t, sampler_rr, uv, layer, lod);
    }
    if ((WRAPS & WRAPS_RC) != 0u && clamps == 2u) {
        return textureSampleLevel(t, sampler_rc, uv, layer, lod);
    }
    if ((WRAPS & WRAPS_CR) != 0u && clamps == 1u) {
        return textureSampleLevel(t, sampler_cr, uv, layer, lod);
    }
    if ((WRAPS & WRAPS_CC) != 0u && clamps == 3u) {
        return textureSampleLevel(t, sampler_cc, uv, layer, lod);
    }
    return vec4f(1.0);
}

// Pools that a slot samples, as a mask.
fn pools_of(slot: u32) -> u32 {
    return (SLOT_POOLS >> (POOL_BITS * slot)) & ((1u << POOL_BITS) - 1u);
}

// Number of sub-frames that sample a footprint; set for surfaces, while coverage is of single points.
var<private> footprint_samples: f32 = 1.0;

// Texture coordinates as all sub-frames together need them: where they see texels apart, each is flat but for an edge
// half as wide as the distance of their places, as else the filter between texels would blur the mean. The texture has
// `size_px` texels; `footprint` is one sub-frame's.
fn between_texels(uv: vec2f, size_px: f32, footprint: f32) -> vec2f {
    if (footprint_samples < 2.0) { return uv; }
    let pixel = footprint * size_px * sqrt(footprint_samples); // the pixel's width, texels
    let edge = 1.0 - saturate(2.0 * pixel - 1.0) * (1.0 - min(0.5 * pixel / footprint_samples, 1.0));
    if (edge >= 1.0) { return uv; }
    let at = uv * size_px - 0.5;
    let whole = floor(at);
    return (whole + 0.5 + saturate((at - whole - 0.5) / edge + 0.5)) / size_px;
}

// Samples a slot. `uv` are already transformed; `footprint` is the width of the ray cone in uv units; `pools` is the
// mask of pools that this slot may be in.
fn sample_slot(slot: TextureUse, uv_in: vec2f, footprint: f32, pools: u32) -> vec4f {
    var uv = uv_in;
    let wrap_u = (slot.bits >> TEXTURE_WRAP_U_SHIFT) & TEXTURE_WRAP_MASK;
    let wrap_v = (slot.bits >> TEXTURE_WRAP_V_SHIFT) & TEXTURE_WRAP_MASK;
    if (wrap_u == WRAP_MIRROR) { uv.x = fold_mirror(uv.x); }
    if (wrap_v == WRAP_MIRROR) { uv.y = fold_mirror(uv.y); }
    let clamps = u32(wrap_u != WRAP_REPEAT) | (u32(wrap_v != WRAP_REPEAT) << 1u);
    let pool_px = f32(SMALLEST_POOL_PX << ((slot.bits >> TEXTURE_SIZE_SHIFT) & TEXTURE_SIZE_MASK));
    var lod = max(log2(max(footprint * pool_px, 1e-6)), 0.0);
    if ((slot.bits & TEXTURE_NEAREST) != 0u && footprint * max(slot.texels.x, slot.texels.y) < 1.0) {
        uv = (floor(uv * slot.texels) + 0.5) / slot.texels;
        lod = 0.0;
    }
    uv = between_texels(uv, pool_px * exp2(-floor(lod)), footprint);
    let pool = slot.bits & (TEXTURE_POOL_MASK | TEXTURE_SRGB);
    if ((pools & 1u) != 0u && pool == 0u) { return sample_wrapped(pool_0, uv, slot.layer, lod, clamps); }
    if ((pools & 2u) != 0u && pool == TEXTURE_SRGB) { return sample_wrapped(pool_0_srgb, uv, slot.layer, lod, clamps); }
    if ((pools & 4u) != 0u && pool == 1u) { return sample_wrapped(pool_1, uv, slot.layer, lod, clamps); }
    if ((pools & 8u) != 0u && pool == (TEXTURE_SRGB | 1u)) { return sample_wrapped(pool_1_srgb, uv, slot.layer, lod, clamps); }
    if ((pools & 16u) != 0u && pool == 2u) { return sample_wrapped(pool_2, uv, slot.layer, lod, clamps); }
    if ((pools & 32u) != 0u && pool == (TEXTURE_SRGB | 2u)) { return sample_wrapped(pool_2_srgb, uv, slot.layer, lod, clamps); }
    return vec4f(1.0);
}
