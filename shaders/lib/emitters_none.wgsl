// Surfaces that emit light no other surface but by reflection rays.

#import frame

fn emitted_light(s: Surface, view: vec3f, albedo: vec3f) -> Shade {
    return Shade();
}

fn met_emission(ray: Reflected, instance: u32, distance_m: f32, s: Surface) -> f32 {
    return 1.0;
}
