// How the surface pass writes a surface, and how it is read again.

#import pack
#import scene

fn pack_surface(s: Surface) -> vec4u {
    return vec4u(
        pack_unit(s.normal),
        pack_unit(s.geometric_normal),
        pack2x16float(vec2f(s.roughness, s.metallic)),
        (pack2x16float(vec2f(s.reflectivity, 0.0)) & 0xffffu) | (s.reflection << 16u) | (layer_bits(s) << 18u),
    );
}

// 14 bits beside the reflection mode. Index and absorption are those of the pixel's material.
fn layer_bits(s: Surface) -> u32 {
    if (!HAS_LAYERS) { return 0u; }
    return u32(s.transmission * 127.0 + 0.5) | (u32(s.clearcoat * 127.0 + 0.5) << 7u);
}

// 16 bits beside the emission.
fn unlit_bits(s: Surface) -> u32 {
    if (!HAS_LAYERS) { return u32(s.unlit); }
    return u32(s.unlit) | (u32(s.is_inside) << 1u) | (u32(s.clearcoat_roughness * 127.0 + 0.5) << 2u)
        | (u32(saturate(s.alpha) * 127.0 + 0.5) << 9u);
}

fn unpack_geometric_normal(bits: vec4u) -> vec3f {
    return unpack_unit(bits.y);
}

fn pack_colors(s: Surface) -> vec4u {
    let emission = min(s.emission, vec3f(65000.0));
    return vec4u(
        pack2x16float(s.base_color.xy),
        pack2x16float(vec2f(s.base_color.z, s.occlusion)),
        pack2x16float(emission.xy),
        (pack2x16float(vec2f(emission.z, 0.0)) & 0xffffu) | (unlit_bits(s) << 16u),
    );
}

// All but the position, which follows from the depth.
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
    s.reflectivity = unpack2x16float(bits.w).x;
    s.reflection = (bits.w >> 16u) & 3u;
    s.emission = vec3f(unpack2x16float(packed.z), unpack2x16float(packed.w).x);
    s.unlit = (packed.w >> 16u) != 0u;
    if (HAS_LAYERS) {
        let layers = bits.w >> 18u;
        let unlit = packed.w >> 16u;
        s.transmission = f32(layers & 0x7fu) / 127.0;
        s.clearcoat = f32((layers >> 7u) & 0x7fu) / 127.0;
        s.unlit = (unlit & 1u) != 0u;
        s.is_inside = (unlit & 2u) != 0u;
        s.clearcoat_roughness = f32((unlit >> 2u) & 0x7fu) / 127.0;
        s.alpha = f32((unlit >> 9u) & 0x7fu) / 127.0;
    }
    return s;
}
