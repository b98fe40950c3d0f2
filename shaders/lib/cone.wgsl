// Ray cones: how wide a pixel's ray is where it meets a surface, for texture level of detail
// (Akenine-Möller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray Cones").

#import frame

struct Cone {
    width_m: f32,
    spread: f32, // radians by which it widens; negative: it narrows
}

// Of a pixel, at a distance from the eye.
fn pixel_cone(distance_m: f32) -> Cone {
    return Cone(pixel_width(distance_m), frame.pixel_spread);
}

// Further along; past its focus a cone that has narrowed widens again.
fn continued(cone: Cone, distance_m: f32) -> Cone {
    let width_m = cone.width_m + cone.spread * distance_m;
    return Cone(abs(width_m), select(cone.spread, -cone.spread, width_m < 0.0));
}

// Mirrored by a surface of this mean curvature: the normal turns by curvature × width across the cone, the
// ray by twice that. Over a sphere this is the geometric mean of both directions.
fn mirrored_cone(cone: Cone, curvature: f32) -> Cone {
    return Cone(cone.width_m, cone.spread + 2.0 * curvature * cone.width_m);
}
