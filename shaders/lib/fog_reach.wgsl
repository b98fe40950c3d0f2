// Part of a ray that a lamp can light: within its cone, on its bright side, in its range.

#import frame

// Distances along a ray, from `span`, within a cone that is narrower than a half space; `offset` leads from the tip to
// the ray's origin.
fn span_in_cone(span: vec2f, offset: vec3f, direction: vec3f, axis: vec3f, cosine: f32) -> vec2f {
    // The cone is (x · axis)² ≥ cos² x², in front of its tip.
    let da = dot(direction, axis);
    let oa = dot(offset, axis);
    let c2 = cosine * cosine;
    let a = da * da - c2;
    let b = da * oa - c2 * dot(direction, offset);
    let c = oa * oa - c2 * dot(offset, offset);
    let root2 = b * b - a * c;
    if (abs(a) < 1e-6) { return span; }
    if (root2 <= 0.0) { return select(span, vec2f(span.x), a < 0.0); }
    // Roots without cancellation.
    let q = -b - select(-1.0, 1.0, b >= 0.0) * sqrt(root2);
    let first = min(q / a, c / select(q, 1e-30, q == 0.0));
    let second = max(q / a, c / select(q, 1e-30, q == 0.0));
    var part = vec2f(first, second);
    if (a > 0.0) { part = select(vec2f(span.x, first), vec2f(second, span.y), da > 0.0); }
    // The other half of the double cone is dark.
    if (a < 0.0 && oa + da * 0.5 * (first + second) <= 0.0) { return vec2f(span.x); }
    let start = clamp(part.x, span.x, span.y);
    return vec2f(start, clamp(part.y, start, span.y));
}

// Distances along a ray, from `span`, on the side of a plane to which `normal` points.
fn span_before(span: vec2f, offset: vec3f, direction: vec3f, normal: vec3f) -> vec2f {
    let rate = dot(direction, normal);
    let height = dot(offset, normal);
    if (abs(rate) < 1e-9) { return select(vec2f(span.x), span, height > 0.0); }
    let at = clamp(-height / rate, span.x, span.y);
    return select(vec2f(span.x, at), vec2f(at, span.y), rate > 0.0);
}

// Distances along a ray, from `span`, within a ball.
fn span_in_ball(span: vec2f, offset: vec3f, direction: vec3f, radius_m: f32) -> vec2f {
    let along_m = -dot(offset, direction);
    let off = offset + direction * along_m;
    let root2 = radius_m * radius_m - dot(off, off);
    if (root2 <= 0.0) { return vec2f(span.x); }
    let start = clamp(along_m - sqrt(root2), span.x, span.y);
    return vec2f(start, clamp(along_m + sqrt(root2), start, span.y));
}

// Distances along a ray, from `span`, that light `i` can light.
fn span_lit_by(span: vec2f, i: u32, origin: vec3f, direction: vec3f) -> vec2f {
    let offset = origin - lights[i].position;
    var lit = span;
    switch lights[i].kind {
        case LIGHT_DIRECTIONAL: { return span; }
        case LIGHT_SPOT: {
            let cosine = -lights[i].spot_offset / lights[i].spot_scale;
            if (cosine > 0.01) { lit = span_in_cone(span, offset, direction, lights[i].direction, cosine); }
        }
        case LIGHT_RECT, LIGHT_DISK: { lit = span_before(span, offset, direction, lights[i].direction); }
        default: {}
    }
    if (lights[i].range_m > 0.0) { lit = span_in_ball(lit, offset, direction, lights[i].range_m); }
    return lit;
}
