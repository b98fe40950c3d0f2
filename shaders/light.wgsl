// Light: view-independent radiance (emission, diffuse), stored apart from the specular of this view.

#import gbuffer
#import radiance
#import work

@group(2) @binding(5) var radiance: RadianceTexture; // w: 1 where it is a display color
@group(2) @binding(6) var specular: RadianceTexture;
@group(2) @binding(7) var visible_lights: texture_storage_2d<rg32uint, write>;

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let pixel = invoked_pixel(group, groups, local);
    if (any(pixel >= vec2u(frame.size)) || is_left_out(pixel)) { return; }
    start_samples(pixel, 0u);
    var lit: Shade;
    var unlit = 0.0;
    if (textureLoad(view_depth, pixel, 0).x < FAR_M) {
        let s = load_surface(pixel);
        start_path(s.position, s.is_inside);
        lit = shade(s, -view_direction(s.position), vec2u(0u));
        unlit = select(0.0, coverage(s), s.unlit);
    } else if (SHOW_ENVIRONMENT) {
        lit.diffuse = environment(normalize(pixel_ray(vec2f(pixel) + 0.5)));
    } else if (!HIDES_BACKGROUND) {
        lit.diffuse = frame.background;
    }
    textureStore(radiance, pixel, stored(vec4f(lit.diffuse, unlit)));
    textureStore(specular, pixel, stored(vec4f(lit.specular, 1.0)));
    if (REUSES_LIGHT) { textureStore(visible_lights, pixel, vec4u(lit.visible, 0u, 0u)); }
    store_work(pixel, 0u);
}
