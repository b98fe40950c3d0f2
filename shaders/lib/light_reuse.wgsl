// Reuse of the light pass's shadow ray results for reflection hits at the same place, where pixels show it. Shadow
// maps are not reused, as looking them up again costs less.
// Whether a light reaches a point depends only on the point and its side, so pixels of other instances may be used
// too, if they lie on the same plane.
//
// Two bits per light: 0 is unknown or partly lit, and is computed anew; REUSED_DARK and REUSED_LIT are reused. Pixels
// that disagree leave no bit when they are combined, so shadow edges are never smeared.

#import gbuffer
#import screen_ray

@group(2) @binding(14) var visible_lights: texture_2d<u32>; // shadow ray results of the light pass

// Light bits of the pixels around a point that lie on its plane; 0 unless their bilinear weight is at least half.
fn reused_visibility(s: Surface) -> vec2u {
    if (frame.reuse_light == 0u) { return vec2u(0u); }
    let distance_m = dot(s.position - frame.eye, frame.forward);
    if (distance_m <= frame.near_m) { return vec2u(0u); }
    let at = to_screen(s.position).xy - 0.5;
    if (any(at < vec2f(-0.5)) || any(at > frame.size - 0.5)) { return vec2u(0u); }
    let corner = floor(at);
    let part = at - corner;
    let tolerance_m = 0.5 * pixel_width(distance_m);
    var agreed = vec2u(0xffffffffu);
    var weight = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let offset = vec2f(f32(k & 1u), f32(k >> 1u));
        let pixel = corner + offset;
        if (any(pixel < vec2f(0.0)) || any(pixel >= frame.size)) { continue; }
        let depth_m = textureLoad(view_depth, vec2u(pixel), 0).x;
        let away_m = dot(position_at(vec2u(pixel), depth_m) - s.position, s.geometric_normal);
        let normal = unpack_geometric_normal(textureLoad(surface, vec2u(pixel), 0));
        if (abs(away_m) > tolerance_m || dot(normal, s.geometric_normal) < 0.9) { continue; }
        let weights = mix(1.0 - part, part, offset);
        weight += weights.x * weights.y;
        agreed &= textureLoad(visible_lights, vec2u(pixel), 0).xy;
    }
    return select(vec2u(0u), agreed, weight >= 0.5);
}
