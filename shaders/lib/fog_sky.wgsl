// Light of the surroundings that fog scatters: by samples of their directions, or of an unoccluded gradient in closed
// form.

#import ambient
#import environment

// Mean of a gradient as the phase function of Henyey and Greenstein weighs directions. Its Legendre moments are the
// powers of the anisotropy, and the gradient needs the means of the height and of its absolute value,
// |y| = 1/2 + 5/8 P2 − 3/16 P4 + 13/128 P6 − …
fn scattered_gradient(direction: vec3f) -> vec3f {
    let g = fog.anisotropy;
    let y = clamp(direction.y, -1.0, 1.0);
    let y2 = y * y;
    let g2 = g * g;
    let p2 = 1.5 * y2 - 0.5;
    let p4 = (35.0 * y2 - 30.0) * y2 * 0.125 + 0.375;
    let p6 = ((231.0 * y2 - 315.0) * y2 + 105.0) * y2 * 0.0625 - 0.3125;
    let size = 0.5 + g2 * (0.625 * p2 + g2 * (-0.1875 * p4 + g2 * (0.1015625 * p6)));
    let height = g * y;
    return max(gradient(0.5 * (size + height), 0.5 * (size - height)), vec3f(0.0));
}

// By samples: one direction for one point of the ray. It follows the phase function or the bright parts of the
// surroundings, on either side of the plane across the ray.
fn scattered_of_sky(way: Way, index: u32) -> Returned {
    if (!SAMPLES_ENVIRONMENT) {
        let light = scattered_gradient(way.direction) * way.scattered;
        return Returned(way.origin, way.direction, BEYOND, light, vec3f(0.0), 1.0);
    }
    let u = sample_square(index, FOG_PLACE_PAIR);
    let place = place_by_depth(way, u.x);
    let position = way.origin + way.direction * place.t;
    let forward = way.direction;
    let by_light = 0.5 * max(environment_share(forward), environment_share(-forward));
    var v = sample_square(index, FOG_SKY_PAIR);
    var direction: vec3f;
    if (v.x < by_light) {
        v.x /= by_light;
        direction = environment_direction(v, select(forward, -forward, u.y < 0.5)).xyz;
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
    return Returned(position, direction, BEYOND, light, vec3f(0.0), 1.0);
}
