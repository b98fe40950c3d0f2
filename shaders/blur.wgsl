// Blur: one direction of the paper's Gaussian over the combined reflection, restricted to reflective
// pixels of about the same normal so that nothing bleeds over edges.

#import blur_params
#import gbuffer
#import cause
#import radiance

@group(2) @binding(5) var cause: texture_2d<u32>;
@group(2) @binding(6) var source: texture_2d<f32>;
@group(2) @binding(7) var blurred: RadianceTexture;
@group(2) @binding(8) var<uniform> params: Params;

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let pixel = moment_pixel(id.xy);
    if (any(pixel >= vec2u(frame.size))) { return; }
    let center = textureLoad(source, pixel, 0);
    if (!reflects(textureLoad(cause, pixel, 0).x)) {
        textureStore(blurred, pixel, center);
        return;
    }
    let normal = unpack_unit(textureLoad(surface, pixel, 0).y);
    var sum = vec3f(0.0);
    var weights = 0.0;
    let reach = i32(ceil(3.0 * params.sigma_px));
    for (var k = -reach; k <= reach; k++) {
        let at = pixel_of_moment(vec2i(pixel) + params.direction * k);
        if (any(at < vec2i(0)) || any(at >= vec2i(frame.size))) { continue; }
        if (!reflects(textureLoad(cause, at, 0).x)) { continue; }
        let x = f32(k) / params.sigma_px;
        let alike = saturate(dot(normal, unpack_unit(textureLoad(surface, at, 0).y)) * 10.0 - 9.0);
        let w = exp(-0.5 * x * x) * alike;
        sum += textureLoad(source, at, 0).xyz * w;
        weights += w;
    }
    textureStore(blurred, pixel, stored(vec4f(sum / max(weights, 1e-6), 1.0)));
}
