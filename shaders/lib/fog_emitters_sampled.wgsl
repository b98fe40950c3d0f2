// Light of emitting surfaces that fog scatters.

#import emitters

// Number of points of emitters among which one is chosen.
const FOG_CANDIDATES: u32 = 8u;

fn emitter_center(chosen: LightChoice) -> vec3f {
    if (HAS_TREE_LAMPS && chosen.instance == NONE) { return tree_lamp(chosen.triangle).position; }
    let c = corners(chosen.instance, chosen.triangle);
    return to_world(chosen.instance, (c.p[0] + c.p[1] + c.p[2]) / 3.0);
}

// A point of an emitter and a point of the ray that it lights, chosen among several by the light that they add.
fn scattered_of_emitters(way: Way, index: u32) -> Scattered {
    if (sampling.light_tree.root == NONE) { return Scattered(); }
    var choice: ScatteredChoice;
    choice.u = sample_square(index, FOG_EMITTER_PLACE_PAIR).y;
    for (var k = 0u; k < FOG_CANDIDATES; k++) {
        let candidate = index * FOG_CANDIDATES + k;
        // By power alone, since the place on the ray is chosen for the emitter.
        let surface = LitPoint(way.origin, way.direction, 0u);
        let chosen = chosen_light(sample_square(candidate, FOG_EMITTER_PAIR).x, true, surface);
        let place = place_towards(way, emitter_center(chosen), sample_square(candidate, FOG_EMITTER_PLACE_PAIR).x);
        let position = way.origin + way.direction * place.t;
        let expected = f32(FOG_CANDIDATES) * chosen.chances.y;
        let l = emitter_sample(chosen, expected, position, sample_square(candidate, FOG_EMITTED_PAIR)).light;
        if (l.pdf <= 0.0) { continue; }
        offer_scattered(&choice, scattered_by(way, place, l, fog_share(position, l.to_light, l.distance_m)));
    }
    return scattered_choice(choice);
}
