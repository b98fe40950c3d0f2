// Orthonormal basis around a normal; columns: tangent, bitangent, normal (Duff et al. 2017, "Building an Orthonormal
// Basis, Revisited").
fn basis(n: vec3f) -> mat3x3f {
    let sign = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    return mat3x3f(
        vec3f(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        vec3f(b, sign + n.y * n.y * a, -n.y),
        n,
    );
}

// A point of the world in object space, by the rows of an instance's `object_from_world`.
fn to_object(rows: mat3x4f, p: vec3f) -> vec3f {
    return direction_to_object(rows, p - vec3f(rows[0].w, rows[1].w, rows[2].w));
}

fn direction_to_object(rows: mat3x4f, d: vec3f) -> vec3f {
    return d * mat3x3f(rows[0].xyz, rows[1].xyz, rows[2].xyz);
}
