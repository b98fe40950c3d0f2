//! Where parts of a placed model are, and what moves them.

use glam::Affine3A;

use super::repeat::Copy;
use crate::world::{World, gltf::Attached, pose::Anchor};

/// A copy of a model that is being placed.
pub struct ModelInstance<'a> {
    /// Index of the `[[instance]]`; `None` for a model that no instance names.
    pub desc: Option<usize>,
    /// Whether that may move.
    pub dynamic: bool,
    /// Index into `Moving::players`, if it plays something.
    pub player: Option<usize>,
    /// Which copy.
    pub copy: &'a Copy,
}

/// Where a part of it is at rest, and what moves it, if anything does.
pub struct Place {
    pub world: Affine3A,
    pub world_from_model: Affine3A,
    pub anchor: Option<Anchor>,
}

impl Place {
    /// Whether an animation moves it.
    pub fn is_animated(&self) -> bool {
        self.anchor.as_ref().is_some_and(|a| a.node.is_some())
    }
}

impl ModelInstance<'_> {
    /// The place of something that hangs on a node of its file.
    pub fn of<T>(&self, world: &World, part: &Attached<T>) -> Place {
        let transforms = [part.node_from_object, part.model_from_object];
        self.place(world, part.node, transforms)
    }

    /// The place of something on `node`; the transforms are from its own space to the node's and
    /// to the model's.
    pub fn place(
        &self,
        world: &World,
        node: Option<usize>,
        [node_from_object, model_from_object]: [Affine3A; 2],
    ) -> Place {
        let slot = self.player.zip(node).and_then(|(player, node)| {
            let slot = world.moving.players[player].slot(node)?;
            Some((player, slot))
        });
        let anchor = (self.dynamic || slot.is_some()).then(|| Anchor {
            desc: self.desc,
            offset: self.copy.offset,
            node: slot,
            local: if slot.is_some() {
                node_from_object
            } else {
                model_from_object
            },
        });
        Place {
            world_from_model: self.copy.world_from_model,
            world: self.copy.world_from_model * model_from_object,
            anchor,
        }
    }
}
