// Arguments: turns the number of rays into workgroups in two dimensions, since a dispatch of more
// than 65,535 in one dimension is silently dropped.

#import constants

@group(2) @binding(0) var<storage, read> counters: array<u32, COUNTERS>;
@group(2) @binding(1) var<storage, read_write> arguments: array<u32, 3>;

const GROUPS_PER_ROW: u32 = 32768u;

@compute @workgroup_size(1)
fn main() {
    let groups = (counters[RAY_COUNTER] + RAYS_PER_GROUP - 1u) / RAYS_PER_GROUP;
    arguments[0] = min(groups, GROUPS_PER_ROW);
    arguments[1] = (groups + GROUPS_PER_ROW - 1u) / GROUPS_PER_ROW;
    arguments[2] = 1u;
}
