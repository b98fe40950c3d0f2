// Depths of a cube's maps: texels with hits of rays from its middle.

#import constants
#import cube_faces

@group(2) @binding(24) var cube_hits: texture_2d_array<u32>; // distance, instance, triangle, place; six layers for a map

// Maximum relative difference of the depths of pixels between which a surface is taken to go on.
const SAME_SURFACE: f32 = 0.2;

// Pixel of a face that has a place.
fn cube_pixel(place: vec2f) -> vec2u {
    let size = f32(textureDimensions(cube_hits).x);
    return vec2u(clamp((place + 1.0) * (0.5 * size), vec2f(0.0), vec2f(size - 1.0)));
}

fn cube_hit(map: u32, direction: vec3f) -> vec4u {
    let at = face_place(direction);
    return textureLoad(cube_hits, cube_pixel(at.place), 6u * map + at.face, 0);
}

// Depth of a pixel of a layer, along the axis of its face.
fn depth_at(layer: u32, pixel: vec2i, size: f32) -> f32 {
    let hit = textureLoad(cube_hits, pixel, layer, 0).xy;
    if (hit.y == NONE) { return FAR_M; }
    let place = (vec2f(pixel) + 0.5) * (2.0 / size) - 1.0;
    return bitcast<f32>(hit.x) * inverseSqrt(1.0 + dot(place, place));
}

// Depth of a map at a place of a face. Its inverse is linear on planes, so that interpolating that between pixels of
// one surface is exact there.
fn depth_seen(map: u32, at: FacePlace) -> f32 {
    let size = f32(textureDimensions(cube_hits).x);
    let layer = 6u * map + at.face;
    let place = clamp((at.place + 1.0) * (0.5 * size) - 0.5, vec2f(0.0), vec2f(size - 1.0));
    let corner = vec2i(min(place, vec2f(size - 2.0)));
    let part = place - vec2f(corner);
    let inverse = 1.0 / vec4f(
        depth_at(layer, corner, size),
        depth_at(layer, corner + vec2i(1, 0), size),
        depth_at(layer, corner + vec2i(0, 1), size),
        depth_at(layer, corner + vec2i(1, 1), size),
    );
    let least = min(min(inverse.x, inverse.y), min(inverse.z, inverse.w));
    let most = max(max(inverse.x, inverse.y), max(inverse.z, inverse.w));
    if (most - least > SAME_SURFACE * most) {
        let near = vec2i(round(place));
        return depth_at(layer, near, size);
    }
    return 1.0 / mix(mix(inverse.x, inverse.y, part.x), mix(inverse.z, inverse.w, part.x), part.y);
}
