//! Transforms of the parts of a placed model, static or animated.

use glam::Affine3A;

use super::repeat::Copy;
use crate::{World, animation::Pointed, gltf::Attached, pose::Anchor};
use reflet_scene::desc::ShownDesc;

/// A model copy being placed.
pub struct ModelInstance<'a> {
    /// Index of the `[[instance]]`; `None` for a model that no instance names.
    pub desc: Option<usize>,
    /// Whether the instance may move.
    pub dynamic: bool,
    /// Index into `Moving::players`, if it plays an animation.
    pub player: Option<usize>,
    /// Visibility to rays of the camera, shadows and reflections.
    pub shown: ShownDesc,
    /// Copy that is placed.
    pub copy: &'a Copy,
}

/// Rest transform of a part, and its animation, if any.
pub struct Place {
    pub world: Affine3A,
    pub world_from_model: Affine3A,
    pub anchor: Option<Anchor>,
    pub shown: ShownDesc,
}

impl Place {
    /// Whether an animation of the file moves the part.
    pub fn is_animated(&self) -> bool {
        self.anchor.as_ref().is_some_and(|a| a.node.is_some())
    }
}

impl ModelInstance<'_> {
    /// Transform of an item attached to a node of its file.
    pub fn place<T>(&self, world: &World, part: &Attached<T>) -> Place {
        let transforms = [part.node_from_object, part.model_from_object];
        self.place_on(world, part.node, part.is_skinned, transforms)
    }

    /// Player that animates values of a light or camera of the file, and the object in the file.
    pub fn pointed(&self, world: &World, object: Option<Pointed>) -> Option<(usize, Pointed)> {
        let (player, object) = self.player.zip(object)?;
        let changes = world.moving.players[player].changes(object);
        changes.then_some((player, object))
    }

    /// Anchor of an item that only its instance moves.
    pub fn still<T>(&self, part: &Attached<T>) -> Anchor {
        Anchor {
            desc: self.desc,
            copy: self.copy.from_instance,
            parent: self.copy.parent,
            node: None,
            is_skinned: false,
            local: part.model_from_object,
        }
    }

    /// Transform of the model itself.
    pub fn whole(&self, world: &World) -> Place {
        self.place_on(world, None, false, [Affine3A::IDENTITY; 2])
    }

    /// Transform of an item on `node`; the given transforms are from the item's space to the node's and to the
    /// model's.
    fn place_on(
        &self,
        world: &World,
        node: Option<usize>,
        is_skinned: bool,
        [node_from_object, model_from_object]: [Affine3A; 2],
    ) -> Place {
        let slot = self.player.zip(node).and_then(|(player, node)| {
            let slot = world.moving.players[player].slot(node)?;
            Some((player, slot))
        });
        let anchor = (self.dynamic || slot.is_some()).then(|| Anchor {
            desc: self.desc,
            copy: self.copy.from_instance,
            parent: self.copy.parent,
            node: slot,
            is_skinned,
            local: if slot.is_some() && !is_skinned {
                node_from_object
            } else {
                model_from_object
            },
        });
        Place {
            world_from_model: self.copy.world_from_model,
            world: self.copy.world_from_model * model_from_object,
            anchor,
            shown: self.shown,
        }
    }
}
