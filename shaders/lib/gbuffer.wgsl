// G-buffer access: the resolved surface of each pixel, as the surface pass wrote it. Values that it has no bits for come
// from the details pass, with a copy of the colors in one array texture: thus passes need no more sampled textures than
// every adapter has.

#import details_layout
#import frame
#import gbuffer_layout
#import shade

override HAS_DETAILS: bool = true; // else the G-buffer holds all values of surfaces

@group(2) @binding(1) var view_depth: texture_2d<f32>; // meters along the view direction; FAR_M: sky
@group(2) @binding(2) var surface: texture_2d<u32>;
@group(2) @binding(3) var colors: texture_2d<u32>;
@group(2) @binding(4) var details: texture_2d_array<u32>;

fn packed_colors(pixel: vec2u) -> vec4u {
    if (!HAS_DETAILS) { return textureLoad(colors, pixel, 0); }
    return textureLoad(details, pixel, 0, 0);
}

fn diffuse_transmission_at(pixel: vec2u) -> f32 {
    if (!HAS_DIFFUSE_TRANSMISSION) { return 0.0; }
    return with_diffuse_transmission(Surface(), textureLoad(details, pixel, 3, 0)).diffuse_transmission;
}

fn detailed(s: Surface, pixel: vec2u) -> Surface {
    if (!HAS_DETAILS) { return s; }
    var whole = with_details(s, textureLoad(details, pixel, 1, 0));
    if (!HAS_FURTHER_DETAILS) { return whole; }
    whole = with_further_details(whole, textureLoad(details, pixel, 2, 0));
    if (HAS_DIFFUSE_TRANSMISSION) { whole = with_diffuse_transmission(whole, textureLoad(details, pixel, 3, 0)); }
    return whole;
}

fn position_at(pixel: vec2u, depth_m: f32) -> vec3f {
    let center = vec2f(pixel) + 0.5;
    return pixel_origin(center) + pixel_ray(center) * depth_m;
}

fn load_surface(pixel: vec2u) -> Surface {
    var s = detailed(unpack_surface(textureLoad(surface, pixel, 0), packed_colors(pixel)), pixel);
    s.position = position_at(pixel, textureLoad(view_depth, pixel, 0).x);
    return s;
}

// Reflection ray of a pixel's surface. It is the same in every pass, since its random numbers start anew.
fn reflected_ray(pixel: vec2u, s: Surface) -> Reflected {
    start_samples(pixel, 0u);
    return reflected(view_direction(s.position), s);
}

// Whether rough reflections are smoothed over neighbors.
override SMOOTHS_REFLECTIONS: bool = false;

// Albedo of the layers whose reflections are traced.
fn reflected_albedo(s: Surface) -> vec3f {
    let view = -view_direction(s.position);
    let only = only_lobe(s, view);
    if (only.share > 0.0) { return specular_albedo(only.layer, view) * only.share; }
    let passed = coat_transmittance(s, dot(coat_normal(s), view));
    return (specular_albedo(coat_of(s), view) * s.clearcoat + specular_albedo(below_coat(s), view) * passed) * s.alpha;
}

// Light of a reflection ray as it is smoothed: the share that its pixel shows, over the albedo.
fn smoothable(s: Surface, ray: Reflected, light: vec3f) -> vec4f {
    if (!SMOOTHS_REFLECTIONS || !is_spread(s)) { return vec4f(light, 1.0); }
    return vec4f(light * ray.weight / max(reflected_albedo(s), vec3f(1e-4)), 1.0);
}
