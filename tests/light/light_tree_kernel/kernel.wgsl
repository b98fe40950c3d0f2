struct Query { position: vec3f, by_power: u32, normal: vec3f, instance: u32, u: vec2f, item: u32, pad: u32 }
struct Answer { instance: u32, item: u32, chosen: vec2f, known: vec2f }
@group(2) @binding(20) var<storage, read> queries: array<Query>;
@group(2) @binding(21) var<storage, read_write> answers: array<Answer>;

@compute @workgroup_size(64)
fn choose(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&queries) {
        return;
    }
    let query = queries[id.x];
    let surface = LitPoint(query.position, query.normal, 0u);
    let chosen = chosen_light(query.u, query.by_power == 1u, surface);
    var known: vec2f;
    if query.instance == NONE {
        known = lamp_chances(query.item, surface);
    } else {
        known = light_chances(query.instance, query.item, surface);
    }
    answers[id.x] = Answer(chosen.instance, chosen.triangle, chosen.chances, known);
}
