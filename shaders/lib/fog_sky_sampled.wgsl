// Light of the surroundings that fog scatters, by samples of their directions.

#import environment

// One direction for one point of the ray. It follows the phase function or the bright parts of the surroundings, on
// either side of the plane across the ray.
fn scattered_of_sky(way: Way, index: u32) -> Scattered {
    let u = sample_square(index, FOG_PLACE_PAIR);
    let place = place_by_depth(way, u.x);
    let position = way.origin + way.direction * place.t;
    let forward = way.direction;
    let by_light = 0.5 * max(environment_share(forward), environment_share(-forward));
    var v = sample_square(index, FOG_SKY_PAIR);
    var direction: vec3f;
    if (v.x < by_light) {
        v.x /= by_light;
        direction = environment_direction(v, select(forward, -forward, u.y < 0.5));
    } else {
        v.x = (v.x - by_light) / (1.0 - by_light);
        direction = fog_direction(forward, v);
    }
    let phase = fog_phase(dot(forward, direction));
    var density = (1.0 - by_light) * phase;
    if (by_light > 0.0) {
        density += by_light * 0.5 * (environment_pdf(direction, forward) + environment_pdf(direction, -forward));
    }
    let light = environment(direction) * (place.weight * phase / max(density, 1e-30) * sky_share(position, direction));
    return Scattered(position, direction, BEYOND, light, 1.0);
}
