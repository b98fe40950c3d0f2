//! Sources of a mesh's deformation: an animation player of its file, or a script.

use std::borrow::Borrow;

use glam::Affine3A;
use xxhash_rust::xxh3::xxh3_64;

use super::{Deformation, Deformed, DeformingNodes, Joint, Vertices};
use crate::{
    Mesh,
    reach::is_within_reach,
    rig::{Player, Rig, RigPose},
};
use reflet_base::math::Bounds;
use reflet_scene::motion::FrameState;

/// A mesh of the world that an animation or a script deforms.
#[derive(Clone, Debug)]
pub struct Deformer {
    /// Index into [`World::meshes`](crate::World::meshes).
    pub mesh: usize,
    /// Source of its deformation.
    pub by: DeformedBy,
}

/// Source of a mesh's deformation.
#[derive(Clone, Debug)]
pub enum DeformedBy {
    /// Nodes of its file, which a player moves.
    Player(PlayedNodes),
    /// The script's `frame`: the index of its model in `SceneDesc::models`.
    Script(usize),
}

/// Nodes that a player moves, and that deform a mesh.
#[derive(Clone, Debug)]
pub struct PlayedNodes {
    /// Index into [`Moving::players`](super::pose::Moving::players).
    pub player: usize,
    joints: Vec<JointSource>,
    nodes: DeformingNodes,
}

/// Source of a joint's transform.
#[derive(Clone, Copy, Debug)]
enum JointSource {
    /// An animated node, by its slot in the player.
    Slot(usize),
    /// A static node: its transform to the model's space.
    Still(Affine3A),
}

impl Deformer {
    /// Deformer of a mesh by `nodes` of its file, which a player of that file moves.
    pub fn new(
        mesh: usize,
        index: usize,
        player: &Player,
        rig: &Rig,
        nodes: &DeformingNodes,
    ) -> Self {
        let source = |joint: &Joint| match player.slot(joint.node) {
            Some(slot) => JointSource::Slot(slot),
            None => {
                let node = rig.nodes.get(joint.node).and_then(Option::as_ref);
                JointSource::Still(node.map_or(Affine3A::IDENTITY, |n| n.model_from_node))
            }
        };
        Self {
            mesh,
            by: DeformedBy::Player(PlayedNodes {
                player: index,
                joints: nodes.joints.iter().map(source).collect(),
                nodes: nodes.clone(),
            }),
        }
    }

    /// The mesh as the players pose it, of which `pose_of` gives the pose by its index, or as the script of a frame
    /// has set it; `None` for a mesh without a deformation, and for vertices that are not finite or too far away.
    pub fn pose<P: Borrow<RigPose>>(
        &self,
        mesh: &Mesh,
        pose_of: impl Fn(usize) -> P,
        state: &FrameState,
    ) -> Option<Deformed> {
        let deformation = mesh.deformation.as_ref()?;
        let vertices = match &self.by {
            DeformedBy::Player(nodes) => {
                nodes.pose(deformation, &mesh.triangles, pose_of(nodes.player).borrow())
            }
            DeformedBy::Script(model) => match (state.meshes.get(model), &deformation.scripted) {
                (Some(set), Some(scripted)) => scripted.pose(mesh, &deformation.bind, set),
                _ => deformation.bind.clone(),
            },
        };
        let finite = vertices.positions.iter().all(|p| p.is_finite());
        let bounds = Bounds::around(vertices.positions.iter().copied());
        (finite && is_within_reach(&bounds)).then(|| Deformed {
            bounds,
            hash: xxh3_64(bytemuck::cast_slice(&vertices.positions)),
            vertices,
        })
    }
}

impl PlayedNodes {
    fn pose(&self, of: &Deformation, triangles: &[[u32; 3]], pose: &RigPose) -> Vertices {
        let joint = |(source, joint): (&JointSource, &Joint)| {
            let model_from_node = match source {
                JointSource::Slot(slot) => pose.nodes[*slot].model_from_node,
                JointSource::Still(transform) => *transform,
            };
            model_from_node * joint.node_from_mesh
        };
        let joints = self.joints.iter().zip(&self.nodes.joints).map(joint);
        let joints: Vec<_> = joints.collect();
        let animated = self.nodes.weights.and_then(|node| pose.weights.get(&node));
        let weights = animated.unwrap_or(&self.nodes.rest_weights);
        of.pose(triangles, weights, &joints)
    }
}
