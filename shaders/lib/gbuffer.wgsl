// G-buffer access: the resolved surface of each pixel, as the surface pass wrote it.

#import details
#import frame
#import gbuffer_layout
#import shade

@group(2) @binding(1) var view_depth: texture_2d<f32>; // meters along the view direction; FAR_M: sky
@group(2) @binding(2) var surface: texture_2d<u32>;

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
