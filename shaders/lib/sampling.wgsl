// Random numbers of samples: Sobol's first two dimensions, scrambled separately for each pixel and each pair of
// dimensions (Burley 2020, "Practical Hash-based Owen Scrambling"). They depend on the pixel and the sub-frame
// alone, and cover the square more evenly the more sub-frames there are.

#import hash
#import structs

@group(0) @binding(5) var<uniform> sampling: Sampling;

// Whether rendering is unbiased: paths end only by Russian roulette, no light is clamped, and refracted light is
// found by refracted rays.
override UNBIASED: bool = false;

// Whether lights or reflections have an extent, so that they are sampled.
override HAS_EXTENT: bool = true;

// Pairs of dimensions of single decisions at a vertex, beyond the dimensions that `next_pair` counts.
const COAT_PAIR: u32 = 0x10000u; // whether the coat or the base reflects
const ONWARD_PAIR: u32 = 0x10002u; // whether the path is reflected or transmitted
const ALPHA_PAIR: u32 = 0x10003u; // whether the path passes beside a surface with coverage
const SCATTER_PAIR: u32 = 0x10004u; // direction of diffuse scattering
const CHOICE_PAIR: u32 = 0x10005u; // whether the path scatters, and Russian roulette
const CHANNEL_PAIR: u32 = 0x10006u; // first color channel of dispersion

// Whether several rays of a sub-frame go towards each kind of light. Software drivers take a tenth less time without the loop.
override SEVERAL_LIGHT_RAYS: bool = true;

var<private> sample_seed: u32;
// Index of a sample within the sub-frame, where an invocation adds up several, as for a probe's map.
var<private> added_sample: u32 = 0u;
// Number of paths by which an invocation samples what is behind a pixel's surface.
var<private> paths_each: u32 = 1u;
var<private> sample_pair: u32; // number of dimension pairs used at this vertex

// Index of the sample that is taken, among all of the picture or the map.
fn sample_index() -> u32 {
    return sampling.sample + added_sample;
}

// Index of its first sample of lights.
fn first_light_sample() -> u32 {
    return sampling.first + added_sample * sampling.rays;
}

// Starts the random numbers of a path vertex: `vertex` counts the surfaces along a path, 0 is the pixel's.
fn start_samples(pixel: vec2u, vertex: u32) {
    if (!HAS_EXTENT) { return; }
    sample_seed = hash(pixel.x + hash(pixel.y + hash(vertex)));
    sample_pair = 0u;
}

// Owen scrambling of a number with reversed bits: each bit is flipped depending on the bits below it (Laine & Karras
// 2011, with the constants of Vegdahl 2021).
fn scrambled(reversed: u32, seed: u32) -> u32 {
    var x = reversed ^ (reversed * 0x3d20adeau);
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Product with Sobol's second generator matrix, Pascal's triangle modulo 2, by sums over all supersets of bits.
fn pascal(index: u32) -> u32 {
    var s = index;
    s ^= (s >> 1u) & 0x55555555u;
    s ^= (s >> 2u) & 0x33333333u;
    s ^= (s >> 4u) & 0x0f0f0f0fu;
    s ^= (s >> 8u) & 0x00ff00ffu;
    s ^= (s >> 16u) & 0x0000ffffu;
    return s;
}

fn unit_float(bits: u32) -> f32 {
    return f32(bits >> 8u) * exp2(-24.0);
}

// Random point in [0, 1)² of the sample `index`, for a pair of dimensions.
fn sample_square(index: u32, pair: u32) -> vec2f {
    let seed = hash(sample_seed + hash(pair));
    let shuffled = reverseBits(scrambled(reverseBits(index), seed));
    let x = reverseBits(scrambled(shuffled, hash(seed + 1u)));
    let y = reverseBits(scrambled(pascal(shuffled), hash(seed + 2u)));
    return vec2f(unit_float(x), unit_float(y));
}

// The next unused pair of dimensions, for `sample_square`; pair 0 belongs to reflections.
fn next_pair() -> u32 {
    sample_pair++;
    return sample_pair;
}
