//! Light trees of the meshes of a world, and the tree over its instances.

use std::{collections::HashMap, sync::Arc};

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rayon::prelude::*;
use reflet_base::math::{Bounds, LUMINANCE};

use super::{Cluster, LIGHT_LEAF, Leaf, NO_NODE, Sides, Tree, UNLIT_ITEM, build, lamps};
use crate::{Instance, World};

/// The trees of a world in one pose.
#[derive(Clone, Debug, Default)]
pub struct LightTrees {
    /// Trees of the meshes.
    pub meshes: Vec<Arc<MeshTree>>,
    /// Instances that emit light, which are the items of the upper tree.
    pub lights: Vec<PlacedLight>,
    /// Node of each of [`World::lamps`] in the upper tree; [`NO_NODE`] for its only item, [`UNLIT_ITEM`] for a dark
    /// lamp. Items of lamps come after the items of `lights`.
    pub lamp_nodes: Vec<u32>,
    /// Tree over the instances and the lamps, in world space; `None` where nothing emits light.
    pub top: Option<Tree>,
}

/// The tree of a mesh in a space from which instances only turn, move and scale it evenly.
#[derive(Clone, Debug)]
pub struct MeshTree {
    key: Key,
    /// Nodes and root; `None` where no triangle has an area.
    pub tree: Option<Tree>,
    /// Node of each triangle; [`NO_NODE`] for the only one of a tree, [`UNLIT_ITEM`] for a triangle without area.
    pub places: Vec<u32>,
    /// Area of all triangles in the tree's space.
    area: f64,
}

/// Key of the tree of a mesh: all that it depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    mesh: usize,
    /// Bits of a transform that distorts the mesh and is part of the tree's space.
    shape: Option<[u32; 9]>,
    /// Hash of the positions of a deformed mesh.
    pose: u64,
}

/// An instance in the upper tree.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLight {
    /// Index into [`World::instances`].
    pub instance: u32,
    /// Index into [`LightTrees::meshes`].
    pub mesh_tree: usize,
    /// Transform into the space of the mesh's tree.
    pub tree_from_world: Affine3A,
    /// Sides that emit light.
    pub sides: Sides,
    /// Its node in the upper tree; [`NO_NODE`] where it is the only one, [`UNLIT_ITEM`] where it emits nothing.
    pub node: u32,
}

impl LightTrees {
    /// Trees of a world in its current pose. The tree of an unchanged mesh is taken from `before`, trees of the same
    /// world, to the same result.
    pub fn new(world: &World, before: Option<&Self>) -> Self {
        let kept: HashMap<Key, &Arc<MeshTree>> = (before.iter())
            .flat_map(|trees| trees.meshes.iter().map(|tree| (tree.key, tree)))
            .collect();
        let mut indices = HashMap::new();
        let mut keys = Vec::new();
        let lights: Vec<_> = world.lighting_instances().collect();
        let mut placed: Vec<_> = (lights.iter())
            .map(|(index, instance)| {
                let (key, tree_from_world) = key_of(world, instance);
                let mesh_tree = *indices.entry(key).or_insert_with(|| {
                    keys.push((key, instance));
                    keys.len() - 1
                });
                PlacedLight {
                    instance: *index as u32,
                    mesh_tree,
                    tree_from_world,
                    sides: sides_of(world, instance),
                    node: UNLIT_ITEM,
                }
            })
            .collect();
        let meshes: Vec<_> = (keys.par_iter())
            .map(|(key, instance)| match kept.get(key) {
                Some(tree) => Arc::clone(tree),
                None => Arc::new(MeshTree::new(world, *key, instance)),
            })
            .collect();
        let mut lamp_nodes = vec![UNLIT_ITEM; world.lamps.len()];
        let top = top_tree(world, &meshes, &mut placed, &mut lamp_nodes);
        Self {
            meshes,
            lights: placed,
            lamp_nodes,
            top,
        }
    }

    /// Whether these are the same trees of meshes in the same order.
    pub fn has_meshes_of(&self, other: &Self) -> bool {
        let keys = |trees: &Self| trees.meshes.iter().map(|m| m.key).collect::<Vec<_>>();
        keys(self) == keys(other)
    }
}

/// Largest relative difference of lengths and cosine of edges in a transform that counts as even.
const EVEN: f32 = 1e-4;

/// Whether a transform turns, mirrors and scales, but does not distort.
fn is_even(linear: &Mat3A) -> bool {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let size = x.length_squared();
    let differs = |v: Vec3A| (v.length_squared() - size).abs() > 2.0 * EVEN * size;
    let leans = |a: Vec3A, b: Vec3A| a.dot(b).abs() > EVEN * size;
    !(differs(y) || differs(z) || leans(x, y) || leans(y, z) || leans(z, x))
}

/// Key of an instance's tree, and the transform into its space.
fn key_of(world: &World, instance: &Instance) -> (Key, Affine3A) {
    let place = &instance.world_from_object;
    let pose = world.deformed.get(&instance.mesh).map_or(0, |d| d.hash);
    let key = |shape| Key {
        mesh: instance.mesh,
        shape,
        pose,
    };
    if instance.is_hidden() {
        return (key(None), Affine3A::IDENTITY);
    }
    if is_even(&place.matrix3) {
        return (key(None), place.inverse());
    }
    let shape = place.matrix3.to_cols_array().map(f32::to_bits);
    let moved = Affine3A::from_translation(Vec3::from(-place.translation));
    (key(Some(shape)), moved)
}

fn sides_of(world: &World, instance: &Instance) -> Sides {
    match world.materials[instance.material].double_sided {
        false => Sides::Front,
        true if world.meshes[instance.mesh].is_closed_outward() => Sides::Closed,
        true => Sides::Both,
    }
}

impl MeshTree {
    /// The tree of an instance's mesh.
    fn new(world: &World, key: Key, instance: &Instance) -> Self {
        let mesh = &world.meshes[key.mesh];
        let posed = world.posed(key.mesh);
        let shape = match key.shape {
            Some(_) => instance.world_from_object.matrix3,
            None => Mat3A::IDENTITY,
        };
        let turn = shape.determinant().signum();
        let mut areas = 0.0;
        let mut leaves = Vec::with_capacity(mesh.triangles.len());
        let is_flat = mesh.capsule_radius_m.is_none();
        for (corners, item) in mesh.triangles.iter().zip(0..).filter(|_| is_flat) {
            let corners = posed.corners(*corners).map(|p| shape * p);
            let [a, b, c] = corners;
            let across = (b - a).cross(c - a) * turn;
            let area = 0.5 * across.length();
            if area.is_normal() {
                areas += f64::from(area);
                leaves.push(triangle(corners, across, area, item));
            }
        }
        for leaf in &mut leaves {
            leaf.cluster.power = (f64::from(leaf.cluster.power) / areas) as f32;
        }
        // Shares too small for a float are never chosen.
        leaves.retain(|leaf| leaf.cluster.power.is_normal());
        let tree = build(&mut leaves);
        let mut places = vec![UNLIT_ITEM; mesh.triangles.len()];
        if let [only] = &leaves[..] {
            places[only.item as usize] = NO_NODE;
        }
        note_places(&tree, |item, node| places[item] = node);
        Self {
            key,
            tree,
            places,
            area: areas,
        }
    }
}

/// Calls `note` for each item of a tree, with the index of its node.
fn note_places(tree: &Option<Tree>, mut note: impl FnMut(usize, u32)) {
    let nodes = tree.iter().flat_map(|tree| &tree.nodes).zip(0..);
    for (node, index) in nodes.filter(|(node, _)| node.link & LIGHT_LEAF != 0) {
        note((node.link & !LIGHT_LEAF) as usize, index);
    }
}

/// A triangle, with its area as power.
fn triangle(corners: [Vec3; 3], across: Vec3, area: f32, item: u32) -> Leaf {
    let bounds = Bounds::around(corners);
    let center = bounds.center();
    let radius = corners
        .map(|p| p.distance(center))
        .into_iter()
        .fold(0.0, f32::max);
    Leaf {
        bounds,
        cluster: Cluster {
            center,
            radius,
            axis: across.normalize_or(Vec3::Z),
            cosine: 1.0,
            power: area,
            sides: Sides::Front,
        },
        item,
    }
}

/// The tree over the instances and the lamps, whose places in it are noted in `lights` and `lamp_nodes`.
fn top_tree(
    world: &World,
    meshes: &[Arc<MeshTree>],
    lights: &mut [PlacedLight],
    lamp_nodes: &mut [u32],
) -> Option<Tree> {
    let of_meshes = lights
        .iter()
        .map(|light| power_of(world, &meshes[light.mesh_tree], light));
    let of_lamps = world.lamps.iter().map(lamps::power_of);
    let powers: Vec<f64> = of_meshes.chain(of_lamps).collect();
    let sum: f64 = powers.iter().sum();
    let first_lamp = lights.len();
    let mut leaves: Vec<Leaf> = (powers.iter().enumerate())
        .filter_map(|(item, power)| {
            // Shares too small for a float are never chosen.
            let power = Some((power / sum) as f32).filter(|power| power.is_normal())?;
            let number = item as u32;
            let Some(light) = lights.get(item) else {
                let lamp = &world.lamps[item - first_lamp];
                return Some(lamps::leaf(lamp, power, number));
            };
            let root = meshes[light.mesh_tree].tree.as_ref()?.root;
            Some(placed(light, root, power, number))
        })
        .collect();
    let tree = build(&mut leaves);
    let mut note = |item: usize, node| match item.checked_sub(first_lamp) {
        None => lights[item].node = node,
        Some(lamp) => lamp_nodes[lamp] = node,
    };
    if let [only] = &leaves[..] {
        note(only.item as usize, NO_NODE);
    }
    note_places(&tree, note);
    tree
}

/// Area of an instance in square meters times the luminance of its emission; 0 where that is no number.
fn power_of(world: &World, mesh: &MeshTree, light: &PlacedLight) -> f64 {
    let instance = &world.instances[light.instance as usize];
    if instance.is_hidden() {
        return 0.0;
    }
    let scale = match mesh.key.shape {
        Some(_) => 1.0,
        None => f64::from(instance.world_from_object.matrix3.x_axis.length()),
    };
    let emission = world.materials[instance.material].emission;
    let power = f64::from(emission.dot(LUMINANCE)) * mesh.area * scale * scale;
    if power.is_finite() && power > 0.0 {
        power
    } else {
        0.0
    }
}

/// An instance as an item of the upper tree.
fn placed(light: &PlacedLight, root: Cluster, power: f32, item: u32) -> Leaf {
    let world_from_tree = light.tree_from_world.inverse();
    let scale = world_from_tree.matrix3.x_axis.length();
    let center = world_from_tree.transform_point3(root.center);
    let radius = root.radius * scale * (1.0 + EVEN);
    let axis = world_from_tree.transform_vector3(root.axis);
    let cluster = Cluster {
        center,
        radius,
        axis: axis.normalize_or(Vec3::Z),
        cosine: root.cosine,
        power,
        sides: light.sides,
    };
    Leaf::ball(cluster, item)
}
