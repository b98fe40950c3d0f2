// Group 1: the scene's geometry, BVHs, materials and textures.

#import constants
#import geometry
#import material
#import records
#import shown
#import structs

@group(1) @binding(6) var pool_0: texture_2d_array<f32>;
@group(1) @binding(7) var pool_0_srgb: texture_2d_array<f32>;
@group(1) @binding(8) var pool_1: texture_2d_array<f32>;
@group(1) @binding(9) var pool_1_srgb: texture_2d_array<f32>;
@group(1) @binding(10) var pool_2: texture_2d_array<f32>;
@group(1) @binding(11) var pool_2_srgb: texture_2d_array<f32>;
@group(1) @binding(12) var sampler_rr: sampler;
@group(1) @binding(13) var sampler_rc: sampler;
@group(1) @binding(14) var sampler_cr: sampler;
@group(1) @binding(15) var sampler_cc: sampler;

// Whether the material of an instance, perhaps NONE, is cut out.
fn is_cutout(instance: u32) -> bool {
    return HAS_CUTOUT && instance != NONE && material_alpha_cutoff(instance_material(instance)) >= 0.0;
}

fn to_world(values: InstanceValues, p: vec3f) -> vec3f {
    return vec4f(p, 1.0) * values.world_from_object;
}

fn direction_to_world(values: InstanceValues, d: vec3f) -> vec3f {
    return vec4f(d, 0.0) * values.world_from_object;
}

// Normals are transformed by the inverse transpose.
fn normal_to_world(values: InstanceValues, n: vec3f) -> vec3f {
    let rows = values.object_from_world;
    return rows[0].xyz * n.x + rows[1].xyz * n.y + rows[2].xyz * n.z;
}
