//! Scene upload: buffers, texture pools and draw calls; group 1 of every shader.

use std::ops::Range;

use reflet_gpu::{Gpu, GpuError};
use reflet_world::{
    World,
    bvh::{CwBvhNode, TraceTriangle, Trees},
};

use super::{
    decals::GpuDecals,
    draw::{Draw, Indexed, draws},
    emitters::{GpuEmitters, NO_LIGHT_TREE},
    geometry::{MeshRange, geometry, mesh_vertices},
    gpu_material::gpu_material,
    instance_records::{RecordInputs, instance_records, records},
    panorama::GpuPanorama,
    records::RecordArray,
    structures::Structures,
};
use crate::{
    buffers::{
        chunks::{Chunks, chunk_of},
        mesh_array::MeshArray,
        texel_array::TexelArray,
        textures::{Pools, samplers},
        tree_array::TreeArray,
    },
    decide::trace_choice::queries,
    layout::types::LightTree,
    lighting::shown_light::ShownLight,
    settings::options::RenderOptions,
};

/// A scene on the GPU.
#[derive(Clone, Debug)]
pub struct GpuScene {
    /// Nodes of the BVHs.
    pub nodes: TreeArray,
    /// Triangles in leaf order.
    pub triangles: TreeArray,
    /// Acceleration structures of the device, where ray queries follow the rays.
    pub structures: Option<Structures>,
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
    /// Decals, if there are any.
    pub decals: Option<GpuDecals>,
    /// Draw calls, one for each instance that has triangles.
    pub draws: Vec<Draw>,
    /// Number of shader bindings of the geometry's arrays.
    pub chunks: Chunks,
    mesh_ranges: Vec<MeshRange>,
    /// Whether reflection rays skip an instance, by index; those past the end are not skipped.
    skipped: Vec<bool>,
    /// Light that pictures show.
    pub shown_light: ShownLight,
    /// Whether the alpha of some cut-out material may change.
    pub has_moving_cutouts: bool,
}

impl GpuScene {
    /// Uploads a world and its BVHs, and builds acceleration structures of these if `queried`.
    ///
    /// # Errors
    /// A buffer past the adapter's limit, named in the message, or a wgpu error.
    pub fn new(gpu: &Gpu, world: &World, trees: &Trees, queried: bool) -> Result<Self, GpuError> {
        let (vertices, mesh_data, mesh_ranges) = geometry(gpu, world)?;
        let pools = Pools::new(gpu, world)?;
        let structures = (queried.then(|| Structures::new(gpu, world, trees, &[]))).transpose()?;
        let inputs = RecordInputs {
            mesh_ranges: &mesh_ranges,
            skipped: &[],
            shown_light: ShownLight::default(),
            queried,
        };
        let (instances, materials) = records(gpu, world, trees, inputs, &pools)?;
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
            structures,
            emitters: GpuEmitters::new(gpu, world, ShownLight::default())?,
            decals: GpuDecals::new(gpu, world),
            instances,
            skipped: Vec::new(),
            shown_light: ShownLight::default(),
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
        options: &RenderOptions,
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
        let queried = queries(trees, options);
        let structures = match &self.structures {
            _ if !queried => None,
            Some(structures) if !new_trees => Some(structures.clone()),
            _ => Some(Structures::new(gpu, world, trees, &self.skipped)?),
        };
        let inputs = RecordInputs {
            queried,
            ..self.record_inputs()
        };
        let (instances, materials) = records(gpu, world, trees, inputs, &pools)?;
        let meshes = (&self.vertices, &self.mesh_data);
        Ok(Self {
            chunks: chunks(gpu, (&nodes, &triangles), meshes, &instances)?,
            nodes,
            triangles,
            structures,
            instances,
            materials,
            draws: draws(world, &self.mesh_ranges),
            pools,
            emitters: GpuEmitters::new(gpu, world, self.shown_light)?,
            decals: GpuDecals::new(gpu, world),
            has_moving_cutouts: has_moving_cutouts(world),
            ..self.clone()
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
            self.write_reflected(gpu, trees);
        }
        self.update_deformed(gpu, world, trees);
        if let Some(decals) = &self.decals {
            decals.update(gpu, world);
        }
        if let Some(structures) = &mut self.structures
            && (!world.deformed.is_empty() || world.instances.iter().any(|i| i.dynamic))
        {
            structures.update(gpu, world, trees, &self.skipped);
        }
    }

    fn record_inputs(&self) -> RecordInputs<'_> {
        RecordInputs {
            mesh_ranges: &self.mesh_ranges,
            skipped: &self.skipped,
            shown_light: self.shown_light,
            queried: self.structures.is_some(),
        }
    }

    fn write_instances(&self, gpu: &Gpu, world: &World, trees: &Trees, range: Range<usize>) {
        let (first, inputs) = (range.start, self.record_inputs());
        let records: Vec<_> = instance_records(world, trees, inputs, range).collect();
        self.instances.write(gpu, first, &records);
    }

    /// Has surfaces and lamps of other light groups than the shown one give no light.
    pub fn show_light(&mut self, gpu: &Gpu, world: &World, trees: &Trees, shown: ShownLight) {
        self.shown_light = shown;
        self.write_instances(gpu, world, trees, 0..world.instances.len());
        if let Some(emitters) = &mut self.emitters {
            emitters.show_light(gpu, world, shown);
        }
    }

    /// Where the parts of the light tree begin: [`GpuEmitters::light_tree`].
    pub fn light_tree(&self) -> LightTree {
        let emitters = self.emitters.as_ref();
        emitters.map_or(NO_LIGHT_TREE, |e| e.light_tree)
    }

    /// Uploads the light trees, if emissive triangles moved or changed.
    pub fn update_emitters(&mut self, gpu: &Gpu, world: &World) {
        if let Some(emitters) = &mut self.emitters {
            emitters.update(gpu, world, self.shown_light);
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
            "structures" => self.structures.as_ref().map(Structures::resource),
            "instances" => Some(self.instances.resource()),
            "decals" => self.decals.as_ref().map(GpuDecals::resource),
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
            (
                "ray_structures",
                self.structures.as_ref().map_or(0, |s| s.bytes),
            ),
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
            ("decals", self.decals.as_ref().map_or(0, GpuDecals::bytes)),
        ]
    }

    /// Uploads the top level for reflection rays, where they have their own.
    pub fn write_reflected(&self, gpu: &Gpu, trees: &Trees) {
        if let Some(range) = trees.reflected_range() {
            (self.nodes).write(gpu, range.start, &trees.nodes[range]);
        }
    }

    /// Has reflection rays skip these instances, in ascending order, and no others.
    pub fn set_skipped(&mut self, gpu: &Gpu, world: &World, trees: &Trees, skipped: &[usize]) {
        let mut wanted = vec![false; skipped.last().map_or(0, |last| last + 1)];
        for index in skipped {
            wanted[*index] = true;
        }
        let was = std::mem::replace(&mut self.skipped, wanted);
        let is = |list: &[bool], index: usize| list.get(index).copied().unwrap_or(false);
        let mut changed =
            (0..world.instances.len()).filter(|i| is(&was, *i) != is(&self.skipped, *i));
        let Some(first) = changed.next() else { return };
        let last = changed.next_back().unwrap_or(first);
        self.write_instances(gpu, world, trees, first..last + 1);
        if let Some(structures) = &mut self.structures {
            structures.update(gpu, world, trees, &self.skipped);
        }
    }
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
        storage_texels: gpu.reads_storage_texels,
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

fn has_moving_cutouts(world: &World) -> bool {
    let mut moving = world.moving.materials.iter();
    moving.any(|m| world.materials[m.material].alpha_cutoff.is_some())
}

const _: () = assert!(size_of::<TraceTriangle>() == 48 && size_of::<CwBvhNode>() == 80);
