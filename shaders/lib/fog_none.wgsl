// Variant without fog: light arrives as it left.

const HAS_FOG: bool = false;

fn fog_share(origin: vec3f, direction: vec3f, distance_m: f32) -> f32 {
    return 1.0;
}

fn sky_share(position: vec3f, direction: vec3f) -> f32 {
    return 1.0;
}
