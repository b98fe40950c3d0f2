// The environment as a panorama, and sampling of directions by its brightness.

#import frame
#import sampling

@group(0) @binding(6) var panorama: texture_2d<f32>;
@group(0) @binding(7) var panorama_density: texture_2d<f32>; // mean brightness of equal-area squares, all levels
@group(0) @binding(8) var panorama_sampler: sampler;

fn into_panorama(direction: vec3f) -> vec3f {
    let t = sampling.turn; // cosine and sine
    return vec3f(direction.x * t.x - direction.z * t.y, direction.y, direction.x * t.y + direction.z * t.x);
}

fn out_of_panorama(direction: vec3f) -> vec3f {
    let t = sampling.turn;
    return vec3f(direction.x * t.x + direction.z * t.y, direction.y, direction.z * t.x - direction.x * t.y);
}

// "Environment Maps" of OpenEXR: longitude 0 is +Z and in the center, growing to the left.
fn environment(direction: vec3f) -> vec3f {
    let d = into_panorama(normalize(direction));
    let is_pole = abs(d.x) + abs(d.z) < 1e-12;
    let longitude = atan2(select(d.x, 0.0, is_pole), select(d.z, 1.0, is_pole));
    let uv = vec2f(0.5 - longitude / (2.0 * PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
    return textureSampleLevel(panorama, panorama_sampler, uv, 0.0).xyz * sampling.scale;
}

fn environment_share() -> f32 {
    return sampling.panorama_share;
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

// Density per solid angle with which `environment_direction` samples a unit direction.
fn environment_pdf(direction: vec3f) -> f32 {
    let edge = 1u << (sampling.density_levels - 1u);
    let place = square_of_direction(into_panorama(direction));
    let at = min(vec2u(place * f32(edge)), vec2u(edge - 1u));
    let mean = textureLoad(panorama_density, vec2u(0u), sampling.density_levels - 1u).x;
    return textureLoad(panorama_density, at, 0).x / (max(mean, 1e-30) * 4.0 * PI);
}

// Samples a unit direction: descends the pyramid, choosing squares by their brightness (Clarberg et al. 2005).
fn environment_direction(u_in: vec2f) -> vec3f {
    var u = u_in;
    var at = vec2u(0u);
    for (var level = i32(sampling.density_levels) - 2; level >= 0; level--) {
        at *= 2u;
        let a = textureLoad(panorama_density, at, level).x;
        let b = textureLoad(panorama_density, at + vec2u(1u, 0u), level).x;
        let c = textureLoad(panorama_density, at + vec2u(0u, 1u), level).x;
        let d = textureLoad(panorama_density, at + vec2u(1u, 1u), level).x;
        let left = (a + c) / max(a + b + c + d, 1e-30);
        let goes_right = u.x >= left;
        let upper = select(a / max(a + c, 1e-30), b / max(b + d, 1e-30), goes_right);
        let goes_down = u.y >= upper;
        at += vec2u(u32(goes_right), u32(goes_down));
        u.x = select(u.x / max(left, 1e-30), (u.x - left) / max(1.0 - left, 1e-30), goes_right);
        u.y = select(u.y / max(upper, 1e-30), (u.y - upper) / max(1.0 - upper, 1e-30), goes_down);
        u = clamp(u, vec2f(0.0), vec2f(1.0 - 6e-8));
    }
    let edge = f32(1u << (sampling.density_levels - 1u));
    return out_of_panorama(normalize(direction_of_square((vec2f(at) + u) / edge)));
}
