//! Checks of posed cameras and lights.

use std::collections::HashMap;

use glam::Vec3;

use crate::desc::{CameraDesc, LIGHT, LightDesc, MOST_CD};

/// Kind of a thing that a script has set: tracks leave such cameras and lights alone, and editors say why other
/// values in the text would not be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// A camera.
    Camera,
    /// A decal.
    Decal,
    /// A light.
    Light,
    /// An instance, or a group by its index after the instances.
    Node,
    /// A `[material.NAME]`.
    Material,
    /// An instance's own `material = { … }`.
    Override,
    /// A material of a model's file, by its index in [`file_materials`](super::file_materials).
    FileMaterial,
}

/// Values that scripts have set in a frame: for each thing, bit `i` stands for field `i` of its table; of a node for
/// its translation, rotation and scale.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptedFields(HashMap<(Kind, usize), u32>);

impl ScriptedFields {
    /// Adds fields of a thing.
    pub fn add(&mut self, kind: Kind, index: usize, fields: u32) {
        *self.0.entry((kind, index)).or_default() |= fields;
    }

    /// Adds all fields of another list.
    pub fn extend(&mut self, more: Self) {
        for ((kind, index), fields) in more.0 {
            self.add(kind, index, fields);
        }
    }

    /// Whether any field of a thing is set.
    pub fn has_any(&self, kind: Kind, index: usize) -> bool {
        self.0.contains_key(&(kind, index))
    }

    /// Whether a field of a thing is set.
    pub fn has(&self, kind: Kind, index: usize, field: usize) -> bool {
        let fields = self.0.get(&(kind, index)).copied().unwrap_or_default();
        fields & (1 << field) != 0
    }
}

/// Reason why a camera can show nothing, as the end of a sentence; `None` if it can.
pub fn wrong_with_camera(camera: &CameraDesc) -> Option<&'static str> {
    let (forward, up) = (camera.target - camera.eye, camera.up);
    if !(camera.eye.is_finite() && camera.target.is_finite() && up.is_finite()) {
        return Some("has a number that is not finite");
    }
    let (Some(forward), Some(up)) = (
        forward.as_dvec3().try_normalize(),
        up.as_dvec3().try_normalize(),
    ) else {
        return Some("has `eye` and `target` in the same place, or no `up`");
    };
    (forward.cross(up).length() < 1e-6).then_some("has its view direction along `up`")
}

/// Reason of [`wrong_with_light`] about the brightness.
pub const TOO_BRIGHT: &str = "is brighter than 1e12 candela";

/// Reason why a light cannot shine, as the end of a sentence; `None` if it can.
pub fn wrong_with_light(light: &LightDesc) -> Option<&'static str> {
    if light.kind.intensity() > MOST_CD {
        return Some(TOO_BRIGHT);
    }
    let usable = |v: Option<Vec3>| v.is_none_or(Vec3::is_finite);
    let stands = LIGHT.iter().all(|field| usable((field.get)(light)));
    if !stands {
        return Some("has a number that is not finite");
    }
    let direction = light.kind.direction();
    direction
        .is_some_and(|d| d == Vec3::ZERO)
        .then_some("has no direction")
}
