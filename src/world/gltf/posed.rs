//! Nodes and morph targets that scripts pose, even if no animation of the file moves them.

use std::collections::{BTreeMap, BTreeSet};

use super::{animated::Animated, schema::Root};

/// Nodes and morph targets of a file that scripts pose.
#[derive(Clone, Debug, Default)]
pub struct Posed {
    /// Names of the posed nodes.
    pub nodes: BTreeSet<String>,
    /// Whether scripts set weights of morph targets.
    pub morphs: bool,
}

impl Posed {
    /// Whether scripts pose nothing.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty() && !self.morphs
    }

    /// Marks the posed nodes, and the nodes with morph targets, as animated.
    pub(super) fn add_to(&self, animated: &mut Animated, root: &Root) {
        for (i, node) in root.nodes.iter().enumerate() {
            let is_named = |name: &String| self.nodes.contains(name);
            if node.name.as_ref().is_some_and(is_named) {
                animated.places.insert(i);
            }
            if self.morphs && count(root, node.mesh) > 0 {
                animated.weights.insert(i);
            }
        }
    }
}

/// Names of the nodes and morph targets that scripts may pose.
#[derive(Clone, Debug, Default)]
pub struct PosedNames {
    /// Indices of the nodes with each name.
    pub nodes: BTreeMap<String, Vec<usize>>,
    /// Morph targets with each name, as indices of node and target.
    pub morphs: BTreeMap<String, Vec<(usize, usize)>>,
    /// Weights at rest of the nodes that have morph targets.
    pub rest_weights: BTreeMap<usize, Vec<f32>>,
}

impl PosedNames {
    /// Names in the nodes for which `is_part` tells that they are part of the scene; empty if nothing is posed.
    pub(super) fn from_nodes(root: &Root, posed: &Posed, is_part: impl Fn(usize) -> bool) -> Self {
        let mut names = Self::default();
        if posed.is_empty() {
            return names;
        }
        for (i, node) in root.nodes.iter().enumerate() {
            if !is_part(i) {
                continue;
            }
            if let Some(name) = &node.name {
                names.nodes.entry(name.clone()).or_default().push(i);
            }
            let Some(mesh) = node.mesh.and_then(|mesh| root.meshes.get(mesh)) else {
                continue;
            };
            let targets = count(root, node.mesh);
            let own = mesh.extras.get("targetNames").and_then(|n| n.as_array());
            for target in 0..targets {
                let name = own.and_then(|own| own.get(target)?.as_str());
                let name = name.map_or_else(|| target.to_string(), str::to_owned);
                names.morphs.entry(name).or_default().push((i, target));
            }
            if targets > 0 {
                let mut weights = node.weights.clone().unwrap_or_else(|| mesh.weights.clone());
                weights.resize(targets, 0.0);
                names.rest_weights.insert(i, weights);
            }
        }
        names
    }
}

/// Number of morph targets of a mesh.
fn count(root: &Root, mesh: Option<usize>) -> usize {
    let mesh = mesh.and_then(|mesh| root.meshes.get(mesh));
    let primitives = mesh.map_or(&[][..], |mesh| &mesh.primitives);
    let counts = primitives.iter().map(|primitive| primitive.targets.len());
    counts.max().unwrap_or(0)
}
