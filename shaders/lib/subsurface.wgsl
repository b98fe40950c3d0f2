// Random walk of a path inside of a solid that scatters light: free flights between isotropic scatterings, until the path
// leaves the solid. Anisotropic scattering is made isotropic before, by the similarity relation (Wyman et al. 1989).

#import area_sampling
#import layers
#import lobe

const FLIGHT_PAIR: u32 = 0x10007u; // length of a free flight, and the color channel whose length it is
const TURN_PAIR: u32 = 0x10008u; // axis of a scattering
const MAX_SCATTERINGS: u32 = 2000u; // scatterings along a path; few paths in a white solid are longer

// Flight of a path to where it is scattered.
struct Flight {
    length_m: f32, // FAR_M: it is not scattered
    shares: vec3f, // probability with which each color channel gives the length
}

// Channels with more of the path's light, `throughput`, give its length more often, so that no channel gets more than all
// have.
fn free_flight(throughput: vec3f) -> Flight {
    let sum = throughput.x + throughput.y + throughput.z;
    let scatters = HAS_SCATTERING && any(media.here.albedo > vec3f(0.0));
    if (!scatters || sum <= 0.0) { return Flight(FAR_M, vec3f(0.0)); }
    let shares = throughput / sum;
    let u = sample_square(sample_index(), FLIGHT_PAIR);
    let extinction = media.here.extinction;
    let rest = select(extinction.y, extinction.z, u.x >= shares.x + shares.y);
    let rate = select(rest, extinction.x, u.x < shares.x);
    return Flight(min(-log(1.0 - u.y) / max(rate, 1e-12), FAR_M), shares);
}

// Factor on the transmittance of a flight over a distance: 1 over the mean probability, over the channels that may give its
// length, of a flight that is as long (Veach 1997, balance heuristic).
fn flight_weight(flight: Flight, distance_m: f32, is_scattered: bool) -> vec3f {
    if (!HAS_SCATTERING || all(flight.shares == vec3f(0.0))) { return vec3f(1.0); }
    let left = medium_transmittance(distance_m);
    if (!is_scattered) { return vec3f(1.0 / max(dot(flight.shares, left), 1e-30)); }
    let extinction = media.here.extinction;
    return extinction * media.here.albedo / max(dot(flight.shares, left * extinction), 1e-30);
}

// Point of an isotropic scattering, as a white diffuse surface with a random normal: the mean over all normals is 1 / 4π
// per steradian. Without `occlusion`, no light sample is taken of the environment, which the next ray sees.
fn scatterer(position: vec3f) -> Surface {
    var s: Surface;
    let u = sample_square(sample_index(), TURN_PAIR);
    let z = 1.0 - 2.0 * u.x;
    s.position = position;
    s.normal = vec3f(on_circle(sqrt(max(1.0 - z * z, 0.0)), u.y), z);
    s.geometric_normal = s.normal;
    s.base_color = vec3f(1.0);
    s.roughness = 1.0;
    s.alpha = 1.0;
    s.occlusion = 0.0;
    return s;
}

// Next ray from the point of a scattering; the path ends by Russian roulette on the light that it carries.
fn scattered_within(s: Surface, throughput: vec3f) -> Reflected {
    walk_scatterings++;
    path_is_chance = true;
    leave_vertex(s.position);
    let direction = cosine_direction(s.normal, sample_square(sample_index(), SCATTER_PAIR));
    var pdf = select(TAKEN, scattered_density(dot(s.normal, direction)), path_scatterings < frame.diffuse_bounces);
    if (media.here.lit_share <= 0.0) { pdf = 0.0; }
    let most = max(throughput.x, max(throughput.y, throughput.z));
    let chance = select(min(most, 1.0), 1.0, walk_scatterings < FIRST_ENDING);
    let ends = walk_scatterings > MAX_SCATTERINGS || sample_square(sample_index(), CHOICE_PAIR).x >= chance;
    return Reflected(direction, vec3f(select(1.0 / max(chance, 1e-30), 0.0, ends)), pdf, 1.0, 1.0, s.normal);
}
