// Arguments: turns the lengths of the lists into two-dimensional workgroup counts of indirect dispatches, since a
// dispatch of more than 65,535 workgroups in one dimension is silently dropped.

#import constants

@group(2) @binding(0) var<storage, read> counters: array<u32, COUNTERS>;
@group(2) @binding(1) var<storage, read_write> arguments: array<vec4u, LISTS>;

override UNDERSAMPLED: bool = false;

const GROUPS_PER_ROW: u32 = 32768u;

fn groups_for(counter: u32) -> u32 {
    return (counters[counter] + RAYS_PER_GROUP - 1u) / RAYS_PER_GROUP;
}

fn in_rows(groups: u32) -> vec4u {
    return vec4u(min(groups, GROUPS_PER_ROW), (groups + GROUPS_PER_ROW - 1u) / GROUPS_PER_ROW, 1u, 0u);
}

@compute @workgroup_size(1)
fn main() {
    arguments[REFLECTORS_LIST] = in_rows(groups_for(REFLECTOR_COUNTER));
    // Rays that become hits of neighbors may begin one group more.
    arguments[RAYS_LIST] = in_rows(groups_for(RAY_COUNTER) + groups_for(HIT_COUNTER) + u32(UNDERSAMPLED));
    arguments[TRANSMISSIVE_LIST] = in_rows(groups_for(TRANSMISSIVE_COUNTER));
}
