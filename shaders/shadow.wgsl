// Shadow: depth from one light, into a cube face or a flat map.

#import capsules_cast
#import frame
#import placed
#import shadow_params
#import surface

@group(2) @binding(0) var<uniform> params: Params;

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) ids: vec2u,
    @location(1) bary: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    var out: Varying;
    let corner = vertex % 3u;
    let index = mesh_word(instance_index_base(instance) + vertex);
    let p = to_world(instance, vertex_position(instance_vertex_base(instance) + index));
    out.clip = params.clip_from_world * vec4f(p, 1.0);
    out.ids = vec2u(instance, vertex / 3u);
    out.bary = vec2f(f32(corner == 1u), f32(corner == 2u));
    return out;
}

@vertex
fn vertex_opaque(vertex: Placed) -> @builtin(position) vec4f {
    return params.clip_from_world * vec4f(placed_in_world(vertex), 1.0);
}

@fragment
fn fragment(in: Varying) {
    if (!alpha_passes(in.ids.x, in.ids.y, in.bary)) { discard; }
}
