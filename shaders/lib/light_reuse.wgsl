// What the light pass found of each shadow ray, lent to what reflections meet at the same place; to
// look into a shadow map again costs less.
// Whether a light reaches a point depends on the point and its side alone, so pixels of other
// instances may lend it too, if they lie on the same plane.
//
// Two bits a light: 0 is unknown or partly lit, and is found out anew; LENT_DARK and LENT_LIT are not.
// Pixels that disagree leave no bit when they are combined, so an edge of a shadow is never smeared.

#import gbuffer
#import screen_ray

// Some light casts its shadow by rays.
override LENDS_LIGHT: bool = true;

// Of the four pixels around a point those that show its place: they must be half of it, by bilinear weight.
fn lent_light(stored: texture_2d<u32>, s: Surface) -> vec2u {
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
        agreed &= textureLoad(stored, vec2u(pixel), 0).xy;
    }
    return select(vec2u(0u), agreed, weight >= 0.5);
}
