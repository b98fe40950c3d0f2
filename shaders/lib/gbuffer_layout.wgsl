// How the surface pass writes a surface, and how it is read again.

#import pack
#import scene

fn pack_surface(s: Surface) -> vec4u {
    return vec4u(
        pack_unit(s.normal),
        pack_unit(s.geometric_normal),
        pack2x16float(vec2f(s.roughness, s.metallic)),
        (pack2x16float(vec2f(s.reflectivity, 0.0)) & 0xffffu) | (s.reflection << 16u) | (u32(s.unlit) << 31u),
    );
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
        pack2x16float(vec2f(emission.z, clamp(s.curvature, -65000.0, 65000.0))),
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
    s.reflection = (bits.w >> 16u) & 0xffu;
    s.unlit = (bits.w >> 31u) != 0u;
    let emission_z_curvature = unpack2x16float(packed.w);
    s.emission = vec3f(unpack2x16float(packed.z), emission_z_curvature.x);
    s.curvature = emission_z_curvature.y;
    return s;
}
