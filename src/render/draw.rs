//! What is rasterized: one draw for each instance that has triangles.

use std::ops::Range;

use glam::Affine3A;

use super::{
    geometry::MeshRange,
    types::{GpuInstance, GpuVertex},
};
use crate::{
    math::Bounds,
    scene::desc::ShownDesc,
    world::{Instance, Material, World},
};

/// How a draw is rasterized.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DrawClass {
    /// Tests alpha.
    pub cutout: bool,
    /// Double-sided.
    pub double_sided: bool,
    /// Mirrored by its transform.
    pub mirrored: bool,
}

/// One instance's draw.
#[derive(Clone, Debug)]
pub struct Draw {
    /// Index of the instance.
    pub instance: u32,
    /// Its part of `mesh_data`.
    pub indices: Range<u32>,
    /// First vertex.
    pub vertex_base: i32,
    /// World bounds.
    pub bounds: Bounds,
    /// How.
    pub class: DrawClass,
    /// Whether its pose, and with it its handedness, may change.
    pub dynamic: bool,
    /// Whether the camera, which culls its triangles from behind, may look through them; see
    /// `GpuScene::find_backs`.
    pub hides_backs: bool,
    /// Hash of the vertices of a deformed mesh, else 0.
    pub shape: u64,
    /// Whether it is drawn into shadow maps, which know no light that passes.
    pub casts_shadow: bool,
    /// Which rays see it.
    pub shown: ShownDesc,
}

impl Draw {
    /// Takes over the pose of its instance.
    pub fn pose(&mut self, world: &World) {
        let instance = &world.instances[self.instance as usize];
        self.class.mirrored = mirrors(&instance.world_from_object);
        self.bounds = world.bounds_of(instance);
        self.shape = shape_of(world, instance.mesh);
    }
}

/// Whether a transform turns triangles around.
pub fn mirrors(transform: &Affine3A) -> bool {
    transform.matrix3.determinant() < 0.0
}

/// How an instance of a material is drawn.
pub fn class_of(material: &Material, transform: &Affine3A) -> DrawClass {
    DrawClass {
        cutout: material.alpha_cutoff.is_some(),
        double_sided: material.double_sided,
        mirrored: mirrors(transform),
    }
}

/// The buffers of all meshes and instances, to draw by indices.
#[derive(Clone, Copy, Debug)]
pub struct Indexed<'a> {
    /// Of [`GpuVertex`].
    pub vertices: &'a wgpu::Buffer,
    /// 32 bits each, and other numbers between those of the meshes.
    pub indices: &'a wgpu::Buffer,
    /// Of [`GpuInstance`].
    pub instances: &'a wgpu::Buffer,
}

impl Indexed<'_> {
    /// What vertex shaders get: the position at location 0, and the rows of the transform to the world from 1 on.
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

    /// Binds them.
    pub fn bind(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.instances.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
    }
}

impl Draw {
    /// Draws it by its indices, which are bound, or has the shader pull its vertices.
    pub fn record(&self, pass: &mut wgpu::RenderPass<'_>, is_indexed: bool) {
        let instance = self.instance..self.instance + 1;
        match is_indexed {
            true => pass.draw_indexed(self.indices.clone(), self.vertex_base, instance),
            false => pass.draw(0..self.indices.len() as u32, instance),
        }
    }
}

/// One for each instance that has triangles.
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
            ),
            dynamic: instance.dynamic,
            hides_backs: false,
            shape: shape_of(world, instance.mesh),
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

fn shape_of(world: &World, mesh: usize) -> u64 {
    world.deformed.get(&mesh).map_or(0, |d| d.hash)
}
