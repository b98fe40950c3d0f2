// Capsules as a light sees them: the depth at which the texel's ray meets the capsule. Spheres without cut-outs are
// disks around their middle: outside of a sphere nothing lies between its surface and such a disk, as the light sees
// them, so that both shadow the same, and a hidden disk is rejected before its texels are shaded.

#import capsule_shape
#import surface

struct CapsuleVarying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) ids: vec2u,
    @location(1) place: vec4f, // in clip space
}

// Position in the map of a drawn vertex.
fn capsule_clip(vertex: u32, instance: u32) -> vec4f {
    // The light of a perspective map is at the only point with this clip position; an orthographic map's is infinitely
    // far.
    let light = params.world_from_clip * vec4f(0.0, 0.0, 1.0, 0.0);
    let eye = select(vec4f(light.xyz, 0.0), vec4f(light.xyz / light.w, 1.0), abs(light.w) > 1e-12);
    let clip = capsule_vertex(instance, vertex, eye, params.clip_from_world, vec2f(0.0));
    return vec4f(clip.xy, max(clip.z, 0.0), clip.w);
}

struct DiskVarying {
    @builtin(position) clip: vec4f,
    @location(0) place: vec2f, // on the square around the disk
}

@vertex
fn vertex_disk(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> DiskVarying {
    return DiskVarying(capsule_clip(vertex, instance), square_place(vertex) * SHAPE_MARGIN);
}

@fragment
fn fragment_disk(in: DiskVarying) {
    if (dot(in.place, in.place) > 1.0) { discard; }
}

@vertex
fn vertex_capsule(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> CapsuleVarying {
    let clip = capsule_clip(vertex, instance);
    return CapsuleVarying(clip, vec2u(instance, capsule_of_vertex(vertex)), clip);
}

// Ray of a texel, from the light of a perspective map, else from the near plane, and how depth in the map follows from
// the distance along it.
struct TexelRay {
    origin: vec3f,
    direction: vec3f,
    near_t: f32, // distance of the near plane, in lengths of the direction
    // Depth of points at a distance t: 1 / t of a perspective map, else t, times x plus y.
    depth: vec2f,
}

// From the light itself: points on the near plane of a perspective map are so near to each other that rounding would
// turn a ray through them by more than a texel.
fn texel_ray(texel: vec2f) -> TexelRay {
    let light = params.world_from_clip * vec4f(0.0, 0.0, 1.0, 0.0);
    let far = params.world_from_clip * vec4f(texel, 0.0, 1.0);
    if (abs(light.w) <= 1e-12) { return TexelRay((far + light).xyz, -light.xyz, 0.0, vec2f(-1.0, 1.0)); }
    let origin = light.xyz / light.w;
    return TexelRay(origin, far.xyz - far.w * origin, 1.0 / (far.w + light.w), vec2f(1.0, -far.w) / light.w);
}

@fragment
fn fragment_capsule(in: CapsuleVarying) -> @builtin(frag_depth) f32 {
    let ray = texel_ray(in.place.xy / in.place.w);
    let hit = solid_capsule_hit(in.ids.x, in.ids.y, ray.origin, ray.direction, ray.near_t, vec2f(0.0), true);
    if (!hit.is_met) { discard; }
    return select(hit.t, 1.0 / hit.t, ray.near_t > 0.0) * ray.depth.x + ray.depth.y;
}
