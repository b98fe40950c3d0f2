// Surface of a pixel, from the instance and the triangle or capsule that the visibility pass found.

#import frame
#import surface

// Intersection of the pixel's ray with the plane of its triangle, which is more exact than the depth buffer: t, and the
// barycentric weights.
fn plane_hit(origin: vec3f, direction: vec3f, instance: u32, triangle: u32) -> vec3f {
    let c = corners(instance, triangle);
    let p0 = to_world(c.values, c.p[0]) - origin;
    let e1 = to_world(c.values, c.p[1]) - origin - p0;
    let e2 = to_world(c.values, c.p[2]) - origin - p0;
    let p = cross(direction, e2);
    let determinant = dot(e1, p);
    let inverse = select(0.0, 1.0 / determinant, abs(determinant) > 1e-30);
    let q = cross(-p0, e1);
    return vec3f(dot(e2, q), dot(-p0, p), dot(direction, q)) * inverse;
}

struct PixelSurface {
    surface: Surface,
    depth_m: f32, // along the view direction
}

fn pixel_surface(pixel: vec2u, hit: vec2u) -> PixelSurface {
    let center = vec2f(pixel) + 0.5;
    let ray = pixel_ray(center);
    var t: f32;
    var place: vec2f;
    var on_plane = true;
    var nearest_m = -1e30; // least depth of the shaded point
    if (is_capsule(hit.x)) {
        let met = solid_capsule_hit(hit.x, hit.y, pixel_origin(center), ray, seen_part(center).x, vec2f(frame.pixel_m, frame.pixel_spread), false);
        t = met.t;
        place = met.place;
        // A plane that touches the capsule may be before the eye.
        on_plane = !has_capsule_normals(hit.x);
        nearest_m = 0.5 * t;
    } else {
        let plane = plane_hit(pixel_origin(center), ray, hit.x, hit.y);
        t = plane.x;
        // A pixel center may lie just outside the triangle that covers the pixel.
        place = clamp(plane.yz, vec2f(0.0), vec2f(1.0));
        place /= max(place.x + place.y, 1.0);
        on_plane = distance(place, plane.yz) < 0.1;
    }
    var shown: PixelSurface;
    // One call for both keeps the inlined code small.
    shown.surface = surface_at(hit.x, hit.y, place, normalize(ray), pixel_width(t * length(ray)));
    // Depth along the pixel's own ray, so that the position computed from it lies on the plane; a triangle seen
    // edge-on is too inexact for that and uses the clamped point.
    let depth_m = max(dot(shown.surface.position - frame.eye, frame.forward), nearest_m);
    shown.depth_m = select(depth_m, t, on_plane);
    return shown;
}
