// Capsules as leaves of trees, for bvh.wgsl.

#import capsule

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
