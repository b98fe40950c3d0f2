//! Node hierarchy of a file, and its animation players.

use std::{collections::BTreeMap, sync::Arc};

use glam::{Affine3A, Vec3};

use super::animation::{Animation, Local, Pointed, PointedValue, Property};
use reflet_scene::{desc::AnimationDesc, motion::FrameState};

/// The nodes of a file's scene, at rest.
#[derive(Clone, Debug, Default)]
pub struct Rig {
    /// Nodes by their index in the file; `None` for a node outside the scene.
    pub nodes: Vec<Option<RigNode>>,
    /// Indices of the nodes of the scene, parents before their children.
    pub order: Vec<usize>,
}

/// A node at rest.
#[derive(Clone, Debug)]
pub struct RigNode {
    /// Index of the parent node.
    pub parent: Option<usize>,
    /// Transform from the node's space to its parent's.
    pub local: Local,
    /// Visibility of the node and its children.
    pub visible: bool,
    /// Whether the node and all its ancestors are visible.
    pub seen: bool,
    /// Transform from the node's space to the model's: the product of all `local` from the root down.
    pub model_from_node: Affine3A,
}

/// Nodes and morph targets of a placed file that scripts pose.
#[derive(Clone, Debug, Default)]
pub struct Scripted {
    /// Nodes of each of the instance's `joints`, by their index in the file.
    pub joints: Vec<Vec<usize>>,
    /// Morph targets of each of the instance's `morphs`, as indices of node and target.
    pub morphs: Vec<Vec<(usize, usize)>>,
    /// Weights at rest of the nodes with these morph targets.
    pub rest_weights: BTreeMap<usize, Vec<f32>>,
}

/// Animation player of a placed file, shared by all copies of an instance.
#[derive(Clone, Debug)]
pub struct Player {
    /// Index into `SceneDesc::instances`; `None` for a model that no instance names.
    pub desc: Option<usize>,
    /// Start, speed and repetition of the animations.
    pub timing: AnimationDesc,
    /// Played animations; the later wins for the same property.
    animations: Vec<Arc<Animation>>,
    scripted: Scripted,
    /// Animated nodes, parents first.
    moved: Vec<MovedNode>,
    /// Index into `moved` of each node of the file.
    slots: Vec<Option<usize>>,
}

/// An animated node, or a descendant of one.
#[derive(Clone, Debug)]
struct MovedNode {
    parent: Parent,
    local: Local,
    visible: bool,
}

/// Parent of an animated node.
#[derive(Clone, Copy, Debug)]
enum Parent {
    /// Another animated node.
    Slot(usize),
    /// A static node: its transform to the model's space, and its visibility.
    Still(Affine3A, bool),
}

/// Pose of all that a player moves, at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RigPose {
    /// Animated nodes by slot, see [`Player::slot`].
    pub nodes: Vec<PosedNode>,
    /// Weights of morph targets, by the index of their node in the file.
    pub weights: BTreeMap<usize, Vec<f32>>,
    /// Animated values of materials, lights and cameras.
    pub values: BTreeMap<(Pointed, PointedValue), Vec3>,
}

/// An animated node at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct PosedNode {
    /// Transform from the node's space to the model's, perhaps singular.
    pub model_from_node: Affine3A,
    /// Whether the node and all its ancestors are visible.
    pub visible: bool,
}

impl Player {
    /// Player of some animations of a file, and of the nodes and morph targets that scripts pose.
    pub fn new(
        rig: &Rig,
        animations: Vec<Arc<Animation>>,
        scripted: Scripted,
        desc: Option<usize>,
        timing: &AnimationDesc,
    ) -> Self {
        let mut animated = vec![false; rig.nodes.len()];
        for channel in animations.iter().flat_map(|a| &a.channels) {
            animated[channel.node] = true;
        }
        for node in scripted.joints.iter().flatten() {
            animated[*node] = true;
        }
        let mut slots = vec![None; rig.nodes.len()];
        let mut moved = Vec::new();
        for &i in &rig.order {
            let Some(node) = &rig.nodes[i] else { continue };
            let above = node.parent.and_then(|p| slots[p]);
            if above.is_none() && !animated[i] {
                continue;
            }
            let still = node.parent.and_then(|p| rig.nodes[p].as_ref());
            let parent = match (above, still) {
                (Some(slot), _) => Parent::Slot(slot),
                (None, Some(parent)) => Parent::Still(parent.model_from_node, parent.seen),
                (None, None) => Parent::Still(Affine3A::IDENTITY, true),
            };
            slots[i] = Some(moved.len());
            moved.push(MovedNode {
                parent,
                local: node.local,
                visible: node.visible,
            });
        }
        Self {
            desc,
            timing: timing.clone(),
            animations,
            scripted,
            moved,
            slots,
        }
    }

    /// Slot of a node in [`Player::pose`], if animated.
    pub fn slot(&self, node: usize) -> Option<usize> {
        self.slots.get(node).copied().flatten()
    }

    /// Whether the player moves the weights of a node's morph targets.
    pub fn moves_weights(&self, node: usize) -> bool {
        if self.scripted.rest_weights.contains_key(&node) {
            return true;
        }
        let mut tracks = self.animations.iter().flat_map(|a| &a.weights);
        tracks.any(|track| track.node == node)
    }

    /// Whether the player changes a material, a light or a camera of the file.
    pub fn changes(&self, object: Pointed) -> bool {
        let mut tracks = self.animations.iter().flat_map(|a| &a.pointers);
        tracks.any(|track| track.object == object)
    }

    /// End of the longest animation, seconds.
    pub fn duration_s(&self) -> f64 {
        let ends = self.animations.iter().map(|a| f64::from(a.duration_s));
        ends.fold(0.0, f64::max)
    }

    /// Pose in a frame: the animations at the time that the instance's script has set, else at the scene's, then
    /// the poses that the script has set.
    pub fn pose(&self, state: &FrameState) -> RigPose {
        let set = self.desc.and_then(|i| *state.animation_s.get(i)?);
        let scene_s = |animation: &Animation| {
            let duration_s = f64::from(animation.duration_s);
            self.timing.local_s(state.time_s, duration_s)
        };
        self.pose_each(|animation| set.unwrap_or_else(|| scene_s(animation)), state)
    }

    /// Pose at a time of all animations, seconds, without anything that scripts set.
    pub fn pose_at(&self, local_s: f64) -> RigPose {
        self.pose_each(|_| local_s, &FrameState::default())
    }

    fn pose_each(&self, local_s: impl Fn(&Animation) -> f64, state: &FrameState) -> RigPose {
        let mut nodes = self.moved.clone();
        let mut weights = self.scripted.rest_weights.clone();
        let mut values = BTreeMap::new();
        for animation in &self.animations {
            let time_s = local_s(animation);
            for channel in &animation.channels {
                let Some(slot) = self.slot(channel.node) else {
                    continue; // not part of the scene
                };
                let value = channel.sampler.value_at(time_s, channel.property);
                match channel.property {
                    Property::Visible => nodes[slot].visible = value.x != 0.0,
                    property => nodes[slot].local.set(property, value),
                }
            }
            for track in &animation.weights {
                weights.insert(track.node, track.weights_at(time_s));
            }
            for track in &animation.pointers {
                values.insert((track.object, track.value), track.value_at(time_s));
            }
        }
        self.follow_script(state, &mut nodes, &mut weights);
        let mut posed: Vec<PosedNode> = Vec::with_capacity(nodes.len());
        for node in nodes {
            let (model_from_parent, seen) = match node.parent {
                Parent::Slot(slot) => (posed[slot].model_from_node, posed[slot].visible),
                Parent::Still(transform, seen) => (transform, seen),
            };
            posed.push(PosedNode {
                model_from_node: model_from_parent * node.local.transform(),
                visible: seen && node.visible,
            });
        }
        RigPose {
            nodes: posed,
            weights,
            values,
        }
    }

    /// Applies the joint poses and morph weights that the instance's script has set.
    fn follow_script(
        &self,
        state: &FrameState,
        nodes: &mut [MovedNode],
        weights: &mut BTreeMap<usize, Vec<f32>>,
    ) {
        let Some(desc) = self.desc else { return };
        let of_instance = (desc, 0)..(desc + 1, 0);
        for (&(_, place), pose) in state.joints.range(of_instance.clone()) {
            let named = self.scripted.joints.get(place);
            for slot in named.into_iter().flatten().filter_map(|n| self.slot(*n)) {
                let local = &mut nodes[slot].local;
                *local = Local::Matrix(pose.over(&local.transform()));
            }
        }
        for (&(_, place), weight) in state.morphs.range(of_instance) {
            let named = self.scripted.morphs.get(place);
            for (node, target) in named.into_iter().flatten() {
                let of_node = weights.get_mut(node);
                if let Some(own) = of_node.and_then(|of_node| of_node.get_mut(*target)) {
                    *own = *weight;
                }
            }
        }
    }
}
