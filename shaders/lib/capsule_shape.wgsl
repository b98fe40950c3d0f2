// Shapes around capsules that are drawn: a few triangles around each, in which every pixel tests its ray against the
// capsule. They are built in object space, where the capsule is not squeezed.

#import capsule
#import surface

// Whether the pipeline draws spheres, as squares that face the eye; other capsules are boxes of which the back faces
// are drawn, so that the eye may be inside.
override SPHERES: bool = false;

// Capsule of a drawn vertex.
fn capsule_of_vertex(vertex: u32) -> u32 {
    return vertex / select(BOX_CORNERS, SQUARE_CORNERS, SPHERES);
}

// Place of a drawn vertex on its square, of side 2 around the middle. Corners 0, 1, 2, 0, 2, 3 of a square.
fn square_place(vertex: u32) -> vec2f {
    let around = (0xe24u >> ((vertex % SQUARE_CORNERS) * 2u)) & 3u;
    return vec2f(f32(around == 1u || around == 2u), f32(around >= 2u)) * 2.0 - 1.0;
}

// Position in the world of a drawn vertex. `eye` is that of the view, or with w = 0 the direction of all its rays.
fn capsule_vertex(instance: u32, vertex: u32, eye: vec4f) -> vec3f {
    let c = corners(instance, capsule_of_vertex(vertex));
    let axis = c.p[1] - c.p[0];
    let radius = instance_capsule_radius_m(instance);
    let side = square_place(vertex);
    if (SPHERES) {
        let rows = instance_object_from_world(instance);
        let from_eye = eye.xyz - eye.w * vec3f(rows[0].w, rows[1].w, rows[2].w);
        let seen = vec3f(dot(rows[0].xyz, from_eye), dot(rows[1].xyz, from_eye), dot(rows[2].xyz, from_eye));
        let view = select(seen, c.p[0] - seen, eye.w > 0.0);
        // Half the side of a square around the circle in which the cone from the eye touches the sphere's middle.
        let distance2 = dot(view, view);
        let beyond = max(distance2 - radius * radius, 1e-4 * radius * radius);
        let half_m = radius * select(1.0, sqrt(distance2 / beyond), eye.w > 0.0);
        let turn = capsule_frame(view);
        return to_world(instance, c.p[0] + (turn[0] * side.x + turn[1] * side.y) * half_m);
    }
    let face = (vertex / SQUARE_CORNERS) % 6u;
    let is_upper = face >= 3u;
    var unit = vec3f(select(-1.0, 1.0, is_upper), select(side.yx, side.xy, is_upper));
    if (face % 3u == 1u) { unit = unit.zxy; }
    if (face % 3u == 2u) { unit = unit.yzx; }
    let turn = capsule_frame(axis);
    let along = select(vec3f(0.0), axis, unit.z > 0.0);
    return to_world(instance, c.p[0] + along + (turn * unit) * radius);
}
