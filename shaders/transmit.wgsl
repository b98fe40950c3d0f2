// Transmit: follows rays through the transmissive surfaces of the listed pixels, to the surfaces behind.

#import cone
#import gbuffer
#import indirect
#import lists
#import radiance

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(6) var transmitted_light: RadianceTexture;
@group(2) @binding(11) var counts: texture_storage_2d<rgba32uint, write>; // with COUNT

const PATHS: u32 = FREE_PATHS;
const FIRST_VERTEX: u32 = 64u; // offset of sample numbers: others than for reflections

// Light from behind the surface of a pixel along one path, which goes this way from the inner side behind it; w: share
// that is covered by surfaces rather than the background.
fn behind_once(pixel: vec2u, s: Surface, way: u32) -> vec4f {
    forget_path();
    first_way = way;
    start_path(s.position, false);
    start_samples(pixel, FIRST_VERTEX);
    cross_surface(s);
    let ray = in_one_channel(s, transmitted(view_direction(s.position), dispersed(s)));
    let start = Start(ray, onward_origin(s, ray.direction));
    let cone = pixel_cone(distance(s.position, frame.eye));
    let found = gathered_by_path(pixel, FIRST_VERTEX + 1u, 0u, start, cone, s.transmission <= 0.0);
    if (!AIMS_THROUGH || way != BACK) { return found; }
    // Paths out find all light of rays that meet no inner side.
    return select(found, vec4f(0.0), vec4<bool>(vec3<bool>(first_way == BACK), true));
}

fn behind(pixel: vec2u) -> vec4f {
    var s = load_surface(pixel);
    if (!is_transmissive(s)) { return vec4f(0.0, 0.0, 0.0, 1.0); }
    // The G-buffer does not hold these values of the material.
    let m = instance_material(textureLoad(ids, pixel, 0).x);
    s.ior = material_ior(m);
    s.dispersion = material_dispersion(m);
    s.material = m;
    s.is_solid = material_is_solid(m) != 0u;
    // More paths in the first pictures, where glass turns or scatters light, so that one path that ends in the dark
    // leaves no black speck: as many as rays towards lights where `light_rays` is left out, four in a picture of one
    // sub-frame and one from seven on.
    let several = select((8u + sampling.samples) / (sampling.samples + 1u), 1u, UNBIASED);
    let is_rough = HAS_ROUGH_REFLECTIONS && s.roughness * s.roughness > SMOOTH_ALPHA;
    let paths = select(1u, several, s.transmission > 0.0 && (s.is_solid || is_rough));
    // Behind the outer side of a rough solid, paths out of its inner side, and an even number of paths back from there,
    // which have most of the grain.
    let splits = AIMS_THROUGH && is_rough && s.is_solid && !s.is_inside && s.transmission > 0.0 && !has_sheen(s);
    let back = select(0u, (paths + 1u) / 2u * 2u, splits);
    var sum = vec4f(0.0);
    for (var k = 0u; k < paths + back; k++) {
        let is_back = k >= paths;
        let index = select(k, k - paths, is_back);
        far_weight = select(1.0, 2.0 * f32(1u - index % 2u), is_back);
        paths_each = select(paths, back, is_back);
        added_sample = sampling.sample * (paths_each - 1u) + index;
        sum += behind_once(pixel, s, select(select(ANY_WAY, OUT, splits), BACK, is_back)) / f32(paths_each);
    }
    return sum;
}

@compute @workgroup_size(RAYS_PER_GROUP)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let index = (group.y * groups.x + group.x) * RAYS_PER_GROUP + lane;
    if (index >= atomicLoad(&counters[TRANSMISSIVE_COUNTER])) { return; }
    let pixel = unpack_pixel(lists[transmissive_slot(index)]);
    textureStore(transmitted_light, pixel, stored(behind(pixel)));
    if (COUNT) { textureStore(counts, pixel, vec4u(0u, traversals, visited_nodes, tested_triangles)); }
    if (exhausted_rays > 0u) { atomicAdd(&counters[EXHAUSTED_COUNTER], exhausted_rays); }
}
