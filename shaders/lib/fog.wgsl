// Fog as a participating medium: how much of it lies on a ray, what it lets through, and its phase function.

#import frame
#import structs

override HAS_FOG: bool = true;

// Whether fog scatters light more than once: paths go on from points in it.
override FOLLOWS_FOG: bool = true;

@group(0) @binding(13) var<uniform> fog: Fog;

// Distances between which a ray may meet fog: within the box, or all of the ray.
fn fog_span(origin: vec3f, direction: vec3f, distance_m: f32) -> vec2f {
    if (fog.falloff_m > 0.0) { return vec2f(0.0, distance_m); }
    let safe = select(direction, vec3f(1e-20), abs(direction) < vec3f(1e-20));
    let a = (fog.lowest - origin) / safe;
    let b = (fog.highest - origin) / safe;
    let enter = min(a, b);
    let leave = max(a, b);
    let start_m = max(max(enter.x, enter.y), max(enter.z, 0.0));
    let end_m = min(min(leave.x, leave.y), min(leave.z, distance_m));
    return vec2f(start_m, max(start_m, end_m));
}

// exp(−x), at least 1.6e-38.
fn decay(x: f32) -> f32 {
    return exp(-min(x, 87.0));
}

// (1 − exp(−x)) / x.
fn mean_decay(x: f32) -> f32 {
    if (x < 0.02) { return 1.0 - x * (0.5 - x * (1.0 / 6.0 - x / 24.0)); }
    return (1.0 - decay(x)) / x;
}

// Height of a point of a ray above the layer of constant density, m.
fn fog_height(origin: vec3f, direction: vec3f, t: f32) -> f32 {
    return origin.y + direction.y * t - fog.height_m;
}

// Density at a height above the layer, over that in it.
fn fog_thinness(height_m: f32) -> f32 {
    if (fog.falloff_m == 0.0) { return 1.0; }
    return decay(max(height_m, 0.0) / fog.falloff_m);
}

// Length of a ray within a span, weighted by the density over that in the layer, m: in closed form. It is evaluated
// from the lower end, where nothing overflows.
fn fog_length(origin: vec3f, direction: vec3f, span: vec2f) -> f32 {
    let length_m = span.y - span.x;
    if (fog.falloff_m == 0.0) { return length_m; }
    let a = fog_height(origin, direction, span.x);
    let b = fog_height(origin, direction, span.y);
    let low = min(a, b);
    let high = max(a, b);
    if (high <= 0.0) { return length_m; }
    var below_m = 0.0;
    if (low < 0.0) { below_m = length_m * (-low / (high - low)); }
    let base = max(low, 0.0);
    return below_m + (length_m - below_m) * fog_thinness(base) * mean_decay((high - base) / fog.falloff_m);
}

// Transmittance of the fog on a ray (Beer-Lambert law).
fn fog_share(origin: vec3f, direction: vec3f, distance_m: f32) -> f32 {
    if (!HAS_FOG) { return 1.0; }
    return decay(fog.density * fog_length(origin, direction, fog_span(origin, direction, distance_m)));
}

// Share of the light of the surroundings that arrives at a point. Where light is scattered once, what fog takes of it
// counts as given back from all around, as it is in white fog under even surroundings.
fn sky_share(position: vec3f, direction: vec3f) -> f32 {
    if (!FOLLOWS_FOG) { return 1.0; }
    return fog_share(position, direction, FAR_M);
}

// Distance in thinning fog after which its weighted length is `left`: `density` is that at the start over that in the
// layer, `rate` the part of it that is lost per meter.
fn thinning(left: f32, density: f32, rate: f32) -> f32 {
    let x = min(left * rate / max(density, 1e-30), 0.9999999);
    if (x < 0.02) { return left / max(density, 1e-30) * (1.0 + x * (0.5 + x * (1.0 / 3.0 + x * 0.25))); }
    return -log(1.0 - x) / rate;
}

// The same in fog that thickens from e^−start on.
fn thickening(left: f32, start: f32, rate: f32) -> f32 {
    let density = decay(start);
    let x = left * rate;
    if (x < 0.02 * density) {
        let part = x / density;
        return left / density * (1.0 - part * (0.5 - part * (1.0 / 3.0 - part * 0.25)));
    }
    return (log(density + x) + start) / rate;
}

// Distance along a ray at which the weighted length from the start of the span is `length_m`: the inverse of
// `fog_length`.
fn fog_reached(origin: vec3f, direction: vec3f, span: vec2f, length_m: f32) -> f32 {
    if (fog.falloff_m == 0.0) { return span.x + length_m; }
    let start = fog_height(origin, direction, span.x);
    let rate = abs(direction.y) / fog.falloff_m;
    var t = span.x;
    var left = length_m;
    if (direction.y >= 0.0) {
        if (start < 0.0) {
            let below_m = -start / max(direction.y, 1e-20);
            if (left <= below_m) { return t + left; }
            t += below_m;
            left -= below_m;
        }
        return t + thinning(left, fog_thinness(start), rate);
    }
    if (start > 0.0) {
        let above_m = min(start / -direction.y, span.y - span.x);
        let above = fog_length(origin, direction, vec2f(span.x, span.x + above_m));
        if (left < above) { return t + thickening(left, start / fog.falloff_m, rate); }
        t += above_m;
        left -= above;
    }
    return t + left;
}

// Phase function of Henyey and Greenstein 1941, per steradian; `cosine` belongs to the angle by which light is turned.
fn fog_phase(cosine: f32) -> f32 {
    let g = fog.anisotropy;
    let d = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (4.0 * PI * d * sqrt(d));
}

// Direction from which fog scatters light into a ray along `direction`, distributed by the phase function.
fn fog_direction(direction: vec3f, u: vec2f) -> vec3f {
    let g = fog.anisotropy;
    var cosine = 1.0 - 2.0 * u.x;
    if (abs(g) > 1e-3) {
        let s = (1.0 - g * g) / (1.0 + g - 2.0 * g * u.x);
        cosine = clamp((1.0 + g * g - s * s) / (2.0 * g), -1.0, 1.0);
    }
    return basis(direction) * vec3f(on_circle(sqrt(max(1.0 - cosine * cosine, 0.0)), u.y), cosine);
}
