//! Draw calls of rasterization: one for each instance that has triangles.

use std::ops::Range;

use glam::Affine3A;
use xxhash_rust::xxh3::xxh3_64_with_seed;

use super::{draw_shape::DrawShape, geometry::MeshRange};
use crate::layout::types::{GpuInstance, GpuVertex};
use reflet_base::math::Bounds;
use reflet_scene::desc::ShownDesc;
use reflet_world::{Instance, Material, World};

/// Properties of a draw call that need a render pipeline of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawClass {
    /// Whether alpha is tested.
    pub cutout: bool,
    /// Whether triangles are double-sided.
    pub double_sided: bool,
    /// Whether the instance's transform mirrors it.
    pub mirrored: bool,
    /// Shape that is drawn.
    pub shape: DrawShape,
}

impl DrawClass {
    /// Whether it is drawn by indices where the device allows it.
    pub fn is_indexed(&self) -> bool {
        !self.cutout && self.shape == DrawShape::Triangles
    }
}

/// Draw call of one instance.
#[derive(Clone, Debug)]
pub struct Draw {
    /// Index of the instance.
    pub instance: u32,
    /// Range of the mesh's indices in `mesh_data`.
    pub indices: Range<u32>,
    /// First vertex of the mesh.
    pub vertex_base: i32,
    /// World bounds.
    pub bounds: Bounds,
    /// Properties that select the pipeline.
    pub class: DrawClass,
    /// Whether the pose, and with it the handedness, may change.
    pub dynamic: bool,
    /// Whether the camera culls back faces of the instance that rays may meet; see `GpuScene::find_backs`.
    pub hides_backs: bool,
    /// Hash of the instance's transform, and of the vertices of a deformed mesh.
    pub pose: u64,
    /// Whether the instance is drawn into shadow maps; mostly transmissive ones are not, as maps cannot attenuate
    /// light.
    pub casts_shadow: bool,
    /// Kinds of rays that see the instance.
    pub shown: ShownDesc,
}

impl Draw {
    /// Updates the draw call from the pose of its instance.
    pub fn pose(&mut self, world: &World) {
        let instance = &world.instances[self.instance as usize];
        self.class.mirrored = mirrors(&instance.world_from_object);
        self.bounds = world.bounds_of(instance);
        self.pose = pose_of(world, instance);
    }
}

/// Whether a transform reverses the winding of triangles.
pub fn mirrors(transform: &Affine3A) -> bool {
    transform.matrix3.determinant() < 0.0
}

/// Properties of the draw call of an instance with this material.
fn class_of(material: &Material, transform: &Affine3A, shape: DrawShape) -> DrawClass {
    DrawClass {
        cutout: material.alpha_cutoff.is_some(),
        double_sided: material.double_sided,
        mirrored: mirrors(transform),
        shape,
    }
}

/// Buffers of all meshes and instances, for indexed drawing.
#[derive(Clone, Copy, Debug)]
pub struct Indexed<'a> {
    /// Vertices: [`GpuVertex`].
    pub vertices: &'a wgpu::Buffer,
    /// Indices of 32 bits; the buffer also holds other data between the meshes.
    pub indices: &'a wgpu::Buffer,
    /// Instances: [`GpuInstance`].
    pub instances: &'a wgpu::Buffer,
}

impl Indexed<'_> {
    /// Inputs of vertex shaders: the position at location 0, and the rows of the transform to the world from 1 on.
    pub const LAYOUTS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &wgpu::vertex_attr_array![0 => Float32x3],
        }),
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<GpuInstance>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &wgpu::vertex_attr_array![1 => Float32x4, 2 => Float32x4, 3 => Float32x4],
        }),
    ];

    /// Binds the vertex, instance and index buffers.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

/// Runs of draw calls whose instances follow each other and have the same mesh: the first call of each, and the
/// range of the instances.
pub fn merged<'a>(
    draws: impl Iterator<Item = &'a Draw>,
) -> impl Iterator<Item = (&'a Draw, Range<u32>)> {
    let mut draws = draws.peekable();
    std::iter::from_fn(move || {
        let first = draws.next()?;
        let mut end = first.instance + 1;
        while let Some(next) =
            draws.next_if(|next| next.instance == end && next.indices == first.indices)
        {
            end = next.instance + 1;
        }
        Some((first, first.instance..end))
    })
}

/// Draw calls of all instances that have triangles.
pub fn draws(world: &World, mesh_ranges: &[MeshRange]) -> Vec<Draw> {
    let draw = |(i, instance): (usize, &Instance)| {
        let range = mesh_ranges[instance.mesh];
        (range.index_count > 0).then(|| Draw {
            instance: i as u32,
            indices: range.index_base..range.index_base + range.index_count,
            vertex_base: range.vertex_base as i32,
            bounds: world.bounds_of(instance),
            class: class_of(
                &world.materials[instance.material],
                &instance.world_from_object,
                range.shape,
            ),
            dynamic: instance.dynamic,
            hides_backs: false,
            pose: pose_of(world, instance),
            casts_shadow: instance.shown.casts_shadow
                && (world.materials[instance.material].transmission)
                    .is_none_or(|share| share < 0.5),
            shown: instance.shown,
        })
    };
    world
        .instances
        .iter()
        .enumerate()
        .filter_map(draw)
        .collect()
}

fn pose_of(world: &World, instance: &Instance) -> u64 {
    let place = instance.world_from_object.to_cols_array();
    let shape = world.deformed.get(&instance.mesh).map_or(0, |d| d.hash);
    xxh3_64_with_seed(bytemuck::cast_slice(&place), shape)
}
