// Tone: linear radiance to display color.

#import constants

struct Params {
    scale: f32, // exposure over the number of sub-frames
    curve: u32, // TONE_*
    sample_share: f32, // one over the number of sub-frames
    pad0: u32,
}

@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(1) var display: texture_storage_2d<rgba8unorm, write>;
@group(2) @binding(2) var<uniform> params: Params;

// Khronos PBR Neutral Tone Mapper, specification of 2024.
fn neutral(c_in: vec3f) -> vec3f {
    let start = 0.8 - 0.04;
    let darkest = min(c_in.x, min(c_in.y, c_in.z));
    let offset = select(0.04, darkest - 6.25 * darkest * darkest, darkest < 0.08);
    let c = c_in - offset;
    let peak = max(c.x, max(c.y, c.z));
    if (peak < start) { return c; }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let gray = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    return mix(c * (new_peak / peak), vec3f(new_peak), gray);
}

// Narkowicz 2015, "ACES Filmic Tone Mapping Curve".
fn aces(c: vec3f) -> vec3f {
    return saturate((c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14));
}

// IEC 61966-2-1.
fn srgb(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, c * 12.92, c <= vec3f(0.0031308));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(color))) { return; }
    let sum = max(textureLoad(color, id.xy, 0), vec4f(0.0));
    var c = sum.xyz * params.scale;
    switch params.curve {
        case TONE_NEUTRAL: { c = neutral(c); }
        case TONE_ACES: { c = aces(c); }
        default: {}
    }
    // Unlit materials are not exposed and not tone-mapped.
    if (sum.w > 0.0) { c = mix(c, sum.xyz * params.sample_share, sum.w * params.sample_share); }
    textureStore(display, id.xy, vec4f(srgb(saturate(c)), 1.0));
}
