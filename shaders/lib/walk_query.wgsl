// Traversal by the device's ray queries, for bvh.wgsl. The acceleration structures (src/render/upload/structures.rs)
// have the triangles of our trees in the same order: one bottom structure for the static tree, in world space, and one
// for each mesh tree. The device only finds candidates; our own tests decide which of them is hit, and where.

enable wgpu_ray_query;

@group(1) @binding(17) var structures: acceleration_structure;

// Whether the traversal passes cut-outs by itself.
const PASSES_CUTOUTS = true;
// Relative distance by which intervals are widened for the device, whose distances are rounded in other ways than ours.
const QUERY_SLACK = 1e-5;

// Mask of the instances that this kind of ray meets, for the device.
fn query_mask(shadow: bool) -> u32 {
    // Camera rays look at what only reflection rays meet, too: culled_t.
    let kind = select(select(SEEN_BY_REFLECTIONS, SEEN_BY_REFLECTIONS | SEEN_BY_CAMERA, OF_CAMERA), SEEN_BY_LIGHTS, shadow);
    return kind | select(kind << MOVING_SHIFT, 0u, STATIC_ONLY);
}

// Tests the triangle or capsule of a candidate, and updates the nearest hit; whether it did.
fn test_candidate(candidate: RayIntersection, world_ray: TraversalRay, t_min: f32, shadow: bool,
        best: ptr<function, Hit>) -> bool {
    let is_static = HAS_STATIC && (!HAS_TOP_LEVEL || candidate.instance_custom_data == STATIC_STRUCTURE);
    let before = *best;
    if (COUNT) { tested_triangles++; }
    if (is_static) {
        test_triangle(candidate.primitive_index, world_ray, t_min, NO_INSTANCE, 0u, shadow, best);
    } else {
        let inside = candidate.instance_custom_data;
        let values = instance_values(inside);
        let flags = values.trace_flags;
        let index = values.tree_root + candidate.primitive_index;
        let ray = object_ray(values, world_ray.origin, world_ray.direction);
        if (HAS_CAPSULES && (flags & CAPSULES) != 0u) {
            test_capsule(index, ray, t_min, inside, flags, shadow, best);
        } else {
            test_triangle(index, ray, t_min, inside, flags, shadow, best);
        }
    }
    if ((*best).instance == before.instance && (*best).triangle == before.triangle && (*best).t == before.t) {
        return false;
    }
    if (HAS_CUTOUT && is_cut_out(*best)) {
        *best = before;
        return false;
    }
    return true;
}

// The nearest hit, or for shadow rays any opaque one. A first query finds the nearest surface, and shortens the ray at
// each; a second looks at all surfaces within the rounding of that distance, which the first may have left out, so that
// among coplanar ones the same is met as in our trees.
fn traverse(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, shadow: bool) -> Hit {
    if (COUNT) { traversals++; }
    let ray = traversal_ray(origin, direction);
    let mask = query_mask(shadow);
    let first = t_min * (1.0 - QUERY_SLACK);
    var start = first;
    var end = t_max * (1.0 + QUERY_SLACK);
    var best = Hit(t_max, NO_INSTANCE, 0u, vec2f(0.0), 0u);
    var query: ray_query;
    for (var round = 0u; round < 2u; round++) {
        rayQueryInitialize(&query, structures,
            RayDesc(RAY_FLAG_FORCE_NO_OPAQUE, mask, start, end, origin, direction));
        while (visits_left > 0u && rayQueryProceed(&query)) {
            visits_left--;
            let candidate = rayQueryGetCandidateIntersection(&query);
            if (!test_candidate(candidate, ray, t_min, shadow, &best)) { continue; }
            if (shadow && is_blocked(best)) { return best; }
            if (round > 0u) { continue; }
            if (HAS_CAPSULES && candidate.kind == RAY_QUERY_INTERSECTION_AABB) {
                // naga 30 reads no expression that only this call has.
                let t = best.t;
                rayQueryGenerateIntersection(&query, t);
            } else {
                rayQueryConfirmIntersection(&query);
            }
        }
        if (best.instance == NO_INSTANCE || visits_left == 0u) { break; }
        start = max(first, best.t * (1.0 - QUERY_SLACK));
        end = best.t * (1.0 + QUERY_SLACK);
    }
    return best;
}
