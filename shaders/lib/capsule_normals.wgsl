// Points and lines whose vertices have normals: such a sphere or capsule stands for a piece of a surface, and is shaded
// as the plane that touches it where its normal points.

#import capsule
#import scene

// Maximum distance from the capsule to the shaded point on that plane, in radii: at grazing views it would be far away.
const FARTHEST_RADII: f32 = 2.0;

// Whether the capsules of an instance are shaded by the normals of their vertices. Light that passes a capsule needs
// its round surface, to be on either side of it.
fn has_capsule_normals(instance: u32) -> bool {
    if (!HAS_CAPSULES || (instance_flags(instance) & FLAG_CAPSULE_NORMALS) == 0u) { return false; }
    let m = instance_material(instance);
    return !HAS_LAYERS || (material_transmission(m) == 0.0 && material_is_blended(m) == 0u);
}

struct TouchingPlane {
    normal: vec3f, // in the world, on the side of the vertices' normals
    back_m: f32, // distance from the capsule, back along the ray, to the shaded point
}

// Plane that touches a capsule where `normal`, in object space, points; `round` is where a ray of unit `direction`
// meets the capsule. The capsule, and others on a sheet of them, are below the shaded point: they neither shadow it nor
// meet rays that it mirrors.
fn touching_plane(values: InstanceValues, axis: vec3f, round: vec3f, normal: vec3f, direction: vec3f) -> TouchingPlane {
    // A line has no surface that looks along it.
    let across = normal - axis * (dot(normal, axis) / max(dot(axis, axis), 1e-37));
    let outward = select(round, normalize(across), dot(across, across) > 1e-6);
    let scaled = normal_to_world(values, outward);
    let radius_m = values.capsule_radius_m / length(scaled);
    let cosine = dot(normalize(scaled), direction);
    let height_m = radius_m * (1.0 - dot(round, outward) * select(1.0, -1.0, cosine > 0.0));
    let enters = dot(normal_to_world(values, round), direction) < 0.0;
    let back_m = min(height_m / max(abs(cosine), 1e-6), FARTHEST_RADII * radius_m);
    return TouchingPlane(normalize(scaled), select(0.0, back_m, enters));
}
