// Variant that traces reflection rays through the BVHs over their whole length.

#import bvh
#import cause

@group(2) @binding(13) var cause: texture_2d<u32>;

// Number of steps in maps, of which there are none, and how a ray ended in them.
const map_steps: u32 = 0u;
const map_cause: u32 = CAUSE_UNMARCHED;

// Length of a pixel's ray that the march has found free.
fn march_free_m(pixel: vec2u) -> f32 {
    return free_m(textureLoad(cause, pixel, 0).x);
}

fn closest_hit(origin: vec3f, direction: vec3f, start_m: f32, end_m: f32) -> Hit {
    return trace_nearest(origin, direction, start_m, end_m);
}
