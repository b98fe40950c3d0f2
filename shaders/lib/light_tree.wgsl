// Light tree: chooses an emissive triangle or a lamp for a surface, and gives the probability of one, by the nodes and
// the formulas of src/world/light_tree.rs. The including shader declares:
//   light_words(i: u32) -> vec4u   texels of src/render/upload/emitters.rs: words of instances, the index of each one's placed
//                                  light; placed lights; nodes; words of triangles, the node of each
//   sampling.light_tree                where these begin

#import constants
#import fog
#import lamps
#import pack
#import sampling

// LIGHT_VECTORS vectors are a placed light: link of its mesh's root, first word of its triangles, node, instance with
// sides in the lowest two bits; then rows of tree_from_world.

// A surface, as a tree sees it.
struct LitPoint {
    position: vec3f,
    normal: vec3f, // 0: a point in fog, which is lit from all around
    sides: u32, // sides that emit light, beside the sides of each node
}

// A chosen triangle or lamp; probabilities of 0: none.
struct LightChoice {
    instance: u32, // NONE: a lamp
    triangle: u32, // or the number of the lamp's record
    chances: vec2f, // by importance, by power
    sides: u32, // sides that emit light: 0 the front, 1 both of a closed mesh, 2 both; of a
    // lamp: 1 if it has a size, 2 if reflections do not show it
}

fn sine_of(cosine: f32) -> f32 {
    return sqrt(max(1.0 - cosine * cosine, 0.0));
}

// Bound of the cosine at which light leaves: the angle to the axis is less by the cone, and by the angle that the ball
// covers.
fn leaving(cosine: f32, cone: f32, ball_sine: f32) -> f32 {
    if (cosine >= cone) { return 1.0; }
    return saturate(cosine * cone + sine_of(cosine) * sine_of(cone) + ball_sine);
}

// Bound of the cosine at which light arrives; 1 without a normal.
fn arriving(way: vec3f, ball_sine: f32, normal: vec3f) -> f32 {
    if (HAS_FOG && all(normal == vec3f(0.0))) { return 1.0; }
    return saturate(ball_sine - dot(way, normal));
}

fn light_importance(a: vec4u, b: vec4u, to: LitPoint) -> f32 {
    let power = bitcast<f32>(a.w);
    let offset = to.position - bitcast<vec3f>(a.xyz);
    let distance2 = dot(offset, offset);
    let radius = bitcast<f32>(b.y & 0xffff0000u);
    if (distance2 <= radius * radius) { return power / max(radius * radius, 1e-36); }
    let inverse = inverseSqrt(distance2);
    let way = offset * inverse;
    let ball_sine = radius * inverse;
    let cone = f32((b.y >> 2u) & 0x3fffu) * (2.0 / 16383.0) - 1.0;
    let cosine = dot(way, unpack_unit(b.x));
    if (HAS_TREE_LAMPS && (b.y & 3u) == CONE_SIDES) {
        // Lamps in a ball shine within their cone alone: up to an angle beyond it that the ball covers, and rounding.
        let nearer = cosine * cone + sine_of(cosine) * sine_of(cone);
        if (cosine < cone && nearer < sine_of(ball_sine) - 1e-6) { return 0.0; }
        return power * arriving(way, ball_sine, to.normal) / distance2;
    }
    let sides = max(b.y & 3u, to.sides);
    var left = leaving(cosine, cone, ball_sine);
    if (sides > 0u && cosine < 0.0) {
        left = max(left, select(1.0, INNER_SHARE, sides == 1u) * leaving(-cosine, cone, ball_sine));
    }
    return power * left * arriving(way, ball_sine, to.normal) / distance2;
}

// A pair of nodes, as a surface sees it.
struct SeenPair {
    shares: vec2f, // of the first node, by importance and by power; below 0 where neither node is important
    links: vec2u,
    parent: u32,
}

fn seen_pair(pair: u32, to: LitPoint) -> SeenPair {
    let at = sampling.light_tree.nodes + pair * LIGHT_NODE_VECTORS;
    let a = light_words(at);
    let a_bounds = light_words(at + 1u);
    let b = light_words(at + LIGHT_NODE_VECTORS);
    let b_bounds = light_words(at + LIGHT_NODE_VECTORS + 1u);
    let first = light_importance(a, a_bounds, to);
    let both = first + light_importance(b, b_bounds, to);
    let by_power = bitcast<f32>(a.w) / (bitcast<f32>(a.w) + bitcast<f32>(b.w));
    let by_place = select(first / both, -1.0, both <= 0.0);
    return SeenPair(vec2f(by_place, by_power), vec2u(a_bounds.z, b_bounds.z), a_bounds.w);
}

// The surface in the space of the tree of a placed light's mesh.
fn in_tree(light: u32, to: LitPoint) -> LitPoint {
    let at = sampling.light_tree.lights + light * LIGHT_VECTORS;
    let rows = mat3x4f(bitcast<vec4f>(light_words(at + 1u)), bitcast<vec4f>(light_words(at + 2u)),
        bitcast<vec4f>(light_words(at + 3u)));
    var normal = vec4f(to.normal, 0.0) * rows;
    if (!HAS_FOG || any(normal != vec3f(0.0))) { normal = normalize(normal); }
    return LitPoint(vec4f(to.position, 1.0) * rows, normal, light_words(at).w & 3u);
}

// Word `i` of an array of words, four in each vector.
fn light_word(first: u32, i: u32) -> u32 {
    return light_words(first + (i >> 2u))[i & 3u];
}

// A random number on its way down the trees, with the probability of the way by importance and by power.
struct Descent {
    u: f32,
    digits: u32, // random bits, for the digits of `u` past its 24
    link: u32,
    chances: vec2f,
}

// Descends to an item of a tree.
fn descend_lights(start: Descent, by_power: bool, to: LitPoint) -> Descent {
    var at = start;
    for (var k = 0u; k < MOST_LINKS; k++) {
        if ((at.link & LIGHT_LEAF) != 0u) { break; }
        let pair = seen_pair(at.link, to);
        let share = select(pair.shares.x, pair.shares.y, by_power);
        let is_second = at.u >= share;
        at.chances *= parts(pair.shares, is_second);
        // The rest of `u` has fewer digits the rarer the way is. Further digits are drawn, so that each level chooses
        // by 24.
        at.digits = hash(at.digits);
        let rest = at.u - select(0.0, share, is_second) + unit_float(at.digits) * exp2(-24.0);
        at.u = min(rest / select(share, 1.0 - share, is_second), 0.99999994);
        at.link = select(pair.links.x, pair.links.y, is_second);
    }
    return at;
}

// Shares of a node of a pair; 0 by importance where neither is important.
fn parts(shares: vec2f, is_second: bool) -> vec2f {
    let both = select(shares, 1.0 - shares, is_second);
    return vec2f(select(both.x, 0.0, shares.x < 0.0), both.y);
}

// The triangle that two random numbers choose: by importance, or by power alone. The second gives digits to the first.
fn chosen_light(u: vec2f, by_power: bool, surface: LitPoint) -> LightChoice {
    var at = Descent(u.x, bitcast<u32>(u.y), sampling.light_tree.root, vec2f(1.0));
    var to = surface;
    var instance = NONE;
    // One call in a loop keeps the inlined code small.
    for (var tree = 0u; tree < 2u; tree++) {
        at = descend_lights(at, by_power, to);
        if (tree == 1u) { break; }
        let light = at.link & ~LIGHT_LEAF;
        let record = light_words(sampling.light_tree.lights + light * LIGHT_VECTORS);
        if (HAS_TREE_LAMPS && is_lamp_record(record)) {
            if (!by_power && at.chances.x <= 0.0) { return LightChoice(); }
            return LightChoice(NONE, light, at.chances, select(u32(bitcast<f32>(record.w) > 0.0), 2u, HIDES_LIGHTS && (record.x & UNREFLECTED_LAMP) != 0u));
        }
        instance = record.w >> 2u;
        at.link = record.x;
        to = in_tree(light, surface);
    }
    // A way that nothing recommends has a chance of 0 by importance, and is left out.
    if (!by_power && at.chances.x <= 0.0) { return LightChoice(); }
    return LightChoice(instance, at.link & ~LIGHT_LEAF, at.chances, to.sides);
}

// Probabilities of the way down to a node of a mesh's tree and to its node `above` in the scene's tree, by importance and by
// power. `to` is the surface in the mesh's tree, `surface` in the scene's. NONE: the way ends above.
fn chances_of_way(item: u32, to: LitPoint, above: u32, surface: LitPoint) -> vec2f {
    var node = item;
    var seen_as = to;
    var chances = vec2f(1.0);
    var is_above = false;
    for (var k = 0u; k < MOST_LINKS; k++) {
        if (node == NONE) {
            if (is_above) { break; }
            is_above = true;
            node = above;
            seen_as = surface;
            continue;
        }
        let pair = seen_pair(node & ~1u, seen_as);
        chances *= parts(pair.shares, (node & 1u) == 1u);
        node = pair.parent;
    }
    return chances;
}

// Probabilities with which `chosen_light` chooses a triangle of an instance that emits light, by importance and by
// power.
fn light_chances(instance: u32, triangle: u32, surface: LitPoint) -> vec2f {
    let light = light_word(0u, instance);
    let record = light_words(sampling.light_tree.lights + light * LIGHT_VECTORS);
    let node = light_word(sampling.light_tree.places, record.y + triangle);
    if (node == UNLIT_ITEM || record.z == UNLIT_ITEM) { return vec2f(0.0); }
    return chances_of_way(node, in_tree(light, surface), record.z, surface);
}

// Probabilities with which `chosen_light` chooses a lamp, by importance and by power.
fn lamp_chances(item: u32, surface: LitPoint) -> vec2f {
    return chances_of_way(NONE, surface, light_words(sampling.light_tree.lights + item * LIGHT_VECTORS).z, surface);
}
