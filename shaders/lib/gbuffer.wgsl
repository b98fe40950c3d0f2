// The resolved surface of each pixel, as the surface pass wrote it.

#import frame
#import pack
#import shade

@group(2) @binding(0) var view_depth: texture_2d<f32>; // meters along the view direction; FAR_M: sky
@group(2) @binding(1) var surface: texture_2d<u32>;
@group(2) @binding(2) var colors: texture_2d<u32>;

fn position_at(pixel: vec2u, depth_m: f32) -> vec3f {
    return frame.eye + pixel_ray(vec2f(pixel) + 0.5) * depth_m;
}

fn load_surface(pixel: vec2u) -> Surface {
    var s: Surface;
    let bits = textureLoad(surface, pixel, 0);
    let packed = textureLoad(colors, pixel, 0);
    let base = vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
    let roughness_metallic = unpack2x16float(bits.z);
    s.position = position_at(pixel, textureLoad(view_depth, pixel, 0).x);
    s.normal = unpack_unit(bits.x);
    s.geometric_normal = unpack_unit(bits.y);
    s.base_color = base.xyz;
    s.occlusion = base.w;
    s.roughness = roughness_metallic.x;
    s.metallic = roughness_metallic.y;
    s.reflectivity = unpack2x16float(bits.w).x;
    s.reflection = bits.w >> 16u;
    s.emission = vec3f(unpack2x16float(packed.z), unpack2x16float(packed.w).x);
    return s;
}
