//! Acceleration structures: BVHs built on the CPU and packed into two buffers for the GPU.
//!
//! Node buffer, 80 bytes (5 × `vec4u`) each, with absolute child and primitive indices:
//!
//! | nodes | what |
//! |---|---|
//! | 0 | root of the static tree, world space |
//! | [`Trees::top_range`] | top level: its root first, then a list of instance ids in leaf order |
//! | … | the other nodes of the static tree, then the mesh trees in object space; deformed ones have room to spare |
//! | [`Trees::reflected_range`] | a second top level, for reflection rays, where they may skip instances |
//!
//! Primitives of a node index the triangle buffer, which also holds capsules. Primitives of a top-level node, marked
//! with [`TOP_LEVEL`], index the `u32` words of the node buffer, where the ids of instances stand. An empty tree is a
//! node without children, so both roots can always be traversed.
//!
//! Nodes have the layout of Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs" (HPG 2017), except that a child's minima and maxima stand side by side per axis; see [`CwBvhNode`].

use std::ops::Range;

use bytemuck::Zeroable;
pub use obvhs::cwbvh::node::CwBvhNode;
use rayon::prelude::*;

use super::{Instance, World, reach::is_within_reach};
use reflet_base::memory;
use reflet_scene::diagnostic::Diagnostic;

pub mod capsule;
mod cluster;
mod gpu_layout;
mod leaves;
mod oracle;
mod placed;
mod placement;
mod refit;
mod reflected;
#[cfg(test)]
mod tests;
mod tree;

pub use gpu_layout::{
    ALPHA_TESTED, CAPSULES, DOUBLE_SIDED, FLIPPED, MATTE_LIGHT, MOVES, SHADOWLESS, TraceInstance,
    TraceTriangle, UNREFLECTED, UNSEEN,
};
pub use leaves::{MeshTree, leaf_corners};
use leaves::{mesh_tree, static_tree, too_far};
pub use oracle::{Oracle, Ray, RayHit};
use placed::PlacedInstances;
use placement::{Placement, error, too_large};
use refit::{DeformingTree, PosedTree};
use reflected::{Reflected, ReflectedTop};
use tree::Tree;

/// Node index of the static tree's root.
pub const STATIC_ROOT: u32 = 0;
/// Node index of the top level's root.
pub const TOP_ROOT: u32 = 1;
/// Flag in `primitive_base_idx` of a node whose primitives are instances, not triangles.
pub const TOP_LEVEL: u32 = 1 << 31;
/// Index that stands for no instance or no tree.
pub const NONE: u32 = u32::MAX;

/// Number of entries of the traversal stack in `shaders/lib/bvh.wgsl`; trees that need more are refused.
pub const STACK_SIZE: u32 = 24;
/// Half of its entries: for the top level where it has many instances, and for the tree of a mesh, which is entered from
/// there. The static tree is traversed before both and may need all.
const HALF_STACK: u32 = STACK_SIZE / 2;

/// Number of 32-bit words of a node.
const NODE_WORDS: usize = size_of::<CwBvhNode>() / 4;
/// Number of `vec4u` of a node.
pub const NODE_VECTORS: usize = NODE_WORDS / 4;
/// Number of `vec4u` of a triangle or capsule.
pub const TRIANGLE_VECTORS: usize = size_of::<TraceTriangle>() / 16;

/// All trees of a world, as the GPU reads them.
#[derive(Clone, Debug)]
pub struct Trees {
    /// Node buffer, laid out as in the module's table; never empty.
    pub nodes: Vec<CwBvhNode>,
    /// Triangle buffer, in leaf order; never empty (a world without triangles has one that no leaf names).
    pub triangles: Vec<TraceTriangle>,
    /// Instance records, parallel to [`World::instances`].
    pub instances: Vec<TraceInstance>,
    /// Range of nodes that [`Trees::update_top_level`] rewrites; empty where nothing was built.
    pub top_range: Range<usize>,
    /// Index of the first node of the list of instance ids.
    top_list: usize,
    /// Number of triangles in the static tree.
    pub static_triangles: usize,
    /// Trees of meshes below the top level.
    pub mesh_trees: Vec<MeshTree>,
    /// Instances of the top level that rays can hit in the current pose, as indices into [`World::instances`].
    pub placed: Vec<u32>,
    /// Instances in the top level, as indices into [`World::instances`]; without trees, the instances that may move.
    pub top_instances: Vec<u32>,
    /// Maximum stack depth of traversal in the mesh trees below the top level of meshes that are not deformed.
    mesh_stack_need: u32,
    /// Trees of the meshes that animations deform.
    deforming: Vec<DeformingTree>,
    /// Top level for reflection rays, where they may skip instances.
    reflected: Option<Reflected>,
}

/// A rebuilt top level, and the trees of deformed meshes below it, that are not applied yet.
pub struct TopLevel {
    /// Posed trees, parallel to `Trees::deforming`.
    deformed: Vec<PosedTree>,
    placed: PlacedInstances,
    /// Top level for reflection rays, where it differs.
    reflected: Option<ReflectedTop>,
    /// Tree over the instances that rays can hit; none where no trees were built.
    tree: Option<Tree>,
}

impl Trees {
    /// Builds all trees; neither buffer exceeds `device_limit_bytes`.
    ///
    /// # Errors
    /// Geometry past that limit, past [`MAX_REACH_M`](super::reach::MAX_REACH_M), or past the memory that is left.
    pub fn build(world: &World, device_limit_bytes: u64) -> Result<Self, Box<Diagnostic>> {
        Self::build_apart(world, device_limit_bytes, &[])
    }

    /// Builds all trees; static instances for which `apart` is true, by index, are kept out of the static tree, so that
    /// rays which pass them visit none of their nodes.
    ///
    /// # Errors
    /// Same errors as [`Trees::build`].
    pub fn build_apart(
        world: &World,
        device_limit_bytes: u64,
        apart: &[bool],
    ) -> Result<Self, Box<Diagnostic>> {
        let placement = Placement::within(world, device_limit_bytes, apart)?;
        placement.check_memory(world, left_bytes(world))?;
        let (static_tree, mut triangles) = static_tree(world, &placement.baked)?;
        let static_triangles = triangles.len();
        let (deformed, rigid): (Vec<usize>, Vec<usize>) =
            (placement.meshes.iter()).partition(|mesh| world.deformed.contains_key(mesh));
        // A top level is no deeper than it has instances.
        let mesh_stack = STACK_SIZE - HALF_STACK.min(placement.top.len() as u32);
        let mesh_trees: Vec<_> = rigid
            .par_iter()
            .map(|mesh| mesh_tree(&world.meshes[*mesh], mesh_stack))
            .collect::<Result<_, _>>()?;

        let placed = PlacedInstances::new(world, &placement.top);
        let top_tree = Tree::build(&placed.boxes);
        let may_move = |i: &u32| world.instances[*i as usize].dynamic;
        let top_capacity = match placement.top.iter().any(may_move) {
            // Every inner node has at least two children.
            true => placement.top.len(),
            false => top_tree.nodes.len(),
        };
        let reserved = top_capacity + placement.top.len().div_ceil(NODE_WORDS);
        let (static_need, mut mesh_need) = (static_tree.stack_need, 0);
        let of_meshes = mesh_trees.iter().map(|(tree, _)| tree.nodes.len());
        let room = of_meshes.sum();
        let mut nodes = with_reserved(static_tree.nodes, reserved, room);
        let mut roots = vec![NONE; world.meshes.len()];
        let mut trees_of_meshes = Vec::with_capacity(placement.meshes.len());
        for (mesh, (mut tree, mesh_triangles)) in rigid.iter().zip(mesh_trees) {
            roots[*mesh] = nodes.len() as u32;
            tree::rebase(&mut tree.nodes, nodes.len() as u32, triangles.len() as u32);
            nodes.append(&mut tree.nodes);
            let first = triangles.len();
            triangles.extend(mesh_triangles);
            trees_of_meshes.push(MeshTree::new(*mesh, first..triangles.len(), false));
            mesh_need = mesh_need.max(tree.stack_need);
        }
        let mut deforming = Vec::with_capacity(deformed.len());
        for mesh in deformed {
            let of = &world.meshes[mesh];
            if !is_within_reach(&of.bounds) {
                return Err(too_far(&format!("mesh \"{}\"", of.name)));
            }
            let tree = DeformingTree::new(mesh, of, nodes.len(), triangles.len());
            roots[mesh] = nodes.len() as u32;
            nodes.resize(tree.nodes.end, CwBvhNode::default());
            triangles.resize(tree.triangles.end, TraceTriangle::zeroed());
            trees_of_meshes.push(MeshTree::new(mesh, tree.triangles.clone(), true));
            deforming.push(tree);
        }
        let skips = placement
            .top
            .iter()
            .any(|i| apart.get(*i as usize) == Some(&true));
        let reflected = skips.then(|| Reflected::reserve(&mut nodes, placement.top.len()));
        if triangles.is_empty() {
            triangles.push(TraceTriangle::zeroed());
        }

        let mut trees = Self {
            instances: records(world, &placement.top, &roots),
            nodes,
            triangles,
            top_range: 1..1 + reserved,
            top_list: 1 + top_capacity,
            static_triangles,
            mesh_trees: trees_of_meshes,
            placed: Vec::new(),
            top_instances: placement.top,
            mesh_stack_need: mesh_need,
            deforming,
            reflected,
        };
        check_nodes(&trees.nodes, static_need, device_limit_bytes)?;
        trees.set_top_level(trees.posed(world, placed, Some(top_tree))?);
        Ok(trees)
    }

    /// Trees for a plan without rays: placeholder buffers, and the instance records, which shading reads too.
    pub fn unbuilt(world: &World) -> Self {
        let record = |i: &Instance| TraceInstance::new(i, world, NONE);
        let dynamic = world.instances.iter().enumerate();
        let dynamic = dynamic.filter(|(_, i)| i.dynamic).map(|(id, _)| id as u32);
        Self {
            nodes: vec![CwBvhNode::default()],
            triangles: vec![TraceTriangle::zeroed()],
            instances: world.instances.iter().map(record).collect(),
            top_range: 1..1,
            top_list: 1,
            static_triangles: 0,
            mesh_trees: Vec::new(),
            placed: Vec::new(),
            top_instances: dynamic.collect(),
            mesh_stack_need: 0,
            deforming: Vec::new(),
            reflected: None,
        }
    }

    /// Whether the trees were built, so that rays can traverse them.
    pub fn is_built(&self) -> bool {
        !self.top_range.is_empty()
    }

    /// Rebuilds the top level after its instances moved, and refits the trees of deformed meshes: rewrites their
    /// records in [`Trees::instances`], the nodes of [`Trees::top_range`] and the ranges of
    /// [`Trees::deformed_ranges`].
    ///
    /// # Errors
    /// Same errors as [`Trees::top_level`]; the trees are unchanged then.
    pub fn update_top_level(&mut self, world: &World) -> Result<(), Box<Diagnostic>> {
        let top = self.top_level(world)?;
        self.set_top_level(top);
        Ok(())
    }

    /// Builds the top level of a posed world without applying it. Instances that are hidden, whose transform is not
    /// invertible, or that reach past [`MAX_REACH_M`](super::reach::MAX_REACH_M), cannot be hit.
    ///
    /// # Errors
    /// Poses whose tree is deeper than the traversal's stack, deformed meshes that reach past
    /// [`MAX_REACH_M`](super::reach::MAX_REACH_M).
    pub fn top_level(&self, world: &World) -> Result<TopLevel, Box<Diagnostic>> {
        let placed = PlacedInstances::new(world, &self.top_instances);
        let tree = self.is_built().then(|| Tree::build(&placed.boxes));
        self.posed(world, placed, tree)
    }

    /// A top level over placed instances, with the deformed meshes in the pose of the world.
    fn posed(
        &self,
        world: &World,
        mut placed: PlacedInstances,
        tree: Option<Tree>,
    ) -> Result<TopLevel, Box<Diagnostic>> {
        // Instances are entered with the top level's entries still on the stack.
        let need = tree.as_ref().map_or(0, |tree| tree.stack_need);
        let pose = |tree: &DeformingTree| {
            let (mesh, posed) = (&world.meshes[tree.mesh], world.posed(tree.mesh));
            if !is_within_reach(&posed.bounds) {
                return Err(too_far(&format!("mesh \"{}\"", mesh.name)));
            }
            Ok(tree.pose(mesh, posed.positions))
        };
        let deformed = self.deforming.par_iter().map(pose);
        let deformed: Vec<PosedTree> = deformed.collect::<Result<_, _>>()?;
        let below = deformed.iter().map(|tree| tree.stack_need);
        check_stack(need + below.fold(self.mesh_stack_need, u32::max))?;
        let boxes = std::mem::take(&mut placed.boxes);
        Ok(TopLevel {
            deformed,
            reflected: self.reflected_top(&placed.ids, &boxes),
            placed,
            tree,
        })
    }

    /// Ranges in [`Trees::nodes`] and [`Trees::triangles`] of each deformed mesh.
    pub fn deformed_ranges(&self) -> impl Iterator<Item = (Range<usize>, Range<usize>)> {
        let trees = self.deforming.iter();
        trees.map(|tree| (tree.nodes.clone(), tree.triangles.clone()))
    }

    /// Applies a rebuilt top level.
    pub fn set_top_level(&mut self, top: TopLevel) {
        for (id, record) in self.top_instances.iter().zip(top.placed.records) {
            let instance = &mut self.instances[*id as usize];
            *instance = TraceInstance {
                tree_root: instance.tree_root,
                ..record
            };
        }
        for (tree, posed) in self.deforming.iter().zip(top.deformed) {
            let nodes = &mut self.nodes[tree.nodes.clone()];
            nodes[..posed.nodes.len()].copy_from_slice(&posed.nodes);
            self.triangles[tree.triangles.clone()].copy_from_slice(&posed.triangles);
        }
        self.set_reflected(top.reflected);
        let Some(mut tree) = top.tree else {
            return;
        };
        let list = self.top_list;
        tree::rebase(
            &mut tree.nodes,
            TOP_ROOT,
            TOP_LEVEL | (list * NODE_WORDS) as u32,
        );
        self.nodes[1..1 + tree.nodes.len()].copy_from_slice(&tree.nodes);
        let words: &mut [u32] = bytemuck::cast_slice_mut(&mut self.nodes[list..self.top_range.end]);
        for (word, primitive) in words.iter_mut().zip(&tree.order) {
            *word = top.placed.ids[*primitive as usize];
        }
        self.placed = top.placed.ids;
    }
}

/// Nodes of the static tree with so many unused nodes after its root, and room for more at the end.
fn with_reserved(mut static_nodes: Vec<CwBvhNode>, reserved: usize, room: usize) -> Vec<CwBvhNode> {
    tree::rebase(&mut static_nodes, reserved as u32, 0);
    let mut nodes = Vec::with_capacity(static_nodes.len() + reserved + room);
    nodes.push(static_nodes[0]);
    nodes.resize(1 + reserved, CwBvhNode::default());
    nodes.extend_from_slice(&static_nodes[1..]);
    nodes
}

/// Records of all instances; `top` are the instances in the top level, `roots` the trees of the meshes.
fn records(world: &World, top: &[u32], roots: &[u32]) -> Vec<TraceInstance> {
    let mut in_top = vec![false; world.instances.len()];
    for i in top {
        in_top[*i as usize] = true;
    }
    let instances = world.instances.iter().zip(in_top);
    let record = |(i, in_top): (&Instance, bool)| {
        TraceInstance::new(i, world, if in_top { roots[i.mesh] } else { NONE })
    };
    instances.map(record).collect()
}

/// Refuses trees that [`Trees::build`] has no memory for.
///
/// # Errors
/// `memory-short`.
pub fn check_memory(world: &World) -> Result<(), Box<Diagnostic>> {
    let placement = Placement::within(world, u64::MAX, &[])?;
    placement.check_memory(world, left_bytes(world))
}

/// Memory that trees may take, bytes: the rest of the load's budget, at most what is free now.
fn left_bytes(world: &World) -> u64 {
    let now = memory::available_bytes().unwrap_or(u64::MAX);
    world.memory.left().min(now)
}

/// Refuses trees past the buffer limit or deeper than the traversal's stack.
fn check_nodes(nodes: &[CwBvhNode], stack_need: u32, limit: u64) -> Result<(), Box<Diagnostic>> {
    let node_bytes = size_of_val(nodes) as u64;
    if node_bytes > limit {
        return Err(too_large("the BVH nodes", node_bytes, limit));
    }
    check_stack(stack_need)
}

/// Refuses trees deeper than the traversal's stack, which would skip nodes.
fn check_stack(need: u32) -> Result<(), Box<Diagnostic>> {
    if need <= STACK_SIZE {
        return Ok(());
    }
    Err(error(
        "geometry-too-deep",
        "the scene's triangles or instances differ so much in size that their BVH is deeper than \
         the traversal stack allows",
        "remove far outliers, and tiny triangles or instances on top of each other",
    ))
}
