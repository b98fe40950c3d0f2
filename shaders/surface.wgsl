// Surface: resolves the G-buffer from the ids of the visibility pass.

#import frame
#import pack
#import surface

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(1) var view_depth: texture_storage_2d<r32float, write>;
@group(2) @binding(2) var surface: texture_storage_2d<rgba32uint, write>;
@group(2) @binding(3) var base_color: texture_storage_2d<rgba16float, write>;
@group(2) @binding(4) var emission: texture_storage_2d<rgba16float, write>;

fn pack_surface(s: Surface) -> vec4u {
    return vec4u(
        pack_unit(s.normal),
        pack_unit(s.geometric_normal),
        pack2x16float(vec2f(s.roughness, s.metallic)),
        (pack2x16float(vec2f(s.reflectivity, 0.0)) & 0xffffu) | (s.reflection << 16u),
    );
}

// Where the pixel's ray meets the plane of its triangle: exact, where the depth buffer is not.
struct PlaneHit {
    t: f32,
    bary: vec2f,
}

fn plane_hit(direction: vec3f, instance: u32, triangle: u32) -> PlaneHit {
    let c = corners(instance, triangle);
    let p0 = to_world(instance, c.p[0]) - frame.eye;
    let e1 = to_world(instance, c.p[1]) - frame.eye - p0;
    let e2 = to_world(instance, c.p[2]) - frame.eye - p0;
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    let inverse = select(0.0, 1.0 / determinant, abs(determinant) > 1e-30);
    let q = cross(-p0, e1);
    return PlaneHit(dot(e2, q) * inverse, vec2f(dot(-p0, p), dot(direction, q)) * inverse);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(frame.size))) { return; }
    let hit = textureLoad(ids, id.xy, 0).xy;
    if (hit.x == NONE) {
        textureStore(view_depth, id.xy, vec4f(FAR_M, 0.0, 0.0, 0.0));
        textureStore(surface, id.xy, vec4u(0u));
        textureStore(base_color, id.xy, vec4f(0.0));
        textureStore(emission, id.xy, vec4f(0.0));
        return;
    }
    let ray = pixel_ray(vec2f(id.xy) + 0.5);
    let plane = plane_hit(ray, hit.x, hit.y);
    // A pixel center may lie just outside the triangle that covers it.
    var bary = clamp(plane.bary, vec2f(0.0), vec2f(1.0));
    bary /= max(bary.x + bary.y, 1.0);
    let s = surface_at(hit.x, hit.y, bary, normalize(ray), frame.pixel_spread * plane.t * length(ray));
    // Depth along this pixel's own ray, so that the position found from it lies on the plane; only
    // a triangle seen edge-on is too far off for that.
    let on_plane = distance(bary, plane.bary) < 0.1;
    let depth_m = select(dot(s.position - frame.eye, frame.forward), plane.t, on_plane);
    textureStore(view_depth, id.xy, vec4f(depth_m, 0.0, 0.0, 0.0));
    textureStore(surface, id.xy, pack_surface(s));
    textureStore(base_color, id.xy, vec4f(s.base_color, s.occlusion));
    textureStore(emission, id.xy, vec4f(min(s.emission, vec3f(65000.0)), 0.0));
}
