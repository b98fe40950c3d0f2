// Prefilter: levels of the cube maps of probes, each for one roughness: the mean radiance over the GGX lobe of a
// surface that is seen straight on (Karis 2013, "Real Shading in Unreal Engine 4"), by samples of visible normals, each
// of which reads the level whose pixels are as large as its share of directions (Křivánek & Colbert 2008).

#import constants
#import cube_faces
#import half
#import prefilter_params

@group(2) @binding(0) var whole: texture_cube_array<f32>; // all levels of the captured maps
@group(2) @binding(1) var whole_sampler: sampler;
@group(2) @binding(2) var finer: texture_2d_array<f32>; // the previous level
@group(2) @binding(3) var level: texture_storage_2d_array<rgba16float, write>;
@group(2) @binding(4) var<uniform> params: Params;

const SAMPLES: u32 = 64u;

// Mean of four pixels of the finer level.
@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn shrink(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(params.face_px))) { return; }
    var sum = vec4f(0.0);
    for (var k = 0u; k < 4u; k++) {
        let at = min(2u * id.xy + vec2u(k & 1u, k >> 1u), textureDimensions(finer) - 1u);
        sum += textureLoad(finer, at, id.z, 0);
    }
    textureStore(level, id.xy, id.z, halved(sum * 0.25));
}

@compute @workgroup_size(GROUP_PX, GROUP_PX)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if (any(id.xy >= vec2u(params.face_px))) { return; }
    let place = (vec2f(id.xy) + 0.5) * (2.0 / f32(params.face_px)) - 1.0;
    let normal = normalize(face_direction(id.z % 6u, place));
    let side = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(normal.x) > 0.7);
    let tangent = normalize(cross(side, normal));
    let bitangent = cross(normal, tangent);
    let a2 = params.alpha * params.alpha;
    let pixel_angle = 4.0 * PI / (6.0 * f32(params.sharp_px) * f32(params.sharp_px));
    var sum = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0u; i < SAMPLES; i++) {
        // Hammersley's sequence, with the radical inverse in base 2.
        let u = vec2f((f32(i) + 0.5) / f32(SAMPLES), f32(reverseBits(i) >> 8u) * exp2(-24.0));
        // Facet normals by their projected density, D cos θ.
        let cos2 = (1.0 - u.x) / (1.0 + (a2 - 1.0) * u.x);
        let sine = sqrt(max(1.0 - cos2, 0.0));
        let turn = 2.0 * PI * u.y;
        let facet = tangent * (sine * cos(turn)) + bitangent * (sine * sin(turn)) + normal * sqrt(cos2);
        let direction = reflect(-normal, facet);
        let weight = dot(normal, direction);
        if (weight <= 0.0) { continue; }
        let d = cos2 * (a2 - 1.0) + 1.0;
        let density = a2 / (4.0 * PI * d * d); // per solid angle of the mirrored direction
        let angle = 1.0 / (f32(SAMPLES) * density);
        let lod = max(0.5 * log2(angle / pixel_angle) + 0.5, 0.0);
        sum += textureSampleLevel(whole, whole_sampler, direction, id.z / 6u, lod) * weight;
        weights += weight;
    }
    textureStore(level, id.xy, id.z, halved(sum / max(weights, 1e-6)));
}
