// Packing of the surface values that the G-buffer has no bits for: written by the details pass, unpacked by later
// ones.

#import scene

// Whether surfaces have details in a second layer.
override HAS_FURTHER_DETAILS: bool = true;

fn pack_details(s: Surface) -> vec4u {
    return vec4u(
        // No color is negative, so that signs are free.
        pack2x16float(min(s.specular_color.xy, vec2f(65000.0))) | (u32(s.has_film) << 31u),
        pack2x16float(vec2f(clamp(s.specular_color.z, 0.0, 65000.0), 0.0)) | (u32(s.has_edge_tint) << 15u) | (pack2x16unorm(vec2f(0.0, s.specular)) & 0xffff0000u),
        pack2x16unorm(s.sheen_color.xy),
        pack2x16unorm(vec2f(s.sheen_color.z, s.sheen_roughness)),
    );
}

fn with_details(surface: Surface, bits: vec4u) -> Surface {
    var s = surface;
    s.specular_color = vec3f(unpack2x16float(bits.x & 0x7fffffffu), unpack2x16float(bits.y & 0x7fffu).x);
    s.has_film = (bits.x >> 31u) != 0u;
    s.has_edge_tint = HAS_EDGE_TINTS && (bits.y & 0x8000u) != 0u;
    s.specular = unpack2x16unorm(bits.y).y;
    let rest = unpack2x16unorm(bits.w);
    s.sheen_color = vec3f(unpack2x16unorm(bits.z), rest.x);
    s.sheen_roughness = rest.y;
    return s;
}

fn with_further_details(surface: Surface, bits: vec4u) -> Surface {
    var s = surface;
    let rest = unpack2x16unorm(bits.w);
    if (HAS_COAT_NORMALS) { s.coat_normal = unpack_unit(bits.x); }
    if (HAS_COAT_INDICES) { s.coat_reflectivity = rest.y; }
    if (HAS_ROUGH_DIFFUSE) { s.diffuse_roughness = rest.x; }
    if (HAS_ANISOTROPY) {
        s.tangent = unpack_unit(bits.y);
        s.anisotropy = bitcast<f32>(bits.z);
    }
    return s;
}

fn pack_diffuse_transmission(s: Surface) -> vec4u {
    let color = s.diffuse_transmission_color;
    return vec4u(pack2x16unorm(color.xy), pack2x16unorm(vec2f(color.z, s.diffuse_transmission)), select(NONE, s.material, bounds_scattering(s)), 0u);
}

fn with_diffuse_transmission(surface: Surface, bits: vec4u) -> Surface {
    var s = surface;
    let rest = unpack2x16unorm(bits.y);
    s.diffuse_transmission_color = vec3f(unpack2x16unorm(bits.x), rest.x);
    s.diffuse_transmission = rest.y;
    s.material = bits.z;
    s.is_solid = bits.z != NONE;
    return s;
}
