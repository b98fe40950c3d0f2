// Variant without layers: nothing is transmitted, and surfaces have no clear coat.

#import bvh
#import frame

const HAS_TRANSMISSION: bool = false;

fn mirrors_inside(s: Surface) -> bool {
    return false;
}

fn is_transmissive(s: Surface) -> bool {
    return false;
}

fn has_traced_coat(s: Surface) -> bool {
    return false;
}

fn reflected_roughness(s: Surface) -> f32 {
    return s.roughness;
}

fn reflected_normal(s: Surface) -> vec3f {
    return s.normal;
}

fn reflected_share(s: Surface) -> f32 {
    return 1.0;
}

fn transmissive_fresnel(s: Surface, cosine: f32) -> vec3f {
    return vec3f(0.0);
}

// Share of the emission at a point of a triangle that leaves the surface at this cosine.
fn emitted_share(material: u32, instance: u32, index: array<u32, 3>, bary: vec2f, cosine: f32) -> f32 {
    return 1.0;
}

fn shade(s: Surface, view: vec3f, lent: vec2u) -> Shade {
    return shade_layer(s, view, lent);
}

fn reflected(direction: vec3f, s: Surface) -> Reflected {
    return lobe_ray(direction, s);
}

fn only_lobe(s: Surface, view: vec3f) -> OnlyLobe {
    return OnlyLobe(s, 1.0);
}

// Next ray of a path from a surface that it has hit.
fn onward(before: Reflected, s: Surface) -> Reflected {
    var ray = lobe_ray(before.direction, s);
    ray.weight *= before.kept;
    return ray;
}

fn onward_origin(s: Surface, direction: vec3f) -> vec3f {
    return ray_origin(s.position, s.geometric_normal);
}

fn through(direction: vec3f, s: Surface) -> Reflected {
    return Reflected(direction, vec3f(0.0), 0.0, 1.0, 1.0, s.normal);
}

// Number of passages through surfaces, which do not count as bounces.
fn crossings() -> u32 {
    return 0u;
}

fn start_path(position: vec3f, is_inside: bool) {}

// Whether the path is within a transmissive solid.
fn is_in_solid() -> bool {
    return false;
}

// Share of light that is left after a distance in the current medium.
fn medium_transmittance(distance_m: f32) -> f32 {
    return 1.0;
}

// Share of light that arrives along a ray.
fn transmittance(origin: vec3f, direction: vec3f, distance_m: f32) -> vec3f {
    return vec3f(select(1.0, 0.0, trace_any(origin, direction, 0.0, distance_m)));
}

// Share of the light scattered below the surface's layers that leaves them towards the view.
fn scattered_share(s: Surface, view: vec3f) -> f32 {
    return 1.0;
}

// Approximate albedo of the directions in which paths continue.
fn onward_albedo(s: Surface, view: vec3f) -> f32 {
    return luminance(fresnel(s, dot(s.normal, view)));
}

fn leave_vertex(position: vec3f) {}

// Share of a pixel that its surface covers.
fn coverage(s: Surface) -> f32 {
    return 1.0;
}
