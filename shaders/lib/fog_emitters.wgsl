// Light of emitting surfaces that fog scatters.

#import emitters

// Number of points of emitters among which one is chosen, and of those among them whose emitter is chosen by power
// alone, and the place on the ray for it. Of the others the place is chosen first, at a random free path, then the
// emitter by the light tree.
const FOG_CANDIDATES: u32 = 8u;
const FOG_BY_POWER: u32 = 4u;

fn emitter_center(chosen: LightChoice) -> vec3f {
    if (HAS_TREE_LAMPS && chosen.instance == NONE) { return tree_lamp(chosen.triangle).position; }
    let c = corners(chosen.instance, chosen.triangle);
    return to_world(c.values, (c.p[0] + c.p[1] + c.p[2]) / 3.0);
}

fn chances_in_fog(chosen: LightChoice, lit: LitPoint) -> vec2f {
    if (HAS_TREE_LAMPS && chosen.instance == NONE) { return lamp_chances(chosen.triangle, lit); }
    return light_chances(chosen.instance, chosen.triangle, lit);
}

// A point of an emitter and a point of the ray that it lights, chosen among several by the light that they add; both
// ways to find one are weighted by the balance heuristic.
fn scattered_of_emitters(way: Way, index: u32) -> Returned {
    if (!HAS_EMITTERS || sampling.light_tree.root == NONE) { return Returned(); }
    var choice: Choice;
    choice.u = sample_square(index, FOG_EMITTER_PLACE_PAIR).y;
    for (var k = 0u; k < FOG_CANDIDATES; k++) {
        let candidate = index * FOG_CANDIDATES + k;
        let is_by_power = k < FOG_BY_POWER;
        let u = sample_square(candidate, FOG_EMITTER_PLACE_PAIR).x;
        var t = place_by_depth(way, u).t;
        let lit = LitPoint(way.origin + way.direction * t, vec3f(0.0), 0u);
        let chosen = chosen_light(sample_square(candidate, FOG_EMITTER_PAIR), is_by_power, lit);
        if (chosen.chances.y <= 0.0) { continue; }
        let pivot = emitter_center(chosen);
        var by_place = chosen.chances.x;
        if (is_by_power) {
            t = place_towards(way, pivot, u).t;
            by_place = chances_in_fog(chosen, LitPoint(way.origin + way.direction * t, vec3f(0.0), 0u)).x;
        }
        let position = way.origin + way.direction * t;
        let seen = seen_and_density(way, angles_at(way, pivot), t);
        let expected = f32(FOG_BY_POWER) * chosen.chances.y * seen.y
            + f32(FOG_CANDIDATES - FOG_BY_POWER) * by_place * seen.x / max(way.scattered, 1e-30);
        let point = emitter_sample(chosen, 1.0, position, sample_square(candidate, FOG_EMITTED_PAIR));
        let l = point.light;
        if (l.pdf <= 0.0) { continue; }
        let place = Place(t, seen.x / max(expected, 1e-30));
        var s = scattered_by(way, place, l, fog_share(position, l.to_light, l.distance_m));
        s.shown = point.shown;
        offer(&choice, s, 1.0);
    }
    return standing_for_all(choice);
}
