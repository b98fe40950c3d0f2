//! Records of instances for shaders.

use std::ops::Range;

use glam::Affine3A;

use reflet_gpu::{Gpu, GpuError};
use reflet_world::{
    Instance, World,
    bvh::{NONE, TraceInstance, Trees, UNREFLECTED},
};

use super::{
    draw::mirrors,
    geometry::MeshRange,
    gpu_material::gpu_material,
    records::{RecordArray, are_texels_preferred},
};
use crate::{
    buffers::textures::Pools,
    layout::{
        gpu_decal::DECAL_SET_SHIFT,
        gpu_struct::Shared as _,
        types::{
            FLAG_AT_LEAST_A_PIXEL, FLAG_CAPSULE_NORMALS, FLAG_COLORS, FLAG_DARK, FLAG_EMITTER,
            FLAG_MIRRORED, GpuInstance, flag,
        },
    },
    lighting::shown_light::ShownLight,
};

/// Inputs of records of instances, beside the world and its trees.
#[derive(Clone, Copy, Debug)]
pub struct RecordInputs<'a> {
    /// Ranges of the meshes.
    pub mesh_ranges: &'a [MeshRange],
    /// Whether reflection rays skip an instance, by index; those past the end are not skipped.
    pub skipped: &'a [bool],
    /// Light that pictures show.
    pub shown_light: ShownLight,
    /// Whether ray queries find triangles, which need the first triangle of a tree rather than its root.
    pub queried: bool,
}

/// Uploads instances and materials.
pub fn records(
    gpu: &Gpu,
    world: &World,
    trees: &Trees,
    inputs: RecordInputs<'_>,
    pools: &Pools,
) -> Result<(RecordArray, RecordArray), GpuError> {
    let (instances, materials) = (&world.instances, &world.materials);
    let in_texels = are_texels_preferred(gpu, instances.len(), materials.len());
    let instances = instance_records(world, trees, inputs, 0..instances.len());
    let materials = materials.iter();
    let materials = materials.map(|m| gpu_material(m, world, &pools.layers));
    let vertex = wgpu::BufferUsages::VERTEX;
    let none = wgpu::BufferUsages::empty();
    Ok((
        RecordArray::new(gpu, "instances", instances, vertex, in_texels)?,
        RecordArray::new(gpu, "materials", materials, none, in_texels)?,
    ))
}

/// Rows of an affine transform.
pub fn rows(transform: &Affine3A) -> [[f32; 4]; 3] {
    let m = transform.matrix3;
    let t = transform.translation;
    [0, 1, 2].map(|r| [m.x_axis[r], m.y_axis[r], m.z_axis[r], t[r]])
}

/// Traversal flags of an instance, which reflection rays pass if it is skipped.
pub fn trace_flags(traced: &TraceInstance, skipped: &[bool], index: usize) -> u32 {
    let is_skipped = skipped.get(index).copied().unwrap_or(false);
    traced.trace_flags | if is_skipped { UNREFLECTED } else { 0 }
}

/// Records of a range of the instances of a world in its pose, with the ranges of its meshes.
pub fn instance_records(
    world: &World,
    trees: &Trees,
    inputs: RecordInputs<'_>,
    range: Range<usize>,
) -> impl ExactSizeIterator<Item = GpuInstance> + Clone {
    let mut first_triangle = vec![
        NONE;
        if inputs.queried {
            world.meshes.len()
        } else {
            0
        }
    ];
    if inputs.queried {
        for tree in &trees.mesh_trees {
            first_triangle[tree.mesh] = tree.triangles.start as u32;
        }
    }
    let record = move |(index, (instance, traced)): (usize, (&Instance, &TraceInstance))| {
        let range = inputs.mesh_ranges[instance.mesh];
        let mesh = &world.meshes[instance.mesh];
        let radius = mesh.capsule_radius_m;
        let has_capsule_normals = radius.is_some() && !mesh.normals.is_empty();
        let light_group = world.materials[instance.material].light_group;
        let is_sampled = world.materials[instance.material].light && radius.is_none();
        GpuInstance {
            world_from_object: rows(&instance.world_from_object),
            object_from_world: traced.object_from_world,
            tree_root: match inputs.queried && traced.tree_root != NONE {
                true => first_triangle[instance.mesh],
                false => traced.tree_root,
            },
            trace_flags: trace_flags(traced, inputs.skipped, index),
            vertex_base: range.vertex_base,
            index_base: range.index_base,
            uv1_base: range.uv1_base,
            material: instance.material as u32,
            flags: flag(mirrors(&instance.world_from_object), FLAG_MIRRORED)
                | flag(range.has_colors, FLAG_COLORS)
                | flag(is_sampled, FLAG_EMITTER)
                | flag(!inputs.shown_light.shows(light_group), FLAG_DARK)
                | flag(has_capsule_normals, FLAG_CAPSULE_NORMALS)
                | flag(mesh.at_least_a_pixel, FLAG_AT_LEAST_A_PIXEL)
                | u32::from(world.decals.set_of(index)) << DECAL_SET_SHIFT,
            capsule_radius_m: radius.unwrap_or(0.0),
            ..GpuInstance::ZERO
        }
    };
    let instances = world.instances[range.clone()].iter();
    let pairs = instances.zip(&trees.instances[range.clone()]);
    (range.zip(pairs)).map(record)
}
