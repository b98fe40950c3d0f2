// Surface: resolves the G-buffer from the ids of the visibility pass and lists the reflective pixels,
// tile by tile so that neighbors stay together.

#import cause
#import gbuffer_layout
#import lists
#import pack
#import shade
#import surface

override HAS_REFLECTIONS: bool = true;
override MARCH: bool = true; // false: method rt, reflective pixels are listed as rays

override RASTERIZED: bool = true; // false: primary rays have found what is culled

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(1) var view_depth: texture_storage_2d<r32float, write>;
@group(2) @binding(2) var surface: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(3) var colors: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(4) var cause: texture_storage_2d<r32uint, write>;
@group(2) @binding(5) var raster_depth: texture_depth_2d; // clip-space z, also of what was culled

const CULLED_SLACK: f32 = 1e-4;

var<workgroup> tile_counts: array<atomic<u32>, 3>; // not reflective, rough, reflective
var<workgroup> tile_start: u32;

// Where the pixel's ray meets the plane of its triangle: exact, where the depth buffer is not.
struct PlaneHit {
    t: f32,
    bary: vec2f,
}

fn plane_hit(origin: vec3f, direction: vec3f, instance: u32, triangle: u32) -> PlaneHit {
    let c = corners(instance, triangle);
    let p0 = to_world(instance, c.p[0]) - origin;
    let e1 = to_world(instance, c.p[1]) - origin - p0;
    let e2 = to_world(instance, c.p[2]) - origin - p0;
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    let inverse = select(0.0, 1.0 / determinant, abs(determinant) > 1e-30);
    let q = cross(-p0, e1);
    return PlaneHit(dot(e2, q) * inverse, vec2f(dot(-p0, p), dot(direction, q)) * inverse);
}

// Keeps the depth of what the camera culls in front of what it shows at `depth_m`.
fn keep_culled(pixel: vec2u, depth_m: f32) {
    let nearest = textureLoad(raster_depth, pixel, 0);
    // What is shown is found by its plane, and differs a little from what was rasterized.
    let is_culled = nearest > screen_z(depth_m * (1.0 - CULLED_SLACK));
    lists[culled_slot(pixel)] = bitcast<u32>(select(0.0, nearest, is_culled));
}

// Resolves a pixel and says what it reflects.
fn resolve(pixel: vec2u) -> u32 {
    let hit = textureLoad(ids, pixel, 0).xy;
    if (hit.x == NONE) {
        if (HAS_CULLED && RASTERIZED) { keep_culled(pixel, FAR_M); }
        textureStore(view_depth, pixel, vec4f(FAR_M, 0.0, 0.0, 0.0));
        textureStore(surface, pixel, vec4u(0u));
        textureStore(colors, pixel, vec4u(0u));
        return CAUSE_NOT_REFLECTIVE;
    }
    let center = vec2f(pixel) + 0.5;
    let ray = pixel_ray(center);
    let plane = plane_hit(pixel_origin(center), ray, hit.x, hit.y);
    // A pixel center may lie just outside the triangle that covers it.
    var bary = clamp(plane.bary, vec2f(0.0), vec2f(1.0));
    bary /= max(bary.x + bary.y, 1.0);
    let s = surface_at(hit.x, hit.y, bary, normalize(ray), pixel_width(plane.t * length(ray)));
    // Depth along this pixel's own ray, so that the position found from it lies on the plane; only
    // a triangle seen edge-on is too far off for that.
    let on_plane = distance(bary, plane.bary) < 0.1;
    let depth_m = select(dot(s.position - frame.eye, frame.forward), plane.t, on_plane);
    if (HAS_CULLED && RASTERIZED) { keep_culled(pixel, depth_m); }
    textureStore(view_depth, pixel, vec4f(depth_m, 0.0, 0.0, 0.0));
    textureStore(surface, pixel, pack_surface(s));
    textureStore(colors, pixel, pack_colors(s));
    // As the packed surface will be read again.
    var packed = s;
    packed.roughness = unpack2x16float(pack2x16float(vec2f(s.roughness, 0.0))).x;
    if (is_reflector(packed)) { return CAUSE_UNMARCHED; }
    return select(CAUSE_NOT_REFLECTIVE, CAUSE_ROUGH, s.reflection != REFLECTION_NONE);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) lane: u32) {
    let inside = all(id.xy < vec2u(frame.size));
    var why = CAUSE_NOT_REFLECTIVE;
    if (inside) { why = resolve(id.xy); }
    if (!HAS_REFLECTIONS) { return; }
    var place = 0u;
    if (inside) {
        textureStore(cause, id.xy, vec4u(why, 0u, 0u, 0u));
        let kind = u32(why == CAUSE_ROUGH) + 2u * u32(why == CAUSE_UNMARCHED);
        place = atomicAdd(&tile_counts[kind], 1u);
    }
    workgroupBarrier();
    if (lane == 0u) {
        let reflective = atomicLoad(&tile_counts[2]);
        atomicAdd(&counters[CAUSE_NOT_REFLECTIVE], atomicLoad(&tile_counts[0]));
        atomicAdd(&counters[CAUSE_ROUGH], atomicLoad(&tile_counts[1]));
        if (MARCH) {
            tile_start = reflector_slot(atomicAdd(&counters[REFLECTOR_COUNTER], reflective));
        } else {
            atomicAdd(&counters[CAUSE_UNMARCHED], reflective);
            tile_start = ray_slot(atomicAdd(&counters[RAY_COUNTER], reflective));
        }
    }
    workgroupBarrier();
    if (inside && why == CAUSE_UNMARCHED) { lists[tile_start + place] = pack_pixel(id.xy); }
}
