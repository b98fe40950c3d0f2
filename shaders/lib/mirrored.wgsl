// Light that the mirror ray of a pixel brings.

#import gbuffer
#import indirect

fn mirrored_light(pixel: vec2u, first: Surface, ray: Reflected, origin: vec3f) -> vec4f {
    start_path(first.position, first.is_inside);
    var start = Start(ray, origin, Surface());
    start.ray.weight = vec3f(1.0); // the pixel's surface weighs its reflection
    let cone = mirrored_cone(pixel_cone(distance(first.position, frame.eye)), first.curvature);
    return smoothable(first, ray, gathered_by_path(pixel, 1u, 0u, start, cone, false).xyz);
}
