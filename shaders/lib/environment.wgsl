// The environment: a gradient from straight up over the horizon to straight down, or a panorama, with sampling of
// directions by its brightness.

#import frame
#import sampling
#import texels

override HAS_PANORAMA: bool = true;

@group(0) @binding(6) var panorama: texture_2d<f32>;
// Cones around the light of coarse equal-area squares, see src/world/environment/cones.rs; then for each square the mean
// brightness of the four squares within it. Of both the coarsest level comes first.
@group(0) @binding(7) var panorama_squares: VectorTexels;
@group(0) @binding(8) var panorama_sampler: sampler;

// A direction turned about the vertical by an angle with this cosine and sine; by `sampling.turn`, into the panorama.
fn turned(direction: vec3f, t: vec2f) -> vec3f {
    return vec3f(direction.x * t.x - direction.z * t.y, direction.y, direction.x * t.y + direction.z * t.x);
}

// Light of the gradient by the shares of the zenith and of the ground.
fn gradient(up: f32, down: f32) -> vec3f {
    return frame.horizon + (frame.zenith - frame.horizon) * up + (frame.ground - frame.horizon) * down;
}

// "Environment Maps" of OpenEXR: longitude 0 is +Z and in the center, growing to the left.
fn environment(direction: vec3f) -> vec3f {
    if (!HAS_PANORAMA) { return gradient(saturate(direction.y), saturate(-direction.y)); }
    let d = turned(normalize(direction), sampling.turn);
    let is_pole = abs(d.x) + abs(d.z) < 1e-12;
    let longitude = atan2(select(d.x, 0.0, is_pole), select(d.z, 1.0, is_pole));
    let uv = vec2f(0.5 - longitude / (2.0 * PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
    return textureSampleLevel(panorama, panorama_sampler, uv, 0.0).xyz * sampling.scale;
}

fn with_sign(size: vec2f, signs: vec2f) -> vec2f {
    return select(size, -size, signs < vec2f(0.0));
}

// Equal-area octahedral map (Clarberg 2008), [0, 1]² to the sphere and back.
fn direction_of_square(place: vec2f) -> vec3f {
    let p = place * 2.0 - 1.0;
    let size = abs(p);
    let to_fold = 1.0 - size.x - size.y;
    let r = 1.0 - abs(to_fold);
    let phi = select((size.y - size.x) / max(r, 1e-12) + 1.0, 1.0, r == 0.0) * (PI / 4.0);
    let z = select(1.0 - r * r, r * r - 1.0, to_fold < 0.0);
    let flat = with_sign(vec2f(cos(phi), sin(phi)), p) * (r * sqrt(max(2.0 - r * r, 0.0)));
    return vec3f(flat, z);
}

fn square_of_direction(d: vec3f) -> vec2f {
    let size = abs(d);
    let r = sqrt(max(1.0 - size.z, 0.0));
    let large = max(size.x, size.y);
    let ratio = select(min(size.x, size.y) / max(large, 1e-30), 0.0, large == 0.0);
    let angle = atan(ratio) * (2.0 / PI);
    let phi = select(angle, 1.0 - angle, size.x < size.y);
    var p = vec2f(r - phi * r, phi * r);
    if (d.z < 0.0) { p = 1.0 - p.yx; }
    return (with_sign(p, d.xy) + 1.0) * 0.5;
}

// Upper bound of the light that a surface with this normal gets from a square: the square's density times the cosine
// towards the nearest direction of the cone around its light. `cone`: axis and cosine of the half angle, both times the
// density.
fn cone_light(cone: vec4f, normal: vec3f) -> f32 {
    let d2 = dot(cone.xyz, cone.xyz);
    let towards = dot(cone.xyz, normal);
    if (towards >= cone.w || d2 <= 0.0) { return sqrt(d2); }
    let sines = sqrt(max((d2 - towards * towards) * (d2 - cone.w * cone.w), 0.0));
    return max(towards * cone.w + sines, 0.0) * inverseSqrt(d2);
}

// Vector of a square in a grid with this edge, in the pyramid of vectors that starts at `first`.
fn square_vector(first: u32, at: vec2u, edge: u32) -> vec4f {
    return bitcast<vec4f>(vector_at(panorama_squares, first + (edge * edge - 1u) / 3u + at.y * edge + at.x));
}

fn square_density(at: vec2u, edge: u32) -> f32 {
    let four = square_vector(MOST_CONES, at / 2u, max(edge / 2u, 1u));
    return four[(at.x & 1u) + 2u * (at.y & 1u)];
}

// Weights of four squares, of which `at` is the first, in a grid with this edge, for a surface with this normal.
fn square_weights(at: vec2u, edge: u32, normal: vec3f) -> vec4f {
    if (edge >= 1u << CONE_LEVELS) { return square_vector(MOST_CONES, at / 2u, edge / 2u); }
    var weights: vec4f;
    for (var k = 0u; k < 4u; k++) {
        weights[k] = cone_light(square_vector(0u, at + vec2u(k & 1u, k >> 1u), edge), normal);
    }
    return weights;
}

// Share of the panorama's light on a surface with this normal that its density holds; 0 of a gradient. The rest comes
// from all directions alike: a quarter of it arrives, as the mean of the cosine over the sphere says.
fn environment_share(normal: vec3f) -> f32 {
    if (!HAS_PANORAMA) { return 0.0; }
    let all = square_vector(0u, vec2u(0u), 1u);
    let held = cone_light(all, turned(normal, sampling.turn));
    return held / max(held + 0.25 * (1.0 - length(all.xyz)), 1e-30);
}

// Density per solid angle with which `environment_direction` samples a unit direction, for a surface with this normal.
fn environment_pdf(direction: vec3f, world_normal: vec3f) -> f32 {
    if (!HAS_PANORAMA) { return 0.0; }
    let normal = turned(world_normal, sampling.turn);
    let finest = sampling.density_levels - 1u;
    let place = square_of_direction(turned(direction, sampling.turn));
    let at = min(vec2u(place * f32(1u << finest)), vec2u((1u << finest) - 1u));
    var pdf = 1.0 / (4.0 * PI);
    let least = i32(sampling.density_levels - min(sampling.density_levels, CONE_LEVELS));
    for (var level = i32(finest) - 1; level >= least; level--) {
        let child = at >> vec2u(u32(level));
        let weights = square_weights(child & vec2u(0xfffffffeu), 1u << (finest - u32(level)), normal);
        let sum = weights.x + weights.y + weights.z + weights.w;
        let own = weights[(child.x & 1u) + 2u * (child.y & 1u)];
        pdf *= 4.0 * own / max(sum, 1e-30);
    }
    let coarse = square_density(at >> vec2u(u32(least)), 1u << (finest - u32(least)));
    return pdf * square_density(at, 1u << finest) / max(coarse, 1e-30);
}

// Samples a unit direction: descends the pyramid, choosing squares by their brightness (Clarberg et al. 2005), the
// coarser ones also by where they are seen from a surface with this normal. w: its density per solid angle.
fn environment_direction(u_in: vec2f, world_normal: vec3f) -> vec4f {
    if (!HAS_PANORAMA) { return vec4f(0.0, 1.0, 0.0, 0.0); }
    var pdf = 1.0 / (4.0 * PI);
    let normal = turned(world_normal, sampling.turn);
    var u = u_in;
    var at = vec2u(0u);
    for (var level = 1u; level < sampling.density_levels; level++) {
        at *= 2u;
        let w = square_weights(at, 1u << level, normal);
        let all = max(w.x + w.y + w.z + w.w, 1e-30);
        let left = (w.x + w.z) / all;
        let goes_right = u.x >= left;
        let upper = select(w.x / max(w.x + w.z, 1e-30), w.y / max(w.y + w.w, 1e-30), goes_right);
        let goes_down = u.y >= upper;
        let child = vec2u(u32(goes_right), u32(goes_down));
        at += child;
        pdf *= 4.0 * w[child.x + 2u * child.y] / all;
        u.x = select(u.x / max(left, 1e-30), (u.x - left) / max(1.0 - left, 1e-30), goes_right);
        u.y = select(u.y / max(upper, 1e-30), (u.y - upper) / max(1.0 - upper, 1e-30), goes_down);
        u = clamp(u, vec2f(0.0), vec2f(1.0 - 6e-8));
    }
    let edge = f32(1u << (sampling.density_levels - 1u));
    return vec4f(turned(normalize(direction_of_square((vec2f(at) + u) / edge)), sampling.turn * vec2f(1.0, -1.0)), pdf);
}
