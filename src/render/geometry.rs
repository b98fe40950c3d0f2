//! Packing of meshes into the shared vertex and index buffers.

use bytemuck::{Pod, cast_slice};
use glam::{Vec3, Vec4};

use crate::{
    gpu::{Gpu, GpuError},
    world::{Mesh, Posed, World},
};

use super::{
    chunks::ChunkedArray,
    types::{GpuVertex, NONE},
};

/// Ranges of a mesh in the shared buffers.
#[derive(Clone, Copy, Debug)]
pub struct MeshRange {
    /// First vertex.
    pub vertex_base: u32,
    /// First index in `mesh_data`.
    pub index_base: u32,
    /// Three a triangle.
    pub index_count: u32,
    /// First second texture coordinate in `mesh_data`; [`NONE`] without.
    pub uv1_base: u32,
    /// Whether its vertices have colors.
    pub has_colors: bool,
}

/// An initialized buffer, never of zero size.
///
/// # Errors
/// A size past the adapter's limit, by `name`, or a wgpu error.
pub fn buffer<T: Pod>(
    gpu: &Gpu,
    name: &str,
    data: &[T],
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, GpuError> {
    let bytes: &[u8] = cast_slice(data);
    let size = (bytes.len().max(size_of::<T>()).max(16) as u64).next_multiple_of(16);
    gpu.check_storage_size(name, size)?;
    let buffer = gpu.scoped(name, || {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    })?;
    gpu.queue.write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

/// Bytes of all vertices, and of all indices and second texture coordinates.
pub fn geometry_bytes(world: &World) -> (u64, u64) {
    let sum = |bytes: fn(&Mesh) -> usize| world.meshes.iter().map(bytes).sum::<usize>() as u64;
    (
        sum(|m| m.positions.len() * size_of::<GpuVertex>()),
        sum(|m| m.triangles.len() * 12 + m.uv1.len() * 8),
    )
}

/// The vertices, the indices and the ranges of each mesh.
///
/// # Errors
/// A wgpu error.
pub fn geometry(
    gpu: &Gpu,
    world: &World,
) -> Result<(ChunkedArray, ChunkedArray, Vec<MeshRange>), GpuError> {
    let mut vertices: Vec<GpuVertex> = Vec::new();
    let mut data: Vec<u32> = Vec::new();
    let mut ranges = Vec::with_capacity(world.meshes.len());
    for (index, mesh) in world.meshes.iter().enumerate() {
        let range = MeshRange {
            vertex_base: vertices.len() as u32,
            index_base: data.len() as u32,
            index_count: 3 * mesh.triangles.len() as u32,
            uv1_base: if mesh.uv1.is_empty() {
                NONE
            } else {
                (data.len() + 3 * mesh.triangles.len()) as u32
            },
            has_colors: !mesh.colors.is_empty(),
        };
        data.extend(mesh.triangles.iter().flatten());
        data.extend(
            mesh.uv1
                .iter()
                .flat_map(|uv| [uv.x.to_bits(), uv.y.to_bits()]),
        );
        vertices.extend(mesh_vertices(mesh, &world.posed(index)));
        ranges.push(range);
    }
    let storage = wgpu::BufferUsages::STORAGE;
    Ok((
        ChunkedArray::new(
            gpu,
            "vertices",
            &vertices,
            storage | wgpu::BufferUsages::VERTEX,
        )?,
        ChunkedArray::new(gpu, "mesh data", &data, storage | wgpu::BufferUsages::INDEX)?,
        ranges,
    ))
}

/// The vertices of a mesh as it is posed.
pub fn mesh_vertices<'a>(
    mesh: &'a Mesh,
    posed: &'a Posed<'_>,
) -> impl Iterator<Item = GpuVertex> + 'a {
    (0..posed.positions.len()).map(|i| vertex(mesh, posed, i))
}

fn vertex(mesh: &Mesh, posed: &Posed<'_>, i: usize) -> GpuVertex {
    let tangent = posed
        .tangents
        .get(i)
        .copied()
        .unwrap_or(Vec4::new(1.0, 0.0, 0.0, 1.0));
    let color = mesh.colors.get(i).copied().unwrap_or(Vec4::ONE);
    GpuVertex {
        position: posed.positions[i].to_array(),
        normal: pack_unit(posed.normals[i]),
        uv: mesh.uv0.get(i).copied().unwrap_or_default().to_array(),
        tangent: pack_unit(tangent.truncate()) & !1 | u32::from(tangent.w >= 0.0),
        color: u32::from_le_bytes(
            color
                .to_array()
                .map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8),
        ),
    }
}

/// Octahedral map, two signed 16-bit numbers; `unpack_unit` in `shaders/lib/pack.wgsl` undoes it.
fn pack_unit(n: Vec3) -> u32 {
    let p = n / (n.x.abs() + n.y.abs() + n.z.abs()).max(1e-20);
    let wrap = |a: f32, b: f32| (1.0 - b.abs()) * if a >= 0.0 { 1.0 } else { -1.0 };
    let [x, y] = if p.z >= 0.0 {
        [p.x, p.y]
    } else {
        [wrap(p.x, p.y), wrap(p.y, p.x)]
    };
    let snorm = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    snorm(x) | snorm(y) << 16
}
