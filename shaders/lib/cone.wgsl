// Ray cones: width of a pixel's ray where it meets a surface, for texture level of detail
// (Akenine-Möller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray Cones").

#import frame

struct Cone {
    width_m: f32,
    spread: f32, // angle by which the cone widens, radians; negative: it narrows
}

// Cone of a pixel's ray at a distance from the eye.
fn pixel_cone(distance_m: f32) -> Cone {
    return Cone(pixel_width(distance_m), frame.pixel_spread);
}

// The cone further along the ray; past its focus a narrowing cone widens again.
fn continued(cone: Cone, distance_m: f32) -> Cone {
    let width_m = cone.width_m + cone.spread * distance_m;
    return Cone(abs(width_m), select(cone.spread, -cone.spread, width_m < 0.0));
}

// Cone mirrored by a surface of this mean curvature: the normal turns by curvature × width across it, the ray by twice
// that, the geometric mean of both directions of a sphere; by half a turn at most, as the angle else grows without end.
fn mirrored_cone(cone: Cone, curvature: f32) -> Cone {
    return Cone(cone.width_m, clamp(cone.spread + 2.0 * curvature * cone.width_m, -PI, PI));
}
