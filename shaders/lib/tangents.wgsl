// Tangents of meshes, and the normal maps that lie along them.

#import pack
#import scene

// Tangent-space normal map with MikkTSpace tangents (glTF 2.0, 3.9.3). `scale` is negative where u or v of the map
// runs against the tangents.
fn perturbed(instance: u32, index: array<u32, 3>, weights: vec3f, n: vec3f, texel: vec3f, scale: vec2f) -> vec3f {
    let axes = tangents(instance, index, weights, n);
    let v = (texel * 2.0 - 1.0) * vec3f(scale, 1.0);
    let mapped = axes[0] * v.x + axes[1] * v.y + n * v.z;
    return select(n, normalize(mapped), dot(mapped, mapped) > 1e-12 && any(axes[0] != vec3f(0.0)));
}

// Tangent and bitangent; zeros where the mesh has none.
fn tangents(instance: u32, index: array<u32, 3>, weights: vec3f, n: vec3f) -> mat2x3f {
    let base = instance_vertex_base(instance);
    var t_object = vec3f(0.0);
    for (var k = 0u; k < 3u; k++) {
        t_object += unpack_unit(vertex_tangent(base + index[k]) & 0xfffffffeu) * weights[k];
    }
    let sign = select(-1.0, 1.0, (vertex_tangent(base + index[0]) & 1u) != 0u);
    let t = direction_to_world(instance, t_object);
    if (dot(t, t) < 1e-20) { return mat2x3f(); }
    let mirrored = select(1.0, -1.0, (instance_flags(instance) & FLAG_MIRRORED) != 0u);
    let tangent = normalize(t);
    return mat2x3f(tangent, cross(n, tangent) * sign * mirrored);
}
