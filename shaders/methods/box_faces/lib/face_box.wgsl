// Box of method ssr+box. Its faces are in the order +X, -X, +Y, -Y, +Z, -Z; each sees inwards along its axis. Points
// are given from the box's least corner, in its size.

#import box_faces_structs

@group(2) @binding(22) var<uniform> face_box: FaceBox;

// Depth at which faces start to see: surfaces in the box's border hide nothing from them.
const FACE_INSET: f32 = 1e-4;

// Point of the box as a face sees it.
struct FacePoint {
    place: vec2f, // on the face, 0 to 1
    depth: f32, // inwards, 0 to 1
}

fn seen_by_face(face: u32, point: vec3f) -> FacePoint {
    var place = point.yz;
    var along = point.x;
    if ((face >> 1u) == 1u) {
        place = point.zx;
        along = point.y;
    } else if ((face >> 1u) == 2u) {
        place = point.xy;
        along = point.z;
    }
    return FacePoint(place, select(along, 1.0 - along, (face & 1u) == 0u));
}

fn point_of_face(face: u32, at: FacePoint) -> vec3f {
    let along = select(at.depth, 1.0 - at.depth, (face & 1u) == 0u);
    switch face >> 1u {
        case 0u: { return vec3f(along, at.place); }
        case 1u: { return vec3f(at.place.y, along, at.place.x); }
        default: { return vec3f(at.place, along); }
    }
}

// Direction in which a face sees.
fn inwards(face: u32) -> vec3f {
    let axis = vec3f(vec3u(face >> 1u) == vec3u(0u, 1u, 2u));
    return select(axis, -axis, (face & 1u) == 0u);
}
