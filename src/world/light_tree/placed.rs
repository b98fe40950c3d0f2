//! Light trees of the meshes of a world, and the one over its instances.

use std::{collections::HashMap, sync::Arc};

use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use rayon::prelude::*;
use reflet_base::math::Bounds;

use super::{Cluster, LIGHT_LEAF, Leaf, NO_NODE, Node, Sides, Tree, UNLIT_ITEM, build};
use crate::{Instance, World, emitters::LUMINANCE};

/// The trees of a world in one pose.
#[derive(Clone, Debug, Default)]
pub struct LightTrees {
    /// Trees of the meshes.
    pub meshes: Vec<Arc<MeshTree>>,
    /// Instances that emit light, which are the items of the upper tree.
    pub lights: Vec<PlacedLight>,
    /// Tree over the instances, in world space; `None` where nothing emits light.
    pub top: Option<Tree>,
}

/// The tree of a mesh in a space from which instances only turn, move and scale it evenly.
#[derive(Clone, Debug)]
pub struct MeshTree {
    key: Key,
    /// Nodes and root; `None` where no triangle has an area.
    pub tree: Option<Tree>,
    /// Node of each triangle; [`NO_NODE`] for the only one of a tree, [`UNLIT_ITEM`] for those without an area.
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

/// A triangle that a tree chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Index into [`World::instances`].
    pub instance: u32,
    /// Index into the mesh's triangles.
    pub triangle: u32,
    /// Probability of the triangle by importance, and by power alone.
    pub chances: [f32; 2],
}

impl LightTrees {
    /// Trees of a world in its current pose. Those of `before`, trees of the same world, are taken over where a mesh is
    /// as it was, to the same result.
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
        let top = top_tree(world, &meshes, &mut placed);
        Self {
            meshes,
            lights: placed,
            top,
        }
    }

    /// Whether these are the same trees of meshes in the same order.
    pub fn has_meshes_of(&self, other: &Self) -> bool {
        let keys = |trees: &Self| trees.meshes.iter().map(|m| m.key).collect::<Vec<_>>();
        keys(self) == keys(other)
    }

    /// The triangle that a random number in [0, 1) chooses for a surface at `point` with this normal: by importance, or
    /// `by_power` alone. `None` where none is important.
    pub fn choose(&self, u: f32, by_power: bool, point: Vec3, normal: Vec3) -> Option<Choice> {
        let top = self.top.as_ref()?;
        let mut descent = Descent {
            u,
            chances: [1.0; 2],
        };
        let light = descent.item(top, by_power, (point, normal, Sides::Front))?;
        let light = &self.lights[light as usize];
        let tree = self.meshes[light.mesh_tree].tree.as_ref()?;
        let triangle = descent.item(tree, by_power, light.seen_from(point, normal))?;
        Some(Choice {
            instance: light.instance,
            triangle,
            chances: descent.chances,
        })
    }

    /// Probabilities with which [`Self::choose`] chooses a triangle, by importance and by power; 0 for one that emits
    /// nothing.
    pub fn chances(&self, instance: u32, triangle: u32, point: Vec3, normal: Vec3) -> [f32; 2] {
        let light = self.lights.iter().find(|l| l.instance == instance);
        let (Some(light), Some(top)) = (light, &self.top) else {
            return [0.0; 2];
        };
        let mesh = &self.meshes[light.mesh_tree];
        let (Some(tree), Some(place)) = (&mesh.tree, mesh.places.get(triangle as usize)) else {
            return [0.0; 2];
        };
        if light.node == UNLIT_ITEM || *place == UNLIT_ITEM {
            return [0.0; 2];
        }
        let below = chances_of(tree, *place, light.seen_from(point, normal));
        let above = chances_of(top, light.node, (point, normal, Sides::Front));
        [above[0] * below[0], above[1] * below[1]]
    }
}

impl PlacedLight {
    /// A surface in the space of the mesh's tree, and the sides that emit light.
    fn seen_from(&self, point: Vec3, normal: Vec3) -> (Vec3, Vec3, Sides) {
        let normal = self.tree_from_world.transform_vector3(normal);
        let point = self.tree_from_world.transform_point3(point);
        (point, normal.normalize_or_zero(), self.sides)
    }
}

/// A random number on its way down, with the probability of the way by importance and by power.
struct Descent {
    u: f32,
    chances: [f32; 2],
}

impl Descent {
    fn item(&mut self, tree: &Tree, by_power: bool, from: (Vec3, Vec3, Sides)) -> Option<u32> {
        let mut link = tree.link;
        while link & LIGHT_LEAF == 0 {
            let shares = shares_of(tree, link, from);
            let share = shares[usize::from(by_power)];
            if share.is_nan() {
                return None;
            }
            let is_second = self.u >= share;
            let part = |share: f32| if is_second { 1.0 - share } else { share };
            let from = if is_second { share } else { 0.0 };
            self.u = ((self.u - from) / part(share)).min(BELOW_ONE);
            let [place, power] = shares.map(part);
            self.chances[0] *= if place.is_nan() { 0.0 } else { place };
            self.chances[1] *= power;
            link = tree.nodes[link as usize + usize::from(is_second)].link;
        }
        Some(link & !LIGHT_LEAF)
    }
}

/// Largest 32-bit float below 1.
const BELOW_ONE: f32 = 0.999_999_94;

/// Shares of the first node of a pair by importance, NaN where neither node is important, and by power.
fn shares_of(tree: &Tree, pair: u32, (point, normal, sides): (Vec3, Vec3, Sides)) -> [f32; 2] {
    let nodes = [pair, pair + 1].map(|i| Node::of_words(tree.nodes[i as usize].words()).cluster);
    let [a, b] = nodes.map(|c| c.importance(point, normal, sides));
    let [power_a, power_b] = nodes.map(|c| c.power);
    [a / (a + b), power_a / (power_a + power_b)]
}

/// Probabilities of a node, from it up.
fn chances_of(tree: &Tree, node: u32, from: (Vec3, Vec3, Sides)) -> [f32; 2] {
    let mut chances = [1.0; 2];
    let mut node = node;
    while node != NO_NODE {
        let shares = shares_of(tree, node & !1, from);
        let parts = shares.map(|share| if node & 1 == 1 { 1.0 - share } else { share });
        chances[0] *= if parts[0].is_nan() { 0.0 } else { parts[0] };
        chances[1] *= parts[1];
        node = tree.nodes[node as usize].parent;
    }
    chances
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
    let bounds = Bounds::of(corners);
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

/// The tree over the instances, whose places in it are noted in `lights`.
fn top_tree(world: &World, meshes: &[Arc<MeshTree>], lights: &mut [PlacedLight]) -> Option<Tree> {
    let powers: Vec<f64> = (lights.iter())
        .map(|light| power_of(world, &meshes[light.mesh_tree], light))
        .collect();
    let sum: f64 = powers.iter().sum();
    let mut leaves: Vec<Leaf> = (lights.iter().zip(&powers).zip(0..))
        .filter_map(|((light, power), item)| {
            let root = meshes[light.mesh_tree].tree.as_ref()?.root;
            let power = (power / sum) as f32;
            // Shares too small for a float are never chosen.
            power.is_normal().then(|| placed(light, root, power, item))
        })
        .collect();
    let tree = build(&mut leaves);
    if let [only] = &leaves[..] {
        lights[only.item as usize].node = NO_NODE;
    }
    note_places(&tree, |item, node| lights[item].node = node);
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
    let half = Vec3::splat(radius);
    Leaf {
        bounds: Bounds {
            min: center - half,
            max: center + half,
        },
        cluster: Cluster {
            center,
            radius,
            axis: axis.normalize_or(Vec3::Z),
            cosine: root.cosine,
            power,
            sides: light.sides,
        },
        item,
    }
}
