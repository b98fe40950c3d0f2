// Faces of a cube map in the order of its layers, +X, -X, +Y, -Y, +Z, -Z, and places on them: -1 to 1, x to the right
// and y downwards, as WebGPU samples them.

// Direction of a place on a face, not normalized: its component along the face's axis is 1.
fn face_direction(face: u32, place: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -place.y, -place.x); }
        case 1u: { return vec3f(-1.0, -place.y, place.x); }
        case 2u: { return vec3f(place.x, 1.0, place.y); }
        case 3u: { return vec3f(place.x, -1.0, -place.y); }
        case 4u: { return vec3f(place.x, -place.y, 1.0); }
        default: { return vec3f(-place.x, -place.y, -1.0); }
    }
}

struct FacePlace {
    face: u32,
    place: vec2f,
    axis: f32, // component of the direction along the face's axis
}

// Face and place that a direction of any length but 0 meets.
fn face_place(d: vec3f) -> FacePlace {
    let size = abs(d);
    var at: FacePlace;
    if (size.x >= size.y && size.x >= size.z) {
        at.face = select(0u, 1u, d.x < 0.0);
        at.axis = size.x;
        at.place = vec2f(select(-d.z, d.z, d.x < 0.0), -d.y) / size.x;
    } else if (size.y >= size.z) {
        at.face = select(2u, 3u, d.y < 0.0);
        at.axis = size.y;
        at.place = vec2f(d.x, select(d.z, -d.z, d.y < 0.0)) / size.y;
    } else {
        at.face = select(4u, 5u, d.z < 0.0);
        at.axis = size.z;
        at.place = vec2f(select(d.x, -d.x, d.z < 0.0), -d.y) / size.z;
    }
    return at;
}
