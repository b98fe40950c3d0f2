// Tone: linear radiance to display color.

#import constants
#import tone_params

@group(2) @binding(0) var color: texture_2d<f32>;
@group(2) @binding(1) var display: texture_storage_2d<rgba8unorm, write>;
@group(2) @binding(2) var<uniform> params: Params;

@group(2) @binding(3) var coverage_sum: texture_2d<f32>;

// Whether the background is transparent: the picture has an alpha channel.
override HAS_ALPHA: bool = false;

// Khronos PBR Neutral Tone Mapper, specification of 2024.
fn neutral(c_in: vec3f) -> vec3f {
    let start = 0.8 - 0.04;
    let darkest = min(min(c_in.x, 0.08), min(c_in.y, c_in.z));
    let c = c_in - (darkest - 6.25 * darkest * darkest);
    let peak = max(c.x, max(c.y, c.z));
    if (peak < start) { return c; }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let gray = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    return mix(c * (new_peak / peak), vec3f(new_peak), gray);
}

// Hill 2016, BakingLab: fit of the Academy's reference rendering and display transforms (ACES).
fn aces(c: vec3f) -> vec3f {
    let film = vec4f(c, 0.0) * params.inset;
    let curve = (film * (film + 0.0245786) - 0.000090537) / (film * (0.983729 * film + 0.4329510) + 0.238081);
    return vec4f(curve, 0.0) * params.outset;
}

// Troy Sobotka's AgX with its default look, by the fit of Wrensch 2023, "Minimal AgX Implementation".
fn agx(c: vec3f) -> vec3f {
    let inset = vec4f(c, 0.0) * params.inset;
    let stops = clamp(log2(max(inset, vec3f(1e-10))), vec3f(-12.47393), vec3f(4.026069));
    let x = (stops + 12.47393) / (4.026069 + 12.47393);
    let x2 = x * x;
    let x4 = x2 * x2;
    let curve = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    return pow(max(vec4f(curve, 0.0) * params.outset, vec3f(0.0)), vec3f(2.2));
}

// IEC 61966-2-1.
fn srgb(c: vec3f) -> vec3f {
    return select(1.055 * pow(c, vec3f(1.0 / 2.4)) - 0.055, c * 12.92, c <= vec3f(0.0031308));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= textureDimensions(color))) { return; }
    var sum = max(textureLoad(color, id.xy, 0), vec4f(0.0));
    var alpha = 1.0;
    if (HAS_ALPHA) {
        // The display color is not premultiplied by alpha, so that the sum is divided by it.
        alpha = saturate(textureLoad(coverage_sum, id.xy, 0).x * params.sample_share);
        sum /= max(alpha, 1e-6);
    }
    var c = sum.xyz * params.scale;
    switch params.curve {
        case TONE_NEUTRAL: { c = neutral(c); }
        case TONE_ACES: { c = aces(c); }
        case TONE_AGX: { c = agx(c); }
        default: {}
    }
    // Unlit materials are not exposed and not tone-mapped.
    if (sum.w > 0.0) { c = mix(c, sum.xyz * params.sample_share, sum.w * params.sample_share); }
    textureStore(display, id.xy, vec4f(srgb(saturate(c)), alpha));
}
