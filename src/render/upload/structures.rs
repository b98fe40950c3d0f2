//! Acceleration structures of the device, for ray queries: one bottom structure for the static tree, one for each mesh
//! tree, and a top structure over them, as the trees of [`reflet_world::bvh`] are.
//!
//! The static tree is a single structure in world space, not an instance for each mesh in it: overlapping instances
//! make a ray enter each of them, which baking spares, and equal corners make equal distances in both traversals. It is
//! an instance of the one top structure rather than a structure beside it, as a ray then needs one query.
//!
//! Triangles are in the order of the trees, so that the index of a primitive finds them in the triangle buffer. All are
//! candidates (not opaque): whether one is hit is decided by our own test in `shaders/lib/walk_query.wgsl`.

use reflet_base::processor_time::Stopwatch;
use reflet_gpu::{Gpu, GpuError};
use reflet_world::{
    World,
    bvh::{MOVES, MeshTree, SHADOWLESS, TraceTriangle, Trees, UNREFLECTED, UNSEEN, leaf_corners},
};

use super::instance_records::{rows, trace_flags};

/// Bit of a structure's mask: reflected rays, and rays that come through glass, meet it.
pub const SEEN_BY_REFLECTIONS: u32 = 1;
/// Bit of a structure's mask: camera rays meet it.
pub const SEEN_BY_CAMERA: u32 = 2;
/// Bit of a structure's mask: shadow rays meet it.
pub const SEEN_BY_LIGHTS: u32 = 4;
/// Number of bits by which these are shifted for moving instances.
pub const MOVING_SHIFT: u32 = 3;
/// Number of the static tree in place of an instance; the most that 24 bits hold.
pub const STATIC_STRUCTURE: u32 = (1 << 24) - 1;

/// Bytes of a triangle's corners.
const CORNER_BYTES: u64 = 36;
/// Bytes of the box of a capsule.
const BOX_BYTES: u64 = wgpu::AABB_GEOMETRY_MIN_STRIDE;

/// A bottom structure.
#[derive(Clone, Debug)]
struct Bottom {
    blas: wgpu::Blas,
    /// The mesh tree that it has the triangles of; `None` for the static tree.
    tree: Option<MeshTree>,
    size: Size,
    /// Corners or boxes; kept for deformed meshes only.
    input: Option<wgpu::Buffer>,
}

/// Kind and number of primitives of a bottom structure.
#[derive(Clone, Debug)]
enum Size {
    Triangles(wgpu::BlasTriangleGeometrySizeDescriptor),
    Boxes(wgpu::BlasAABBGeometrySizeDescriptor),
}

/// The acceleration structures of a scene.
#[derive(Clone, Debug)]
pub struct Structures {
    bottom: Vec<Bottom>,
    top: wgpu::Tlas,
    /// Size of all structures, bytes, where the driver's allocator tells it; else 0.
    pub bytes: u64,
    /// Time in which they were built, milliseconds: processor time on software adapters.
    pub build_ms: f64,
    /// Time in which the structures of deformed meshes and the top structure were last built for another pose,
    /// milliseconds; 0 where they never were.
    pub update_ms: f64,
}

impl Structures {
    /// Builds the structures of a world and its trees.
    ///
    /// # Errors
    /// More triangles or instances than the device's structures hold, a lost device, exhausted memory.
    pub fn new(
        gpu: &Gpu,
        world: &World,
        trees: &Trees,
        skipped: &[bool],
    ) -> Result<Self, GpuError> {
        let whole = (trees.static_triangles > 0).then_some(None);
        let of_meshes = trees.mesh_trees.iter().filter(|t| !t.triangles.is_empty());
        let owners: Vec<Option<&MeshTree>> = whole.into_iter().chain(of_meshes.map(Some)).collect();
        let instances = trees.top_instances.len() as u32 + 1;
        check(
            "the instances of the scene",
            instances.into(),
            gpu.limits.max_tlas_instance_count.min(STATIC_STRUCTURE),
        )?;
        let before = allocated(gpu);
        let mut bottom = Vec::with_capacity(owners.len());
        for tree in owners {
            bottom.push(Bottom::new(gpu, world, trees, tree)?);
        }
        let top = gpu.scoped("the top acceleration structure", || {
            gpu.device.create_tlas(&wgpu::CreateTlasDescriptor {
                label: Some("top structure"),
                max_instances: instances,
                flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
                update_mode: wgpu::AccelerationStructureUpdateMode::Build,
            })
        })?;
        let bytes = allocated(gpu).saturating_sub(before);
        let mut structures = Self {
            bottom,
            top,
            bytes,
            build_ms: 0.0,
            update_ms: 0.0,
        };
        let watch = Stopwatch::start();
        for index in 0..structures.bottom.len() {
            // One by one, so that the corners of only one structure are in memory.
            let input = structures.bottom[index].upload(gpu, world, trees)?;
            gpu.scoped("building an acceleration structure", || {
                structures.build(gpu, &[(index, &input)], false);
            })?;
            gpu.wait()?;
            let bottom = &mut structures.bottom[index];
            if bottom.tree.as_ref().is_some_and(|tree| tree.is_deformed) {
                bottom.input = Some(input);
            }
        }
        structures.place(world, trees, skipped);
        gpu.scoped("building the top acceleration structure", || {
            structures.build(gpu, &[], true);
        })?;
        gpu.wait()?;
        structures.build_ms = watch.cost_ms(gpu.is_software());
        Ok(structures)
    }

    /// Rebuilds the structures of deformed meshes, and the top structure, for a world and trees in another pose, and
    /// waits for them, so that their time is not part of a frame's. Errors appear at the next submission.
    pub fn update(&mut self, gpu: &Gpu, world: &World, trees: &Trees, skipped: &[bool]) {
        let watch = Stopwatch::start();
        let mut deformed = Vec::new();
        for (index, bottom) in self.bottom.iter().enumerate() {
            if let Some(input) = &bottom.input {
                gpu.queue
                    .write_buffer(input, 0, &bottom.input_bytes(world, trees));
                deformed.push((index, input.clone()));
            }
        }
        let deformed: Vec<_> = deformed
            .iter()
            .map(|(index, input)| (*index, input))
            .collect();
        self.place(world, trees, skipped);
        self.build(gpu, &deformed, true);
        if gpu.wait().is_ok() {
            self.update_ms = watch.cost_ms(gpu.is_software());
        }
    }

    /// Binding of the top structure.
    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        self.top.as_binding()
    }

    /// Places the static tree and the instances that rays can hit.
    fn place(&mut self, world: &World, trees: &Trees, skipped: &[bool]) {
        let mut of_mesh = vec![None; world.meshes.len()];
        let mut placed = Vec::with_capacity(trees.placed.len() + 1);
        for bottom in &self.bottom {
            match &bottom.tree {
                Some(tree) => of_mesh[tree.mesh] = Some(&bottom.blas),
                None => placed.push(wgpu::TlasInstance::new(
                    &bottom.blas,
                    [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0],
                    STATIC_STRUCTURE,
                    // Its triangles have flags of their own.
                    (SEEN_BY_REFLECTIONS | SEEN_BY_CAMERA | SEEN_BY_LIGHTS) as u8,
                )),
            }
        }
        for id in &trees.placed {
            let instance = &world.instances[*id as usize];
            let rows = rows(&instance.world_from_object);
            let index = *id as usize;
            let mask = mask(trace_flags(&trees.instances[index], skipped, index));
            if let Some(blas) = of_mesh[instance.mesh] {
                let mut transform = [0.0; 12];
                transform.copy_from_slice(rows.as_flattened());
                placed.push(wgpu::TlasInstance::new(blas, transform, *id, mask));
            }
        }
        let slots = self.top.get().len();
        let mut placed = placed.into_iter();
        for slot in &mut self.top[0..slots] {
            *slot = placed.next();
        }
    }

    /// Submits the building of some bottom structures from their inputs, and of the top one.
    fn build(&self, gpu: &Gpu, of: &[(usize, &wgpu::Buffer)], with_top: bool) {
        let entries: Vec<_> = (of.iter())
            .map(|(index, input)| self.bottom[*index].entry(input))
            .collect();
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor {
                label: Some("acceleration structures"),
            });
        encoder.build_acceleration_structures(&entries, with_top.then_some(&self.top));
        gpu.queue.submit([encoder.finish()]);
    }
}

impl Bottom {
    fn new(
        gpu: &Gpu,
        world: &World,
        trees: &Trees,
        tree: Option<&MeshTree>,
    ) -> Result<Self, GpuError> {
        let count = tree.map_or(trees.static_triangles, |tree| tree.triangles.len());
        let what = tree.map_or_else(
            || "the static geometry".to_owned(),
            |tree| format!("mesh \"{}\"", world.meshes[tree.mesh].name),
        );
        check(&what, count as u64, gpu.limits.max_blas_primitive_count)?;
        let are_capsules =
            tree.is_some_and(|tree| world.meshes[tree.mesh].capsule_radius_m.is_some());
        // Candidates: not opaque.
        let flags = wgpu::AccelerationStructureGeometryFlags::NO_DUPLICATE_ANY_HIT_INVOCATION;
        let size = match are_capsules {
            true => Size::Boxes(wgpu::BlasAABBGeometrySizeDescriptor {
                primitive_count: count as u32,
                flags,
            }),
            false => Size::Triangles(wgpu::BlasTriangleGeometrySizeDescriptor {
                vertex_format: wgpu::VertexFormat::Float32x3,
                vertex_count: 3 * count as u32,
                index_format: None,
                index_count: None,
                flags,
            }),
        };
        let is_deformed = tree.is_some_and(|tree| tree.is_deformed);
        let descriptor = wgpu::CreateBlasDescriptor {
            label: Some("bottom structure"),
            flags: match is_deformed {
                true => wgpu::AccelerationStructureFlags::PREFER_FAST_BUILD,
                false => wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
            },
            update_mode: wgpu::AccelerationStructureUpdateMode::Build,
        };
        let sizes = match size.clone() {
            Size::Triangles(size) => wgpu::BlasGeometrySizeDescriptors::Triangles {
                descriptors: vec![size],
            },
            Size::Boxes(size) => wgpu::BlasGeometrySizeDescriptors::AABBs {
                descriptors: vec![size],
            },
        };
        let blas = gpu.scoped(&format!("the acceleration structure of {what}"), || {
            gpu.device.create_blas(&descriptor, sizes)
        })?;
        Ok(Self {
            blas,
            tree: tree.cloned(),
            size,
            input: None,
        })
    }

    /// Primitives of the structure, in the order of the tree.
    fn leaves<'a>(&self, trees: &'a Trees) -> &'a [TraceTriangle] {
        match &self.tree {
            Some(tree) => &trees.triangles[tree.triangles.clone()],
            None => &trees.triangles[..trees.static_triangles],
        }
    }

    /// Corners or boxes of the primitives.
    fn input_bytes(&self, world: &World, trees: &Trees) -> Vec<u8> {
        let leaves = self.leaves(trees);
        let mut floats: Vec<f32> = Vec::with_capacity(leaves.len() * 9);
        let mesh = self.tree.as_ref().map(|tree| tree.mesh);
        for leaf in leaves {
            match &self.size {
                Size::Triangles(_) => {
                    let corners = leaf_corners(world, mesh, leaf);
                    floats.extend(corners.iter().flat_map(|corner| corner.to_array()));
                }
                Size::Boxes(_) => {
                    let bounds = leaf.capsule_box();
                    floats.extend(bounds.min.to_array());
                    floats.extend(bounds.max.to_array());
                }
            }
        }
        bytemuck::cast_slice(&floats).to_vec()
    }

    fn upload(&self, gpu: &Gpu, world: &World, trees: &Trees) -> Result<wgpu::Buffer, GpuError> {
        let bytes = match &self.size {
            Size::Triangles(size) => CORNER_BYTES * u64::from(size.vertex_count / 3),
            Size::Boxes(size) => BOX_BYTES * u64::from(size.primitive_count),
        };
        let what = "the corners of an acceleration structure";
        gpu.check_buffer_size(what, bytes)?;
        let usage = wgpu::BufferUsages::BLAS_INPUT | wgpu::BufferUsages::COPY_DST;
        let buffer = gpu.scoped(what, || gpu.buffer("corners", bytes, usage))?;
        let data = self.input_bytes(world, trees);
        for (piece, first) in data
            .chunks(Gpu::PIECE_BYTES)
            .zip((0..).step_by(Gpu::PIECE_BYTES))
        {
            gpu.queue.write_buffer(&buffer, first, piece);
            gpu.finish_writes()?;
        }
        Ok(buffer)
    }

    fn entry<'a>(&'a self, input: &'a wgpu::Buffer) -> wgpu::BlasBuildEntry<'a> {
        wgpu::BlasBuildEntry {
            blas: &self.blas,
            geometry: match &self.size {
                Size::Triangles(size) => {
                    wgpu::BlasGeometries::TriangleGeometries(vec![wgpu::BlasTriangleGeometry {
                        size,
                        vertex_buffer: input,
                        first_vertex: 0,
                        vertex_stride: CORNER_BYTES / 3,
                        index_buffer: None,
                        first_index: None,
                        transform_buffer: None,
                        transform_buffer_offset: None,
                    }])
                }
                Size::Boxes(size) => {
                    wgpu::BlasGeometries::AabbGeometries(vec![wgpu::BlasAabbGeometry {
                        size,
                        stride: BOX_BYTES,
                        aabb_buffer: input,
                        primitive_offset: 0,
                    }])
                }
            },
        }
    }
}

/// Mask of an instance with these traversal flags.
fn mask(flags: u32) -> u8 {
    let seen = |hidden: u32, bit: u32| if flags & hidden == 0 { bit } else { 0 };
    let kinds = seen(UNREFLECTED, SEEN_BY_REFLECTIONS)
        | seen(UNSEEN, SEEN_BY_CAMERA)
        | seen(SHADOWLESS, SEEN_BY_LIGHTS);
    let shift = if flags & MOVES == 0 { 0 } else { MOVING_SHIFT };
    (kinds << shift) as u8
}

/// Bytes that the driver's allocator has given out, 0 where it does not tell.
fn allocated(gpu: &Gpu) -> u64 {
    let report = gpu.device.generate_allocator_report();
    report.map_or(0, |report| report.total_allocated_bytes)
}

fn check(what: &str, wanted: u64, limit: u32) -> Result<(), GpuError> {
    if wanted <= limit.into() {
        return Ok(());
    }
    Err(GpuError::Limit {
        what: format!("the acceleration structure of {what}"),
        wanted,
        limit: limit.into(),
        unit: "primitives",
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_of_ray_has_a_bit_for_what_rests_and_one_for_what_moves() {
        assert_eq!(mask(0), 0b111);
        assert_eq!(mask(MOVES), 0b11_1000);
        assert_eq!(mask(UNREFLECTED), 0b110);
        assert_eq!(mask(UNSEEN | SHADOWLESS | MOVES), 0b00_1000);
    }
}
