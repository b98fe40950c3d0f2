//! Choosing an emitter by light trees, and its probability: the CPU's side of `shaders/lib/light_tree.wgsl`.

use glam::Vec3;
use reflet_base::pcg::hash;

use super::{LIGHT_LEAF, LightTrees, NO_NODE, Node, PlacedLight, Sides, Tree, UNLIT_ITEM};

/// Emitter that a tree chose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Chosen {
    /// A triangle of an instance.
    Triangle {
        /// Index into [`World::instances`](crate::World::instances).
        instance: u32,
        /// Index into the mesh's triangles.
        triangle: u32,
    },
    /// A lamp, as an index into [`World::lamps`](crate::World::lamps).
    Lamp(u32),
}

/// A choice of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The chosen emitter.
    pub what: Chosen,
    /// Its probability by importance, and by power alone.
    pub chances: [f32; 2],
}

impl LightTrees {
    /// The triangle or lamp that two random numbers in [0, 1) choose for a surface at `point` with this normal: by
    /// importance, or `by_power` alone. The second gives the first the digits that it lacks far down. `None` where none
    /// is important.
    pub fn choose(&self, u: [f32; 2], by_power: bool, point: Vec3, normal: Vec3) -> Option<Choice> {
        let top = self.top.as_ref()?;
        let mut descent = Descent {
            u: u[0],
            digits: u[1].to_bits(),
            chances: [1.0; 2],
        };
        let item = descent.item(top, by_power, &Receiver::of_front(point, normal))? as usize;
        let what = match self.lights.get(item) {
            None => Chosen::Lamp((item - self.lights.len()) as u32),
            Some(light) => {
                let tree = self.meshes[light.mesh_tree].tree.as_ref()?;
                let triangle = descent.item(tree, by_power, &light.receiver(point, normal))?;
                Chosen::Triangle {
                    instance: light.instance,
                    triangle,
                }
            }
        };
        Some(Choice {
            what,
            chances: descent.chances,
        })
    }

    /// Probabilities with which [`Self::choose`] chooses a triangle or a lamp, by importance and by power; 0 for one
    /// that emits nothing.
    pub fn chances(&self, of: Chosen, point: Vec3, normal: Vec3) -> [f32; 2] {
        let Some(top) = &self.top else {
            return [0.0; 2];
        };
        let in_top = |node| match node {
            UNLIT_ITEM => [0.0; 2],
            node => chances_of(top, node, &Receiver::of_front(point, normal)),
        };
        let (instance, triangle) = match of {
            Chosen::Lamp(lamp) => {
                let node = self.lamp_nodes.get(lamp as usize);
                return in_top(node.copied().unwrap_or(UNLIT_ITEM));
            }
            Chosen::Triangle { instance, triangle } => (instance, triangle),
        };
        let Some(light) = self.lights.iter().find(|l| l.instance == instance) else {
            return [0.0; 2];
        };
        let mesh = &self.meshes[light.mesh_tree];
        let (Some(tree), Some(place)) = (&mesh.tree, mesh.places.get(triangle as usize)) else {
            return [0.0; 2];
        };
        if *place == UNLIT_ITEM {
            return [0.0; 2];
        }
        let below = chances_of(tree, *place, &light.receiver(point, normal));
        let above = in_top(light.node);
        [above[0] * below[0], above[1] * below[1]]
    }
}

/// A surface in the space of a tree, which the tree's emitters light.
struct Receiver {
    point: Vec3,
    normal: Vec3,
    /// Sides of the emitters that emit light.
    sides: Sides,
}

impl Receiver {
    /// A surface that the fronts of emitters light.
    const fn of_front(point: Vec3, normal: Vec3) -> Self {
        let sides = Sides::Front;
        Self {
            point,
            normal,
            sides,
        }
    }
}

impl PlacedLight {
    /// A surface in the space of the mesh's tree.
    fn receiver(&self, point: Vec3, normal: Vec3) -> Receiver {
        let normal = self.tree_from_world.transform_vector3(normal);
        Receiver {
            point: self.tree_from_world.transform_point3(point),
            normal: normal.normalize_or_zero(),
            sides: self.sides,
        }
    }
}

/// A random number on its way down, with the probability of the way by importance and by power.
struct Descent {
    u: f32,
    /// Random bits, for the digits of `u` past its 24.
    digits: u32,
    chances: [f32; 2],
}

impl Descent {
    fn item(&mut self, tree: &Tree, by_power: bool, receiver: &Receiver) -> Option<u32> {
        let mut link = tree.link;
        while link & LIGHT_LEAF == 0 {
            let shares = shares_of(tree, link, receiver);
            let share = shares[usize::from(by_power)];
            if share.is_nan() {
                return None;
            }
            let is_second = self.u >= share;
            let part = |share: f32| if is_second { 1.0 - share } else { share };
            let from = if is_second { share } else { 0.0 };
            self.digits = hash(self.digits);
            let more = (self.digits >> 8) as f32 * DIGITS_24 * DIGITS_24;
            self.u = ((self.u - from + more) / part(share)).min(BELOW_ONE);
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
/// Step between random numbers of 24 bits.
const DIGITS_24: f32 = 1.0 / (1 << 24) as f32;

/// Shares of the first node of a pair by importance, NaN where neither node is important, and by power.
fn shares_of(tree: &Tree, pair: u32, receiver: &Receiver) -> [f32; 2] {
    let nodes = [pair, pair + 1].map(|i| Node::of_words(tree.nodes[i as usize].words()).cluster);
    let [a, b] = nodes.map(|c| c.importance(receiver.point, receiver.normal, receiver.sides));
    let [power_a, power_b] = nodes.map(|c| c.power);
    [a / (a + b), power_a / (power_a + power_b)]
}

/// Probabilities of a node, from it up.
fn chances_of(tree: &Tree, node: u32, receiver: &Receiver) -> [f32; 2] {
    let mut chances = [1.0; 2];
    let mut node = node;
    while node != NO_NODE {
        let shares = shares_of(tree, node & !1, receiver);
        let parts = shares.map(|share| if node & 1 == 1 { 1.0 - share } else { share });
        chances[0] *= if parts[0].is_nan() { 0.0 } else { parts[0] };
        chances[1] *= parts[1];
        node = tree.nodes[node as usize].parent;
    }
    chances
}
