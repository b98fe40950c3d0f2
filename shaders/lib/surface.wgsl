// The one function that turns (instance, triangle, barycentrics, footprint) into a surface, for rasterized pixels
// and traced hits alike, so that no seam shows between them.

#import basis
#import capsule
#import capsule_normals
#import decals
#import diffuse
#import film
#import patterned
#import frame
#import pack
#import scene
#import texture

override HAS_NORMAL_MAPS: bool = true;
override HAS_TEXTURES: bool = true;
override HAS_CHECKERS: bool = true;

struct Corner {
    values: InstanceValues,
    p: array<vec3f, 3>,
    vertex: array<Vertex, 3>,
    index: array<u32, 3>,
}

// Instances are read once, by `instance_values`: some drivers read again at each call.
fn corners(instance: u32, triangle: u32) -> Corner {
    var c: Corner;
    c.values = instance_values(instance);
    let base = c.values.index_base + triangle * 3u;
    for (var k = 0u; k < 3u; k++) {
        c.index[k] = mesh_word(base + k);
        c.vertex[k] = vertex_at(c.values.vertex_base + c.index[k]);
        c.p[k] = c.vertex[k].position;
    }
    return c;
}

fn is_capsule(instance: u32) -> bool {
    return HAS_CAPSULES && instance_capsule_radius_m(instance) > 0.0;
}

// Barycentric weights of vertex 1 and vertex 2 at the second part of a hit, which of a capsule is a place on its
// surface.
fn weights_at(c: Corner, bary: vec2f) -> vec2f {
    if (!HAS_CAPSULES || c.values.capsule_radius_m <= 0.0) { return bary; }
    return vec2f(capsule_point(bary, c.p[1] - c.p[0], c.values.capsule_radius_m).share, 0.0);
}

// Hit of a ray with a capsule; t is in lengths of the direction.
struct CapsuleHit {
    is_met: bool,
    t: f32,
    place: vec2f,
}

// Radius in object space at which a capsule is a pixel wide where a ray passes it: of the ray alone, so that neither
// near nor far parts of a cloud become blobs. `o` is relative to the base.
fn pixel_radius_m(values: InstanceValues, o: vec3f, d: vec3f, axis: vec3f, width: vec2f) -> f32 {
    let dd = dot(d, d);
    let along = dot(axis, d);
    // Where the line of the ray and the axis are nearest to each other.
    let apart = dot(axis, axis) * dd - along * along;
    let share = clamp((dot(o, axis) * dd - along * dot(o, d)) / max(apart, 1e-37), 0.0, 1.0);
    let t = dot(axis * share - o, d) / dd;
    let away = o + d * t - axis * share;
    // A placement may squeeze the capsule by another factor on each side.
    let side = select(away, capsule_frame(normalize(d))[0], dot(away, away) <= 1e-12 * dd * t * t);
    let squeezed = length(direction_to_world(values, side)) / length(side);
    let half_m = select(LINE_PX, POINT_PX, dot(axis, axis) == 0.0) * 0.5 * (width.x + width.y * t);
    return min(half_m / max(squeezed, 1e-30), 0.25 * abs(t) * sqrt(dd));
}

// Where a ray past `t_min` meets a capsule, as in test_capsule of bvh.wgsl; where it misses, the point nearest to it.
// `width` is of a pixel: m at the ray's origin, and m more for each length of its direction; thinner points and lines get it.
fn capsule_hit(instance: u32, capsule: u32, origin: vec3f, direction: vec3f, t_min: f32, width: vec2f, shadow: bool) -> CapsuleHit {
    let c = corners(instance, capsule);
    let values = c.values;
    let axis = c.p[1] - c.p[0];
    let o = to_object(values.object_from_world, origin) - c.p[0];
    let d = direction_to_object(values.object_from_world, direction);
    var radius = values.capsule_radius_m;
    if ((values.flags & FLAG_AT_LEAST_A_PIXEL) != 0u && width.x + width.y > 0.0) { radius = max(radius, pixel_radius_m(values, o, d, axis, width)); }
    let span = capsule_span(o, d, axis, radius);
    if (!span.is_met) {
        let t = dot(0.5 * axis - o, d) / dot(d, d);
        return CapsuleHit(false, t, capsule_place(o + d * t, axis, radius));
    }
    let sees_backs = shadow || (values.trace_flags & DOUBLE_SIDED) != 0u;
    let t = select(span.enter, span.leave, span.enter <= t_min && sees_backs);
    return CapsuleHit(t > t_min, t, capsule_place(o + d * t, axis, radius));
}

fn uv_corner(c: Corner, k: u32, second: bool) -> vec2f {
    if (second && c.values.uv1_base != NONE) {
        let at = c.values.uv1_base + c.index[k] * 2u;
        return vec2f(bitcast<f32>(mesh_word(at)), bitcast<f32>(mesh_word(at + 1u)));
    }
    return c.vertex[k].uv;
}

fn material_alpha(material: u32, instance: u32, c: Corner, bary: vec2f, footprint: Footprint) -> f32 {
    let slot = material_texture(material, BASE_COLOR_SLOT);
    var alpha = material_base_color(material).w;
    if (HAS_PATTERNED) { alpha = patterned_alpha(material, alpha, patterned_point(instance, c, bary, footprint)); }
    if (HAS_TEXTURES) { alpha *= texel_at(slot, pools_of(BASE_COLOR_SLOT), c, bary, footprint).w; }
    if ((c.values.flags & FLAG_COLORS) != 0u) { alpha *= vertex_color(c, bary).w; }
    return alpha;
}

// Meshes without colors leave out this texel.
fn vertex_color(c: Corner, bary: vec2f) -> vec4f {
    let base = c.values.vertex_base;
    return unpack4x8unorm(vertex_at(base + c.index[0]).color) * (1.0 - bary.x - bary.y)
        + unpack4x8unorm(vertex_at(base + c.index[1]).color) * bary.x
        + unpack4x8unorm(vertex_at(base + c.index[2]).color) * bary.y;
}

// Whether a cut-out surface is solid at a point. It samples the finest mip level: coverage must not depend on the
// kind of ray.
fn alpha_passes(instance: u32, triangle: u32, bary: vec2f) -> bool {
    let c = corners(instance, triangle);
    let m = c.values.material;
    return material_alpha(m, instance, c, weights_at(c, bary), Footprint()) >= material_alpha_cutoff(m);
}

// Where a capsule is first solid along a ray past `t_min`: a cut-out one perhaps on its inner side.
fn solid_capsule_hit(instance: u32, capsule: u32, origin: vec3f, direction: vec3f, t_min: f32, width: vec2f, shadow: bool) -> CapsuleHit {
    var start = t_min;
    var hit: CapsuleHit;
    // One call in a loop keeps the inlined code small.
    for (var side = 0u; side < 2u; side++) {
        hit = capsule_hit(instance, capsule, origin, direction, start, width, shadow);
        if (!hit.is_met || !is_cutout(instance) || alpha_passes(instance, capsule, hit.place)) { return hit; }
        start = hit.t;
    }
    hit.is_met = false;
    return hit;
}

// Share of an instance's emission that the picture shows.
fn shown_emission(instance: u32) -> f32 {
    if (!HAS_LIGHT_GROUPS) { return 1.0; }
    return select(1.0, 0.0, (instance_flags(instance) & FLAG_DARK) != 0u);
}

// Mean curvature of a triangle of twice this area in the world, from its vertex normals: the turn of the normal
// along each edge, averaged over the three.
fn mean_curvature(p: array<vec3f, 3>, normals: array<vec3f, 3>, area2_world: f32) -> f32 {
    let e = array<vec3f, 3>(p[1] - p[0], p[2] - p[1], p[0] - p[2]);
    let turns = array<vec3f, 3>(normals[1] - normals[0], normals[2] - normals[1], normals[0] - normals[2]);
    var sum = 0.0;
    for (var k = 0; k < 3; k++) { sum += dot(turns[k], e[k]) / max(dot(e[k], e[k]), 1e-30); }
    return sum / 3.0 * sqrt(length(cross(e[0], e[1])) / area2_world);
}

// Minimum lift of smooth surfaces, m, so that they are known as smooth at their vertices too.
const LEAST_LIFT_M: f32 = 1e-6;

// Height over the triangle, along its normal, of the smooth surface whose tangent planes at the vertices belong to the
// vertex normals (Hanika 2021, "Hacking the Shadow Terminator"); 0 where it is nowhere above.
fn smooth_lift(p: array<vec3f, 3>, normals: array<vec3f, 3>, weights: vec3f, normal: vec3f, area2_world: f32) -> f32 {
    let point = p[0] * weights.x + p[1] * weights.y + p[2] * weights.z;
    var offset = vec3f(0.0);
    for (var k = 0; k < 3; k++) { offset -= normals[k] * (min(dot(point - p[k], normals[k]), 0.0) * weights[k]); }
    let area2 = length(cross(p[1] - p[0], p[2] - p[0]));
    return max(dot(offset, normal), 0.0) / max(length(normal), 1e-20) * sqrt(area2_world / max(area2, 1e-30));
}

// Conjugate diameters of the ellipse in which a cone of this width meets a plane.
fn cone_diameters(cone_m: f32, direction: vec3f, normal: vec3f) -> mat2x3f {
    let across = basis(direction);
    let cosine = dot(direction, normal);
    let onto_plane = direction / select(min(cosine, -0.05), max(cosine, 0.05), cosine > 0.0);
    let first = across[0] - onto_plane * dot(across[0], normal);
    return mat2x3f(first * cone_m, (across[1] - onto_plane * dot(across[1], normal)) * cone_m);
}

// Surface at a hit. `direction` is the unit direction of the arriving ray, `cone_m` the width of its cone here; `place`
// are barycentric weights, or the place on a capsule.
fn surface_at(instance: u32, triangle: u32, place: vec2f, direction: vec3f, cone_m: f32) -> Surface {
    let c = corners(instance, triangle);
    let values = c.values;
    let m = values.material;
    var s = material_surface(m);
    let p0 = to_world(values, c.p[0]);
    let e1 = to_world(values, c.p[1]) - p0;
    let e2 = to_world(values, c.p[2]) - p0;
    let radius = values.capsule_radius_m;
    let is_round = HAS_CAPSULES && radius > 0.0;
    var round = CapsulePoint();
    var bary = place;
    if (is_round) {
        round = capsule_point(place, c.p[1] - c.p[0], radius);
        bary = vec2f(round.share, 0.0);
    }
    s.position = p0 + e1 * bary.x + e2 * bary.y;
    let cross_world = cross(e1, e2);
    var area2 = max(length(cross_world), 1e-20);
    var ng = cross_world / area2;
    if ((values.flags & FLAG_MIRRORED) != 0u) { ng = -ng; }
    let outward = direction_to_world(values, round.normal);
    if (is_round) {
        s.position += outward * radius;
        ng = normalize(normal_to_world(values, round.normal));
        area2 = dot(outward, outward); // patterns know their scale by it
    }
    var weights = vec3f(1.0 - bary.x - bary.y, bary.x, bary.y);
    var normals: array<vec3f, 3>;
    for (var k = 0u; k < 3u; k++) { normals[k] = unpack_unit(c.vertex[k].normal); }
    var n_object = normals[0] * weights.x + normals[1] * weights.y + normals[2] * weights.z;
    let is_plane = is_round && has_capsule_normals(instance);
    if (is_plane) {
        let plane = touching_plane(values, c.p[1] - c.p[0], round.normal, n_object, direction);
        s.position -= direction * plane.back_m;
        ng = plane.normal;
    } else if (is_round) {
        n_object = round.normal;
    }
    let behind = dot(ng, direction) > 0.0;
    // All sub-frames together sample the pixel's footprint, an ellipse: each takes a disk of its share of the area, or
    // as wide as the distance of their places along the ellipse, so that it is not blurred across.
    footprint_samples = frame.sub_frames;
    let shares = frame.sub_frames * max(abs(dot(ng, direction)), 0.05);
    let width_m = cone_m * max(inverseSqrt(shares), 1.0 / shares);
    var footprint = Footprint(width_m, width_m / sqrt(area2), mat2x3f(), mat2x2f());
    if (HAS_TEXTURES) { footprint.diameters = cone_diameters(cone_m, direction, ng); }
    if (HAS_TEXTURES && !is_round) {
        footprint.bary_diameters = transpose(mat2x3f(cross(e2, ng), cross(ng, e1))) * footprint.diameters * (1.0 / area2);
    }

    if ((HAS_TEXTURES || HAS_CHECKERS || HAS_PATTERNED || HAS_DECALS) && s.reflection != REFLECTION_NONE) {
        s.curvature = mean_curvature(c.p, normals, area2) * select(1.0, -1.0, behind);
        // The mean curvature of a sphere, and of a cylinder.
        let turns = select(1.0, 0.5, round.share > 0.0 && round.share < 1.0);
        if (is_round) { s.curvature = turns / (radius * length(outward)) * select(1.0, -1.0, behind); }
        if (is_plane) { s.curvature = 0.0; }
    }
    // With layers, the G-buffer has no bits for the lift.
    let bends = min(dot(normals[0], normals[1]), dot(normals[0], normals[2])) < 0.99999;
    if (!HAS_LAYERS && !behind && bends && !is_round) {
        s.lift_m = max(smooth_lift(c.p, normals, weights, n_object, area2), LEAST_LIFT_M);
    }
    var n = normal_to_world(values, n_object);
    n = select(ng, normalize(n), dot(n, n) > 1e-20);
    let plain_normal = n;
    if (HAS_PATTERNED) {
        var at = patterned_point(instance, c, bary, footprint);
        if (is_round) {
            at = PatternedPoint(at.position + round.normal * radius, round.normal, footprint.width_share, instance);
        }
        s = with_patterned(s, m, at);
        if (HAS_BUMPS) {
            let relief = normal_to_world(values, bumped(m, n_object, at));
            n = select(n, normalize(relief), dot(relief, relief) > 1e-20);
        }
    }

    if ((values.flags & FLAG_COLORS) != 0u) { s.base_color *= vertex_color(c, bary).xyz; }
    if (HAS_CHECKERS && material_checker_size_m(m) > 0.0) {
        let size = material_checker_size_m(m);
        let p_object = c.p[0] * weights.x + c.p[1] * weights.y + c.p[2] * weights.z + round.normal * select(0.0, radius, is_round);
        var cross_object = cross(c.p[1] - c.p[0], c.p[2] - c.p[0]);
        if (is_round) { cross_object = round.normal; }
        let area2_object = max(length(cross_object), 1e-20);
        let width = footprint.width_share * sqrt(area2_object) / size;
        let odd = pattern(material_pattern(m), p_object / size, cross_object / area2_object, width);
        s.base_color *= mix(material_checker_a(m), material_checker_b(m), odd);
    }
    var coat_normal = n;
    if (HAS_TEXTURES) {
        s.base_color *= texel_at(material_texture(m, BASE_COLOR_SLOT), pools_of(BASE_COLOR_SLOT), c, bary, footprint).xyz;
        let metallic_roughness = texel_at(material_texture(m, METALLIC_ROUGHNESS_SLOT), pools_of(METALLIC_ROUGHNESS_SLOT), c, bary, footprint);
        s.roughness *= metallic_roughness.y;
        s.metallic *= metallic_roughness.z;
        let normal_map = material_texture(m, NORMAL_SLOT);
        if (HAS_NORMAL_MAPS && normal_map.layer != NONE) {
            let texel = texel_at(normal_map, pools_of(NORMAL_SLOT), c, bary, footprint);
            let scale = material_normal_scale(m) * normal_map.signs;
            n = perturbed(c, weights, n, texel.xyz, scale);
            s.roughness = roughened(s.roughness, texel.w, scale.x);
        }
        if (HAS_COAT_NORMALS && LAYER_POOLS != 0u && material_layer_texture(m, CLEARCOAT_NORMAL_SLOT).layer != NONE) {
            let texel = layer_texel(CLEARCOAT_NORMAL_SLOT, c, bary, footprint);
            let scale = material_layer_texture(m, CLEARCOAT_NORMAL_SLOT).signs;
            coat_normal = perturbed(c, weights, coat_normal, texel.xyz, scale);
            s.clearcoat_roughness = roughened(s.clearcoat_roughness, texel.w, scale.x);
        }
        let occlusion = texel_at(material_texture(m, OCCLUSION_SLOT), pools_of(OCCLUSION_SLOT), c, bary, footprint).x;
        s.occlusion = 1.0 + material_occlusion_strength(m) * (occlusion - 1.0);
        s.emission *= texel_at(material_texture(m, EMISSION_SLOT), pools_of(EMISSION_SLOT), c, bary, footprint).xyz;
    }
    if (HAS_DECALS) {
        s.normal = n;
        s = with_decals(s, instance, plain_normal, behind, footprint);
        n = s.normal;
    }
    if (s.unlit) {
        // KHR_materials_unlit: light does not change the base color; the material has no specular.
        s.emission += s.base_color;
        s.base_color = vec3f(0.0);
    }
    s.emission *= shown_emission(instance);
    if (behind) {
        n = -n;
        ng = -ng;
        coat_normal = -coat_normal;
    }
    if (HAS_LAYERS) {
        s.transmission *= layer_texel(TRANSMISSION_SLOT, c, bary, footprint).x;
        s.clearcoat *= layer_texel(CLEARCOAT_SLOT, c, bary, footprint).x;
        s.clearcoat_roughness *= layer_texel(CLEARCOAT_ROUGHNESS_SLOT, c, bary, footprint).y;
        s.ior = material_ior(m);
        s.dispersion = material_dispersion(m);
        s.material = m;
        s.is_solid = material_is_solid(m) != 0u;
        s.is_inside = behind && s.is_solid;
        s.alpha = 1.0;
        if (material_is_blended(m) != 0u) { s.alpha = material_alpha(m, instance, c, bary, footprint); }
    }
    s = with_textured_details(s, c, bary, footprint);
    if (HAS_ANISOTROPY) { s = with_grooves(s, c, weights, bary, footprint, n); }
    s.normal = facing(n, ng);
    s = with_film(s, c, bary, footprint, dot(s.normal, direction));
    if (HAS_COAT_NORMALS) { s.coat_normal = facing(coat_normal, ng); }
    s.geometric_normal = ng;
    return as_boundary(s);
}

// Flips a normal to the side of the geometric normal: interpolated or mapped normals may tip over at silhouettes.
fn facing(normal: vec3f, geometric_normal: vec3f) -> vec3f {
    let below = dot(normal, geometric_normal);
    if (below >= 0.0) { return normal; }
    return normalize(normal - 2.0 * below * geometric_normal);
}

// Texel of a material's texture at a point; 1 where it has none. `pools` must be a constant.
fn texel_at(used: TextureUse, pools: u32, c: Corner, bary: vec2f, footprint: Footprint) -> vec4f {
    if (pools == 0u || used.layer == NONE) { return vec4f(1.0); }
    let second = (used.bits & TEXTURE_UV1) != 0u;
    var uv: array<vec2f, 3>;
    for (var k = 0u; k < 3u; k++) {
        let raw = vec3f(uv_corner(c, k, second), 1.0);
        uv[k] = vec2f(dot(used.row_u, raw), dot(used.row_v, raw));
    }
    let per_bary = mat2x2f(uv[1] - uv[0], uv[2] - uv[0]);
    return sample_slot(used, uv[0] + per_bary * bary, per_bary * footprint.bary_diameters, pools);
}

// Applies the textures of specular strength, specular color, diffuse transmission and sheen.
fn with_textured_details(s0: Surface, c: Corner, bary: vec2f, footprint: Footprint) -> Surface {
    var s = s0;
    if (HAS_TINTS && LAYER_POOLS != 0u) {
        s.specular *= layer_texel(SPECULAR_SLOT, c, bary, footprint).w;
        s.specular_color *= layer_texel(SPECULAR_COLOR_SLOT, c, bary, footprint).xyz;
    }
    if (HAS_DIFFUSE_TRANSMISSION && LAYER_POOLS != 0u) {
        s.diffuse_transmission *= layer_texel(DIFFUSE_TRANSMISSION_SLOT, c, bary, footprint).w;
        s.diffuse_transmission_color *= layer_texel(DIFFUSE_TRANSMISSION_COLOR_SLOT, c, bary, footprint).xyz;
    }
    if (HAS_SHEEN && LAYER_POOLS != 0u) {
        s.sheen_color *= layer_texel(SHEEN_COLOR_SLOT, c, bary, footprint).xyz;
        s.sheen_roughness *= layer_texel(SHEEN_ROUGHNESS_SLOT, c, bary, footprint).w;
    }
    return s;
}

// Minimum roughness of anisotropic surfaces: its square is a little above SMOOTH_ALPHA.
const LEAST_SPREAD_ROUGHNESS: f32 = 0.045;

// Grain of KHR_materials_anisotropy; none where the mesh has no texture coordinates to give a direction. `n` is the
// shading normal.
fn with_grooves(s0: Surface, c: Corner, weights: vec3f, bary: vec2f, footprint: Footprint, n: vec3f) -> Surface {
    var s = s0;
    let m = c.values.material;
    var strength = s.anisotropy;
    s.anisotropy = 0.0;
    if (strength <= 0.0) { return s; }
    var along = vec2f(1.0, 0.0);
    if (LAYER_POOLS != 0u && material_layer_texture(m, ANISOTROPY_SLOT).layer != NONE) {
        let texel = layer_texel(ANISOTROPY_SLOT, c, bary, footprint);
        along = (texel.xy * 2.0 - 1.0) * material_layer_texture(m, ANISOTROPY_SLOT).signs;
        strength *= texel.z;
    }
    let turn = material_anisotropy_turn(m);
    along = vec2f(along.x * turn.x - along.y * turn.y, along.x * turn.y + along.y * turn.x);
    let axes = tangents(c, weights, n);
    let tangent = axes[0] * along.x + axes[1] * along.y;
    if (strength <= 0.0 || dot(tangent, tangent) < 1e-12) { return s; }
    s.tangent = normalize(tangent);
    s.anisotropy = strength;
    s.roughness = max(s.roughness, LEAST_SPREAD_ROUGHNESS);
    return s;
}

// Texel of `Material.layer_textures` at a point; 1 where the material has none.
fn layer_texel(slot: u32, c: Corner, bary: vec2f, footprint: Footprint) -> vec4f {
    if (LAYER_POOLS == 0u) { return vec4f(1.0); }
    return texel_at(material_layer_texture(c.values.material, slot), LAYER_POOLS, c, bary, footprint);
}

// Tangent-space normal map with MikkTSpace tangents (glTF 2.0, 3.9.3). `scale` is negative where u or v of the map
// runs against the tangents.
fn perturbed(c: Corner, weights: vec3f, n: vec3f, texel: vec3f, scale: vec2f) -> vec3f {
    let axes = tangents(c, weights, n);
    let v = (texel * 2.0 - 1.0) * vec3f(scale, 1.0);
    let mapped = axes[0] * v.x + axes[1] * v.y + n * v.z;
    return select(n, normalize(mapped), dot(mapped, mapped) > 1e-12 && any(axes[0] != vec3f(0.0)));
}

// Roughness of a surface whose normals are a mean of a normal map's: its lobe is as much wider as they spread (Toksvig
// 2005, "Mipmapping Normal Maps", with alpha² = 2 / (exponent + 2)). Mirrors stay smooth, up to twice the roughness of
// SMOOTH_ALPHA in part: a facet of a steep bump mirrors much of its light below the surface, and would be black.
// `alpha`: see src/render/buffers/textures/resample.rs.
fn roughened(roughness: f32, alpha: f32, scale: f32) -> f32 {
    let r2 = roughness * roughness;
    let lack = (1.0 - (1.0 - (1.0 - alpha) * (1.0 - alpha)) * taps_agreement) * saturate((r2 / SMOOTH_ALPHA - 1.0) / 3.0);
    return min(sqrt(sqrt(r2 * r2 + 2.0 * scale * scale * lack / max(1.0 - lack, 1e-3))), 1.0);
}

// Tangent and bitangent; zeros where the mesh has none.
fn tangents(c: Corner, weights: vec3f, n: vec3f) -> mat2x3f {
    var t_object = vec3f(0.0);
    for (var k = 0u; k < 3u; k++) { t_object += unpack_unit(c.vertex[k].tangent & 0xfffffffeu) * weights[k]; }
    let sign = select(-1.0, 1.0, (c.vertex[0].tangent & 1u) != 0u);
    let t = direction_to_world(c.values, t_object);
    if (dot(t, t) < 1e-20) { return mat2x3f(); }
    let mirrored = select(1.0, -1.0, (c.values.flags & FLAG_MIRRORED) != 0u);
    let tangent = normalize(t);
    return mat2x3f(tangent, cross(n, tangent) * sign * mirrored);
}
