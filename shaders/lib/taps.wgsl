// Taps: neighbors of a pixel over which passes smooth light, on a disk that is turned from pixel to pixel.

#import frame
#import sampling

const GOLDEN_ANGLE: f32 = 2.39996323;

fn inside(at: vec2i) -> bool {
    return all(at >= vec2i(0)) && all(at < vec2i(frame.size));
}

// Interleaved gradient noise (Jimenez 2014): rotation of the taps, which differs between neighboring pixels and between
// sub-frames.
fn turn_of(pixel: vec2u) -> f32 {
    let noise = fract(52.9829189 * fract(dot(vec2f(pixel), vec2f(0.06711056, 0.00583715))));
    return 2.0 * PI * fract(noise + 0.61803399 * f32(sampling.sample));
}

// Distance of a tap from the middle of the disk, as a share of its radius.
fn tap_radius(k: u32, taps: u32) -> f32 {
    return sqrt((f32(k) + 0.5) / f32(taps));
}

// Pixel of a tap on a disk of this radius, pixels; outside of the picture there is none.
fn tap_at(pixel: vec2u, turn: f32, radius_px: f32, k: u32) -> vec2i {
    let angle = turn + GOLDEN_ANGLE * f32(k);
    return pixel_of_moment(vec2i(round(vec2f(pixel) + radius_px * vec2f(cos(angle), sin(angle)))));
}
