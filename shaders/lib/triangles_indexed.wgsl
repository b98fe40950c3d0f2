// Opaque triangles drawn by their indices, so that vertices shared by triangles are transformed once.

enable primitive_index;

#import frame
#import placed

struct IndexedVarying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) instance: u32,
}

@vertex
fn vertex_indexed(vertex: Placed, @builtin(instance_index) instance: u32) -> IndexedVarying {
    return IndexedVarying(frame.clip_from_world * vec4f(placed_in_world(vertex), 1.0), instance);
}

@fragment
fn fragment_indexed(in: IndexedVarying, @builtin(primitive_index) triangle: u32) -> @location(0) vec2u {
    if (is_cut_away(in.clip)) { discard; }
    return vec2u(in.instance, triangle);
}
