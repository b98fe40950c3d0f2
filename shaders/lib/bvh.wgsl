// Rays through the scene: the nearest hit, or any hit. `walk` stands for `walk_trees`, our traversal of the static tree
// and the top level, or `walk_query`, the device's; both test triangles and capsules by the functions here.
//
// The buffers are packed by src/world/bvh.rs, whose module comment documents the layout. The including shader
// declares:
//   node_words(i: u32) -> vec4u        NODE_VECTORS per node, for walk_trees
//   triangle_words(i: u32) -> vec4u    TRIANGLE_VECTORS per TraceTriangle
//   instance_values(i: u32) -> InstanceValues, with object_from_world: mat3x4f, tree_root, trace_flags: u32
//   alpha_passes(instance: u32, triangle: u32, bary: vec2f) -> bool
//
// Nearest hits ignore single-sided triangles from behind; shadow rays are blocked by either side.
// Intervals are open: t_min < t < t_max. Directions may have any length but 0; t is in units of that length.

#import basis
#import capsule
#import constants
#import coplanar
#import shown
#import walk

// Whether the scene has a static tree and a top level; each constant drops its code where it is false.
override HAS_STATIC: bool = true;
override HAS_TOP_LEVEL: bool = true;
// Whether nearest hits are of camera rays. The traversal then also keeps the nearest triangle that these rays
// ignore, as a back face, as cut away or as hidden from the camera, and that reflection rays meet.
override OF_CAMERA: bool = false;
// Whether rays pass through instances that may move.
override STATIC_ONLY: bool = false;
// Whether some instance is marked ALPHA_TESTED: cut-outs and transmissive materials.
override HAS_TESTED: bool = true;
// Whether nodes and triangles are counted; without it the counting code is dropped.
override COUNT: bool = false;

const NO_INSTANCE = NONE;
// Maximum number of nodes that one ray may visit, over all BVHs and behind all cut-outs. Usual rays visit some
// hundred; one that needs more, through thousands of overlapping instances, is counted and ends as a miss, so that
// no input can make the GPU loop forever.
override MAX_VISITS: u32 = 262144u;

struct Hit {
    // Distance in lengths of the ray's direction; t_max for a miss.
    t: f32,
    // Instance of the hit; NO_INSTANCE for a miss.
    instance: u32,
    // Index of the triangle in the mesh of the instance.
    triangle: u32,
    // Barycentric weights of vertex 1 and vertex 2, inside the triangle; of a capsule the place on its surface.
    bary: vec2f,
    // Flags ALPHA_TESTED, DOUBLE_SIDED, FLIPPED of the triangle that was hit.
    flags: u32,
}

// Counts since the invocation started, with COUNT: traversals from the root, of which a ray through cut-outs needs
// several, nodes visited and triangles tested.
var<private> traversals: u32 = 0u;
var<private> visited_nodes: u32 = 0u;
var<private> tested_triangles: u32 = 0u;
// Distance of the nearest ignored triangle since the invocation started, with OF_CAMERA.
var<private> culled_t: f32 = 1e30;
// Number of nodes that the ray may still visit, and number of rays that ran out of them.
var<private> visits_left: u32 = 0u;
var<private> exhausted_rays: u32 = 0u;

// In walk_trees the alpha of cut-outs is looked up outside the traversal, which then starts again behind transparent
// ones: inside the loop the look-up would cost every ray (on llvmpipe two thirds of all tracing time in Sponza),
// outside it costs only rays that meet cut-outs. This is the maximum number of such restarts.
const MAX_LAYERS = 1024u;

fn trace_nearest(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> Hit {
    return trace_solid(origin, direction, t_min, t_max, false);
}

fn trace_solid(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, shadow: bool) -> Hit {
    visits_left = MAX_VISITS;
    passed_cutout = vec2u(NONE);
    var start_m = t_min;
    // One call in a loop keeps the inlined code small: the traversal is long.
    for (var layer = 0u; layer <= MAX_LAYERS; layer++) {
        let hit = traverse(origin, direction, start_m, t_max, shadow);
        if (visits_left == 0u) { break; }
        if (!HAS_CUTOUT || PASSES_CUTOUTS || !is_cut_out(hit)) { return hit; }
        passed_cutout = vec2u(hit.instance, hit.triangle);
        // Coplanar surfaces are passed in the order of their ids, never going back.
        start_m = max(start_m, hit.t);
    }
    exhausted_rays++;
    return Hit(t_max, NO_INSTANCE, 0u, vec2f(0.0), 0u);
}

fn is_cut_out(hit: Hit) -> bool {
    let is_passed_through = hit.instance != NO_INSTANCE && (hit.flags & ALPHA_TESTED) != 0u
        && !alpha_passes(hit.instance, hit.triangle, hit.bary);
    if (OF_CAMERA && is_passed_through) { culled_t = min(culled_t, hit.t); }
    return is_passed_through;
}

struct TraversalRay {
    origin: vec3f,
    direction: vec3f,
    inverse: vec3f,
    // 7 − the octant of the direction in each byte: XORed with a child's slot, it sorts children by distance.
    octant4: u32,
}

fn traversal_ray(origin: vec3f, direction: vec3f) -> TraversalRay {
    let size = abs(direction);
    // A finite substitute for 1 / 0; over any distance it bends the ray by less than rounding does.
    let smallest = max(max(size.x, max(size.y, size.z)) * 1e-12, 1e-30);
    let positive = direction >= vec3f(0.0);
    let safe = select(-max(size, vec3f(smallest)), max(size, vec3f(smallest)), positive);
    let bits = select(vec3u(0u), vec3u(0x04040404u, 0x02020202u, 0x01010101u), positive);
    return TraversalRay(origin, direction, 1.0 / safe, bits.x | bits.y | bits.z);
}

// Flag of instances that this kind of ray ignores.
fn passed_flags(shadow: bool) -> u32 {
    return select(select(UNREFLECTED, UNSEEN, OF_CAMERA), SHADOWLESS, shadow);
}

// Whether a surface is outside the ray's interval, or behind the nearest one so far or beaten by it where both are
// coplanar. Opaque surfaces block light whatever lies on them.
fn is_hidden(t: f32, t_min: f32, id: vec2u, flags: u32, shadow: bool, best: Hit) -> bool {
    if (is_passed_by(t, id, t_min)) { return true; }
    if (best.instance == NO_INSTANCE || !is_coplanar(t, best.t)) { return t >= best.t; }
    let is_tested = (flags & ALPHA_TESTED) != 0u;
    if (shadow && is_tested != ((best.flags & ALPHA_TESTED) != 0u)) { return is_tested; }
    return !comes_after(vec2u(best.instance, best.triangle), id);
}

// Tests one triangle and updates the nearest hit. `inside` is the instance whose object space the
// ray is in.
fn test_triangle(index: u32, ray: TraversalRay, t_min: f32, inside: u32, inside_flags: u32,
        shadow: bool, best: ptr<function, Hit>) {
    let at = index * TRIANGLE_VECTORS;
    let a = triangle_words(at);
    let b = triangle_words(at + 1u);
    let c = triangle_words(at + 2u);
    let edge1 = bitcast<vec3f>(b.xyz);
    let edge2 = bitcast<vec3f>(c.xyz);
    // Möller and Trumbore 1997.
    let p = cross(ray.direction, edge2);
    let det = dot(edge1, p);
    let flat = abs(det) < 1e-36;
    let inverse_det = 1.0 / select(det, 1.0, flat);
    let s = ray.origin - bitcast<vec3f>(a.xyz);
    let q = cross(s, edge1);
    let bary = vec2f(dot(s, p), dot(ray.direction, q)) * inverse_det;
    let t = dot(edge2, q) * inverse_det;
    let outside = max(max(-bary.x, -bary.y), bary.x + bary.y - 1.0);
    let is_inner = HAS_TOP_LEVEL && inside != NO_INSTANCE;
    let id = vec2u(select(a.w, inside, is_inner), b.w);
    let flags = select(c.w, inside_flags, is_inner);
    if (flat || !(outside <= 0.01) || is_hidden(t, t_min, id, flags, shadow, *best)) { return; }
    // Tolerance for the rounding error of the barycentric weights: neighbors overlap by it, so that no ray passes
    // between.
    let longest = max(dot(edge1, edge1), dot(edge2, edge2));
    let size = length(s) * length(ray.direction) * sqrt(longest);
    if (outside > 2.4e-7 * size * abs(inverse_det)) { return; }
    let front = (det > 0.0) != ((flags & FLIPPED) != 0u);
    let is_culled = !shadow && !front && (flags & DOUBLE_SIDED) == 0u;
    if (is_culled || is_passed(flags, passed_flags(shadow))) {
        if (OF_CAMERA && !is_passed(flags, UNREFLECTED)) { culled_t = min(culled_t, t); }
        return;
    }
    *best = Hit(t, id.x, id.y, clamped(bary), flags);
}

// Barycentric weights of a point beside the triangle, moved into it.
fn clamped(bary: vec2f) -> vec2f {
    let positive = max(bary, vec2f(0.0));
    return positive / max(positive.x + positive.y, 1.0);
}

// Tests one capsule, as test_triangle does a triangle.
fn test_capsule(index: u32, ray: TraversalRay, t_min: f32, inside: u32, flags: u32, shadow: bool,
        best: ptr<function, Hit>) {
    let at = index * TRIANGLE_VECTORS;
    let a = triangle_words(at);
    let b = triangle_words(at + 1u);
    let radius = bitcast<f32>(triangle_words(at + 2u).x);
    let axis = bitcast<vec3f>(b.xyz);
    let origin = ray.origin - bitcast<vec3f>(a.xyz);
    let span = capsule_span(origin, ray.direction, axis, radius);
    if (!span.is_met) { return; }
    let sees_backs = shadow || (flags & DOUBLE_SIDED) != 0u;
    let t = select(span.enter, span.leave, span.enter <= t_min && sees_backs);
    let id = vec2u(inside, b.w);
    // Neighbors share the spheres at their ends, which rasterization gives to the nearer of them by rounding.
    let is_neighbor = inside == (*best).instance;
    if (select(is_hidden(t, t_min, id, flags, shadow, *best), is_passed_by(t, id, t_min) || t >= (*best).t, is_neighbor)) {
        return;
    }
    if (is_passed(flags, passed_flags(shadow))) {
        if (OF_CAMERA && !is_passed(flags, UNREFLECTED)) { culled_t = min(culled_t, t); }
        return;
    }
    *best = Hit(t, inside, b.w, capsule_place(origin + ray.direction * t, axis, radius), flags);
}

// Whether a shadow ray can stop: an opaque triangle blocks it.
fn is_blocked(best: Hit) -> bool {
    return best.instance != NO_INSTANCE && (!HAS_TESTED || (best.flags & ALPHA_TESTED) == 0u);
}

// The ray in an instance's object space; t has the same meaning there.
fn object_ray(values: InstanceValues, origin: vec3f, direction: vec3f) -> TraversalRay {
    let rows = values.object_from_world;
    return traversal_ray(to_object(rows, origin), direction_to_object(rows, direction));
}
