//! Packing of meshes into the shared vertex and index buffers.

use bytemuck::{Pod, cast_slice};
use glam::{Vec3, Vec4};

use reflet_gpu::{Gpu, GpuError};
use reflet_world::{Mesh, Posed, World};

use super::draw_shape::DrawShape;
use crate::{
    buffers::{
        mesh_array::{MeshArray, Upload},
        texel_array::TexelArray,
    },
    layout::{
        gpu_struct::Shared as _,
        types::{GpuVertex, NONE},
        unit_vector::pack_unit,
    },
};

/// Ranges of a mesh in the shared buffers.
#[derive(Clone, Copy, Debug)]
pub struct MeshRange {
    /// First vertex.
    pub vertex_base: u32,
    /// First index in `mesh_data`.
    pub index_base: u32,
    /// Number of indices, three per triangle.
    pub index_count: u32,
    /// Position of the first second texture coordinate in `mesh_data`; [`NONE`] without.
    pub uv1_base: u32,
    /// Whether the vertices have colors.
    pub has_colors: bool,
    /// Shape that is drawn of the mesh.
    pub shape: DrawShape,
}

/// Creates an initialized buffer, never of zero size.
///
/// # Errors
/// A size past the adapter's limit, named by `name`, or a wgpu error.
pub fn buffer<T: Pod>(
    gpu: &Gpu,
    name: &str,
    data: impl ExactSizeIterator<Item = T>,
    usage: wgpu::BufferUsages,
) -> Result<wgpu::Buffer, GpuError> {
    let size = (data.len().max(1) * size_of::<T>()).max(16) as u64;
    let size = size.next_multiple_of(16);
    gpu.check_storage_size(name, size)?;
    let usage = usage | wgpu::BufferUsages::COPY_DST;
    let buffer = gpu.scoped(name, || gpu.buffer(name, size, usage))?;
    write_in_pieces(gpu, &buffer, data)?;
    Ok(buffer)
}

/// Writes a buffer in pieces, so that few elements and wgpu's copies of them are in memory at a time.
fn write_in_pieces<T: Pod>(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    mut data: impl ExactSizeIterator<Item = T>,
) -> Result<(), GpuError> {
    let most = Gpu::PIECE_BYTES / size_of::<T>();
    let mut written = 0;
    while data.len() > 0 {
        if written > 0 {
            gpu.finish_writes()?;
        }
        let piece: Vec<T> = data.by_ref().take(most).collect();
        gpu.queue.write_buffer(buffer, written, cast_slice(&piece));
        written += size_of_val(piece.as_slice()) as u64;
    }
    Ok(())
}

/// Size of all vertices, and of all indices and second texture coordinates, bytes.
pub fn geometry_bytes(world: &World) -> (u64, u64) {
    let sum = |bytes: fn(&Mesh) -> usize| world.meshes.iter().map(bytes).sum::<usize>() as u64;
    (
        sum(|m| m.positions.len() * size_of::<GpuVertex>()),
        sum(|m| m.triangles.len() * 12 + m.uv1.len() * 8),
    )
}

/// Uploads vertices and indices, and returns their arrays and the ranges of each mesh.
///
/// # Errors
/// A wgpu error, or a lost device.
pub fn geometry(
    gpu: &Gpu,
    world: &World,
) -> Result<(MeshArray, MeshArray, Vec<MeshRange>), GpuError> {
    let mut ranges = Vec::with_capacity(world.meshes.len());
    let (mut vertex_count, mut data_count) = (0, 0);
    for mesh in &world.meshes {
        let index_count = 3 * mesh.triangles.len();
        let has_uv1 = !mesh.uv1.is_empty();
        ranges.push(MeshRange {
            vertex_base: vertex_count as u32,
            index_base: data_count as u32,
            index_count: index_count as u32,
            uv1_base: if has_uv1 {
                (data_count + index_count) as u32
            } else {
                NONE
            },
            has_colors: !mesh.colors.is_empty(),
            shape: DrawShape::for_mesh(mesh),
        });
        vertex_count += mesh.positions.len();
        data_count += index_count + 2 * mesh.uv1.len();
    }
    let storage = wgpu::BufferUsages::STORAGE;
    let usage = storage | wgpu::BufferUsages::VERTEX;
    let in_texels = TexelArray::is_preferred::<GpuVertex>(gpu, vertex_count)
        && TexelArray::is_preferred::<u32>(gpu, data_count);
    let mut vertices = Upload::new(gpu, "vertices", vertex_count, usage, in_texels)?;
    for (index, mesh) in world.meshes.iter().enumerate() {
        vertices.extend(mesh_vertices(mesh, &world.posed(index)))?;
    }
    let usage = storage | wgpu::BufferUsages::INDEX;
    let mut data = Upload::new(gpu, "mesh data", data_count, usage, in_texels)?;
    for mesh in &world.meshes {
        data.extend(mesh.triangles.iter().flatten().copied())?;
        data.extend(
            mesh.uv1
                .iter()
                .flat_map(|uv| uv.to_array())
                .map(f32::to_bits),
        )?;
    }
    Ok((vertices.finish(), data.finish(), ranges))
}

/// The vertices of a mesh in its current pose.
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
    let color = posed.colors.get(i).or(mesh.colors.get(i));
    let color = color.copied().unwrap_or(Vec4::ONE);
    let uv = posed.uv0.get(i).or(mesh.uv0.get(i));
    GpuVertex {
        position: posed.positions[i].to_array(),
        normal: pack_unit(posed.normals.get(i).copied().unwrap_or(Vec3::Z)),
        uv: uv.copied().unwrap_or_default().to_array(),
        tangent: pack_unit(tangent.truncate()) & !1 | u32::from(tangent.w >= 0.0),
        color: u32::from_le_bytes(
            color
                .to_array()
                .map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8),
        ),
        ..GpuVertex::ZERO
    }
}
