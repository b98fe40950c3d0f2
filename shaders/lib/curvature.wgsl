// Curvature of triangles by their vertex normals, and the smooth surface that those describe.

// Mean curvature of a triangle of twice this area in the world, from its vertex normals: the turn of the normal
// along each edge, averaged over the three.
fn mean_curvature(p: array<vec3f, 3>, normals: array<vec3f, 3>, area2_world: f32) -> f32 {
    let e = array<vec3f, 3>(p[1] - p[0], p[2] - p[1], p[0] - p[2]);
    let turns = array<vec3f, 3>(normals[1] - normals[0], normals[2] - normals[1], normals[0] - normals[2]);
    var sum = 0.0;
    for (var k = 0; k < 3; k++) { sum += dot(turns[k], e[k]) / max(dot(e[k], e[k]), 1e-30); }
    return sum / 3.0 * sqrt(length(cross(e[0], e[1])) / area2_world);
}

// Minimum lift of smooth surfaces, m, so that they are known as smooth at their vertices too.
const LEAST_LIFT_M: f32 = 1e-6;

// Height over the triangle, along its normal, of the smooth surface whose tangent planes at the vertices belong to the
// vertex normals (Hanika 2021, "Hacking the Shadow Terminator"); 0 where it is nowhere above.
fn smooth_lift(p: array<vec3f, 3>, normals: array<vec3f, 3>, weights: vec3f, normal: vec3f, area2_world: f32) -> f32 {
    let point = p[0] * weights.x + p[1] * weights.y + p[2] * weights.z;
    var offset = vec3f(0.0);
    for (var k = 0; k < 3; k++) { offset -= normals[k] * (min(dot(point - p[k], normals[k]), 0.0) * weights[k]); }
    let area2 = length(cross(p[1] - p[0], p[2] - p[0]));
    return max(dot(offset, normal), 0.0) / max(length(normal), 1e-20) * sqrt(area2_world / max(area2, 1e-30));
}
