// Light on a surface: one function for rasterized pixels, screen hits and traced hits.

#import ambient
#import diffuse
#import emitters
#import energy
#import environment
#import area_sampling
#import fog
#import frame
#import layers
#import lobe
#import surface
#import shadow
#import sheen

// Whether later passes may reuse which lights reach the surface of a pixel: some light casts its shadow by rays.
override REUSES_LIGHT: bool = true;
// Whether there are lights without a size, and whether there are several. Software drivers take a fifth less time without
// the loop.
override HAS_HARD_LIGHTS: bool = true;
override SEVERAL_HARD_LIGHTS: bool = true;

// Light bits, two for each of the first REUSED_LIGHTS: 0 is unknown or partly lit.
const REUSED_DARK: u32 = 1u;
const REUSED_LIT: u32 = 2u;

struct Shade {
    diffuse: vec3f, // view-independent light: emission, lights and environment
    specular: vec3f, // specular light of the lights and, where no reflection is traced, of the environment
    visible: vec2u, // light bits of the lights that reach the surface; see light_reuse.wgsl
}

// Reflectance at normal incidence of the dielectric part (KHR_materials_specular).
fn dielectric_f0(s: Surface) -> vec3f {
    if (!HAS_TINTS) { return vec3f(s.reflectivity); }
    return min(s.reflectivity * s.specular_color, vec3f(1.0)) * s.specular;
}

fn f0(s: Surface) -> vec3f {
    return mix(dielectric_f0(s), s.base_color, s.metallic);
}

// Reflectance at grazing angles; a reflectance below 2 % at normal incidence is treated as occlusion of the specular
// lobe (Lagarde & de Rousiers 2014, 3.2), so a reflectivity of 0 has no specular at all.
fn f90(f: vec3f) -> f32 {
    return saturate(50.0 * dot(f, vec3f(1.0 / 3.0)));
}

// Share of light that the dielectric part reflects at grazing angles: the specular strength changes it, the specular
// color only where it tints edges.
fn dielectric_f90(s: Surface) -> vec3f {
    if (!HAS_EDGE_TINTS || !s.has_edge_tint) { return vec3f(s.specular); }
    return min(s.specular * s.specular_color, vec3f(1.0));
}

// Reflectance of a surface at grazing angles.
fn grazing_reflectance(s: Surface) -> vec3f {
    if (!HAS_TINTS) { return vec3f(f90(f0(s))); }
    return f90(mix(vec3f(s.reflectivity), s.base_color, s.metallic)) * mix(dielectric_f90(s), vec3f(1.0), s.metallic);
}

// Schlick's power at the cosine 1/7, an angle of 82°, and the value there of the curve `c (1 - c)^6`, which has its peak there.
const EDGE_SCHLICK: f32 = 0.46266436;
const EDGE_PEAK: f32 = 0.05665278;

// Reflectance that a metal lacks of Schlick's, by its tint at 82° (F82 of OpenPBR 1.1, section "Metal"; Kutz, Hašan &
// Edmondson 2021, "Novel aspects of the Adobe Standard Material", 2.3). At most all of it: for dark metals with dark tints F82 is below 0.
fn edge_dip(s: Surface, cosine: f32) -> vec3f {
    if (!HAS_EDGE_TINTS || !s.has_edge_tint) { return vec3f(0.0); }
    let grazing = vec3f(f90(s.base_color));
    let c = saturate(cosine);
    let weight = schlick_weight(c);
    let dip = mix(s.base_color, grazing, EDGE_SCHLICK) * (1.0 - dielectric_f90(s)) * (c * (1.0 - c) * weight / EDGE_PEAK);
    return s.metallic * min(dip, mix(s.base_color, grazing, weight));
}

// Reflectance of the dielectric part at normal and grazing incidence, by its strongest channel, so that the light
// left to the diffuse part is not tinted.
fn dielectric_reflectance(s: Surface) -> vec2f {
    if (!HAS_TINTS) { return vec2f(s.reflectivity, f90(vec3f(s.reflectivity))); }
    let f = dielectric_f0(s);
    return vec2f(max(f.x, max(f.y, f.z)), f90(vec3f(s.reflectivity)) * s.specular);
}

// Fresnel reflectance (Schlick 1994); exact for transmissive surfaces and where an index of refraction is given.
fn fresnel(s: Surface, cosine: f32) -> vec3f {
    if (is_exact(s)) { return exact_fresnel(s, cosine); }
    return schlick_fresnel(s, cosine);
}

// Schlick's reflectance, with the dip of metals.
fn schlick_fresnel(s: Surface, cosine: f32) -> vec3f {
    return max(mix(f0(s), grazing_reflectance(s), schlick_weight(cosine)) - edge_dip(s, cosine), vec3f(0.0));
}

// Roughness below which a surface's reflection is traced; higher for metals, which show nothing else.
fn reflects_below(s: Surface) -> f32 {
    return frame.roughness_cutoff * (1.0 + METAL_REACH * s.metallic);
}

// Share of the light of one layer's reflection rays, lamps left out, that its pixel shows. Towards the cut-off the
// replacement of reflections past it takes the rest, so that nothing jumps there.
fn kept_share(layer: Surface) -> f32 {
    if (layer.reflection == REFLECTION_MIRROR || mirrors_inside(layer)) { return 1.0; }
    let limit = reflects_below(layer);
    return clamp((limit - layer.roughness) / (CUTOFF_FADE * limit), 1e-3, 1.0);
}

// Share of the environment's specular light that a layer gets without reflection rays.
fn stand_in_share(layer: Surface) -> f32 {
    if (!is_reflector(layer)) { return 1.0; }
    return 1.0 - kept_share(layer);
}

fn is_reflector(s: Surface) -> bool {
    let is_traced = s.roughness < reflects_below(s) || mirrors_inside(s);
    return s.reflection == REFLECTION_MIRROR || (s.reflection == REFLECTION_AUTO && is_traced) || has_traced_coat(s);
}

// Whether a path that hits the surface continues by mirroring or transmission.
fn goes_on(s: Surface) -> bool {
    return is_reflector(s) || is_transmissive(s);
}

// Share of light that a diffuse scatterer of this color below the specular lobe of a surface returns.
fn below_lobe(s: Surface, view: vec3f, color: vec3f) -> vec3f {
    return color * (1.0 - s.metallic) * unreflected(s, view) * reflected_share(s) * base_share(s, view);
}

// Share of light that the surface scatters diffusely, below its specular lobe.
fn diffuse_albedo(s: Surface, view: vec3f) -> vec3f {
    let albedo = below_lobe(s, view, diffuse_color(s, view));
    if (!HAS_DIFFUSE_TRANSMISSION) { return albedo; }
    return albedo * (1.0 - s.diffuse_transmission);
}

// Share of light from its other side that the surface scatters to the side of the view (KHR_materials_diffuse_transmission).
fn passed_albedo(s: Surface, view: vec3f) -> vec3f {
    if (!HAS_DIFFUSE_TRANSMISSION) { return vec3f(0.0); }
    return below_lobe(s, view, s.diffuse_transmission_color * s.diffuse_transmission);
}

// Share of the light from other surfaces that the surface scatters, by all of its layers.
fn scattering_albedo(s: Surface, view: vec3f) -> vec3f {
    return (diffuse_albedo(s, view) + sheen_albedo(s, view) + passed_albedo(s, view)) * scattered_share(s, view);
}

fn ggx_alpha(s: Surface) -> f32 {
    return max(s.roughness * s.roughness, SMOOTH_ALPHA);
}

// GGX with the height-correlated Smith term (Heitz 2014), times cos θ.
fn ggx(s: Surface, view: vec3f, to_light: vec3f) -> vec3f {
    if (is_outer_side(s)) { return refracted_lobe(s, view, to_light); }
    let h = normalize(view + to_light);
    let nl = saturate(dot(s.normal, to_light));
    let nv = max(dot(s.normal, view), 1e-3);
    let visibility = 0.5 / max(nl * masked(s, view, nv) + nv * masked(s, to_light, nl), 1e-6);
    return fresnel(s, dot(view, h)) * compensation(s, shown_lobe(s, view)) * (facet_density(s, h) * visibility * nl * base_share(s, view));
}

// The only layer of a surface with a traced reflection, and the share of that layer's light that arrives; a share of
// 0 where two layers are traced.
struct OnlyLobe {
    layer: Surface,
    share: f32,
}

// Whether the surface shows lights without a size: a mirror shows a point only where it is exactly in line. Lobes are at
// least as wide as SMOOTH_ALPHA.
fn shows_points(s: Surface) -> bool {
    return (s.metallic > 0.0 || s.reflectivity > 0.0) && s.reflection != REFLECTION_MIRROR && s.roughness > 0.0
        && !is_outer_side(s);
}

// Whether a surface's reflection is blurred, beyond rounding.
fn is_spread(s: Surface) -> bool {
    let roughness = reflected_roughness(s);
    return is_reflector(s) && s.reflection != REFLECTION_MIRROR && roughness * roughness > SMOOTH_ALPHA;
}

// Irradiance per unit cosine and direction of a light without a size, without shadow but through fog.
fn incoming(i: u32, position: vec3f) -> LightSample {
    var lamp = placed_lamp(i);
    lamp.extent = 0.0; // also of a radius whose square is too small for a number
    var r = LightSample(-lamp.direction, 1e30, lamp.color, 1.0);
    if (lamp.kind != LIGHT_DIRECTIONAL) { r = lamp_point(lamp, position, vec2f(0.0)); }
    r.color *= fog_share(position, r.to_light, r.distance_m);
    return r;
}

// Share of a lamp's intensity that its range leaves (KHR_lights_punctual, "Range Property"); a range of 0 is unlimited.
fn range_share(range_m: f32, distance_m: f32) -> f32 {
    if (range_m <= 0.0) { return 1.0; }
    let x = distance_m / range_m;
    return saturate(1.0 - x * x * x * x);
}

// Share within a spot's cone, which falls off by a scale and an offset of the cosine (KHR_lights_punctual, "Inner and
// Outer Cone Angles").
fn cone_share(ahead: vec3f, falloff: vec2f, to_light: vec3f) -> f32 {
    let cone = saturate(-dot(ahead, to_light) * falloff.x + falloff.y);
    return cone * cone;
}

// Two bits of light `i`; a word holds 16 lights. 0 past the last one.
fn reused_bits(words: vec2u, i: u32) -> u32 {
    if (i >= REUSED_LIGHTS) { return 0u; }
    return (words[i >> 4u] >> (2u * (i & 15u))) & 3u;
}

// Adds light `i`, which has no size, to the light on one layer of a surface.
fn add_hard_light(i: u32, s: Surface, view: vec3f, albedo: vec3f, reused: vec2u, out: ptr<function, Shade>) {
    let l = incoming(i, s.position);
    let known = reused_bits(reused, i);
    if (!faces(s, l.to_light) || max(l.color.x, max(l.color.y, l.color.z)) <= 0.0 || known == REUSED_DARK) { return; }
    var visible = vec3f(1.0);
    if (known != REUSED_LIT) {
        visible = light_visibility(i, smooth_position(s), s.geometric_normal, l.to_light, l.distance_m);
    }
    if (i < REUSED_LIGHTS && lights[i].shadow == SHADOW_RAY) {
        let bits = select(0u, REUSED_DARK, all(visible == vec3f(0.0))) | select(0u, REUSED_LIT, all(visible == vec3f(1.0)));
        (*out).visible[i >> 4u] |= bits << (2u * (i & 15u));
    }
    let lit = l.color * visible * shown_share(i);
    (*out).diffuse += (diffuse_towards(s, albedo, view, l.to_light) + sheen(s, view, l.to_light)) * lit * (dot(s.normal, l.to_light) / PI);
    if (shows_points(s) && is_reflected(i)) { (*out).specular += ggx(s, view, l.to_light) * lit; }
}

// Light on one layer of a surface. `reused`: known light bits of the surface; 0: unknown.
fn shade_layer(s: Surface, view: vec3f, reused: vec2u) -> Shade {
    let albedo = diffuse_albedo(s, view);
    var out = environment_light(s, view, albedo);
    out.diffuse += s.emission;
    if (HAS_HARD_LIGHTS && !is_outer_side(s)) {
        for (var i = 0u; i < frame.hard_lights; i++) {
            add_hard_light(i, s, view, albedo, reused, &out);
            if (!SEVERAL_HARD_LIGHTS) { break; }
        }
    }
    let sampled = sampled_light(s, view, albedo);
    out.diffuse += sampled.diffuse;
    out.specular += sampled.specular;
    return out;
}

// Whether light from this direction can reach the surface: from below the plane of a triangle only where the smooth
// surface lies above the triangle.
fn faces(s: Surface, direction: vec3f) -> bool {
    return dot(s.normal, direction) > 0.0 && (s.lift_m > 0.0 || dot(s.geometric_normal, direction) > 0.0);
}

// Position for shadow look-ups: on the smooth surface, so that shadows end where its shading does rather than at the
// edges of triangles.
fn smooth_position(s: Surface) -> vec3f {
    return s.position + s.geometric_normal * s.lift_m;
}

// Share of a path's light that its pixel gets, where the path carries it undivided.
var<private> path_share: f32 = 1.0;

// Light that a path adds at one of its hits; what the pixel gets of it is limited from the second hit on.
fn found_light(light: vec3f, hit: u32) -> vec3f {
    if (hit == 0u) { return light; }
    return limited(light * path_share) / path_share;
}

// Light of a surface that a ray meets, as far as the surface before keeps it; `reused` as of `shade_layer`.
fn met_light(ray: Reflected, s: Surface, reused: vec2u) -> vec3f {
    finds_alone = ray.pdf == 0.0;
    let lit = shade(s, -ray.direction, reused);
    return (lit.diffuse + lit.specular) * ray.kept;
}

// Light that the ray of a path sees at its end, unless that is the surface that it meets: a light with a size or, past
// all surfaces, the environment. `instance` and `distance_m` belong to the surface; NONE where there is none.
fn seen_at_end(origin: vec3f, ray: Reflected, instance: u32, distance_m: f32) -> SeenLight {
    let is_past_all = instance == NONE;
    let seen = seen_light(origin, ray, select(distance_m, 2.0 * FAR_M, is_past_all));
    if (seen.is_seen) { return seen; }
    if (is_past_all) { return SeenLight(true, environment(ray.direction) * ray.sky_weight, FAR_M); }
    return SeenLight(false, vec3f(0.0), distance_m);
}

// Whether the ray has any weight: a facet may mirror the view into the surface, which gives none.
fn carries_light(ray: Reflected) -> bool {
    return any(ray.weight > vec3f(0.0));
}

// Mirror direction, lifted above the surface where a tilted shading normal would send it below.
fn mirror_direction(direction: vec3f, s: Surface) -> vec3f {
    return lifted(reflect(direction, s.normal), s);
}

fn lifted(r: vec3f, s: Surface) -> vec3f {
    let height = dot(r, s.geometric_normal);
    return normalize(r + s.geometric_normal * max(0.01 - height, 0.0));
}

fn ray_origin(position: vec3f, geometric_normal: vec3f) -> vec3f {
    return position + geometric_normal * start_offset_m(position);
}
