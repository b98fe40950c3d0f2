// Hits of the mirror rays of pixels, as passes write them: distance, instance, triangle and barycentrics, NONE of a traced
// ray, in layers that a pass may both read and write.

#import constants

@group(2) @binding(29) var written_hit: texture_storage_2d_array<r32uint, read_write>;

fn store_hit(pixel: vec2u, hit: vec4u) {
    for (var layer = 0u; layer < 4u; layer++) { textureStore(written_hit, pixel, layer, vec4u(hit[layer], 0u, 0u, 0u)); }
}

fn stored_hit(pixel: vec2u) -> vec4u {
    var hit: vec4u;
    for (var layer = 0u; layer < 4u; layer++) { hit[layer] = textureLoad(written_hit, pixel, layer).x; }
    return hit;
}
