// Dispersion of solids (KHR_materials_dispersion): past the first dispersive solid a path carries one color channel,
// and many sub-frames together hold all three.

#import sampling

override HAS_DISPERSION: bool = true;

// Minimum number of sub-frames for dispersion: with fewer, single colors would show as specks.
const LEAST_SAMPLES: u32 = 8u;

var<private> path_channel: u32 = 0u; // color channel of the path, 1 to 3; 0: all channels

fn is_dispersive(s: Surface) -> bool {
    return HAS_DISPERSION && s.is_solid && s.dispersion > 0.0 && s.transmission > 0.0 && s.ior > 1.0
        && sampling.samples >= LEAST_SAMPLES;
}

// Sub-frame of the path, or its sample of a map, all of whose paths have one channel.
fn channel_index() -> u32 {
    return sample_index() / paths_each;
}

// Channel of the path, 1 to 3: sub-frames take the channels in turn, and each pixel starts with another one.
fn next_channel() -> u32 {
    if (path_channel > 0u) { return path_channel; }
    let first = u32(sample_square(0u, CHANNEL_PAIR).x * 3.0);
    return 1u + (first + channel_index()) % 3u;
}

fn normal_reflectance(index: f32) -> f32 {
    let root = (index - 1.0) / (index + 1.0);
    return root * root;
}

// The surface with the index of refraction of the path's channel.
fn dispersed(s0: Surface) -> Surface {
    var s = s0;
    if (!is_dispersive(s)) { return s; }
    let index = s.ior + (s.ior - 1.0) * 0.025 * s.dispersion * (f32(next_channel()) - 2.0);
    s.reflectivity = min(s.reflectivity * normal_reflectance(index) / normal_reflectance(s.ior), 1.0);
    s.ior = index;
    return s;
}

// Restricts the path to one channel past the surface, weighted to stand for all three.
fn in_one_channel(s: Surface, ray: Reflected) -> Reflected {
    var out = ray;
    if (is_dispersive(s) && path_channel == 0u) {
        path_channel = next_channel();
        path_is_chance = true;
        // Number of sub-frames divided by the number of sub-frames with this one's channel.
        let weight = f32(sampling.samples) / f32((sampling.samples + 2u - channel_index() % 3u) / 3u);
        out.weight *= select(vec3f(0.0), vec3f(weight), vec3u(path_channel) == vec3u(1u, 2u, 3u));
    }
    return out;
}
