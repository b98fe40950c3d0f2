// Height of visible surfaces over the tangent plane of a reflector.

#import frame

// Height of the surface of a pixel over the reflector's tangent plane, affine in the pixel and in clip-space z: a point
// on or below that plane is never in front of the ray, for camera and ray are both above it, and so is every point
// between them. This keeps grazing floors from reflecting themselves.
struct TangentPlane {
    rise: vec2f, // per column, and per row
    rise_z: f32, // per clip-space z
    height: f32, // of pixel 0 at a clip-space z of 0
    least: f32, // minimum height in front of the ray, beyond rounding
}

fn tangent_plane(s: Surface) -> TangentPlane {
    let normal = s.geometric_normal;
    let eye = dot(frame.eye - s.position, normal);
    let rise = vec2f(2.0, -2.0) * vec2f(dot(frame.right, normal), dot(frame.up, normal)) / frame.size;
    let corner = dot(pixel_offset(vec2f(0.5)), normal);
    let approach = dot(frame.forward, normal);
    if (is_orthographic()) {
        let range_m = frame.far_m - frame.near_m;
        return TangentPlane(rise, -range_m * approach, eye + corner + frame.far_m * approach, frame.pixel_m * 0.2);
    }
    // Heights over view depth.
    return TangentPlane(rise, eye / frame.near_m, approach + corner, 2e-4);
}

fn is_above(plane: TangentPlane, pixel: vec2i, z: f32) -> bool {
    return dot(plane.rise, vec2f(pixel)) + plane.rise_z * z + plane.height > plane.least;
}
