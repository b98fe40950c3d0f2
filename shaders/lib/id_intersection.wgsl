// Intersection of a ray with the triangle or capsule that a pixel names, by its ids.

#import bvh
#import surface

// Maximum distance of points of one surface from a common plane, pixel footprints.
const SAME_PLANE_PX: f32 = 3.0;

// Number of triangles and capsules tested since the invocation started, with COUNT.
var<private> march_triangles: u32 = 0u;

struct Triangle {
    corner: vec3f, // relative to the ray's origin
    edge1: vec3f,
    edge2: vec3f,
    normal: vec3f, // not normalized
}

fn triangle_of(id: vec2u, origin: vec3f) -> Triangle {
    if (COUNT) { march_triangles++; }
    let c = corners(id.x, id.y);
    let corner = to_world(c.values, c.p[0]) - origin;
    let edge1 = to_world(c.values, c.p[1]) - origin - corner;
    let edge2 = to_world(c.values, c.p[2]) - origin - corner;
    return Triangle(corner, edge1, edge2, cross(edge1, edge2));
}

// Intersection of the ray with the plane of a triangle: distance, and barycentric weights of its second and third
// vertex.
fn meet(t: Triangle, direction: vec3f) -> vec3f {
    let p = cross(direction, t.edge2);
    let determinant = dot(t.edge1, p);
    if (abs(determinant) < 1e-36) { return vec3f(-1.0); }
    let q = cross(-t.corner, t.edge1);
    return vec3f(dot(t.edge2, q), dot(-t.corner, p), dot(direction, q)) / determinant;
}

// Whether a point lies in the triangle, with a tolerance for the rounding of its barycentric weights.
fn is_inside(bary: vec2f) -> bool {
    return max(max(-bary.x, -bary.y), bary.x + bary.y - 1.0) <= 1e-5;
}

// Hit of a ray with the triangle or capsule of a pixel: distance, and barycentric weights, which lie outside the
// triangle where the ray meets only its plane, or the place on a capsule; the distance is negative where it misses the
// capsule.
fn meet_named(id: vec2u, origin: vec3f, direction: vec3f) -> vec3f {
    if (!is_capsule(id.x)) { return meet(triangle_of(id, origin), direction); }
    if (COUNT) { march_triangles++; }
    let met = capsule_hit(id.x, id.y, origin, direction, 0.0, vec2f(0.0), false);
    return vec3f(select(-1.0, met.t, met.is_met), met.place);
}
