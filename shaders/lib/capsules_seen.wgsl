// Capsules as the camera sees them: ids, and the depth at which the pixel's ray meets the capsule.

#import capsule_shape
#import frame
#import surface

struct CapsuleVarying {
    @builtin(position) clip: vec4f,
    @location(0) @interpolate(flat) ids: vec2u,
}

@vertex
fn vertex_capsule(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> CapsuleVarying {
    let eye = select(vec4f(frame.eye, 1.0), vec4f(frame.forward, 0.0), is_orthographic());
    var clip = capsule_vertex(instance, vertex, eye, frame.clip_from_world, vec2f(frame.pixel_m, frame.pixel_spread));
    // The shape may reach past the near plane, before the far side of the capsule, and past the far plane of an
    // orthographic camera, behind the capsule.
    clip.z = min(max(clip.z, 0.0), max(clip.w, 0.0));
    return CapsuleVarying(clip, vec2u(instance, capsule_of_vertex(vertex)));
}

struct CapsuleFragment {
    @location(0) ids: vec2u,
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment_capsule(in: CapsuleVarying) -> CapsuleFragment {
    let seen = seen_part(in.clip.xy);
    let hit = solid_capsule_hit(in.ids.x, in.ids.y, pixel_origin(in.clip.xy), pixel_ray(in.clip.xy), seen.x, vec2f(frame.pixel_m, frame.pixel_spread), false);
    if (!hit.is_met || hit.t > seen.y) { discard; }
    return CapsuleFragment(in.ids, screen_z(hit.t));
}
