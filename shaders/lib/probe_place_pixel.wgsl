// Variant that chooses probes by the point that a pixel shows.

#import surface

fn choosing_point(pixel: vec2u, s: Surface) -> vec3f {
    return s.position;
}
