// Light of emissive surfaces, by samples of their triangles: chosen by area and luminance, then uniform in area.

#import bvh
#import extent
#import frame
#import sampling
#import shown
#import surface

const HAS_EMITTERS: bool = true;

// Alias table of emissive triangles (Walker's method, as of Vose 1991), a texel each: instance, triangle, share of
// the column that is its own, and index of the triangle that has the rest.
@group(1) @binding(16) var emitters: texture_2d<u32>;

// Density per area with which points of a material are chosen.
fn emitter_density(material: u32) -> f32 {
    return luminance(material_emission(material)) / max(sampling.emitted_power, 1e-30);
}

fn emitter_texel(k: u32) -> vec4u {
    return textureLoad(emitters, vec2u(k % TEXEL_COLUMNS, k / TEXEL_COLUMNS), 0);
}

fn chosen_emitter(u: vec2f) -> vec2u {
    let found = emitter_texel(min(u32(u.x * f32(sampling.emitters)), sampling.emitters - 1u));
    if (u.y < bitcast<f32>(found.z)) { return found.xy; }
    return emitter_texel(found.w).xy;
}

// A point of an emissive triangle as a light sample, without visibility.
fn emitter_sample(id: vec2u, position: vec3f, u: vec2f) -> LightSample {
    var r: LightSample;
    let instance = id.x;
    let m = instance_material(instance);
    let c = corners(instance, id.y);
    let p0 = to_world(instance, c.p[0]);
    let e1 = to_world(instance, c.p[1]) - p0;
    let e2 = to_world(instance, c.p[2]) - p0;
    let root = sqrt(u.x);
    let bary = vec2f(root * (1.0 - u.y), root * u.y);
    let offset = p0 + e1 * bary.x + e2 * bary.y - position;
    let d2 = max(dot(offset, offset), 1e-20);
    r.distance_m = sqrt(d2);
    r.to_light = offset / r.distance_m;
    let area2 = cross(e1, e2);
    let flags = instance_trace_flags(instance);
    var facing = -dot(area2, r.to_light) / max(length(area2), 1e-30);
    if ((instance_flags(instance) & FLAG_MIRRORED) != 0u) { facing = -facing; }
    if ((flags & DOUBLE_SIDED) != 0u) { facing = abs(facing); }
    if (facing <= 0.0) { return r; }
    var emission = material_emission(m) * emitted_share(m, instance, c.index, bary, facing);
    if (HAS_TEXTURES) {
        emission *= texel_at(material_texture(m, EMISSION_SLOT), pools_of(EMISSION_SLOT), instance, c.index, bary, 1.0, 0.0).xyz;
    }
    let density = emitter_density(m);
    r.color = emission * (facing / (d2 * density));
    r.pdf = density * d2 / facing;
    return r;
}

// Number of points of emitters of which each light ray is aimed at one.
const EMITTER_CANDIDATES: u32 = 8u;

// Light of one point, chosen among several by the light that the surface would reflect of each (resampled importance
// sampling; Talbot et al. 2005).
fn returned_of_emitters(s: Surface, view: vec3f, to: Receiver, index: u32) -> Returned {
    if (sampling.emitted_power <= 0.0) { return Returned(); }
    let which = next_pair();
    let where_on_it = next_pair();
    var choice: Choice;
    choice.u = sample_square(index, next_pair()).x;
    for (var k = 0u; k < EMITTER_CANDIDATES; k++) {
        let candidate = index * EMITTER_CANDIDATES + k;
        let id = chosen_emitter(sample_square(candidate, which));
        var l = emitter_sample(id, s.position, sample_square(candidate, where_on_it));
        l.pdf *= f32(EMITTER_CANDIDATES);
        offer(&choice, returned_of_lamp(s, view, to, l, !is_passed(instance_trace_flags(id.x), UNREFLECTED)));
    }
    var one = standing_for_all(choice);
    one.diffuse /= f32(EMITTER_CANDIDATES);
    one.specular /= f32(EMITTER_CANDIDATES);
    return one;
}

// Share of a surface's emission that a reflection ray takes; the rest comes by light samples. Lamps are not dimmed by
// the surface before, so that share is undone.
fn met_emission(ray: Reflected, instance: u32, distance_m: f32, s: Surface) -> f32 {
    if ((instance_flags(instance) & FLAG_EMITTER) == 0u) { return 1.0; }
    if (ray.pdf == 0.0) { return 1.0 / ray.kept; }
    if (ray.pdf == TAKEN) { return 0.0; }
    let way_m = distance_m + passed_m;
    let facing = abs(dot(s.geometric_normal, ray.direction));
    let pdf = emitter_density(instance_material(instance)) * way_m * way_m / max(facing, 1e-12);
    return balance(ray.pdf, pdf * f32(sampling.rays * EMITTER_CANDIDATES)) / ray.kept;
}
