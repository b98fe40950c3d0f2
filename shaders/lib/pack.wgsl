// Packing of unit vectors in 32 bits: octahedral map (Cigolle et al. 2014, "A Survey of Efficient Representations
// for Independent Unit Vectors"), 16 bits per axis.

fn oct_wrap(p: vec2f) -> vec2f {
    return (1.0 - abs(p.yx)) * select(vec2f(-1.0), vec2f(1.0), p >= vec2f(0.0));
}

fn pack_unit(n: vec3f) -> u32 {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    return pack2x16snorm(select(oct_wrap(p), p, n.z >= 0.0));
}

fn unpack_unit(bits: u32) -> vec3f {
    let p = unpack2x16snorm(bits);
    let z = 1.0 - abs(p.x) - abs(p.y);
    return normalize(vec3f(select(oct_wrap(p), p, z >= 0.0), z));
}
