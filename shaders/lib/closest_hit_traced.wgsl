// Variant that traces reflection rays through the BVHs over their whole length.

#import bvh

// Number of steps in maps, of which there are none, and how a ray ended in them.
const map_steps: u32 = 0u;
const map_cause: u32 = CAUSE_UNMARCHED;

fn closest_hit(origin: vec3f, direction: vec3f, start_m: f32, end_m: f32) -> Hit {
    return trace_nearest(origin, direction, start_m, end_m);
}
