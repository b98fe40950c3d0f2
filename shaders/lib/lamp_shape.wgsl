// Lamps with a size: a sampled point of a ball or of a flat lamp, and the point at which a ray meets it.

#import frame

struct Lamp {
    position: vec3f,
    kind: u32, // LIGHT_*
    direction: vec3f,
    extent: f32, // radius, m; of a flat lamp half its second edge; 0: a point without a size
    color: vec3f, // candela per channel
    range_m: f32, // 0: unlimited
    half_u: vec3f, // half axes of a flat lamp, m
    half_v: vec3f,
    spot: vec2f, // scale and offset of the cone falloff
}

fn is_flat(lamp: Lamp) -> bool {
    return lamp.kind == LIGHT_RECT || lamp.kind == LIGHT_DISK;
}

// A sampled point of a light: its arriving radiance over the density of choosing it.
struct LightSample {
    to_light: vec3f,
    distance_m: f32,
    color: vec3f,
    pdf: f32, // per solid angle
}

// Area of a flat lamp.
fn flat_area(lamp: Lamp) -> f32 {
    let edges = sqrt(dot(lamp.half_u, lamp.half_u) * dot(lamp.half_v, lamp.half_v));
    return edges * select(4.0, PI, lamp.kind == LIGHT_DISK);
}

// A point of a flat lamp, uniform in area, for a surface at `position`; its color is the intensity straight ahead.
fn flat_point(lamp: Lamp, position: vec3f, u: vec2f) -> LightSample {
    var r: LightSample;
    var at = u * 2.0 - 1.0;
    if (lamp.kind == LIGHT_DISK) { at = on_circle(sqrt(u.x), u.y); }
    let way = lamp.position + lamp.half_u * at.x + lamp.half_v * at.y - position;
    let d2 = max(dot(way, way), 1e-20);
    r.distance_m = sqrt(d2);
    r.to_light = way / r.distance_m;
    let facing = max(-dot(lamp.direction, r.to_light), 0.0);
    r.color = lamp.color * (facing / d2);
    r.pdf = d2 / max(facing * flat_area(lamp), 1e-20);
    return r;
}

// A point of a glowing ball: its visible cap is sampled uniformly in solid angle (Shirley & Wang 1994).
fn ball_point(offset: vec3f, radius_m: f32, intensity: vec3f, u: vec2f) -> LightSample {
    var r: LightSample;
    let d2 = dot(offset, offset);
    let sine2 = radius_m * radius_m / d2;
    if (sine2 >= 1.0) { return r; }
    let d = sqrt(d2);
    let cap = sine2 / (1.0 + sqrt(1.0 - sine2)); // 1 - cos, without cancellation
    let below = u.x * cap;
    let flat2 = below * (2.0 - below);
    r.to_light = basis(offset / d) * vec3f(on_circle(sqrt(flat2), u.y), 1.0 - below);
    r.distance_m = d * (1.0 - below) - sqrt(max(radius_m * radius_m - d2 * flat2, 0.0));
    // I = π r² L.
    r.color = intensity * (2.0 * cap / (radius_m * radius_m));
    r.pdf = 1.0 / (2.0 * PI * cap);
    return r;
}

// Point at which a ray meets a lamp.
struct MetPoint {
    t: f32, // below 0: it does not
    pdf: f32, // density per solid angle of light samples, from where the ray was `passed_m` before
    radiance: vec3f,
}

fn flat_met(lamp: Lamp, offset: vec3f, direction: vec3f, passed_m: f32) -> MetPoint {
    let facing = -dot(direction, lamp.direction);
    let u2 = dot(lamp.half_u, lamp.half_u);
    let v2 = dot(lamp.half_v, lamp.half_v);
    let at_t = -dot(offset, lamp.direction) / max(facing, 1e-12);
    let on = direction * at_t - offset;
    let at = vec2f(dot(on, lamp.half_u) / u2, dot(on, lamp.half_v) / v2);
    let inside = select(max(abs(at.x), abs(at.y)), length(at), lamp.kind == LIGHT_DISK) <= 1.0;
    let area = flat_area(lamp);
    let pdf = (at_t + passed_m) * (at_t + passed_m) / max(facing * area, 1e-20);
    return MetPoint(select(-1.0, at_t, facing > 0.0 && inside), pdf, lamp.color / area);
}

fn ball_met(offset: vec3f, radius_m: f32, direction: vec3f, passed_m: f32) -> MetPoint {
    let along = dot(offset, direction);
    let off = offset - direction * along;
    let rest = radius_m * radius_m - dot(off, off);
    let whole = offset + direction * passed_m;
    let sine2 = min(radius_m * radius_m / max(dot(whole, whole), 1e-20), 1.0);
    let pdf = (1.0 + sqrt(1.0 - sine2)) / (2.0 * PI * sine2);
    let is_met = rest > 0.0 && dot(offset, offset) > radius_m * radius_m;
    return MetPoint(select(-1.0, along - sqrt(max(rest, 0.0)), is_met), pdf, vec3f(0.0));
}
