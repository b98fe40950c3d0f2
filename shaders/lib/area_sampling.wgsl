// Sampling of everything with an extent: lights with a size, and reflections of rough surfaces.

#import fog
#import diffuse
#import dispersion
#import frame
#import lamp_shape
#import lamps
#import facets
#import lobe
#import sampling

override HAS_ROUGH_REFLECTIONS: bool = true;
override HAS_SHADOW_RAYS: bool = true; // whether some light casts its shadow by rays
override HAS_ENVIRONMENT_RAYS: bool = true; // whether the environment's light can be blocked
override HAS_SIZED_LIGHTS: bool = true;
override SEVERAL_SIZED_LIGHTS: bool = true; // without loops over them software drivers take less time
override HAS_SIZED_SUNS: bool = true; // whether some light with a size is directional
override HAS_SAMPLED_LIGHT: bool = true; // whether there are lights with a size, sampled environments or emitters
override HAS_INDIRECT: bool = true; // whether diffuse surfaces light each other

const TAKEN: f32 = -1.0;
const BEYOND: f32 = FAR_M; // distance of directional lights and of the environment

// Direction of a reflection ray, its weight, and its share of light that is sampled in other ways too.
struct Reflected {
    direction: vec3f,
    weight: vec3f,
    pdf: f32, // lobe_density; 0: the only possible direction; TAKEN: light samples find all lights
    sky_weight: f32, // share of the environment's light; the rest comes by rays towards it
    kept: f32, // share of the light of a surface that the ray meets, lamps left out
    normal: vec3f, // of the surface that the ray leaves, by which light samples choose emitters
}

// Whether a surface has a rough reflection. Its light is then found by reflection rays and by light samples,
// combined by the power heuristic (Veach 1997, 9.2.2.2).
fn is_rough_reflector(s: Surface) -> bool {
    return HAS_ROUGH_REFLECTIONS && is_reflector(s) && s.reflection != REFLECTION_MIRROR
        && s.roughness * s.roughness > SMOOTH_ALPHA;
}

// Power heuristic: weight of a sample of density `pdf` where another technique has the density `other`.
fn balance(pdf: f32, other: f32) -> f32 {
    let ratio = min(other / max(pdf, 1e-18), 1e18);
    return 1.0 / (1.0 + ratio * ratio);
}

// Density per solid angle of a diffusely scattered ray.
fn scattered_density(cosine: f32) -> f32 {
    return max(cosine, 1e-6) / PI;
}

// Whether the path has left a surface in a randomly chosen direction.
var<private> path_is_chance: bool = false;

// Light that a path adds past its first hit: after a random choice it is limited, as bright and rare contributions
// show as specks long before they converge. A path of one color channel stands for three.
fn limited(light: vec3f) -> vec3f {
    let brightest = max(light.x, max(light.y, light.z));
    let limit = frame.glint_limit * select(1.0, 3.0, HAS_DISPERSION && path_channel > 0u);
    if (!HAS_EXTENT || UNBIASED || !path_is_chance || limit <= 0.0 || brightest <= limit) { return light; }
    return light * (limit / brightest);
}

// Reflection ray of one sampled microfacet per sub-frame; over many sub-frames they cover all visible facets.
// `direction` is the arriving ray's.
fn lobe_ray(direction: vec3f, s: Surface) -> Reflected {
    let mirror = mirror_direction(direction, s);
    let kept = kept_share(s);
    if (!is_rough_reflector(s)) {
        let weight = fresnel(s, dot(s.normal, -direction)) * base_share(s, -direction);
        return Reflected(mirror, weight, 0.0, kept, kept, s.normal);
    }
    path_is_chance = true;
    let nv = max(dot(s.normal, -direction), 1e-3);
    let bound = reflection_bound(s, nv);
    let sampled = mirroring_facet(s, direction, bound);
    let facet = sampled.normal;
    let out = mirrored(s, direction, facet);
    if (sampled.share <= 0.0) { return Reflected(mirror, vec3f(0.0), 0.0, 1.0, 1.0, s.normal); }
    let facets = masked(s, -direction, nv);
    let bounded = sampled.share * (bound * nv + facets) / (nv + facets);
    let weight = fresnel(s, dot(facet, -direction)) * compensation(s, shown_lobe(s, -direction)) * (bounded * base_share(s, -direction));
    if (mirrors_inside(s)) { return Reflected(lifted(out, s), weight, 0.0, kept, kept, s.normal); }
    let pdf = lobe_density(s, -direction, out);
    let sky_weight = kept * balance(pdf, environment_rays_pdf(s, -direction, out));
    return Reflected(lifted(out, s), weight, pdf, sky_weight, kept, s.normal);
}

// A light other than a directional one.
fn placed_lamp(i: u32) -> Lamp {
    let spot = vec2f(lights[i].spot_scale, lights[i].spot_offset);
    return Lamp(lights[i].position, lights[i].kind, lights[i].direction, lights[i].extent, lights[i].color, lights[i].range_m,
        lights[i].half_u, lights[i].half_v, spot);
}

fn light_sample(i: u32, position: vec3f, u: vec2f) -> LightSample {
    if (lights[i].kind != LIGHT_DIRECTIONAL) { return lamp_point(placed_lamp(i), position, u); }
    // E = π L sin² of half the angle.
    let least = cos(lights[i].extent);
    let z = 1.0 - u.x * (1.0 - least);
    let to_light = basis(-lights[i].direction) * vec3f(on_circle(sqrt(max(1.0 - z * z, 0.0)), u.y), z);
    return LightSample(to_light, BEYOND, lights[i].color * (2.0 / (1.0 + least)), 1.0 / (2.0 * PI * (1.0 - least)));
}

// Light that a surface, or fog at a point of a ray, reflects from one sampled point, if nothing blocks it.
struct Returned {
    position: vec3f,
    to_light: vec3f,
    distance_m: f32,
    diffuse: vec3f, // of fog: all of it
    specular: vec3f,
    shown: f32, // share that the picture shows
}

// Parts of a surface's reflection that light samples contribute to.
struct Receiver {
    albedo: vec3f,
    is_rough: bool, // whether its reflection rays find the same light
    has_specular: bool, // false: a sharp reflector, whose reflection rays alone find lights
    stand_in: f32, // share of the environment's specular light that reflection rays leave to light samples
}

fn returned(s: Surface, view: vec3f, to: Receiver, l: LightSample, aimed: f32, specular_share: f32) -> Returned {
    var r = Returned(s.position, l.to_light, l.distance_m, vec3f(0.0), vec3f(0.0), 1.0);
    r.diffuse = (diffuse_towards(s, to.albedo, view, l.to_light) + sheen(s, view, l.to_light)) * l.color * (dot(s.normal, l.to_light) / PI * aimed);
    if (to.has_specular) { r.specular = ggx(s, view, l.to_light) * l.color * specular_share; }
    return r;
}

// Reflected light of a lamp or an emitter. `is_met`: rays that the surface scatters or mirrors find it too, and
// share its light.
fn returned_of_lamp(s: Surface, view: vec3f, to: Receiver, l: LightSample, is_met: bool) -> Returned {
    if (l.pdf <= 0.0 || !faces(s, l.to_light) || max(l.color.x, max(l.color.y, l.color.z)) <= 0.0) { return Returned(); }
    let pdf = l.pdf * f32(sampling.rays);
    let dimmed = fog_share(s.position, l.to_light, l.distance_m);
    var aimed = dimmed;
    var share = dimmed;
    if (is_met) {
        // A ray that the surface scatters finds the rest. Near a lamp, light samples alone would be bright and rare.
        if (path_scatterings < frame.diffuse_bounces) { aimed *= balance(pdf, scattered_density(dot(s.normal, l.to_light))); }
        if (to.is_rough) { share *= balance(pdf, lobe_density(s, view, l.to_light)); }
    }
    return returned(s, view, to, l, aimed, share);
}

// Share of light that arrives at the surface from a point. The ray is aimed at the point from its offset origin;
// otherwise a light at a grazing angle could block itself.
fn arriving_from(s: Surface, to_light: vec3f, distance_m: f32) -> vec3f {
    let origin = ray_origin(smooth_position(s), s.geometric_normal);
    var toward = to_light;
    var reach_m = FAR_M;
    if (distance_m < BEYOND) {
        let way = s.position + to_light * distance_m - origin;
        let way_m = max(length(way), 1e-12);
        toward = way / way_m;
        reach_m = way_m * 0.9999;
    }
    // One call, as drivers inline the traversal at each.
    return transmittance(origin, toward, reach_m);
}

// Reservoir of one among several sampled points, by the light that would be reflected of each.
struct Choice {
    one: Returned,
    part: f32, // weight of `one`
    whole: f32, // sum of the weights of all offered points
    u: f32, // uniform random number in [0, 1) for the next choice
}

const BELOW_ONE: f32 = 0.99999994;

fn offer(choice: ptr<function, Choice>, r: Returned, seen_share: f32) {
    // By the mean of the channels, not by luminance: blue lights would be rare and bright.
    let weight = dot(r.diffuse + r.specular, vec3f(1.0 / 3.0)) * seen_share;
    if (weight <= 0.0) { return; }
    (*choice).whole += weight;
    // The random number that made a choice is uniform within the chosen part, and is rescaled for the next one.
    let share = weight / (*choice).whole;
    if ((*choice).u < share) {
        (*choice).u /= share;
        (*choice).one = r;
        (*choice).part = weight;
    } else {
        (*choice).u = ((*choice).u - share) / (1.0 - share);
    }
    (*choice).u = min((*choice).u, BELOW_ONE);
}

// Light of the chosen point, scaled to stand for all offered points.
fn standing_for_all(choice: Choice) -> Returned {
    let scale = choice.whole / max(choice.part, 1e-30);
    var one = choice.one;
    one.diffuse *= scale;
    one.specular *= scale;
    return one;
}

// Groups of light sources, each with a shadow ray of its own: otherwise a sun behind a wall would be chosen nearly
// always, and the sky in the window hardly ever.
const SUNS: u32 = 0u;
const LAMPS: u32 = 1u;
const SKY: u32 = 2u;
const EMITTERS: u32 = 3u;

// Light of all sources with an extent: lights with a size, the environment where rays go towards it, and emitters.
// Each of several lamps, and each of several suns, offers a point, and one is chosen (resampled importance
// sampling; Talbot et al. 2005). Lights without shadows are added without a ray.
fn sampled_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    var out: Shade;
    if (!HAS_SAMPLED_LIGHT) { return out; }
    let is_rough = is_rough_reflector(s);
    let has_specular = (is_rough || !is_reflector(s)) && (s.metallic > 0.0 || s.reflectivity > 0.0);
    let stand_in = select(0.0, stand_in_share(s), s.metallic > 0.0 || s.reflectivity > 0.0);
    let has_highlight = HAS_HARD_LAMPS && shows_points(s);
    let has_lobe = has_specular || stand_in > 0.0 || has_highlight;
    if (!has_lobe && !has_sheen(s) && max(albedo.x, max(albedo.y, albedo.z)) <= 0.0) { return out; }
    let to = Receiver(albedo, is_rough, has_specular, stand_in);
    let first_source = select(SKY, select(LAMPS, SUNS, HAS_SIZED_SUNS), HAS_SIZED_LIGHTS);
    let end_source = select(select(SKY, EMITTERS, HAS_ENVIRONMENT_RAYS), EMITTERS + 1u, HAS_EMITTERS);
    let first_pair = sample_pair;
    for (var k = 0u; k < sampling.rays; k++) {
        let index = first_light_sample() + k;
        sample_pair = first_pair;
        var suns: Choice;
        var lamps: Choice;
        if (HAS_SIZED_LIGHTS) {
            let u = sample_square(index, next_pair());
            suns.u = u.x;
            lamps.u = u.y;
            for (var i = frame.hard_lights; i < frame.light_count; i++) {
                let l = light_sample(i, s.position, sample_square(index, next_pair()));
                var r = returned_of_lamp(s, view, to, l, is_reflected(i));
                if (!is_reflected(i)) { r.specular = vec3f(0.0); }
                r.shown = shown_share(i);
                if (!HAS_SHADOW_RAYS || lights[i].shadow != SHADOW_RAY) {
                    out.diffuse += r.diffuse * r.shown;
                    out.specular += r.specular * r.shown;
                } else if (HAS_SIZED_SUNS && lights[i].kind == LIGHT_DIRECTIONAL) {
                    offer(&suns, r, 1.0);
                } else {
                    offer(&lamps, r, 1.0);
                }
                if (!SEVERAL_SIZED_LIGHTS) { break; }
            }
        }
        let sky = returned_of_environment(s, view, to, index);
        if (!HAS_ENVIRONMENT_RAYS) {
            out.diffuse += sky.diffuse;
            out.specular += sky.specular;
        }
        let emitted = returned_of_emitters(s, view, to, index);
        // One call in a loop keeps the inlined code small: the traversal is long.
        for (var source = first_source; source < end_source; source++) {
            var r = emitted;
            if (HAS_SIZED_SUNS && source == SUNS) { r = standing_for_all(suns); }
            if (HAS_SIZED_LIGHTS && source == LAMPS) { r = standing_for_all(lamps); }
            if (source == SKY) { r = sky; }
            if (!any(r.diffuse + r.specular > vec3f(0.0)) || (!HAS_ENVIRONMENT_RAYS && source == SKY)) { continue; }
            let arriving = arriving_from(s, r.to_light, r.distance_m) * r.shown;
            out.diffuse += r.diffuse * arriving;
            out.specular += r.specular * arriving;
        }
        if (!SEVERAL_LIGHT_RAYS) { break; }
    }
    let rays = f32(sampling.rays);
    return Shade(out.diffuse / rays, out.specular / rays, vec2u(0u));
}

// Length of the path through transmissive surfaces since the last surface whose light samples share the lights that
// a ray meets, m.
var<private> passed_m: f32 = 0.0;

// The nearest light with a size that a reflection ray meets.
struct SeenLight {
    is_seen: bool,
    radiance: vec3f,
    distance_m: f32,
}

// A light with a size that a ray meets, and the light of the environment behind it; `point.t` 0: it meets none.
struct MetLight {
    point: MetPoint,
    behind: vec3f,
}

fn met_sized_light(i: u32, origin: vec3f, ray: Reflected) -> MetLight {
    var met: MetLight;
    if (!is_reflected(i)) { return met; }
    if (lights[i].kind != LIGHT_DIRECTIONAL) {
        met.point = lamp_met(placed_lamp(i), origin, ray.direction);
        return met;
    }
    let extent = lights[i].extent;
    if (-dot(ray.direction, lights[i].direction) < cos(extent)) { return met; }
    met.point = MetPoint(BEYOND, 1.0 / (2.0 * PI * (1.0 - cos(extent))), lights[i].color / PI / pow(sin(extent), 2.0));
    met.behind = environment(ray.direction) * ray.sky_weight;
    return met;
}

fn seen_light(origin: vec3f, ray: Reflected, t_max: f32) -> SeenLight {
    var seen: SeenLight;
    var behind = vec3f(0.0);
    var pdf = 0.0;
    var nearest = t_max;
    if (HAS_SIZED_LIGHTS) {
        for (var i = frame.hard_lights; i < frame.light_count; i++) {
            let met = met_sized_light(i, origin, ray);
            if (met.point.t > 0.0 && met.point.t < nearest) {
                nearest = met.point.t;
                pdf = met.point.pdf;
                behind = met.behind;
                seen = SeenLight(true, met.point.radiance * shown_share(i), nearest);
            }
            if (!SEVERAL_SIZED_LIGHTS) { break; }
        }
    }
    if (HAS_SIZED_LAMPS) {
        let lamp = met_lamp(origin, ray, nearest);
        if (lamp.t < nearest) {
            pdf = lamp.pdf;
            behind = vec3f(0.0);
            seen = SeenLight(true, lamp.radiance, lamp.t);
        }
    }
    if (ray.pdf == TAKEN) { seen.radiance = vec3f(0.0); }
    if (ray.pdf > 0.0) { seen.radiance *= balance(ray.pdf, pdf * f32(sampling.rays)); }
    seen.radiance += behind;
    return seen;
}
