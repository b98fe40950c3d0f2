// Guides: color and normal of the surfaces that pixels show, for a denoiser; added to the sums of the sub-frames
// before, so that edges in them are as smooth as in the picture.

#import cause
#import gbuffer
#import guides_params

@group(2) @binding(5) var cause: texture_2d<u32>;
@group(2) @binding(6) var hit: texture_2d_array<u32>;
@group(2) @binding(7) var guides: texture_storage_2d_array<r32float, read_write>; // red, green, blue; x, y, z
@group(2) @binding(8) var<uniform> params: Params;

// Color of the surface of a pixel, in sharp mirrors with the color of the reflected surface, white for the environment,
// by the share that they reflect.
fn color_of(pixel: vec2u, s: Surface) -> vec3f {
    if (!HAS_REFLECTIONS || s.roughness >= SHARP_ROUGHNESS || !reflects(textureLoad(cause, pixel, 0).x)) { return s.base_color + s.emission; }
    let instance = textureLoad(hit, pixel, 1, 0).x;
    var seen = vec3f(1.0);
    if (instance != NONE) {
        let m = instance_material(instance);
        seen = min(material_base_color(m).xyz + material_emission(m), seen);
    }
    let reflected = fresnel(s, -dot(s.normal, view_direction(s.position)));
    return reflected * seen + (1.0 - reflected) * (1.0 - s.metallic) * s.base_color + s.emission;
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = moment_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    var color = vec3f(0.0);
    var normal = vec3f(0.0);
    if (textureLoad(view_depth, pixel, 0).x < FAR_M) {
        let s = load_surface(pixel);
        color = min(color_of(pixel, s), vec3f(1.0));
        normal = s.normal;
    }
    let values = array<f32, 6>(color.x, color.y, color.z, normal.x, normal.y, normal.z);
    for (var layer = 0u; layer < 6u; layer++) {
        var sum = values[layer];
        if (params.sample > 0u) { sum += textureLoad(guides, pixel, layer).x; }
        textureStore(guides, pixel, layer, vec4f(sum, 0.0, 0.0, 0.0));
    }
}
