struct Instance {
    object_from_world: mat3x4f,
    tree_root: u32,
    trace_flags: u32,
}
@group(1) @binding(0) var<storage, read> nodes: array<vec4u>;
@group(1) @binding(1) var<storage, read> triangles: array<vec4u>;
@group(1) @binding(2) var<storage, read> instances: array<Instance>;

fn node_words(i: u32) -> vec4u {
    return nodes[i];
}
fn triangle_words(i: u32) -> vec4u {
    return triangles[i];
}
fn instance_object_from_world(i: u32) -> mat3x4f {
    return instances[i].object_from_world;
}
fn instance_tree_root(i: u32) -> u32 {
    return instances[i].tree_root;
}
fn instance_trace_flags(i: u32) -> u32 {
    return instances[i].trace_flags;
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
