// Numbers that samples are made of: Sobol's first two dimensions, scrambled anew for each pixel and each
// pair of dimensions (Burley 2020, "Practical Hash-based Owen Scrambling"). They depend on the pixel and
// the sub-frame alone, and fill the square more evenly the more sub-frames there are.

struct Sampling {
    first: u32, // of this sub-frame's samples
    rays: u32, // of a pixel and sub-frame
    panorama_share: f32, // of the light that the density holds
    density_levels: u32,
    turn: vec2f, // cosine and sine of the panorama's rotation
    scale: f32, // radiance of a texel of 1
    sample: u32, // the sub-frame
    samples: u32, // sub-frames of a picture
    emitters: u32, // triangles that light
    emitted_power: f32, // of all of them: areas by the luminance that they emit
    pad0: u32,
}

@group(0) @binding(5) var<uniform> sampling: Sampling;

// Whether paths end by chance alone, nothing of them is left out, and light that is refracted is found as such.
override UNBIASED: bool = false;

var<private> sample_seed: u32;
var<private> sample_pair: u32; // of dimensions, counted since the start

// PCG (Jarzynski & Olano 2020, "Hash Functions for GPU Rendering").
fn hash(x: u32) -> u32 {
    let state = x * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// `vertex` counts the surfaces along a path: 0 is what the pixel shows.
fn start_samples(pixel: vec2u, vertex: u32) {
    sample_seed = hash(pixel.x + hash(pixel.y + hash(vertex)));
    sample_pair = 0u;
}

// Owen scrambling of a number whose bits are reversed: each bit flips by those below it (Laine & Karras
// 2011, with the constants of Vegdahl 2021).
fn scrambled(reversed: u32, seed: u32) -> u32 {
    var x = reversed ^ (reversed * 0x3d20adeau);
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Sobol's second generator matrix, Pascal's triangle modulo 2, by the sums over all supersets of bits.
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

// A point in [0, 1)² of the sub-frame's sample `index`.
fn sample_square(index: u32, pair: u32) -> vec2f {
    let seed = hash(sample_seed + hash(pair));
    let shuffled = reverseBits(scrambled(reverseBits(index), seed));
    let x = reverseBits(scrambled(shuffled, hash(seed + 1u)));
    let y = reverseBits(scrambled(pascal(shuffled), hash(seed + 2u)));
    return vec2f(unit_float(x), unit_float(y));
}

// The next pair of dimensions, which the caller asks for by `sample_square`; 0 is that of reflections.
fn next_pair() -> u32 {
    sample_pair++;
    return sample_pair;
}
