override factor: u32 = 1;
@group(0) @binding(0) var<storage, read_write> values: array<u32>;
@group(0) @binding(3) var coordinates: texture_storage_2d<rg32uint, write>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < arrayLength(&values) { values[id.x] *= factor; }
    textureStore(coordinates, vec2u(id.x % 33u, id.x / 33u), vec4u(id.x % 33u, id.x / 33u, 0u, 0u));
}
