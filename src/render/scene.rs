//! Scene upload: buffers, texture pools and draw calls; group 1 of every shader.

use std::ops::Range;

use glam::Affine3A;

use reflet_gpu::{Gpu, GpuError};
use reflet_world::{
    Instance, World,
    bvh::{CwBvhNode, TraceInstance, TraceTriangle, Trees},
};

use super::{
    chunks::{Chunks, chunk_of},
    draw::{Draw, Indexed, draws, mirrors},
    emitters::{GpuEmitters, NO_LIGHT_TREE},
    geometry::{MeshRange, geometry, mesh_vertices},
    gpu_material::gpu_material,
    mesh_array::MeshArray,
    panorama::GpuPanorama,
    records::{RecordArray, are_texels_preferred},
    texel_array::TexelArray,
    textures::{Pools, samplers},
    tree_array::TreeArray,
    types::{
        FLAG_CAPSULE_NORMALS, FLAG_COLORS, FLAG_EMITTER, FLAG_MIRRORED, FLAG_TRACED, GpuInstance,
        flag,
    },
};

/// A scene on the GPU.
#[derive(Debug)]
pub struct GpuScene {
    /// Nodes of the BVHs.
    pub nodes: TreeArray,
    /// Triangles in leaf order.
    pub triangles: TreeArray,
    /// Instances, parallel to [`World::instances`].
    pub instances: RecordArray,
    /// Attributes of all meshes; also the vertex buffer.
    pub vertices: MeshArray,
    /// Indices and second texture coordinates; also the index buffer.
    pub mesh_data: MeshArray,
    /// Materials, parallel to [`World::materials`].
    pub materials: RecordArray,
    /// Texture pools with all images.
    pub pools: Pools,
    /// Samplers with repeat/repeat, repeat/clamp, clamp/repeat, clamp/clamp along u and v.
    pub samplers: [wgpu::Sampler; 4],
    /// Panorama of the environment, if it has one.
    pub panorama: Option<GpuPanorama>,
    /// Light trees of emissive triangles, if there are any.
    pub emitters: Option<GpuEmitters>,
    /// Draw calls, one for each instance that has triangles.
    pub draws: Vec<Draw>,
    /// Number of shader bindings of the geometry's arrays.
    pub chunks: Chunks,
    mesh_ranges: Vec<MeshRange>,
    /// Whether the reflections of an instance are traced at once, by index; those past the end are marched.
    traced: Vec<bool>,
    /// Whether the alpha of some cut-out material may change.
    pub has_moving_cutouts: bool,
}

impl GpuScene {
    /// Uploads a world and its BVHs.
    ///
    /// # Errors
    /// A buffer past the adapter's limit, named in the message, or a wgpu error.
    pub fn new(gpu: &Gpu, world: &World, trees: &Trees) -> Result<Self, GpuError> {
        let (vertices, mesh_data, mesh_ranges) = geometry(gpu, world)?;
        let pools = Pools::new(gpu, world)?;
        let (instances, materials) = records(gpu, world, trees, (&mesh_ranges, &[]), &pools)?;
        let panorama = world.environment.panorama.as_deref();
        let (nodes, triangles) = tree_arrays(gpu, trees)?;
        Ok(Self {
            panorama: panorama.map(|p| GpuPanorama::new(gpu, p)).transpose()?,
            chunks: chunks(
                gpu,
                (&nodes, &triangles),
                (&vertices, &mesh_data),
                &instances,
            )?,
            nodes,
            triangles,
            emitters: GpuEmitters::new(gpu, world)?,
            instances,
            traced: Vec::new(),
            vertices,
            mesh_data,
            materials,
            samplers: samplers(gpu),
            draws: draws(world, &mesh_ranges),
            mesh_ranges,
            pools,
            has_moving_cutouts: has_moving_cutouts(world),
        })
    }

    /// A scene with the same meshes and images, and the materials, instances and, if `new_trees`, the BVHs of
    /// another world.
    ///
    /// # Errors
    /// Same errors as [`GpuScene::new`].
    pub fn with_materials(
        &self,
        gpu: &Gpu,
        world: &World,
        trees: &Trees,
        new_trees: bool,
    ) -> Result<Self, GpuError> {
        // A material's sampler settings may need an image resampled in another way.
        let pools = match self.pools.layers.cover(world) {
            true => self.pools.clone(),
            false => Pools::new(gpu, world)?,
        };
        let (nodes, triangles) = if new_trees {
            tree_arrays(gpu, trees)?
        } else {
            (self.nodes.clone(), self.triangles.clone())
        };
        let kept = (self.mesh_ranges.as_slice(), self.traced.as_slice());
        let (instances, materials) = records(gpu, world, trees, kept, &pools)?;
        let meshes = (&self.vertices, &self.mesh_data);
        Ok(Self {
            chunks: chunks(gpu, (&nodes, &triangles), meshes, &instances)?,
            nodes,
            triangles,
            instances,
            traced: self.traced.clone(),
            vertices: self.vertices.clone(),
            mesh_data: self.mesh_data.clone(),
            materials,
            samplers: self.samplers.clone(),
            draws: draws(world, &self.mesh_ranges),
            mesh_ranges: self.mesh_ranges.clone(),
            pools,
            panorama: self.panorama.clone(),
            emitters: GpuEmitters::new(gpu, world)?,
            has_moving_cutouts: has_moving_cutouts(world),
        })
    }

    /// Sets for all draw calls whether they hide back faces, found once per mesh from its edges.
    pub fn find_backs(&mut self, world: &World) {
        for draw in &mut self.draws {
            draw.hides_backs = world.hides_backs(&world.instances[draw.instance as usize]);
        }
    }

    /// Uploads the vertices of deformed meshes, and their BVHs.
    pub fn update_deformed(&self, gpu: &Gpu, world: &World, trees: &Trees) {
        for mesh in world.deformed.keys() {
            let posed = world.posed(*mesh);
            let vertices: Vec<_> = mesh_vertices(&world.meshes[*mesh], &posed).collect();
            let first = self.mesh_ranges[*mesh].vertex_base as usize;
            self.vertices.write(gpu, first, &vertices);
        }
        for (nodes, triangles) in trees.deformed_ranges() {
            self.nodes.write(gpu, nodes.start, &trees.nodes[nodes]);
            let moved = &trees.triangles[triangles.clone()];
            self.triangles.write(gpu, triangles.start, moved);
        }
    }

    /// Uploads the poses of a world whose instances moved, and the top level over them.
    pub fn update(&mut self, gpu: &Gpu, world: &World, trees: &Trees) {
        for draw in self.draws.iter_mut().filter(|draw| draw.dynamic) {
            draw.pose(world);
        }
        let mut end = 0;
        for run in world.instances.chunk_by(|a, b| a.dynamic == b.dynamic) {
            let range = end..end + run.len();
            end = range.end;
            if run[0].dynamic {
                self.write_instances(gpu, world, trees, range);
            }
        }
        let range = trees.top_range.clone();
        if trees.is_built() && world.instances.iter().any(|i| i.dynamic) {
            self.nodes.write(gpu, range.start, &trees.nodes[range]);
        }
        self.update_deformed(gpu, world, trees);
    }

    fn write_instances(&self, gpu: &Gpu, world: &World, trees: &Trees, range: Range<usize>) {
        let (first, kept) = (range.start, (&*self.mesh_ranges, &*self.traced));
        let records: Vec<_> = instance_records(world, trees, kept, range).collect();
        self.instances.write(gpu, first, &records);
    }

    /// Sets for each instance whether its reflections are traced at once rather than marched, by index; those past the
    /// end are marched.
    pub fn set_traced(&mut self, gpu: &Gpu, world: &World, trees: &Trees, traced: Vec<bool>) {
        if self.traced != traced {
            self.traced = traced;
            self.write_instances(gpu, world, trees, 0..world.instances.len());
        }
    }

    /// Where the parts of the light tree begin: [`GpuEmitters::light_tree`].
    pub fn light_tree(&self) -> [u32; 4] {
        let emitters = self.emitters.as_ref();
        emitters.map_or(NO_LIGHT_TREE, |e| e.light_tree)
    }

    /// Uploads the light trees, if emissive triangles moved or changed.
    pub fn update_emitters(&mut self, gpu: &Gpu, world: &World) {
        if let Some(emitters) = &mut self.emitters {
            emitters.update(gpu, world);
        }
    }

    /// Uploads the parameters of materials that may change.
    pub fn update_materials(&self, gpu: &Gpu, world: &World) {
        for moving in &world.moving.materials {
            let material = &world.materials[moving.material];
            let record = gpu_material(material, world, &self.pools.layers);
            self.materials.write(gpu, moving.material, &[record]);
        }
    }

    /// Buffers for indexed drawing; `None` where the geometry needs more than one buffer.
    pub fn indexed(&self) -> Option<Indexed<'_>> {
        Some(Indexed {
            vertices: self.vertices.whole()?,
            indices: self.mesh_data.whole()?,
            instances: self.instances.buffer(),
        })
    }

    /// The resource with this name in group 1, if there is one.
    pub fn resource(&self, name: &str) -> Option<wgpu::BindingResource<'_>> {
        let view = |pool: usize, srgb: usize| {
            Some(wgpu::BindingResource::TextureView(
                &self.pools.views[pool][srgb],
            ))
        };
        let sampler = |i: usize| Some(wgpu::BindingResource::Sampler(&self.samplers[i]));
        match name {
            "instances" => Some(self.instances.resource()),
            "emitters" => self.emitters.as_ref().map(GpuEmitters::resource),
            "materials" => Some(self.materials.resource()),
            "pool_0" => view(0, 0),
            "pool_0_srgb" => view(0, 1),
            "pool_1" => view(1, 0),
            "pool_1_srgb" => view(1, 1),
            "pool_2" => view(2, 0),
            "pool_2_srgb" => view(2, 1),
            "sampler_rr" => sampler(0),
            "sampler_rc" => sampler(1),
            "sampler_cr" => sampler(2),
            "sampler_cc" => sampler(3),
            _ => {
                let (array, chunk) = chunk_of(name);
                match array {
                    "nodes" => self.nodes.binding(chunk),
                    "triangles" => self.triangles.binding(chunk),
                    "vertices" => self.vertices.binding(chunk),
                    "mesh_data" => self.mesh_data.binding(chunk),
                    _ => None,
                }
            }
        }
    }

    /// Name and bytes of each buffer and texture class.
    pub fn report(&self) -> Vec<(&'static str, u64)> {
        vec![
            ("tree_nodes", self.nodes.size()),
            ("tree_triangles", self.triangles.size()),
            ("instances", self.instances.size()),
            ("vertices", self.vertices.size()),
            ("mesh_data", self.mesh_data.size()),
            ("materials", self.materials.size()),
            ("texture_pools", self.pools.bytes),
            ("panorama", self.panorama.as_ref().map_or(0, |p| p.bytes)),
            (
                "emitters",
                self.emitters.as_ref().map_or(0, GpuEmitters::bytes),
            ),
        ]
    }
}

/// Uploads instances and materials.
fn records(
    gpu: &Gpu,
    world: &World,
    trees: &Trees,
    kept: (&[MeshRange], &[bool]),
    pools: &Pools,
) -> Result<(RecordArray, RecordArray), GpuError> {
    let (instances, materials) = (&world.instances, &world.materials);
    let in_texels = are_texels_preferred(gpu, instances.len(), materials.len());
    let instances = instance_records(world, trees, kept, 0..instances.len());
    let materials = materials.iter();
    let materials = materials.map(|m| gpu_material(m, world, &pools.layers));
    let vertex = wgpu::BufferUsages::VERTEX;
    let none = wgpu::BufferUsages::empty();
    Ok((
        RecordArray::new(gpu, "instances", instances, vertex, in_texels)?,
        RecordArray::new(gpu, "materials", materials, none, in_texels)?,
    ))
}

/// Number of shader bindings of the BVHs and the meshes.
fn chunks(
    gpu: &Gpu,
    (nodes, triangles): (&TreeArray, &TreeArray),
    (vertices, mesh_data): (&MeshArray, &MeshArray),
    instances: &RecordArray,
) -> Result<Chunks, GpuError> {
    let bytes = nodes.size() + triangles.size() + vertices.size() + mesh_data.size();
    let chunks = Chunks {
        nodes: nodes.count(),
        triangles: triangles.count(),
        tree_texels: nodes.is_texels(),
        vertices: vertices.count(),
        mesh_data: mesh_data.count(),
        mesh_texels: vertices.is_texels(),
        record_texels: instances.is_texels(),
        ..Chunks::WHOLE
    };
    chunks.on(gpu, bytes)
}

/// Uploads nodes and triangles of the BVHs.
fn tree_arrays(gpu: &Gpu, trees: &Trees) -> Result<(TreeArray, TreeArray), GpuError> {
    let (nodes, triangles) = (trees.nodes.as_slice(), trees.triangles.as_slice());
    let in_texels = TexelArray::is_preferred::<CwBvhNode>(gpu, nodes.len())
        && TexelArray::is_preferred::<TraceTriangle>(gpu, triangles.len());
    Ok((
        TreeArray::new(gpu, "tree nodes", nodes, in_texels)?,
        TreeArray::new(gpu, "tree triangles", triangles, in_texels)?,
    ))
}

fn rows(transform: &Affine3A) -> [[f32; 4]; 3] {
    let m = transform.matrix3;
    let t = transform.translation;
    [0, 1, 2].map(|r| [m.x_axis[r], m.y_axis[r], m.z_axis[r], t[r]])
}

fn has_moving_cutouts(world: &World) -> bool {
    let mut moving = world.moving.materials.iter();
    moving.any(|m| world.materials[m.material].alpha_cutoff.is_some())
}

/// Records of a range of the instances of a world in its pose, with the ranges of its meshes and the instances whose
/// reflections are traced at once.
fn instance_records(
    world: &World,
    trees: &Trees,
    (mesh_ranges, unmarched): (&[MeshRange], &[bool]),
    range: Range<usize>,
) -> impl ExactSizeIterator<Item = GpuInstance> + Clone {
    let record = move |(index, (instance, traced)): (usize, (&Instance, &TraceInstance))| {
        let is_traced = unmarched.get(index).copied().unwrap_or(false);
        let range = mesh_ranges[instance.mesh];
        let mesh = &world.meshes[instance.mesh];
        let radius = mesh.capsule_radius_m;
        let has_capsule_normals = radius.is_some() && !mesh.normals.is_empty();
        let is_sampled = world.materials[instance.material].light && radius.is_none();
        GpuInstance {
            world_from_object: rows(&instance.world_from_object),
            object_from_world: traced.object_from_world,
            tree_root: traced.tree_root,
            trace_flags: traced.trace_flags,
            vertex_base: range.vertex_base,
            index_base: range.index_base,
            uv1_base: range.uv1_base,
            material: instance.material as u32,
            flags: flag(mirrors(&instance.world_from_object), FLAG_MIRRORED)
                | flag(range.has_colors, FLAG_COLORS)
                | flag(is_sampled, FLAG_EMITTER)
                | flag(is_traced, FLAG_TRACED)
                | flag(has_capsule_normals, FLAG_CAPSULE_NORMALS),
            capsule_radius_m: radius.unwrap_or(0.0),
        }
    };
    let instances = world.instances[range.clone()].iter();
    let pairs = instances.zip(&trees.instances[range.clone()]);
    (range.zip(pairs)).map(record)
}

const _: () = assert!(size_of::<TraceTriangle>() == 48 && size_of::<CwBvhNode>() == 80);
