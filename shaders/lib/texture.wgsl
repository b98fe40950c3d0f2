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

// Most look-ups along a footprint that is longer than wide.
const MOST_TAPS: f32 = 16.0;

// Number of sub-frames that sample a footprint; set for surfaces, while coverage is of single points.
var<private> footprint_samples: f32 = 1.0;
// Length of the mean of the normals that the last look-up found along its footprint.
var<private> taps_agreement: f32 = 1.0;

// Texture coordinates as all sub-frames together need them: where they see texels apart, each is flat but for an edge
// half as wide as the distance of their places, as else the filter between texels would blur the mean. The texture has
// `size_px` texels; `pixel` is the extent of a pixel along its axes, texels.
fn between_texels(uv: vec2f, size_px: f32, pixel: vec2f) -> vec2f {
    if (footprint_samples < 2.0) { return uv; }
    let edge = 1.0 - saturate(2.0 * pixel - 1.0) * (1.0 - min(0.5 * pixel / footprint_samples, vec2f(1.0)));
    let at = uv * size_px - 0.5;
    let whole = floor(at);
    let flat = (whole + 0.5 + saturate((at - whole - 0.5) / edge + 0.5)) / size_px;
    return select(flat, uv, edge >= vec2f(1.0));
}

// Samples a slot. `uv` are already transformed; `footprint` holds two conjugate diameters of a pixel's ellipse in uv
// units; `pools` is the mask of pools that this slot may be in.
fn sample_slot(slot: TextureUse, uv: vec2f, footprint: mat2x2f, pools: u32) -> vec4f {
    let pool_px = f32(SMALLEST_POOL_PX << ((slot.bits >> TEXTURE_SIZE_SHIFT) & TEXTURE_SIZE_MASK));
    let diameters = footprint * pool_px;
    // The ellipse by the eigenvalues of its matrix: squared extents along the axes of the texture, and their product.
    let extent2 = diameters[0] * diameters[0] + diameters[1] * diameters[1];
    let slant = diameters[0].x * diameters[0].y + diameters[1].x * diameters[1].y;
    let excess = 0.5 * (extent2.x - extent2.y);
    let long2 = 0.5 * (extent2.x + extent2.y) + length(vec2f(excess, slant));
    let long = sqrt(max(long2, 1e-12));
    let short = min(abs(determinant(diameters)) / long, long);
    // One sub-frame takes a disk of its share of the area, or looks up as many disks as reach to the next one's place.
    let disk = sqrt(long * short / footprint_samples);
    let reach = max(disk, long / footprint_samples);
    var width = max(min(reach, short / min(sqrt(footprint_samples), 3.0)), min(reach / MOST_TAPS, disk));
    let is_nearest = (slot.bits & TEXTURE_NEAREST) != 0u && all(sqrt(extent2 / footprint_samples) * slot.texels < vec2f(pool_px));
    let taps = select(clamp(round(reach / max(width, 1.0)), 1.0, MOST_TAPS), 1.0, is_nearest);
    width = max(width, min(reach / taps, disk));
    var axis = select(vec2f(slant, long2 - extent2.x), vec2f(long2 - extent2.y, slant), excess > 0.0);
    axis *= reach / (taps * pool_px * max(length(axis), 1e-12));
    let lod = select(max(log2(max(width, 1e-6)), 0.0), 0.0, is_nearest);
    let pixel = sqrt(extent2) * exp2(-floor(lod));
    let wrap_u = (slot.bits >> TEXTURE_WRAP_U_SHIFT) & TEXTURE_WRAP_MASK;
    let wrap_v = (slot.bits >> TEXTURE_WRAP_V_SHIFT) & TEXTURE_WRAP_MASK;
    let clamps = u32(wrap_u != WRAP_REPEAT) | (u32(wrap_v != WRAP_REPEAT) << 1u);
    let pool = slot.bits & (TEXTURE_POOL_MASK | TEXTURE_SRGB);
    var sum = vec4f(0.0);
    var lengths = 0.0;
    for (var tap = 0.5; tap < taps; tap += 1.0) {
        var at = uv + axis * (tap - 0.5 * taps);
        if (wrap_u == WRAP_MIRROR) { at.x = fold_mirror(at.x); }
        if (wrap_v == WRAP_MIRROR) { at.y = fold_mirror(at.y); }
        if (is_nearest) { at = (floor(at * slot.texels) + 0.5) / slot.texels; }
        at = between_texels(at, pool_px * exp2(-floor(lod)), pixel);
        var texel = vec4f(1.0);
        if ((pools & 1u) != 0u && pool == 0u) { texel = sample_wrapped(pool_0, at, slot.layer, lod, clamps); }
        if ((pools & 2u) != 0u && pool == TEXTURE_SRGB) { texel = sample_wrapped(pool_0_srgb, at, slot.layer, lod, clamps); }
        if ((pools & 4u) != 0u && pool == 1u) { texel = sample_wrapped(pool_1, at, slot.layer, lod, clamps); }
        if ((pools & 8u) != 0u && pool == (TEXTURE_SRGB | 1u)) { texel = sample_wrapped(pool_1_srgb, at, slot.layer, lod, clamps); }
        if ((pools & 16u) != 0u && pool == 2u) { texel = sample_wrapped(pool_2, at, slot.layer, lod, clamps); }
        if ((pools & 32u) != 0u && pool == (TEXTURE_SRGB | 2u)) { texel = sample_wrapped(pool_2_srgb, at, slot.layer, lod, clamps); }
        sum += texel;
        lengths += length(2.0 * texel.xyz - 1.0);
    }
    taps_agreement = select(1.0, length(2.0 * sum.xyz - taps) / max(lengths, 1e-6), taps > 1.0);
    return sum / taps;
}
