// Solids that bend colors differently (KHR_materials_dispersion): past the first of them a path has one color
// channel, so that many sub-frames hold all three.

#import frame
#import sampling

override HAS_DISPERSION: bool = true;

// Fewer sub-frames would show specks of single colors: then all are bent alike.
const LEAST_SAMPLES: u32 = 8u;
const CHANNEL_PAIR: u32 = 0x10004u;

var<private> path_channel: u32 = 0u; // 0: all of them; else one more than its number

fn is_dispersive(s: Surface) -> bool {
    return HAS_DISPERSION && s.is_solid && s.dispersion > 0.0 && s.transmission > 0.0 && s.ior > 1.0
        && sampling.samples >= LEAST_SAMPLES;
}

// Sub-frames take the channels in turn, each pixel from another one on.
fn next_channel() -> u32 {
    if (path_channel > 0u) { return path_channel; }
    let first = u32(sample_square(0u, CHANNEL_PAIR).x * 3.0);
    return 1u + (first + sampling.sample) % 3u;
}

// All sub-frames over those that take the channel of this one.
fn channel_weight() -> f32 {
    return f32(sampling.samples) / f32((sampling.samples + 2u - sampling.sample % 3u) / 3u);
}

fn normal_reflectance(index: f32) -> f32 {
    let root = (index - 1.0) / (index + 1.0);
    return root * root;
}

// The surface as the path's channel meets it.
fn dispersed(s0: Surface) -> Surface {
    var s = s0;
    if (!is_dispersive(s)) { return s; }
    let index = s.ior + (s.ior - 1.0) * 0.025 * s.dispersion * (f32(next_channel()) - 2.0);
    s.reflectivity = min(s.reflectivity * normal_reflectance(index) / normal_reflectance(s.ior), 1.0);
    s.ior = index;
    return s;
}

// Has the path keep its channel past the surface: it stands for all three.
fn in_one_channel(s: Surface, ray: Reflected) -> Reflected {
    var out = ray;
    if (is_dispersive(s) && path_channel == 0u) {
        path_channel = next_channel();
        path_is_chance = true;
        out.weight *= select(vec3f(0.0), vec3f(channel_weight()), vec3u(path_channel) == vec3u(1u, 2u, 3u));
    }
    return out;
}
