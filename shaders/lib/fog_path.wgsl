// Paths through fog: where its light is scattered more than once, they go on from points in the fog.

// Share of the scattered light of the surroundings that a ray finds: without scattered paths the share of the
// surroundings behind it.
fn sky_kept(ray: Reflected) -> f32 {
    if (FOLLOWS_FOG) { return 1.0; }
    return ray.sky_weight / max(ray.kept, 1e-30);
}

// Ray of a path that is scattered at a point of its way. Lights straight from there are counted already.
fn scattered_from(way: Way, u: f32) -> Start {
    let position = way.origin + way.direction * place_by_depth(way, u).t;
    path_scatterings++;
    path_is_chance = true;
    leave_vertex(position);
    let direction = fog_direction(way.direction, sample_square(sample_index(), FOG_TURN_PAIR));
    return Start(Reflected(direction, fog.albedo, TAKEN, 0.0, 1.0, vec3f(0.0)), position, Surface());
}

// Passes the fog, or is scattered by it, with the probabilities of light, while the path may scatter.
fn passed(air: Air, way: Way) -> Air {
    var next = air;
    if (!FOLLOWS_FOG || path_scatterings >= frame.diffuse_bounces) {
        next.share = vec3f(1.0 - way.scattered);
        return next;
    }
    let u = sample_square(sample_index(), FOG_PATH_PAIR);
    if (u.x >= way.scattered) { return next; }
    let start = scattered_from(way, u.x / way.scattered);
    next.share = start.ray.weight * air.ray.kept;
    if (UNBIASED) { next.share *= survival(next.share, u.y); }
    next.scatters = true;
    next.ray = start.ray;
    next.position = start.origin;
    return next;
}

// Ray of a path that begins in the fog before a pixel.
fn scattered_start(way: Way) -> Start {
    var start = Start(Reflected(way.direction, vec3f(0.0), 0.0, 0.0, 1.0, vec3f(0.0)), way.origin, Surface());
    if (way.scattered <= 1e-12 || path_scatterings >= frame.diffuse_bounces) { return start; }
    start = scattered_from(way, sample_square(sample_index(), FOG_PATH_PAIR).x);
    start.ray.weight *= way.scattered;
    return start;
}
