//! Light trees on the GPU: how shaders choose emissive triangles and lamps.

use reflet_gpu::{Gpu, GpuError};
use reflet_scene::desc::ShadowMode;
use reflet_world::{
    Light, World,
    light_tree::{LIGHT_LEAF, LIGHT_NODE_VECTORS, LightTrees, NO_NODE, Node, PlacedLight, Tree},
};

use crate::{
    buffers::texel_array::TexelArray,
    layout::{gpu_struct::Shared as _, types::LightTree},
    lighting::{lights::gpu_light, shown_light::ShownLight},
};

/// Parameters of shaders for a world without a light tree.
pub const NO_LIGHT_TREE: LightTree = LightTree {
    root: NO_NODE,
    ..LightTree::ZERO
};

/// Number of vectors of a placed light and of a lamp's record.
pub const LIGHT_VECTORS: usize = 4;

/// First word of a lamp's record, whose lowest three bits are the kind; a placed light has a link there.
pub const LAMP_RECORD: u32 = 0xffff_ffe0;

/// Bit of the first word of a lamp's record: the picture shows another light group.
pub const DARK_LAMP: u32 = 8;

/// Bit of the first word of a lamp's record: reflections do not show the lamp.
pub const UNREFLECTED_LAMP: u32 = 16;

/// The light trees on the GPU, in an array of vectors: for each instance the index of its placed light; placed lights,
/// then lamps; nodes, of the upper tree first; for each triangle of each mesh its node.
#[derive(Clone, Debug)]
pub struct GpuEmitters {
    array: TexelArray,
    trees: LightTrees,
    /// The world's lamps at the last upload.
    lamps: Vec<Light>,
    parts: Parts,
    /// Vectors where placed lights, nodes and nodes of triangles begin, and the link of the root.
    pub light_tree: LightTree,
    /// Whether the trees of surfaces may differ from frame to frame.
    is_moving: bool,
}

/// Vectors where the parts of the array begin, and the end of the last one.
#[derive(Clone, Copy, Debug)]
struct Parts {
    lights: usize,
    nodes: usize,
    places: usize,
    end: usize,
}

impl Parts {
    /// Sizes that hold all trees of a world in this pose, or with `in_any_pose` in every pose.
    fn for_world(world: &World, trees: &LightTrees, in_any_pose: bool) -> Self {
        let meshes: Vec<usize> = match in_any_pose {
            true => (world.lighting_instances())
                .map(|(_, i)| world.meshes[i.mesh].triangles.len())
                .collect(),
            false => trees.meshes.iter().map(|m| m.places.len()).collect(),
        };
        let lights = world.instances.len().div_ceil(4);
        let items = trees.lights.len() + trees.lamp_nodes.len();
        let nodes = lights + LIGHT_VECTORS * items;
        // A tree has less than two nodes for each item; its nodes come in pairs.
        let triangles: usize = meshes.iter().sum();
        let places = nodes + LIGHT_NODE_VECTORS * 2 * (items + triangles);
        let words: usize = meshes.iter().map(|count| count.next_multiple_of(4)).sum();
        Self {
            lights,
            nodes,
            places,
            end: places + words / 4,
        }
    }
}

impl GpuEmitters {
    /// Uploads the light trees of a world, of whose lamps a part is shown; `None` where nothing is sampled as a light.
    ///
    /// # Errors
    /// A wgpu error.
    pub fn new(gpu: &Gpu, world: &World, shown: ShownLight) -> Result<Option<Self>, GpuError> {
        if !world.has_emitters() {
            return Ok(None);
        }
        let trees = LightTrees::new(world, None);
        let is_moving = world.has_moving_emitters();
        let parts = Parts::for_world(world, &trees, is_moving);
        let mut this = Self {
            array: TexelArray::sized::<[u32; 4]>(gpu, "emitters", parts.end)?,
            trees,
            lamps: world.lamps.clone(),
            parts,
            light_tree: NO_LIGHT_TREE,
            is_moving,
        };
        this.upload(gpu, world, shown, true);
        gpu.finish_writes()?;
        Ok(Some(this))
    }

    /// Uploads the trees again, if emitters may have moved: trees of meshes only if one changed.
    pub fn update(&mut self, gpu: &Gpu, world: &World, shown: ShownLight) {
        if !self.is_moving && self.lamps == world.lamps {
            return;
        }
        let trees = LightTrees::new(world, Some(&self.trees));
        let are_meshes_kept = trees.has_meshes_of(&self.trees);
        self.trees = trees;
        self.lamps.clone_from(&world.lamps);
        self.upload(gpu, world, shown, !are_meshes_kept);
    }

    /// Has lamps of other light groups than the shown one give no light; random choices stay.
    pub fn show_light(&mut self, gpu: &Gpu, world: &World, shown: ShownLight) {
        self.upload(gpu, world, shown, false);
    }

    fn upload(&mut self, gpu: &Gpu, world: &World, shown: ShownLight, with_meshes: bool) {
        let bases = self.mesh_bases();
        let parts = &self.parts;
        self.array.write(gpu, 0, &self.index(world.instances.len()));
        let lamps = world.lamps.iter().zip(&self.trees.lamp_nodes);
        let lights: Vec<_> = (self.trees.lights.iter())
            .flat_map(|light| self.light(light, &bases))
            .chain(lamps.flat_map(|(lamp, node)| shown_record(lamp, *node, shown)))
            .collect();
        self.array.write(gpu, parts.lights, &lights);
        let root = self.trees.top.as_ref().map_or(NO_NODE, |top| top.link);
        if let Some(top) = &self.trees.top {
            self.array.write(gpu, parts.nodes, &vectors(top, 0));
        }
        let meshes = self.trees.meshes.iter().zip(&bases);
        for (mesh, [nodes, places]) in meshes.filter(|_| with_meshes) {
            if let Some(tree) = &mesh.tree {
                let at = parts.nodes + LIGHT_NODE_VECTORS * *nodes as usize;
                self.array.write(gpu, at, &vectors(tree, *nodes));
            }
            let placed = mesh.places.iter().map(|place| linked(*place, *nodes));
            let at = parts.places + *places as usize / 4;
            self.array.write(gpu, at, &in_fours(placed));
        }
        self.light_tree = LightTree {
            lights: parts.lights as u32,
            nodes: parts.nodes as u32,
            places: parts.places as u32,
            root,
        };
    }

    /// First node and first word of triangles of each mesh's tree.
    fn mesh_bases(&self) -> Vec<[u32; 2]> {
        let items = self.trees.lights.len() + self.trees.lamp_nodes.len();
        let mut next = [2 * items, 0];
        let bases = self.trees.meshes.iter().map(|mesh| {
            let [nodes, places] = next;
            let used = mesh.tree.as_ref().map_or(0, |tree| tree.nodes.len());
            next = [nodes + used, places + mesh.places.len().next_multiple_of(4)];
            [nodes as u32, places as u32]
        });
        bases.collect()
    }

    /// Indices of placed lights, by instance.
    fn index(&self, instances: usize) -> Vec<[u32; 4]> {
        let mut index = vec![0; instances];
        for (light, number) in self.trees.lights.iter().zip(0..) {
            index[light.instance as usize] = number;
        }
        in_fours(index.into_iter())
    }

    fn light(&self, light: &PlacedLight, bases: &[[u32; 2]]) -> [[u32; 4]; LIGHT_VECTORS] {
        let [nodes, places] = bases[light.mesh_tree];
        let tree = self.trees.meshes[light.mesh_tree].tree.as_ref();
        let root = tree.map_or(NO_NODE, |tree| linked(tree.link, nodes));
        let m = light.tree_from_world.matrix3;
        let t = light.tree_from_world.translation;
        let row = |r: usize| [m.x_axis[r], m.y_axis[r], m.z_axis[r], t[r]].map(f32::to_bits);
        let bits = light.instance << 2 | light.sides as u32;
        [[root, places, light.node, bits], row(0), row(1), row(2)]
    }

    /// Binding of the array for shaders.
    pub fn resource(&self) -> wgpu::BindingResource<'_> {
        self.array.resource()
    }

    /// Size in bytes.
    pub fn bytes(&self) -> u64 {
        self.array.size()
    }
}

/// Record of a lamp, which is dark where its light is not shown.
fn shown_record(lamp: &Light, node: u32, shown: ShownLight) -> [[u32; 4]; LIGHT_VECTORS] {
    let mut record = lamp_record(lamp, node);
    if !shown.shows(lamp.desc.light_group) {
        record[0][0] |= DARK_LAMP;
    }
    record
}

/// Record of a lamp whose place in the upper tree is `node`; see `shaders/lib/lamps.wgsl`.
pub(crate) fn lamp_record(lamp: &Light, node: u32) -> [[u32; 4]; LIGHT_VECTORS] {
    let light = gpu_light(lamp, ShadowMode::Ray);
    let half_v = glam::Vec3::from(light.half_v).length();
    let form = match lamp.desc.kind.cone_deg() {
        Some(_) => [light.spot_scale, light.spot_offset, 0.0],
        None => light.half_u,
    };
    let row =
        |[x, y, z]: [f32; 3], channel: usize| [x, y, z, light.color[channel]].map(f32::to_bits);
    let extent = light.extent.max(half_v).to_bits();
    [
        [
            LAMP_RECORD | light.kind | ((1 - light.reflected) * UNREFLECTED_LAMP),
            light.range_m.to_bits(),
            node,
            extent,
        ],
        row(light.position, 0),
        row(light.direction, 1),
        row(form, 2),
    ]
}

/// A link, or the index of a node, of a tree whose nodes begin at `first`. Items and marks stay.
fn linked(link: u32, first: u32) -> u32 {
    match link & LIGHT_LEAF {
        0 => link + first,
        _ => link,
    }
}

/// Nodes of a tree that begin at node `first`.
fn vectors(tree: &Tree, first: u32) -> Vec<[u32; 4]> {
    let node = |node: &Node| {
        let [a, b, c, d, e, f, link, parent] = node.words();
        [
            [a, b, c, d],
            [e, f, linked(link, first), linked(parent, first)],
        ]
    };
    tree.nodes.iter().flat_map(node).collect()
}

/// Words in vectors of four, the last one filled up with 0.
fn in_fours(words: impl ExactSizeIterator<Item = u32>) -> Vec<[u32; 4]> {
    let mut fours = vec![[0; 4]; words.len().div_ceil(4)];
    for (index, word) in words.enumerate() {
        fours[index / 4][index % 4] = word;
    }
    fours
}
