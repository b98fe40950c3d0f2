// Variant of fog whose light is scattered once.

// Share of what fog scatters of the surroundings that a ray finds: that of the surroundings behind it.
fn sky_kept(ray: Reflected) -> f32 {
    return ray.sky_weight / max(ray.kept, 1e-30);
}

fn passed(air: Air, way: Way) -> Air {
    var through = air;
    through.share = vec3f(1.0 - way.scattered);
    return through;
}

// Ray of a path that begins in the fog before a pixel: none.
fn scattered_start(way: Way) -> Start {
    return Start(Reflected(way.direction, vec3f(0.0), 0.0, 0.0, 1.0, vec3f(0.0)), way.origin);
}
