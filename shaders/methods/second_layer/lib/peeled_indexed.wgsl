// Opaque triangles of the second depth layer, drawn by their indices.

#import triangles
#import layer_test

@fragment
fn fragment_peeled(in: IndexedVarying, @builtin(primitive_index) triangle: u32) -> @location(0) vec2u {
    let id = vec2u(in.instance, triangle);
    if (!is_behind(in.clip, id)) { discard; }
    return id;
}
