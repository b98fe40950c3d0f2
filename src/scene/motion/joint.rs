//! What scripts pose inside the files of instances.

use glam::{Affine3A, Quat, Vec3};

/// What a script sets of a node, relative to its parent; the rest is as the file or its animation has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointPose {
    /// Meters.
    pub translation: Option<Vec3>,
    /// In place of its own.
    pub rotation: Option<Quat>,
    /// Factor along each axis.
    pub scale: Option<Vec3>,
    /// A further rotation, about the node's own axes.
    pub turn: Option<Quat>,
}

impl JointPose {
    /// Parent from node, of a node that is otherwise at `own`.
    pub fn over(&self, own: &Affine3A) -> Affine3A {
        let (scale, rotation, translation) = own.to_scale_rotation_translation();
        let rotation = self.rotation.unwrap_or(rotation);
        Affine3A::from_scale_rotation_translation(
            self.scale.unwrap_or(scale),
            rotation * self.turn.unwrap_or(Quat::IDENTITY),
            self.translation.unwrap_or(translation),
        )
    }
}
