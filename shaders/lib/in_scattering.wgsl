// Light that fog scatters into a ray: for each light one point of the ray, with a shadow.

#import fog
#import fog_emitters
#import fog_path
#import fog_reach
#import fog_sky
#import sampling

// Pairs of dimensions of random numbers: for each light a point of the ray and a point of the light, then the others.
const FOG_PAIR: u32 = 0x20000u;
const FOG_LIGHT_PAIR: u32 = 0x20000u + MAX_LIGHTS;
const FOG_CHOICE_PAIR: u32 = 0x21000u; // which light has a shadow ray
const FOG_SKY_PAIR: u32 = 0x21001u; // direction of the surroundings
const FOG_PLACE_PAIR: u32 = 0x21002u; // point that the surroundings light, and the side of the ray
const FOG_EMITTER_PAIR: u32 = 0x21003u; // which emitting triangle
const FOG_EMITTED_PAIR: u32 = 0x21004u; // point of the triangle
const FOG_EMITTER_PLACE_PAIR: u32 = 0x21005u; // point of the ray that it lights
const FOG_PATH_PAIR: u32 = 0x21006u; // where the path is scattered, and whether it goes on
const FOG_TURN_PAIR: u32 = 0x21007u; // direction in which it goes on

// Optical depth past which no point lights the start of a ray: less than rounding arrives from there.
const DEEPEST: f32 = 16.0;

// Part of a ray that lies in fog.
struct Way {
    origin: vec3f,
    direction: vec3f,
    span: vec2f, // distances at which it begins and ends, m
    length_m: f32, // length weighted by density
    scattered: f32, // 1 minus its transmittance
}

fn way_in_fog(origin: vec3f, direction: vec3f, distance_m: f32) -> Way {
    return way_within(origin, direction, fog_span(origin, direction, distance_m));
}

fn way_within(origin: vec3f, direction: vec3f, span: vec2f) -> Way {
    let length_m = fog_length(origin, direction, span);
    let depth = min(fog.density * length_m, 87.0);
    return Way(origin, direction, span, length_m, depth * mean_decay(depth));
}

// A point of a ray, and the light that arrives from there over the density of choosing it, for a radiance of 1 per
// meter.
struct Place {
    t: f32,
    weight: f32,
}

// A point at a random free path: it has the density of the light that is scattered and arrives.
fn place_by_depth(way: Way, u: f32) -> Place {
    let x = u * way.scattered;
    var depth = -log(max(1.0 - x, 1e-30));
    if (x < 0.02) { depth = x * (1.0 + x * (0.5 + x * (1.0 / 3.0 + x * 0.25))); }
    let reached = fog_reached(way.origin, way.direction, way.span, min(depth / fog.density, way.length_m));
    return Place(clamp(reached, way.span.x, way.span.y), way.scattered);
}

// A ray as angles at `pivot`, from the foot of the perpendicular.
struct Angles {
    along_m: f32, // distance at which the foot lies
    nearest_m: f32, // length of the perpendicular
    start: f32, // tangent of the angle at which the ray enters the fog
    angle: f32, // angle that the ray spans in the fog
    end_m: f32, // distance past which no point is chosen
}

fn angles_at(way: Way, pivot: vec3f) -> Angles {
    var end_m = way.span.y;
    let deepest_m = DEEPEST / fog.density;
    if (way.length_m > deepest_m) {
        end_m = min(end_m, fog_reached(way.origin, way.direction, way.span, deepest_m));
    }
    end_m = min(end_m, way.span.x + 1e12);
    let along_m = dot(pivot - way.origin, way.direction);
    let off = pivot - way.origin - way.direction * along_m;
    let from_m = way.span.x - along_m;
    let to_m = end_m - along_m;
    let nearest_m = max(length(off), 1e-6 * (1e-6 + min(abs(from_m), abs(to_m))));
    // Angles from the foot of the perpendicular, in units of its length; their difference keeps its digits.
    let a = from_m / nearest_m;
    let b = to_m / nearest_m;
    return Angles(along_m, nearest_m, a, max(atan2(b - a, 1.0 + a * b), 1e-30), end_m);
}

// Share of `place_towards` that is chosen at random free paths: the more the denser the fog.
fn share_by_depth(way: Way) -> f32 {
    return 0.5 * way.scattered;
}

// At a point of a ray: the density of free paths that end there and are not absorbed before, per meter, times the light
// that arrives from there; and the density with which `place_towards` chooses the point.
fn seen_and_density(way: Way, at: Angles, t: f32) -> vec2f {
    let by_depth = share_by_depth(way);
    let thinness = fog_thinness(fog_height(way.origin, way.direction, t));
    let before_m = fog_length(way.origin, way.direction, vec2f(way.span.x, t));
    let seen = fog.density * thinness * decay(fog.density * before_m);
    let offset_m = t - at.along_m;
    let by_angle = at.nearest_m / (at.angle * (at.nearest_m * at.nearest_m + offset_m * offset_m));
    return vec2f(seen, by_depth * seen / max(way.scattered, 1e-30) + (1.0 - by_depth) * by_angle);
}

// A point for light from `pivot`: at equal angles seen from there (Kulla and Fajardo 2012, "Importance Sampling
// Techniques for Path Tracing in Participating Media"), or, the more often the denser the fog, at a random free path;
// weighted by the balance heuristic.
fn place_towards(way: Way, pivot: vec3f, u: f32) -> Place {
    let by_depth = share_by_depth(way);
    let at = angles_at(way, pivot);
    var t: f32;
    if (u < by_depth) {
        t = place_by_depth(way, u / by_depth).t;
    } else {
        let step = at.angle * (u - by_depth) / (1.0 - by_depth);
        // The tangent of the sum of two angles.
        let s = sin(step);
        let c = cos(step);
        t = at.along_m + at.nearest_m * (at.start * c + s) / max(c - at.start * s, 1e-30);
    }
    t = clamp(t, way.span.x, at.end_m);
    let seen = seen_and_density(way, at, t);
    return Place(t, seen.x / max(seen.y, 1e-30));
}

// Light that a point of a ray scatters into it; `share` of the point's light arrives there.
fn scattered_by(way: Way, place: Place, l: LightSample, share: f32) -> Returned {
    let light = l.color * (place.weight * share * fog_phase(dot(way.direction, l.to_light)));
    return Returned(way.origin + way.direction * place.t, l.to_light, l.distance_m, light, vec3f(0.0), 1.0);
}

fn scattered_of_light(way: Way, i: u32, index: u32) -> Returned {
    let u = sample_square(index, FOG_PAIR + i);
    var place: Place;
    if (lights[i].kind == LIGHT_DIRECTIONAL) {
        place = place_by_depth(way, u.x);
    } else {
        let lit = way_within(way.origin, way.direction, span_lit_by(way.span, i, way.origin, way.direction));
        if (lit.scattered <= 1e-12) { return Returned(); }
        place = place_towards(lit, lights[i].position, u.x);
        place.weight *= decay(fog.density * fog_length(way.origin, way.direction, vec2f(way.span.x, lit.span.x)));
    }
    let position = way.origin + way.direction * place.t;
    if (HAS_SIZED_LIGHTS && i >= frame.hard_lights) {
        let l = light_sample(i, position, sample_square(index, FOG_LIGHT_PAIR + i));
        return scattered_by(way, place, l, fog_share(position, l.to_light, l.distance_m));
    }
    return scattered_by(way, place, incoming(i, position), 1.0);
}

// Light that the fog on a ray scatters into it, coming straight from lights, emitters and the surroundings. `index` is
// the number of the sample, `sky_kept` the share of the light of the surroundings that counts.
fn scattered_on_way(way: Way, index: u32, sky_kept: f32) -> vec3f {
    var out = vec3f(0.0);
    if (way.scattered <= 1e-12) { return out; }
    let u = sample_square(index, FOG_CHOICE_PAIR);
    var suns: Choice;
    var lamps: Choice;
    suns.u = u.x;
    lamps.u = u.y;
    for (var i = 0u; i < frame.light_count; i++) {
        var s = scattered_of_light(way, i, index);
        s.shown = shown_share(i);
        if (!any(s.diffuse > vec3f(0.0))) { continue; }
        if (!HAS_SHADOW_RAYS || lights[i].shadow != SHADOW_RAY) {
            out += s.diffuse * s.shown * map_share(i, s.position, s.to_light, s.to_light);
        } else if (lights[i].kind == LIGHT_DIRECTIONAL) {
            offer(&suns, s, 1.0);
        } else {
            offer(&lamps, s, 1.0);
        }
    }
    var sky: Returned;
    if (sky_kept > 0.0) { sky = scattered_of_sky(way, index); }
    sky.diffuse *= sky_kept;
    if (!HAS_ENVIRONMENT_RAYS) { out += sky.diffuse; }
    let emitted = scattered_of_emitters(way, index);
    // One call in a loop keeps the inlined code small: the traversal is long.
    let first = select(SKY, SUNS, HAS_SHADOW_RAYS);
    let end = select(select(SKY, EMITTERS, HAS_ENVIRONMENT_RAYS), EMITTERS + 1u, HAS_EMITTERS);
    for (var source = first; source < end; source++) {
        var s = emitted;
        if (source == SUNS) { s = standing_for_all(suns); }
        if (source == LAMPS) { s = standing_for_all(lamps); }
        if (source == SKY) { s = sky; }
        if (!any(s.diffuse > vec3f(0.0)) || (!HAS_ENVIRONMENT_RAYS && source == SKY)) { continue; }
        let reach_m = select(FAR_M, s.distance_m * 0.9999, s.distance_m < BEYOND);
        out += s.diffuse * s.shown * transmittance(s.position, s.to_light, reach_m);
    }
    return out * fog.albedo;
}

// Light on the way of a ray: light that fog scatters into it, and the continuation of a path past it.
struct Air {
    light: vec3f, // light that fog scatters into the ray
    share: vec3f, // factor on light from further on
    scatters: bool, // whether it goes on from a point in the fog, along `ray`, rather than from the end of the way
    ray: Reflected,
    position: vec3f,
}

fn through_air(origin: vec3f, ray: Reflected, distance_m: f32) -> Air {
    var air = Air(vec3f(0.0), vec3f(1.0), false, ray, origin);
    // No fog is within transmissive solids.
    if (!HAS_FOG || (HAS_LAYERS && media.solids > 0u)) { return air; }
    let way = way_in_fog(origin, ray.direction, distance_m);
    air.light = scattered_on_way(way, sample_index(), sky_kept(ray)) * ray.kept;
    return passed(air, way);
}
