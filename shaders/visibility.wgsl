// Visibility: rasterizes depth and ids (instance, triangle), nothing else. Vertices are pulled for cut-outs, and
// where the device has no primitive index, so that triangles are numbered by their vertices.

#import triangles
#import capsules_seen
#import frame
#import surface

override CUTOUT: bool = false; // whether this pipeline draws cut-out materials

struct Varying {
    @builtin(position) @invariant clip: vec4f,
    @location(0) @interpolate(flat) ids: vec2u,
    @location(1) bary: vec2f,
}

@vertex
fn vertex(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Varying {
    var out: Varying;
    let triangle = vertex / 3u;
    let corner = vertex % 3u;
    let index = mesh_word(instance_index_base(instance) + vertex);
    let p = to_world(instance, vertex_position(instance_vertex_base(instance) + index));
    out.clip = frame.clip_from_world * vec4f(p, 1.0);
    out.ids = vec2u(instance, triangle);
    out.bary = vec2f(f32(corner == 1u), f32(corner == 2u));
    return out;
}

@fragment
fn fragment(in: Varying) -> @location(0) vec2u {
    if (CUTOUT) {
        if (!alpha_passes(in.ids.x, in.ids.y, in.bary)) { discard; }
    }
    return in.ids;
}
