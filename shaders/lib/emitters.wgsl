// Light of emissive surfaces, by samples of their triangles: chosen by light trees, then uniform in solid angle or
// area.

#import area_sampling
#import lamps
#import light_tree
#import sampling
#import shown
#import surface
#import texels

override HAS_EMITTERS: bool = true;

// Light trees, a texel for each of their vectors.
@group(1) @binding(16) var emitters: VectorTexels;

fn light_words(k: u32) -> vec4u {
    return vector_at(emitters, k);
}

// Number of points of emitters of which each light ray is aimed at one, and of those among them whose triangle is
// chosen by power alone. The latter keep what the tree holds for unimportant from being bright and rare. Past a random
// choice, where the path's own grain is larger, there are fewer of both.
const EMITTER_CANDIDATES: u32 = 8u;
const CANDIDATES_BY_POWER: u32 = 2u;
const FEWER: u32 = 2u;

// Number of candidates that are expected of a triangle, where they are not fewer; by which the weights of light samples
// and of rays that meet it are found everywhere.
fn expected_candidates(chances: vec2f) -> f32 {
    return dot(chances, vec2f(f32(EMITTER_CANDIDATES - CANDIDATES_BY_POWER), f32(CANDIDATES_BY_POWER)));
}

// Distance of a triangle in lengths of its longest edge at the first corner, up to which its points are chosen by solid
// angle. Farther ones are sampled as well by area, at less cost.
const FAR_EDGES: f32 = 3.0;

// Largest solid angle of a triangle whose points are chosen by it, steradians: near a half space, 2 π, the formulas
// lose their digits.
const LARGEST_SOLID_ANGLE: f32 = 6.2;

// World-space corners of a triangle, relative to a point on the surface that it lights.
struct SeenTriangle {
    p: array<vec3f, 3>,
    area2: vec3f, // cross product of two edges, on the front
    solid_angle: f32, // steradians; 0: its points are chosen by area
}

fn seen_triangle(c: Corner, position: vec3f) -> SeenTriangle {
    var t: SeenTriangle;
    for (var k = 0u; k < 3u; k++) { t.p[k] = to_world(c.values, c.p[k]) - position; }
    let e1 = t.p[1] - t.p[0];
    let e2 = t.p[2] - t.p[0];
    t.area2 = cross(e1, e2);
    if ((c.values.flags & FLAG_MIRRORED) != 0u) { t.area2 = -t.area2; }
    if (dot(t.p[0], t.p[0]) > FAR_EDGES * FAR_EDGES * max(dot(e1, e1), dot(e2, e2))) { return t; }
    // Van Oosterom & Strackee 1983, "The Solid Angle of a Plane Triangle".
    let a = normalize(t.p[0]);
    let b = normalize(t.p[1]);
    let d = normalize(t.p[2]);
    let solid_angle = 2.0 * atan2(abs(dot(a, cross(b, d))), 1.0 + dot(a, b) + dot(b, d) + dot(d, a));
    // Small ones, seen from the edge, would lose their digits.
    if (solid_angle > 1e-3 && solid_angle < LARGEST_SOLID_ANGLE) { t.solid_angle = solid_angle; }
    return t;
}

// Density per solid angle of a point of a triangle at the distance of which `d2` is the square.
fn point_density(t: SeenTriangle, d2: f32, facing: f32) -> f32 {
    if (t.solid_angle > 0.0) { return 1.0 / t.solid_angle; }
    return d2 / max(facing * 0.5 * length(t.area2), 1e-30);
}

// Unit length, at a right angle to `to`.
fn across(v: vec3f, to: vec3f) -> vec3f {
    return normalize(v - to * dot(v, to));
}

// A direction towards a triangle, uniform in solid angle (Arvo 1995, "Stratified Sampling of Spherical Triangles").
fn spherical_direction(t: SeenTriangle, u: vec2f) -> vec3f {
    let a = normalize(t.p[0]);
    let b = normalize(t.p[1]);
    let c = normalize(t.p[2]);
    let to_b = across(b, a);
    let to_c = across(c, a);
    let alpha = atan2(length(cross(to_b, to_c)), dot(to_b, to_c));
    let angle = u.x * t.solid_angle - alpha;
    let s = sin(angle);
    let q = cos(angle);
    let cos_alpha = cos(alpha);
    let sin_alpha = sin(alpha);
    let k1 = q - cos_alpha;
    let k2 = s + sin_alpha * dot(a, b);
    let below = (k2 * s + k1 * q) * sin_alpha;
    let cosine = clamp(((k2 * q - k1 * s) * cos_alpha - k2) / select(below, 1e-30, below == 0.0), -1.0, 1.0);
    let on_edge = cosine * a + sqrt(1.0 - cosine * cosine) * across(c, a);
    let z = 1.0 - u.y * (1.0 - dot(on_edge, b));
    return z * b + sqrt(max(1.0 - z * z, 0.0)) * across(on_edge, b);
}

// Barycentric weights of vertex 1 and vertex 2 of a point that is sampled.
fn sampled_place(t: SeenTriangle, u: vec2f) -> vec2f {
    if (t.solid_angle == 0.0) {
        let root = sqrt(u.x);
        return vec2f(root * (1.0 - u.y), root * u.y);
    }
    // Möller & Trumbore 1997, with the eye at the origin.
    let direction = spherical_direction(t, u);
    let e1 = t.p[1] - t.p[0];
    let e2 = t.p[2] - t.p[0];
    let s = cross(direction, e2);
    let q = cross(-t.p[0], e1);
    let place = clamp(vec2f(dot(-t.p[0], s), dot(direction, q)) / dot(s, e1), vec2f(0.0), vec2f(1.0));
    return place / max(place.x + place.y, 1.0);
}

// A point of an emissive triangle as a light sample, without visibility, and a guess of the share that arrives: little
// from the inner side of a closed mesh.
struct EmitterSample {
    light: LightSample,
    seen_share: f32,
    shown: f32, // share that the picture shows
}

// `candidates`: number of them that are expected of the triangle.
fn emitter_sample(chosen: LightChoice, candidates: f32, position: vec3f, u: vec2f) -> EmitterSample {
    var r: LightSample;
    if (candidates <= 0.0) { return EmitterSample(r, 0.0, 0.0); }
    if (HAS_TREE_LAMPS && chosen.instance == NONE) {
        r = lamp_point(tree_lamp(chosen.triangle), position, u);
        r.pdf *= candidates;
        r.color /= candidates;
        return EmitterSample(r, 1.0, lamp_shown(chosen.triangle));
    }
    let instance = chosen.instance;
    let c = corners(instance, chosen.triangle);
    let m = c.values.material;
    let t = seen_triangle(c, position);
    let bary = sampled_place(t, u);
    let offset = t.p[0] + (t.p[1] - t.p[0]) * bary.x + (t.p[2] - t.p[0]) * bary.y;
    let d2 = max(dot(offset, offset), 1e-20);
    r.distance_m = sqrt(d2);
    r.to_light = offset / r.distance_m;
    var facing = -dot(t.area2, r.to_light) / max(length(t.area2), 1e-30);
    let seen_share = select(1.0, INNER_SHARE, facing < 0.0 && chosen.sides == 1u);
    if ((c.values.trace_flags & DOUBLE_SIDED) != 0u) { facing = abs(facing); }
    if (facing <= 0.0) { return EmitterSample(r, 0.0, 0.0); }
    var emission = material_at(m, instance, c, bary, Footprint()).emission * emitted_share(m, instance, c, bary, facing);
    if (HAS_TEXTURES) {
        emission *= texel_at(material_texture(m, EMISSION_SLOT), pools_of(EMISSION_SLOT), c, bary, Footprint()).xyz;
    }
    r.pdf = candidates * point_density(t, d2, facing);
    r.color = emission / max(r.pdf, 1e-30);
    return EmitterSample(r, seen_share, shown_emission(instance));
}

// Light of one point, chosen among several by the light that the surface would reflect of each (resampled importance
// sampling; Talbot et al. 2005).
fn returned_of_emitters(s: Surface, view: vec3f, to: Receiver, index: u32) -> Returned {
    if (!HAS_EMITTERS || sampling.light_tree.root == NONE) { return Returned(); }
    let lit = LitPoint(s.position, s.normal, 0u);
    let by_place = next_pair();
    let by_power = next_pair();
    let where_on_it = next_pair();
    var choice: Choice;
    choice.u = sample_square(index, next_pair()).x;
    let candidates = EMITTER_CANDIDATES / select(1u, FEWER, path_is_chance);
    let powerful = CANDIDATES_BY_POWER / select(1u, FEWER, path_is_chance);
    for (var k = 0u; k < candidates; k++) {
        let is_by_power = k < powerful;
        let place = index * select(candidates - powerful, powerful, is_by_power) + k - select(powerful, 0u, is_by_power);
        let which = sample_square(place, select(by_place, by_power, is_by_power));
        let chosen = chosen_light(which, is_by_power, lit);
        let expected = expected_candidates(chosen.chances);
        let point = emitter_sample(chosen, expected, s.position, sample_square(index * candidates + k, where_on_it));
        var part = to;
        var is_met = chosen.sides == 1u;
        if (!HAS_TREE_LAMPS || chosen.instance != NONE) {
            let flags = instance_trace_flags(chosen.instance);
            is_met = !is_passed(flags, UNREFLECTED);
            part.has_specular = to.has_specular && !is_passed(flags, MATTE_LIGHT);
        } else if (!is_met) {
            // No ray finds a point without a size, so that its highlight comes by light samples alone.
            part.has_specular = shows_points(s) && chosen.sides == 0u;
        }
        var lit_by = returned_of_lamp(s, view, part, point.light, is_met);
        lit_by.shown = point.shown;
        offer(&choice, lit_by, point.seen_share);
    }
    var one = standing_for_all(choice);
    // Light over the density of the expected candidates, each of which stands for as many as there are fewer.
    one.diffuse *= f32(EMITTER_CANDIDATES / candidates);
    one.specular *= f32(EMITTER_CANDIDATES / candidates);
    return one;
}

// Share of a surface's emission that a reflection ray takes; the rest comes by light samples. Lamps are not dimmed by
// the surface before, so that share is undone.
fn met_emission(ray: Reflected, instance: u32, triangle: u32, distance_m: f32, s: Surface) -> f32 {
    if (!HAS_EMITTERS || (instance_flags(instance) & FLAG_EMITTER) == 0u) { return 1.0; }
    if (ray.pdf == 0.0) { return 1.0 / ray.kept; }
    if (ray.pdf == TAKEN) { return 0.0; }
    let way_m = distance_m + passed_m;
    let origin = s.position - ray.direction * way_m;
    let t = seen_triangle(corners(instance, triangle), origin);
    let facing = abs(dot(s.geometric_normal, ray.direction));
    let candidates = expected_candidates(light_chances(instance, triangle, LitPoint(origin, ray.normal, 0u)));
    let pdf = candidates * point_density(t, way_m * way_m, facing);
    return balance(ray.pdf, pdf * f32(sampling.rays)) / ray.kept;
}
