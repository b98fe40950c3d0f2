// Decals: materials that are projected onto the surfaces inside boxes.

#import patterned
#import scene
#import structs
#import texture

override HAS_DECALS: bool = true;

struct Decals {
    decals: array<Decal, MOST_DECALS>,
    sets: array<array<vec4u, 2>, MOST_DECAL_SETS>, // a bit for each decal
}

@group(1) @binding(18) var<uniform> decals: Decals;

// A decal at a point: the surface of its material, and its coverage of the surface below.
struct DecalPoint {
    surface: Surface,
    share: f32,
}

// Texel of a decal's texture; 1 where it has none. `footprint` holds the pixel's conjugate diameters in coordinates of the projection.
fn decal_texel(m: u32, slot: u32, uv: vec2f, footprint: mat2x2f) -> vec4f {
    let used = material_texture(m, slot);
    if (pools_of(slot) == 0u || used.layer == NONE) { return vec4f(1.0); }
    let at = vec2f(dot(used.row_u, vec3f(uv, 1.0)), dot(used.row_v, vec3f(uv, 1.0)));
    return sample_slot(used, at, transpose(mat2x2f(used.row_u.xy, used.row_v.xy)) * footprint, pools_of(slot));
}

// Surface of a decal at `p` of its cube. `cosine` is that between the surface's normal and the box's Z, `axes` are the
// gradients of the cube's coordinates, `n` is the normal that it bends.
fn decal_point(d: Decal, index: u32, p: vec3f, axes: mat3x3f, cosine: f32, footprint: Footprint, n: vec3f) -> DecalPoint {
    let m = d.material;
    var s = material_surface(m);
    s.normal = n;
    var alpha = material_base_color(m).w;
    let uv = vec2f(p.x + 0.5, 0.5 - p.y);
    // Width of the footprint in texture coordinates, by the area that the surface covers of the projection.
    let width = footprint.width_m * sqrt(length(axes[0]) * length(axes[1]) * max(abs(cosine), 1e-3));
    if (HAS_PATTERNED || HAS_CHECKERS) {
        let own_width = width * sqrt(d.size.x * d.size.y);
        let at = PatternedPoint(p * d.size, vec3f(0.0, 0.0, 1.0), own_width, index);
        if (HAS_PATTERNED) {
            s = with_patterned(s, m, at);
            alpha = patterned_alpha(m, alpha, at);
        }
        let size_m = material_checker_size_m(m);
        if (HAS_CHECKERS && size_m > 0.0) {
            let odd = pattern(material_pattern(m), at.position / size_m, at.normal, own_width / size_m);
            s.base_color *= mix(material_checker_a(m), material_checker_b(m), odd);
        }
    }
    if (HAS_TEXTURES) {
        let seen = transpose(mat2x3f(axes[0], -axes[1])) * footprint.diameters;
        let color = decal_texel(m, BASE_COLOR_SLOT, uv, seen);
        s.base_color *= color.xyz;
        alpha *= color.w;
        let metallic_roughness = decal_texel(m, METALLIC_ROUGHNESS_SLOT, uv, seen);
        s.roughness *= metallic_roughness.y;
        s.metallic *= metallic_roughness.z;
        s.emission *= decal_texel(m, EMISSION_SLOT, uv, seen).xyz;
        if (HAS_NORMAL_MAPS && material_texture(m, NORMAL_SLOT).layer != NONE) {
            let texel = decal_texel(m, NORMAL_SLOT, uv, seen);
            let scale = material_normal_scale(m) * material_texture(m, NORMAL_SLOT).signs;
            let scaled = (texel.xyz * 2.0 - 1.0) * vec3f(scale, 1.0);
            s.roughness = roughened(s.roughness, texel.w, scale.x);
            let right = axes[0] - n * dot(axes[0], n);
            let up = axes[1] - n * dot(axes[1], n);
            let bent = normalize(right) * scaled.x + normalize(up) * scaled.y + n * scaled.z;
            if (dot(right, right) > 0.0 && dot(up, up) > 0.0 && dot(bent, bent) > 1e-12) { s.normal = normalize(bent); }
        }
    }
    return DecalPoint(s, saturate(alpha * d.opacity * saturate((cosine - d.least_cosine) * d.per_cosine)));
}

// A surface with the decals of its instance, in their order. `plain` is its normal without normal map, on its front;
// `behind` says whether it is seen from its back.
fn with_decals(s0: Surface, instance: u32, plain: vec3f, behind: bool, footprint: Footprint) -> Surface {
    var s = s0;
    let own = instance_flags(instance) >> DECAL_SET_SHIFT;
    if (own == 0u) { return s; }
    // An opaque surface shows the decals of the visible side, glass the decals of its outside, a thin sheet both.
    let transmits = HAS_LAYERS && s.transmission > 0.0;
    let is_thin = transmits && material_is_solid(instance_material(instance)) == 0u;
    let side = select(1.0, -1.0, behind && !transmits);
    for (var word = 0u; word < MOST_DECALS / 32u; word++) {
        var left = decals.sets[own][word / 4u][word % 4u];
        while (left != 0u) {
            let bit = firstTrailingBit(left);
            left &= left - 1u;
            let index = word * 32u + bit;
            let d = decals.decals[index];
            let p = vec4f(s.position, 1.0) * d.box_from_world;
            if (any(abs(p) > vec3f(0.5))) { continue; }
            let axes = mat3x3f(d.box_from_world[0].xyz, d.box_from_world[1].xyz, d.box_from_world[2].xyz);
            var cosine = dot(plain, normalize(axes[2])) * side;
            if (is_thin) { cosine = abs(cosine); }
            if (cosine <= d.least_cosine) { continue; }
            let over = decal_point(d, index, p, axes, cosine, footprint, s.normal);
            let share = over.share;
            if ((d.changes & DECAL_COLOR) != 0u) {
                s.base_color = mix(s.base_color, over.surface.base_color, share);
                s.transmission *= 1.0 - share;
                s.diffuse_transmission *= 1.0 - share;
                // A surface that is sampled as a light has one emission for all who ask.
                if ((instance_flags(instance) & FLAG_EMITTER) == 0u) { s.emission += over.surface.emission * share; }
            }
            if ((d.changes & DECAL_METALLIC) != 0u) { s.metallic = mix(s.metallic, over.surface.metallic, share); }
            if ((d.changes & DECAL_ROUGHNESS) != 0u) {
                s.roughness = mix(s.roughness, over.surface.roughness, share);
                s.reflectivity = mix(s.reflectivity, over.surface.reflectivity, share);
            }
            if ((d.changes & DECAL_NORMAL) != 0u) {
                let n = mix(s.normal, over.surface.normal, share);
                if (dot(n, n) > 1e-12) { s.normal = normalize(n); }
            }
        }
    }
    return s;
}
