// Light of the surroundings that fog scatters, in closed form: an unoccluded gradient.

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
    return max(frame.horizon + (frame.zenith - frame.horizon) * (0.5 * (size + height))
        + (frame.ground - frame.horizon) * (0.5 * (size - height)), vec3f(0.0));
}

fn scattered_of_sky(way: Way, index: u32) -> Scattered {
    return Scattered(way.origin, way.direction, BEYOND, scattered_gradient(way.direction) * way.scattered, 1.0);
}
