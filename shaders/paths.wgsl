// Paths: follows paths from the surfaces of pixels on, for one kind of light in each dispatch. Passes share this shader, which
// is mostly the light that paths find, so that drivers compile it once.
// - Mirrored: follows the mirror rays of the listed pixels through the BVHs, and shades hits of the march
//   and hits that neighbors share.
// - Behind: follows rays through the transmissive surfaces of the listed pixels, to the surfaces behind.
// - Received: path traces the diffuse light that the surfaces of pixels receive from other surfaces.

#import cause_stored
#import gbuffer
#import indirect
#import mirror_hit
#import paths_params
#import radiance
#import work

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(6) var path_light: RadianceTexture;
@group(2) @binding(12) var<uniform> params: Params;

override TRACE: bool = true; // false: methods that answer refused rays otherwise, or not at all
// Whether received light is smoothed over neighbors: it is stored without the albedo of the surface then, -1 in colors that
// the surface does not scatter, and w is the width of a pixel over the distance that the light came from; 0 where the
// surface scatters none.
override SMOOTHED: bool = false;

const LEAVES_PIXELS: bool = true;
const BEHIND_VERTEX: u32 = 64u; // offset of sample numbers: others than for reflections
const RECEIVED_VERTEX: u32 = 128u; // likewise

// Where mirror rays march through maps, pipelines follow either them or other paths: both read more textures than a
// stage may.
fn has_behind() -> bool {
    return HAS_TRANSMISSION && !(MAPPED && MIRRORS);
}

fn is_behind() -> bool {
    return has_behind() && start_light == LIGHT_BEHIND;
}

fn is_received() -> bool {
    return HAS_INDIRECT && !(MAPPED && MIRRORS) && start_light == RECEIVED_LIGHT;
}

// The pixel of an invocation; NONE: none. `leads`: whether leaders are followed alone, of listed rays that have any.
fn path_pixel(group: vec3u, groups: vec3u, local: vec3u, lane: u32, leads: bool) -> vec2u {
    let at = group.y * groups.x + group.x;
    if (is_received()) {
        let pixel = invoked_pixel(group, groups, local);
        return select(pixel, vec2u(NONE), any(pixel >= vec2u(frame.size)) || is_left_out(pixel));
    }
    // Invocations past the end of a list fill its last workgroup.
    if (is_behind()) {
        let index = at * RAYS_PER_GROUP + lane;
        if (index >= atomicLoad(&counters[TRANSMISSIVE_COUNTER])) { return vec2u(NONE); }
        return unpack_pixel(lists[transmissive_slot(index)]);
    }
    if (!MIRRORS || !HAS_REFLECTIONS) { return vec2u(NONE); }
    // A workgroup has rays alone or screen hits alone, since hits would wait for the rays beside them. Groups of the shorter
    // list are spread among the others: software drivers give each thread a block of adjacent groups.
    let counter = select(RAY_COUNTER, select(REST_COUNTER, LEADER_COUNTER, leads), UNDERSAMPLED);
    let rays = select(atomicLoad(&counters[counter]), 0u, !TRACE);
    let hits = select(atomicLoad(&counters[HIT_COUNTER]), 0u, leads);
    let groups_of = (vec2u(rays, hits) + RAYS_PER_GROUP - 1u) / RAYS_PER_GROUP;
    let few = min(groups_of.x, groups_of.y);
    let every = (groups_of.x + groups_of.y) / max(few, 1u);
    let before = min((at + 1u) / every, few); // groups of the shorter list up to this one
    let is_few = before > min(at / every, few);
    is_known = is_few == (groups_of.y <= groups_of.x);
    let index = select(at - before, before - 1u, is_few) * RAYS_PER_GROUP + lane;
    if (index >= select(rays, hits, is_known) || (!SHADE && is_known)) { return vec2u(NONE); }
    if (leads) { return unpack_pixel(lists[leader_slot(index)]); }
    return unpack_pixel(lists[select(ray_slot(index), hit_slot(index), is_known)]);
}

// Numbers of paths behind a surface that go forward, and back from the inner side of a rough solid, an even number, which
// have most of the grain. More paths in the first pictures, where glass turns or scatters light, so that one path that ends in
// the dark leaves no black speck: as many as rays towards lights where `light_rays` is left out, four in a picture of one
// sub-frame and one from seven on.
fn paths_behind(s: Surface) -> vec2u {
    let several = select((8u + sampling.samples) / (sampling.samples + 1u), 1u, UNBIASED);
    let is_rough = HAS_ROUGH_REFLECTIONS && s.roughness * s.roughness > SMOOTH_ALPHA;
    let forward = select(1u, several, s.transmission > 0.0 && (s.is_solid || is_rough));
    let splits = AIMS_THROUGH && is_rough && s.is_solid && !s.is_inside && s.transmission > 0.0 && !has_sheen(s);
    return vec2u(forward, select(0u, (forward + 1u) / 2u * 2u, splits));
}

// Prepares a path behind a surface, by its number: the first paths go forward, then come paths back.
fn start_behind(s: Surface, k: u32, paths: vec2u) {
    let is_back = k >= paths.x;
    let index = select(k, k - paths.x, is_back);
    far_weight = select(1.0, 2.0 * f32(1u - index % 2u), is_back);
    paths_each = select(paths.x, paths.y, is_back);
    added_sample = sampling.sample * (paths_each - 1u) + index;
    forget_path();
    first_way = select(select(ANY_WAY, OUT, paths.y > 0u), BACK, is_back);
    cross_surface(s);
}

// Light of a pixel by all of its paths, as it is stored.
fn followed(pixel: vec2u) -> vec4f {
    if (is_received() && textureLoad(view_depth, pixel, 0).x >= FAR_M) { return vec4f(0.0); }
    var s = load_surface(pixel);
    let view = -view_direction(s.position);
    var paths = vec2u(1u, 0u);
    var albedo = vec3f(0.0);
    var vertex = 0u; // number of the samples of the pixel's surface
    if (is_behind()) {
        if (!is_transmissive(s)) { return vec4f(0.0, 0.0, 0.0, 1.0); }
        // The G-buffer does not hold these values of the material.
        let m = instance_material(textureLoad(ids, pixel, 0).x);
        s.ior = material_ior(m);
        s.dispersion = material_dispersion(m);
        s.material = m;
        s.is_solid = material_is_solid(m) != 0u;
        paths = paths_behind(s);
        vertex = BEHIND_VERTEX;
    } else if (is_received()) {
        albedo = scattering_albedo(s, view);
        if (max(albedo.x, max(albedo.y, albedo.z)) <= select(0.0, 1e-4, SMOOTHED)) { return vec4f(0.0, 0.0, 0.0, select(1.0, 0.0, SMOOTHED)); }
        // The path ends no sooner where the surface is dark.
        if (SMOOTHED) { path_share = max(albedo.x, max(albedo.y, albedo.z)); }
        vertex = RECEIVED_VERTEX;
    } else if (MIRRORS && HAS_REFLECTIONS) {
        if (!MAPPED) { free_start_m = free_m(textureLoad(written_cause, pixel).x); }
        if (is_known) {
            let hit = stored_hit(pixel);
            // In fog, rays past all surfaces are listed too, for the light on their way.
            known_hit = Hit(select(bitcast<f32>(hit.x), FAR_M, HAS_FOG && hit.y == NONE), hit.y, hit.z, unpack2x16unorm(hit.w), 0u);
        }
    }
    let distance_m = distance(s.position, frame.eye);
    var sum = vec4f(0.0);
    for (var k = 0u; k < paths.x + paths.y; k++) {
        start_path(s.position, is_mirrored() && s.is_inside);
        if (is_behind()) { start_behind(s, k, paths); }
        start_samples(pixel, vertex);
        let start = Start(Reflected(-view, vec3f(1.0), 0.0, 1.0, 1.0, s.normal), s.position, s);
        let found = gathered_by_path(pixel, vertex + 1u, 0u, start, pixel_cone(distance_m), is_behind() && s.transmission <= 0.0);
        // Paths out find all light of rays that meet no inner side.
        let counts_alone = !(AIMS_THROUGH && is_behind()) || k < paths.x;
        sum += select(found, vec4f(0.0), vec4<bool>(vec3<bool>(!counts_alone && first_way == BACK), !counts_alone)) / f32(paths_each);
        // Other paths are alone. Software drivers take a fifth less time without the loop.
        if (!has_behind()) { break; }
    }
    if (is_mirrored()) {
        if (!carries_light(first_ray)) { return vec4f(0.0); }
        return smoothable(s, first_ray, sum.xyz);
    }
    if (!is_received()) { return sum; }
    if (!SMOOTHED) { return vec4f(sum.xyz, 1.0); }
    let arrived = select(vec3f(-1.0), sum.xyz * path_share / max(albedo, vec3f(1e-4)), albedo >= vec3f(1e-4));
    return vec4f(arrived, clamp(pixel_width(distance_m) / first_m, 1e-3, 1.0));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(local_invocation_index) lane: u32) {
    // llvmpipe 22.3 crashes on conditions that depend only on values of a fourth uniform block; no lane is that large.
    start_light = select(params.light, MIRRORED_LIGHT, lane >= RAYS_PER_GROUP);
    let leads = UNDERSAMPLED && select(params.leads, 0u, lane >= RAYS_PER_GROUP) != 0u;
    let pixel = path_pixel(group, groups, local, lane, leads);
    if (pixel.x == NONE) { return; }
    let light = followed(pixel);
    if (SHADE) { textureStore(path_light, pixel, stored(light)); }
    if (is_mirrored() && !is_known) {
        store_hit(pixel, first_hit);
        keep_cause(pixel, first_cause);
    }
    store_work(pixel, map_steps);
}
