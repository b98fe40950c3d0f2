// Shapes around capsules that are drawn: a quadrilateral that faces the eye, in which every pixel tests its ray against
// the capsule. They are built in object space, where the capsule is not squeezed.

#import capsule
#import surface

// Whether the pipeline draws spheres, whose quadrilaterals are squares.
override SPHERES: bool = false;

// Size of a quadrilateral over the size of the capsule it surrounds: rasterization rounds its edges.
const SHAPE_MARGIN: f32 = 1.01;

// Capsule of a drawn vertex.
fn capsule_of_vertex(vertex: u32) -> u32 {
    return vertex / SQUARE_CORNERS;
}

// Place of a drawn vertex on a square of side 2 around the middle: x leads from the base to the other end, y across.
// Corners 0, 1, 2, 0, 2, 3 of the square.
fn square_place(vertex: u32) -> vec2f {
    let around = (0xe24u >> ((vertex % SQUARE_CORNERS) * 2u)) & 3u;
    return vec2f(f32(around == 1u || around == 2u), f32(around >= 2u)) * 2.0 - 1.0;
}

// Position in clip space of a drawn vertex. `eye` is the view's, or with w = 0 the direction of all its rays; `width` is
// of a pixel, m, and its growth with each meter from the eye.
//
// Seen from the eye, the outer corners of two squares around the ends are equally high over the plane of eye and axis,
// so that the great circle between them passes above both ends and all between.
fn capsule_vertex(instance: u32, vertex: u32, eye: vec4f, clip_from_world: mat4x4f, width: vec2f) -> vec4f {
    let c = corners(instance, capsule_of_vertex(vertex));
    let axis = select(c.p[1] - c.p[0], vec3f(0.0), SPHERES);
    let values = c.values;
    let radius = values.capsule_radius_m;
    let side = square_place(vertex);
    let rows = values.object_from_world;
    let from_eye = eye.xyz - eye.w * vec3f(rows[0].w, rows[1].w, rows[2].w);
    let seen = direction_to_object(rows, from_eye);
    let has_eye = eye.w > 0.0;
    let base = select(seen, c.p[0] - seen, has_eye);
    let end = select(seen, base + axis, has_eye);
    let normal = cross(base, axis);
    let is_end_on = SPHERES || dot(normal, normal) <= 1e-12 * dot(base, base) * dot(axis, axis);
    let across = select(normalize(normal), capsule_frame(base)[0], is_end_on);
    let base_m = length(base);
    let end_m = length(end);
    // Half the side of a square around the circle in which the cone from the eye touches a sphere, over its distance.
    let nearest_m = min(base_m, end_m);
    let round = radius * inverseSqrt(max(nearest_m * nearest_m - radius * radius, 1e-4 * radius * radius));
    // A point or a line that is thinner than a pixel is drawn as wide: see pixel_radius_m.
    let squeeze = max(length(rows[0].xyz), max(length(rows[1].xyz), length(rows[2].xyz)));
    let way = max(distance(eye.xyz, to_world(values, c.p[0])) / base_m, distance(eye.xyz, to_world(values, c.p[0] + axis)) / end_m);
    let least_px = select(LINE_PX, POINT_PX, SPHERES || dot(axis, axis) == 0.0);
    let half_px = select(0.0, 0.5 * least_px, (values.flags & FLAG_AT_LEAST_A_PIXEL) != 0u);
    let spread = max(round, half_px * squeeze * width.y * way);
    let outer_base = base / base_m - cross(across, base / base_m) * spread;
    let outer_end = end / end_m + cross(across, end / end_m) * spread;
    let nearest = base + axis * capsule_share(-base, axis);
    let is_inside = dot(nearest, nearest) < 1.1 * radius * radius;
    let is_around = dot(outer_base, outer_end) < 0.0 && dot(cross(outer_base, outer_end), across) < 0.1 * (1.0 + spread * spread);
    // From within or all around, the whole picture is drawn.
    if (!SPHERES && has_eye && (is_inside || is_around)) { return vec4f(side, 0.5, 1.0); }
    let toward = select(base / base_m, end / end_m, side.x > 0.0);
    let half_m = SHAPE_MARGIN * select(max(radius, half_px * squeeze * width.x), spread * select(base_m, end_m, side.x > 0.0), has_eye);
    let corner = (cross(across, toward) * side.x + across * side.y) * half_m;
    let position = c.p[0] + select(vec3f(0.0), axis, side.x > 0.0) + corner;
    return clip_from_world * vec4f(to_world(values, position), 1.0);
}
