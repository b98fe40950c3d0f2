// Filtered patterns of two colors in object space.

#import constants

// Whether some material has a pattern other than a checker; without one the code is dropped.
override HAS_PATTERNS: bool = false;

const BRICK_SIZE = vec3f(1.0, 1.0 / 3.0, 0.5); // length, height, depth
const MORTAR: f32 = 0.06;
const OCTAVES = 5u;

// Integral from 0 to x of the square wave that is 1 in the first cell, -1 in the second, and so on.
fn square_wave_integral(x: f32) -> f32 {
    return 1.0 - 2.0 * abs(fract(x * 0.5) - 0.5);
}

// 3D checker, filtered by the box around the footprint, which lies in the surface and so has no depth along the
// normal. The small shift keeps faces that lie on a cell border stable.
fn checker(p: vec3f, normal: vec3f, width: f32) -> f32 {
    let w = max(width * sqrt(max(vec3f(1.0) - normal * normal, vec3f(0.0))), vec3f(1e-4));
    let q = p + 1e-3;
    var product = 1.0;
    for (var axis = 0; axis < 3; axis++) {
        let half = w[axis] * 0.5;
        product *= (square_wave_integral(q[axis] + half) - square_wave_integral(q[axis] - half)) / w[axis];
    }
    return 0.5 - 0.5 * clamp(product, -1.0, 1.0);
}

// Integral from 0 to x of pulses as wide as the mortar, around multiples of `period`.
fn mortar_integral(x: f32, period: f32) -> f32 {
    let shifted = x / period + 0.5;
    let inside = clamp((fract(shifted) - 0.5) * period + 0.5 * MORTAR, 0.0, MORTAR);
    return floor(shifted) * MORTAR + inside;
}

// Share of mortar between bricks in a running bond, box-filtered like the checker. A face shows no joint that lies
// in its own plane.
fn mortar(p: vec3f, normal: vec3f, width: f32) -> f32 {
    let w = max(width * sqrt(max(vec3f(1.0) - normal * normal, vec3f(0.0))), vec3f(1e-3));
    let odd = fract(floor(p.y / BRICK_SIZE.y) * 0.5) * 2.0;
    // Rows of bricks are shifted by half a brick along the wall.
    let q = p + 1e-3 + vec3f(0.5, 0.0, 0.25) * odd;
    var brick = 1.0;
    for (var axis = 0; axis < 3; axis++) {
        if (abs(normal[axis]) > 0.7) { continue; }
        let half = w[axis] * 0.5;
        let period = BRICK_SIZE[axis];
        brick *= 1.0 - (mortar_integral(q[axis] + half, period) - mortar_integral(q[axis] - half, period)) / w[axis];
    }
    return 1.0 - clamp(brick, 0.0, 1.0);
}

// Pseudo-random gradient of a lattice cell by an integer hash of its coordinates (Jarzynski and Olano 2020,
// "pcg3d").
fn lattice_gradient(cell: vec3i) -> vec3f {
    var v = bitcast<vec3u>(cell) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return vec3f(v >> vec3u(8u)) * (2.0 / 16777216.0) - 1.0;
}

// Gradient noise (Perlin 2002), about -1 to 1.
fn gradient_noise(p: vec3f) -> f32 {
    let cell = vec3i(floor(p));
    let f = p - floor(p);
    let u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    var sum = 0.0;
    for (var corner = 0; corner < 8; corner++) {
        let at = vec3i(corner & 1, (corner >> 1) & 1, corner >> 2);
        let side = vec3f(at);
        let weights = mix(vec3f(1.0) - u, u, side);
        sum += weights.x * weights.y * weights.z * dot(lattice_gradient(cell + at), f - side);
    }
    return sum;
}

// Octaves of noise; octaves finer than the footprint fade out, which prevents aliasing.
fn octaves(p: vec3f, width: f32) -> f32 {
    var sum = 0.0;
    var scale = 1.0;
    for (var octave = 0u; octave < OCTAVES; octave++) {
        let fade = 1.0 - smoothstep(0.25, 0.75, width * scale);
        if (fade <= 0.0) { break; }
        sum += fade * gradient_noise(p * scale + 17.0 * f32(octave)) / scale;
        scale *= 2.0;
    }
    return sum;
}

const DOT_RADIUS: f32 = 0.3;

// Share of the second color of disks around the lattice points, on the faces across the largest part of the normal.
// Their edge is as wide as the footprint; where that is wider than a disk, it shows the mean.
fn dots(p: vec3f, normal: vec3f, width: f32) -> f32 {
    let n = abs(normal);
    var q = p.xy;
    if (n.x > n.y && n.x > n.z) { q = p.yz; } else if (n.y > n.z) { q = p.zx; }
    let distance = length(fract(q + 0.5) - 0.5);
    let edge = max(width, 1e-4);
    let inside = clamp(0.5 + (DOT_RADIUS - distance) / edge, 0.0, 1.0);
    return mix(inside, PI * DOT_RADIUS * DOT_RADIUS, smoothstep(0.25, 1.0, width));
}

// Share of the second color of stripes across X, filtered by the box of the footprint. The small shift is the
// checker's.
fn stripes(x: f32, normal: vec3f, width: f32) -> f32 {
    let w = max(width * sqrt(max(1.0 - normal.x * normal.x, 0.0)), 1e-4);
    let q = x + 1e-3;
    return 0.5 - 0.5 * clamp((square_wave_integral(q + 0.5 * w) - square_wave_integral(q - 0.5 * w)) / w, -1.0, 1.0);
}

// Distance to the nearest of random points, one in each cell of a lattice at its gradient, and a random number of that
// cell (Worley 1996, "A Cellular Texture Basis Function").
fn nearest_point(p: vec3f) -> vec2f {
    var nearest = vec2f(9.0, 0.0);
    for (var k = 0; k < 27; k++) {
        let cell = vec3i(floor(p)) + vec3i(k % 3, k / 3 % 3, k / 9) - 1;
        let random = 0.5 + 0.5 * lattice_gradient(cell);
        let away = distance(p, vec3f(cell) + random);
        if (away < nearest.x) { nearest = vec2f(away, fract(16.0 * random.x)); }
    }
    return nearest;
}

// Share of the second color at a point, given in units of the pattern's size.
fn pattern(kind: u32, p: vec3f, normal: vec3f, width: f32) -> f32 {
    if (HAS_PATTERNS) {
        switch kind {
            case PATTERN_BRICK: { return mortar(p, normal, width); }
            case PATTERN_NOISE: { return clamp(0.5 + 0.7 * octaves(p, width), 0.0, 1.0); }
            case PATTERN_MARBLE: {
                // Veins across X, distorted by noise; the mean of a sine over the footprint fades with the width.
                let bent = p.x + 1.2 * octaves(p, width);
                let fade = exp(-2.0 * width * width);
                return 0.5 + 0.5 * fade * sin(6.2831853 * 0.5 * bent);
            }
            case PATTERN_STRIPES: { return stripes(p.x, normal, width); }
            case PATTERN_GRADIENT: { return clamp(p.x, 0.0, 1.0); }
            case PATTERN_DOTS: { return dots(p, normal, width); }
            case PATTERN_WOOD: {
                // A saw of the distance from X, box-filtered.
                if (width >= 1.0) { return 0.5; }
                let w = max(width, 1e-4);
                let ring = fract(length(p.yz) + 0.25 * octaves(vec3f(0.2 * p.x, p.yz), width) - 0.5 * w);
                return ring + 0.5 * w - max(ring + w - 1.0, 0.0) / w;
            }
            case PATTERN_VORONOI, PATTERN_CELLS: {
                let shown = mix(min(nearest_point(p), vec2f(1.0)), vec2f(0.55, 0.5), smoothstep(0.25, 1.0, width));
                return select(shown.x, shown.y, kind == PATTERN_CELLS);
            }
            default: {}
        }
    }
    return checker(p, normal, width);
}
