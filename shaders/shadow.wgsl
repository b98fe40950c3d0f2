// Shadow: depth from one light, into a cube face or a flat map.

#import capsules_cast
#import placed
#import pulled_vertex
#import shadow_params
#import surface

@group(2) @binding(0) var<uniform> params: Params;

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    return pulled_vertex(vertex, instance, params.clip_from_world);
}

@vertex
fn vertex_opaque(vertex: Placed) -> @builtin(position) vec4f {
    return params.clip_from_world * vec4f(placed_in_world(vertex), 1.0);
}

@fragment
fn fragment(in: Varying) {
    if (!alpha_passes(in.ids.x, in.ids.y, in.bary)) { discard; }
}
