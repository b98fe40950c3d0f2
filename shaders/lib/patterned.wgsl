// Numbers and colors of materials that follow patterns.

#import basis
#import pack
#import pattern
#import patterned_keys
#import scene

// Whether some number or color of a material follows a pattern.
override HAS_PATTERNED: bool = false;

// Part of a surface that a pixel sees.
struct Footprint {
    width_m: f32, // diameter of one sub-frame's disk
    width_share: f32, // the same as a share of the root of twice the triangle's area
    diameters: mat2x3f, // two conjugate diameters of the pixel's ellipse, m
    bary_diameters: mat2x2f, // the same in barycentric coordinates
}

// A point in object space, with the width there of the footprint.
struct PatternedPoint {
    position: vec3f,
    normal: vec3f,
    width: f32,
    instance: u32,
}

fn patterned_point(instance: u32, c: Corner, bary: vec2f, footprint: Footprint) -> PatternedPoint {
    let p = c.p[0];
    let e1 = c.p[1] - p;
    let e2 = c.p[2] - p;
    let across = cross(e1, e2);
    let area2_object = max(length(across), 1e-20);
    return PatternedPoint(p + e1 * bary.x + e2 * bary.y, across / area2_object, footprint.width_share * sqrt(area2_object), instance);
}

// Rotation by the smallest angle that turns `axis` to X: Möller and Hughes 1999, "Efficiently Building a Matrix to
// Rotate One Vector to Another".
fn turned_to_x(v: vec3f, axis: vec3f) -> vec3f {
    if (axis.x < -0.9999) { return vec3f(-v.xy, v.z); }
    let k = cross(axis, vec3f(1.0, 0.0, 0.0));
    return v * axis.x + cross(k, v) + k * (dot(k, v) / (1.0 + axis.x));
}

fn patterned_value(used: Patterned, at: PatternedPoint) -> vec3f {
    let axis = unpack_unit(used.axis);
    var p = turned_to_x(at.position - used.origin, axis) / used.size_m;
    if ((used.bits & PER_INSTANCE) != 0u) { p += 64.0 * lattice_gradient(vec3i(i32(at.instance), 0, 0)); }
    let kind = used.bits & (PER_INSTANCE - 1u);
    return mix(used.first, used.second, pattern(kind, p, turned_to_x(at.normal, axis), at.width / used.size_m));
}

// Pattern that a value of a material follows; of size 0 where it follows none.
fn pattern_of(m: u32, which: u32) -> Patterned {
    for (var k = 0u; k < MOST_PATTERNED; k++) {
        let used = material_patterned(m, k);
        if (used.size_m <= 0.0 || used.bits >> PATTERNED_SHIFT == which) { return used; }
    }
    return Patterned();
}

fn patterned_alpha(m: u32, plain: f32, at: PatternedPoint) -> f32 {
    let used = pattern_of(m, ALPHA_VARIES);
    if (used.size_m <= 0.0) { return plain; }
    return patterned_value(used, at).x;
}

// Whether some surface has a relief.
override HAS_BUMPS: bool = true;
// Least distance of the points whose heights give a slope, over the size of the pattern.
const LEAST_STEP: f32 = 0.002;

// Normal of a surface with its relief, in object space (Blinn 1978, "Simulation of Wrinkled Surfaces"), by differences
// of heights over the width of a pixel.
fn bumped(m: u32, normal: vec3f, at: PatternedPoint) -> vec3f {
    let used = pattern_of(m, BUMP_VARIES);
    if (used.size_m <= 0.0) { return normal; }
    let n = normalize(normal);
    let axes = basis(n);
    let step = max(at.width, LEAST_STEP * used.size_m);
    var slope = vec3f(0.0);
    // One call in a loop keeps the inlined code small.
    for (var k = 0u; k < 4u; k++) {
        let way = select(axes[0], axes[1], k >= 2u) * select(-1.0, 1.0, (k & 1u) == 1u);
        var beside = at;
        beside.position += way * (0.5 * step);
        slope += way * (patterned_value(used, beside).x / step);
    }
    return n - slope;
}

// The surface with the values of its material that follow patterns, apart from its alpha.
fn with_patterned(s0: Surface, m: u32, at: PatternedPoint) -> Surface {
    var s = s0;
    for (var k = 0u; k < MOST_PATTERNED; k++) {
        let used = material_patterned(m, k);
        if (used.size_m <= 0.0) { break; }
        s = with_value(s, used.bits >> PATTERNED_SHIFT, patterned_value(used, at));
    }
    return s;
}

// Surface with the parameters of a material at a point of a triangle, before textures.
fn material_at(m: u32, instance: u32, c: Corner, bary: vec2f, footprint: Footprint) -> Surface {
    let s = material_surface(m);
    if (!HAS_PATTERNED) { return s; }
    return with_patterned(s, m, patterned_point(instance, c, bary, footprint));
}
