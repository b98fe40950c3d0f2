struct InstanceValues {
    object_from_world: mat3x4f,
    tree_root: u32,
    trace_flags: u32,
}
@group(1) @binding(0) var<storage, read> nodes: array<vec4u>;
@group(1) @binding(1) var<storage, read> triangles: array<vec4u>;
@group(1) @binding(2) var<storage, read> instances: array<InstanceValues>;

fn node_words(i: u32) -> vec4u {
    return nodes[i];
}
fn triangle_words(i: u32) -> vec4u {
    return triangles[i];
}
fn instance_values(i: u32) -> InstanceValues {
    return instances[i];
}

struct Query { origin: vec3f, t_min: f32, direction: vec3f, t_max: f32 }
struct Answer { hit: Hit, blocked: u32, exhausted: u32, visits: vec2u }
@group(0) @binding(0) var<storage, read> queries: array<Query>;
@group(0) @binding(1) var<storage, read_write> answers: array<Answer>;

fn alpha_passes(instance: u32, triangle: u32, bary: vec2f) -> bool {
    return (instance + triangle) % 3u != 0u && bary.x < 0.6;
}

@compute @workgroup_size(64)
fn trace(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let query = queries[id.x];
    let hit = trace_nearest(query.origin, query.direction, query.t_min, query.t_max);
    let visits = vec2u(visited_nodes, tested_triangles);
    let blocked = trace_solid(query.origin, query.direction, query.t_min, query.t_max, true).instance != NO_INSTANCE;
    answers[id.x] = Answer(hit, u32(blocked), exhausted_rays, visits);
}
