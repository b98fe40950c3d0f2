// Surface: resolves the G-buffer from the ids of the visibility pass and lists the reflective and the transmissive
// pixels, tile by tile so that neighbors stay together.

#import gbuffer_layout
#import lists
#import pixel_surface
#import shade

override MARCH: bool = true; // whether the rays of reflective pixels are marched
override RASTERIZED: bool = true; // false: primary rays found ids and the depth of culled triangles

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(1) var view_depth: texture_storage_2d<r32float, write>;
@group(2) @binding(2) var surface: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(3) var colors: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(4) var cause: texture_storage_2d<r32uint, write>;
@group(2) @binding(5) var raster_depth: texture_depth_2d; // clip-space z, culled triangles included

const CULLED_SLACK: f32 = 1e-4;

// Kinds of pixels; a pixel is of one of the first three, and perhaps transmissive.
const UNREFLECTIVE: u32 = 0u;
const ROUGH: u32 = 1u;
const REFLECTIVE: u32 = 2u;
const TRANSMISSIVE: u32 = 3u;
var<workgroup> tile_counts: array<atomic<u32>, 4>;
var<workgroup> reflective_start: u32;
var<workgroup> transmissive_start: u32;

// Writes the depth of the surface that the pixel shows, and for the march the depth of the nearest surface that its
// rays may meet: perhaps a culled triangle in front of it.
fn store_depth(pixel: vec2u, instance: u32, depth_m: f32) {
    textureStore(view_depth, pixel, vec4f(depth_m, 0.0, 0.0, 0.0));
    if (!HAS_REFLECTIONS || !MARCH) { return; }
    var nearest = screen_z(depth_m);
    let slot = pyramid_slot(pyramid(), pixel, 0u);
    if (HAS_CULLED && RASTERIZED) {
        // The depth of the surface is computed from its plane, and differs a little from the rasterized depth.
        let culled = textureLoad(raster_depth, pixel, 0);
        if (culled > screen_z(depth_m * (1.0 - CULLED_SLACK))) { nearest = culled; }
    } else if (HAS_CULLED) {
        nearest = max(nearest, bitcast<f32>(lists[slot]));
    }
    lists[slot] = bitcast<u32>(select(nearest, -nearest, is_cutout(instance)));
}

struct Resolved {
    kind: u32, // its kind but for TRANSMISSIVE
    is_transmissive: bool,
}

// Resolves the surface of a pixel into the G-buffer.
fn resolve(pixel: vec2u) -> Resolved {
    let hit = textureLoad(ids, pixel, 0).xy;
    if (hit.x == NONE) {
        store_depth(pixel, NONE, FAR_M);
        textureStore(surface, pixel, vec4u(0u));
        textureStore(colors, pixel, vec4u(0u));
        return Resolved(UNREFLECTIVE, false);
    }
    let shown = pixel_surface(pixel, hit);
    let s = shown.surface;
    store_depth(pixel, hit.x, shown.depth_m);
    textureStore(surface, pixel, pack_surface(s));
    textureStore(colors, pixel, pack_colors(s));
    let rough = select(UNREFLECTIVE, ROUGH, s.reflection != REFLECTION_NONE);
    return Resolved(select(rough, REFLECTIVE, is_reflector(rounded_surface(s))), is_transmissive(s));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u, @builtin(local_invocation_index) lane: u32) {
    let pixel = surface_pixel(invoked_place(group, groups, local));
    let inside = all(pixel < vec2u(frame.size));
    var found = Resolved(UNREFLECTIVE, false);
    if (inside) { found = resolve(pixel); }
    let is_shown = inside && all(pixel_of_moment(vec2i(pixel)) == vec2i(pixel)); // of this moment
    if (!is_shown || is_left_out(pixel)) { found = Resolved(UNREFLECTIVE, false); }
    if (!HAS_REFLECTIONS && !HAS_TRANSMISSION) { return; }
    let kind = found.kind;
    var place = 0u;
    var transmissive_place = 0u;
    if (HAS_REFLECTIONS && is_shown) {
        let causes = array<u32, 3>(CAUSE_NOT_REFLECTIVE, CAUSE_ROUGH, CAUSE_UNMARCHED);
        textureStore(cause, pixel, vec4u(causes[kind], 0u, 0u, 0u));
        place = atomicAdd(&tile_counts[kind], 1u);
    }
    if (HAS_TRANSMISSION && found.is_transmissive) { transmissive_place = atomicAdd(&tile_counts[TRANSMISSIVE], 1u); }
    workgroupBarrier();
    if (lane == 0u) {
        if (HAS_TRANSMISSION) {
            transmissive_start = atomicAdd(&counters[TRANSMISSIVE_COUNTER], atomicLoad(&tile_counts[TRANSMISSIVE]));
        }
        atomicAdd(&counters[CAUSE_NOT_REFLECTIVE], atomicLoad(&tile_counts[UNREFLECTIVE]));
        atomicAdd(&counters[CAUSE_ROUGH], atomicLoad(&tile_counts[ROUGH]));
        let reflective = atomicLoad(&tile_counts[REFLECTIVE]);
        if (MARCH) {
            reflective_start = atomicAdd(&counters[REFLECTOR_COUNTER], reflective);
        } else {
            reflective_start = atomicAdd(&counters[CAUSE_UNMARCHED], reflective);
            atomicAdd(&counters[RAY_COUNTER], reflective);
        }
    }
    workgroupBarrier();
    if (HAS_TRANSMISSION && found.is_transmissive) {
        lists[transmissive_slot(transmissive_start + transmissive_place)] = pack_pixel(pixel);
    }
    if (HAS_REFLECTIONS && kind == REFLECTIVE) { lists[reflector_slot(reflective_start + place)] = pack_pixel(pixel); }
}
