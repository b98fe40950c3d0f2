// Packing of a surface into the G-buffer, and its inverse.

#import pack
#import scene

// Emission of surfaces, over its value in 16 bits: a power of two.
override EMISSION_SCALE: f32 = 1.0;

fn pack_surface(s: Surface) -> vec4u {
    return vec4u(
        pack_unit(s.normal),
        pack_unit(s.geometric_normal),
        pack2x16float(vec2f(s.roughness, s.metallic)),
        // No reflectivity is negative, so that a sign is free.
        (pack2x16float(vec2f(s.reflectivity, 0.0)) & 0x7fffu) | (u32(s.has_index) << 15u) | (s.reflection << 16u) | (layer_bits(s) << 18u),
    );
}

// The surface with the numbers that decide whether it reflects rounded as they are packed.
fn rounded_surface(s0: Surface) -> Surface {
    var s = s0;
    let rounded = unpack2x16float(pack2x16float(vec2f(s.roughness, s.metallic)));
    s.roughness = rounded.x;
    s.metallic = rounded.y;
    s.clearcoat = round(s.clearcoat * COAT_STEPS) / COAT_STEPS;
    s.clearcoat_roughness = round(s.clearcoat_roughness * COAT_STEPS) / COAT_STEPS;
    return s;
}

// Layer values in 14 bits beside the reflection mode. Index and absorption are read from the pixel's material.
fn layer_bits(s: Surface) -> u32 {
    if (!HAS_LAYERS) { return u32(s.unlit) | (lift_bits(s.lift_m) << 1u); }
    return u32(s.transmission * 127.0 + 0.5) | (u32(s.clearcoat * COAT_STEPS + 0.5) << 7u);
}

// Lift in 13 bits: 128 steps per octave from 2^-20 m up; 0: none.
fn lift_bits(lift_m: f32) -> u32 {
    if (lift_m <= 0.0) { return 0u; }
    return u32(clamp(log2(lift_m) * 128.0 + 2561.5, 1.0, 8191.0));
}

// Values in 16 bits beside the emission.
fn unlit_bits(s: Surface) -> u32 {
    if (!HAS_LAYERS) { return pack2x16float(vec2f(clamp(s.curvature, -65000.0, 65000.0), 0.0)) & 0xffffu; }
    return u32(s.unlit) | (u32(s.is_inside) << 1u) | (u32(s.clearcoat_roughness * COAT_STEPS + 0.5) << 2u)
        | (u32(saturate(s.alpha) * 127.0 + 0.5) << 9u);
}

// With layers, occlusion and curvature have only 8 bits each.
fn pack_blue_and_occlusion(s: Surface) -> u32 {
    if (!HAS_LAYERS) { return pack2x16float(vec2f(s.base_color.z, s.occlusion)); }
    let occlusion = u32(saturate(s.occlusion) * 255.0 + 0.5);
    return (pack2x16float(vec2f(s.base_color.z, 0.0)) & 0xffffu) | (occlusion << 16u) | (curvature_bits(s.curvature) << 24u);
}

// Curvature as a sign and a logarithm in quarters of an octave: 2^-16 to 2^15 per meter; 0: flat.
fn curvature_bits(curvature: f32) -> u32 {
    let size = abs(curvature);
    if (size < 2e-5) { return 0u; }
    return u32(clamp(log2(size) * 4.0 + 64.5, 1.0, 127.0)) | (u32(curvature < 0.0) << 7u);
}

fn coarse_curvature(bits: u32) -> f32 {
    if (bits == 0u) { return 0.0; }
    let size = exp2((f32(bits & 0x7fu) - 64.0) / 4.0);
    return select(size, -size, (bits & 0x80u) != 0u);
}

fn unpack_geometric_normal(bits: vec4u) -> vec3f {
    return unpack_unit(bits.y);
}

fn pack_colors(s: Surface) -> vec4u {
    let emission = min(s.emission / EMISSION_SCALE, vec3f(65000.0));
    return vec4u(
        pack2x16float(s.base_color.xy),
        pack_blue_and_occlusion(s),
        pack2x16float(emission.xy),
        (pack2x16float(vec2f(emission.z, 0.0)) & 0xffffu) | (unlit_bits(s) << 16u),
    );
}

// All values but the position, which follows from the depth.
fn unpack_surface(bits: vec4u, packed: vec4u) -> Surface {
    var s: Surface;
    let base = vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
    let roughness_metallic = unpack2x16float(bits.z);
    s.normal = unpack_unit(bits.x);
    s.geometric_normal = unpack_geometric_normal(bits);
    s.base_color = base.xyz;
    s.occlusion = base.w;
    s.roughness = roughness_metallic.x;
    s.metallic = roughness_metallic.y;
    s.reflectivity = unpack2x16float(bits.w & 0x7fffu).x;
    s.has_index = HAS_INDICES && (bits.w & 0x8000u) != 0u;
    s.reflection = (bits.w >> 16u) & 3u;
    s.emission = vec3f(unpack2x16float(packed.z), unpack2x16float(packed.w).x) * EMISSION_SCALE;
    s.coat_reflectivity = COAT_REFLECTIVITY;
    if (!HAS_LAYERS) {
        s.unlit = ((bits.w >> 18u) & 1u) != 0u;
        let lift = bits.w >> 19u;
        s.lift_m = select(exp2((f32(lift) - 2561.0) / 128.0), 0.0, lift == 0u);
        s.curvature = unpack2x16float(packed.w).y;
        return s;
    }
    let layers = bits.w >> 18u;
    let unlit = packed.w >> 16u;
    s.transmission = f32(layers & 0x7fu) / 127.0;
    s.clearcoat = f32((layers >> 7u) & 0x7fu) / COAT_STEPS;
    s.unlit = (unlit & 1u) != 0u;
    s.is_inside = (unlit & 2u) != 0u;
    s.clearcoat_roughness = f32((unlit >> 2u) & 0x7fu) / COAT_STEPS;
    s.alpha = f32((unlit >> 9u) & 0x7fu) / 127.0;
    s.occlusion = f32((packed.y >> 16u) & 0xffu) / 255.0;
    s.curvature = coarse_curvature(packed.y >> 24u);
    return s;
}
