// Compose: diffuse and specular of the view, with the found reflection in place of the mirror term; adds
// the picture to the sum of the sub-frames before it.

#import compose_params
#import gbuffer
#import cause

@group(2) @binding(5) var radiance: texture_2d<f32>;
@group(2) @binding(6) var specular: texture_2d<f32>;
@group(2) @binding(7) var reflection: texture_2d<f32>;
@group(2) @binding(8) var transmitted_light: texture_2d<f32>;
@group(2) @binding(9) var fog_light: texture_2d<f32>; // w: transmittance
@group(2) @binding(10) var indirect_light: texture_2d<f32>;
@group(2) @binding(11) var cause: texture_2d<u32>;
@group(2) @binding(12) var hit: texture_2d_array<u32>;
@group(2) @binding(13) var previous: texture_2d<f32>;
@group(2) @binding(14) var color: texture_storage_2d<rgba32float, write>; // w: sum of display color shares
@group(2) @binding(15) var<uniform> params: Params;

// The paper's attenuation: a reflection fades into the environment towards the maximum ray length.
fn faded(pixel: vec2u, direction: vec3f, found: vec3f) -> vec3f {
    if (frame.fade == 0u) { return found; }
    let at = vec2u(textureLoad(hit, pixel, 0, 0).x, textureLoad(hit, pixel, 1, 0).x);
    if (at.y == NONE) { return found; }
    let rest = saturate(1.0 - bitcast<f32>(at.x) / frame.ray_length_m);
    return mix(environment(direction), found, rest);
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = moment_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    let lit = textureLoad(radiance, pixel, 0);
    var out = lit.xyz + textureLoad(specular, pixel, 0).xyz;
    var unlit = lit.w;
    if (HAS_TRANSMISSION) { out += textureLoad(transmitted_light, pixel, 0).xyz; }
    if (HAS_INDIRECT) { out += textureLoad(indirect_light, pixel, 0).xyz; }
    if (HAS_REFLECTIONS && reflects(textureLoad(cause, pixel, 0).x)) {
        let s = load_surface(pixel);
        let ray = reflected_ray(pixel, s);
        var weight = ray.weight;
        if (SMOOTHS_REFLECTIONS && is_spread(s)) { weight = max(reflected_albedo(s), vec3f(1e-4)); }
        out += weight * faded(pixel, ray.direction, textureLoad(reflection, pixel, 0).xyz);
    }
    if (HAS_LAYERS && any(frame.eye_extinction > vec3f(0.0))) {
        // About as much light as is scattered away on the way to the eye is scattered into it.
        out *= exp(-frame.eye_extinction * (1.0 - frame.eye_scattering) * textureLoad(view_depth, pixel, 0).x * length(pixel_ray(vec2f(pixel) + 0.5)));
    }
    if (HAS_FOG) {
        let air = textureLoad(fog_light, pixel, 0);
        out = out * air.w + air.xyz;
        unlit *= air.w;
    }
    if (params.sample > 0u) {
        let before = textureLoad(previous, pixel, 0);
        out += before.xyz;
        unlit += before.w;
    }
    textureStore(color, pixel, vec4f(out, unlit));
}
