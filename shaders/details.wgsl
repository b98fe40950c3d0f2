// Details: values of the surfaces that pixels show, for which the G-buffer has no bits; layer 0 is a copy of its colors.

#import details_layout
#import pixel_surface

@group(2) @binding(0) var ids: texture_2d<u32>;
@group(2) @binding(1) var colors: texture_2d<u32>;
@group(2) @binding(2) var details: texture_storage_2d_array<rgba32uint, write>;

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = surface_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    let hit = textureLoad(ids, pixel, 0).xy;
    var s: Surface;
    if (hit.x != NONE) { s = pixel_surface(pixel, hit).surface; }
    textureStore(details, pixel, 0, textureLoad(colors, pixel, 0));
    textureStore(details, pixel, 1, pack_details(s));
    if (HAS_FURTHER_DETAILS) {
        let shares = pack2x16unorm(vec2f(s.diffuse_roughness, s.coat_reflectivity));
        textureStore(details, pixel, 2, vec4u(pack_unit(s.coat_normal), pack_unit(s.tangent), bitcast<u32>(s.anisotropy), shares));
    }
    if (HAS_DIFFUSE_TRANSMISSION) { textureStore(details, pixel, 3, pack_diffuse_transmission(s)); }
}
