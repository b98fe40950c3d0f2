// Share of a light that arrives: filtered shadow maps, or shadow rays.

#import frame
#import layers

// Whether lights without a size cast shadows by rays, by cube maps or by flat maps.
override HAS_HARD_SHADOW_RAYS: bool = true;
override HAS_CUBE_MAPS: bool = true;
override HAS_FLAT_MAPS: bool = true;

fn light_visibility(i: u32, position: vec3f, normal: vec3f, to_light: vec3f, distance_m: f32) -> vec3f {
    if (HAS_HARD_SHADOW_RAYS && lights[i].shadow == SHADOW_RAY) {
        let size = max(max(abs(position.x), abs(position.y)), max(abs(position.z), 1e-3));
        let origin = position + normal * (size * 4e-5);
        return transmittance(origin, to_light, distance_m * 0.9999);
    }
    return vec3f(map_share(i, position, normal, to_light));
}

// Share of a light that arrives as its shadow map says; 1 without one.
fn map_share(i: u32, position: vec3f, normal: vec3f, to_light: vec3f) -> f32 {
    if (lights[i].shadow != SHADOW_MAP) { return 1.0; }
    if (HAS_CUBE_MAPS && (!HAS_FLAT_MAPS || lights[i].kind == LIGHT_POINT)) {
        return cube_visibility(i, position, normal, to_light);
    }
    if (HAS_FLAT_MAPS) { return map_visibility(i, position, normal, to_light); }
    return 1.0;
}

// The point offset from the surface by about the width of a shadow texel there, more at grazing light ("normal
// offset", Holbert 2011): acne and gaps both stay below a texel.
fn offset_point(position: vec3f, normal: vec3f, to_light: vec3f, texel_m: f32) -> vec3f {
    let slope = sqrt(max(1.0 - pow(saturate(dot(normal, to_light)), 2.0), 0.0));
    return position + normal * texel_m * (0.5 + 2.0 * slope) + to_light * texel_m * 0.5;
}

// Cube faces store near / distance along the major axis, so one comparison serves all six.
fn cube_visibility(i: u32, position: vec3f, normal: vec3f, to_light: vec3f) -> f32 {
    let rough = abs(position - lights[i].position);
    let texel_m = lights[i].texel * max(rough.x, max(rough.y, rough.z));
    let d = offset_point(position, normal, to_light, texel_m) - lights[i].position;
    let axis = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(to_light.x) > 0.7);
    let u = normalize(cross(to_light, axis)) * texel_m;
    let v = normalize(cross(to_light, u)) * texel_m;
    var lit = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let tap = d + u * (f32(k & 1u) - 0.5) + v * (f32(k >> 1u) - 0.5);
        // Each tap uses the axis of its own face: at the edge of two faces their depths differ.
        let a = abs(tap);
        let reference = lights[i].clip_from_world[3].z / max(max(a.x, max(a.y, a.z)), 1e-6);
        lit += textureSampleCompareLevel(shadow_cubes, shadow_sampler, tap, lights[i].layer, reference);
    }
    return lit * 0.25;
}

fn map_visibility(i: u32, position: vec3f, normal: vec3f, to_light: vec3f) -> f32 {
    var texel_m = lights[i].texel;
    if (lights[i].kind == LIGHT_SPOT) { texel_m *= max(dot(position - lights[i].position, lights[i].direction), 0.0); }
    let clip = lights[i].clip_from_world * vec4f(offset_point(position, normal, to_light, texel_m), 1.0);
    if (clip.w <= 0.0) { return 1.0; }
    let ndc = clip.xyz / clip.w;
    let uv = vec2f(ndc.x * 0.5 + 0.5, 0.5 - ndc.y * 0.5);
    if (any(uv < vec2f(0.0)) || any(uv > vec2f(1.0))) { return 1.0; }
    let texel = 1.0 / vec2f(textureDimensions(shadow_maps));
    var lit = 0.0;
    for (var k = 0u; k < 4u; k++) {
        let at = uv + texel * (vec2f(f32(k & 1u), f32(k >> 1u)) - 0.5);
        lit += textureSampleCompareLevel(shadow_maps, shadow_sampler, at, lights[i].layer, ndc.z);
    }
    return lit * 0.25;
}
