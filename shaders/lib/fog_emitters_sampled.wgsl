// Light of emitting surfaces that fog scatters.

#import emitters

// Number of points of emitters among which one is chosen.
const FOG_CANDIDATES: u32 = 8u;

// A point of an emitter and a point of the ray that it lights, chosen among several by the light that they add.
fn scattered_of_emitters(way: Way, index: u32) -> Scattered {
    if (sampling.emitted_power <= 0.0) { return Scattered(); }
    var choice: ScatteredChoice;
    choice.u = sample_square(index, FOG_EMITTER_PLACE_PAIR).y;
    for (var k = 0u; k < FOG_CANDIDATES; k++) {
        let candidate = index * FOG_CANDIDATES + k;
        let id = chosen_emitter(sample_square(candidate, FOG_EMITTER_PAIR));
        let c = corners(id.x, id.y);
        let pivot = to_world(id.x, (c.p[0] + c.p[1] + c.p[2]) / 3.0);
        let place = place_towards(way, pivot, sample_square(candidate, FOG_EMITTER_PLACE_PAIR).x);
        let position = way.origin + way.direction * place.t;
        let l = emitter_sample(id, position, sample_square(candidate, FOG_EMITTED_PAIR));
        if (l.pdf <= 0.0) { continue; }
        offer_scattered(&choice, scattered_by(way, place, l, fog_share(position, l.to_light, l.distance_m)));
    }
    var one = scattered_choice(choice);
    one.light /= f32(FOG_CANDIDATES);
    return one;
}
