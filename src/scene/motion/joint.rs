//! Poses that scripts give to nodes inside the files of instances.

use glam::{Affine3A, Quat, Vec3};

/// Changes that a script makes to a node, relative to its parent; `None` keeps the value of the file or its
/// animation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointPose {
    /// Translation in place of the node's own, meters.
    pub translation: Option<Vec3>,
    /// Rotation in place of the node's own.
    pub rotation: Option<Quat>,
    /// Scale along each axis, in place of the node's own.
    pub scale: Option<Vec3>,
    /// Additional rotation, about the node's own axes.
    pub turn: Option<Quat>,
}

impl JointPose {
    /// Transform from node to parent space of a node whose own transform is `own`.
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
