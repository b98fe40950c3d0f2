// Lamps that a light tree chooses: their samples, and the nearest one on a ray. area_sampling.wgsl and emitters.wgsl,
// which import this file, declare the rest of its bindings.

#import lamp_shape
#import sampling

override HAS_TREE_LAMPS: bool = true;
override HAS_SIZED_LAMPS: bool = true; // whether some lamp of the tree has a size
override HAS_HARD_LAMPS: bool = true; // whether some lamp of the tree has none

// Records of lamps are as long as records of placed lights: kind with LAMP_RECORD, range, node and extent; position,
// direction, and half of the first edge or the cone falloff, each with a channel of the color.
fn is_lamp_record(record: vec4u) -> bool {
    return (record.x & ~(7u | DARK_LAMP | UNREFLECTED_LAMP)) == LAMP_RECORD;
}

// Share of a lamp's light that the picture shows.
fn lamp_shown(item: u32) -> f32 {
    if (!HAS_LIGHT_GROUPS) { return 1.0; }
    return select(1.0, 0.0, (light_words(sampling.light_tree.lights + item * LIGHT_VECTORS).x & DARK_LAMP) != 0u);
}

fn tree_lamp(item: u32) -> Lamp {
    let at = sampling.light_tree.lights + item * LIGHT_VECTORS;
    let record = light_words(at);
    let place = bitcast<vec4f>(light_words(at + 1u));
    let ahead = bitcast<vec4f>(light_words(at + 2u));
    let form = bitcast<vec4f>(light_words(at + 3u));
    let extent = bitcast<f32>(record.w);
    let half_v = cross(form.xyz / max(length(form.xyz), 1e-30), ahead.xyz) * extent;
    let color = vec3f(place.w, ahead.w, form.w);
    return Lamp(place.xyz, record.x & 7u, ahead.xyz, extent, color, bitcast<f32>(record.y), form.xyz, half_v, form.xy);
}

fn lamp_reach(lamp: Lamp, to_light: vec3f, distance_m: f32) -> f32 {
    var share = range_share(lamp.range_m, distance_m);
    if (lamp.kind == LIGHT_SPOT) { share *= cone_share(lamp.direction, lamp.spot, to_light); }
    return share;
}

// A point of a lamp: its arriving radiance over its density per solid angle; of a lamp without a size the light itself,
// with the density 1.
fn lamp_point(lamp: Lamp, position: vec3f, u: vec2f) -> LightSample {
    if (is_flat(lamp)) { return flat_point(lamp, position, u); }
    let offset = lamp.position - position;
    let d2 = max(dot(offset, offset), 1e-20);
    let d = sqrt(d2);
    var r = LightSample(offset / d, d, lamp.color / d2, 1.0);
    if (lamp.extent > 0.0) { r = ball_point(offset, lamp.extent, lamp.color, u); }
    r.color *= lamp_reach(lamp, offset / d, d);
    return r;
}

// Point at which a ray meets a lamp with a size.
fn lamp_met(lamp: Lamp, origin: vec3f, direction: vec3f) -> MetPoint {
    let offset = lamp.position - origin;
    if (is_flat(lamp)) { return flat_met(lamp, offset, direction, passed_m); }
    var ball = ball_met(offset, lamp.extent, direction, passed_m);
    let d = length(offset);
    ball.radiance = lamp.color / PI * (lamp_reach(lamp, offset / max(d, 1e-12), d) / (lamp.extent * lamp.extent));
    return ball;
}

// Distance along a ray at which it enters the ball of a node; FAR_M past it or past `t_max`.
fn entered(node: u32, origin: vec3f, direction: vec3f, t_max: f32) -> f32 {
    let at = sampling.light_tree.nodes + node * LIGHT_NODE_VECTORS;
    let radius = bitcast<f32>(light_words(at + 1u).y & 0xffff0000u);
    let offset = bitcast<vec3f>(light_words(at).xyz) - origin;
    let along = dot(offset, direction);
    let off = offset - direction * along;
    let rest = radius * radius - dot(off, off);
    let half_m = sqrt(max(rest, 0.0));
    if (rest < 0.0 || along + half_m < 0.0 || along - half_m > t_max) { return 2.0 * FAR_M; }
    return along - half_m;
}

// Point at which a ray meets the first lamp with a size; `t` of `t_max`: none. The density is of light samples of the
// surface that the ray left, the choice of the lamp included.
fn met_lamp(origin: vec3f, ray: Reflected, t_max: f32) -> MetPoint {
    var met = MetPoint(t_max, 0.0, vec3f(0.0));
    if (!HAS_SIZED_LAMPS || sampling.light_tree.root == NONE) { return met; }
    var item = NONE;
    var open: array<u32, MOST_LINKS>;
    var count = 1u;
    open[0] = sampling.light_tree.root;
    while (count > 0u) {
        count--;
        let link = open[count];
        if ((link & LIGHT_LEAF) == 0u) {
            let a = entered(link, origin, ray.direction, met.t);
            let b = entered(link + 1u, origin, ray.direction, met.t);
            let is_first_nearer = a <= b;
            let links = vec2u(node_link(link), node_link(link + 1u));
            // The nearer one is looked at next.
            if (max(a, b) <= met.t) {
                open[count] = select(links.x, links.y, is_first_nearer);
                count++;
            }
            if (min(a, b) <= met.t) {
                open[count] = select(links.y, links.x, is_first_nearer);
                count++;
            }
            continue;
        }
        let found = link & ~LIGHT_LEAF;
        let record = light_words(sampling.light_tree.lights + found * LIGHT_VECTORS);
        if (!is_lamp_record(record) || (HIDES_LIGHTS && (record.x & UNREFLECTED_LAMP) != 0u)) { continue; }
        let lamp = tree_lamp(found);
        if (lamp.extent <= 0.0) { continue; }
        let at = lamp_met(lamp, origin, ray.direction);
        if (at.t > 0.0 && at.t < met.t) {
            met = MetPoint(at.t, at.pdf, at.radiance * lamp_shown(found));
            item = found;
        }
    }
    if (item != NONE && ray.pdf > 0.0) {
        let lit = LitPoint(origin - ray.direction * passed_m, ray.normal, 0u);
        met.pdf *= expected_candidates(lamp_chances(item, lit));
    }
    return met;
}

fn node_link(node: u32) -> u32 {
    return light_words(sampling.light_tree.nodes + node * LIGHT_NODE_VECTORS + 1u).z;
}
