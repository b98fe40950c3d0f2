//! Checks of posed cameras and lights.

use std::collections::HashMap;

use glam::Vec3;

use crate::desc::{CameraDesc, LIGHT, LightDesc, MATERIAL_FIELDS, MOST_CD};

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

const _: () = assert!(
    MATERIAL_FIELDS <= u64::BITS as usize,
    "a bit for each value"
);

/// Values that scripts have set in a frame: for each thing, bit `i` stands for field `i` of its table; of a node for
/// its translation, rotation and scale.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScriptedFields(HashMap<(Kind, usize), u64>);

impl ScriptedFields {
    /// Adds fields of a thing.
    pub fn add(&mut self, kind: Kind, index: usize, fields: u64) {
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

/// Reason why a camera or a light is useless.
#[derive(Clone, Copy, Debug)]
pub struct Unusable {
    /// End of a sentence that begins with the camera or the light.
    pub why: &'static str,
    /// Advice.
    pub help: &'static str,
}

impl Unusable {
    /// A missing or wrong direction.
    const fn by_direction(why: &'static str) -> Self {
        let help = "let the point that it looks at move too, or lead it around that point, as in \
                    `eye = { orbit = { center = [0, 1, 0], period_s = 8 } }`";
        Self { why, help }
    }
}

/// Reason why a camera can show nothing; `None` if it can.
pub fn wrong_with_camera(camera: &CameraDesc) -> Option<Unusable> {
    let (forward, up) = (camera.target - camera.eye, camera.up);
    let wrong = Unusable::by_direction;
    if !(camera.eye.is_finite() && camera.target.is_finite() && up.is_finite()) {
        return Some(wrong("has a number that is not finite"));
    }
    let (Some(forward), Some(up)) = (
        forward.as_dvec3().try_normalize(),
        up.as_dvec3().try_normalize(),
    ) else {
        return Some(wrong(
            "has `eye` and `target` in the same place, or no `up`",
        ));
    };
    let is_along = forward.cross(up).length() < 1e-6;
    is_along.then(|| wrong("has its view direction along `up`"))
}

/// Reason why a light cannot shine; `None` if it can.
pub fn wrong_with_light(light: &LightDesc) -> Option<Unusable> {
    if light.kind.intensity() > MOST_CD {
        return Some(Unusable {
            why: "is brighter than 1e12 candela",
            help: "lower its flux or power, or widen its beam",
        });
    }
    let wrong = Unusable::by_direction;
    let usable = |v: Option<Vec3>| v.is_none_or(Vec3::is_finite);
    let stands = LIGHT.iter().all(|field| usable((field.get)(light)));
    if !stands {
        return Some(wrong("has a number that is not finite"));
    }
    let direction = light.kind.direction();
    let has_none = direction.is_some_and(|d| d == Vec3::ZERO);
    has_none.then(|| wrong("has no direction"))
}
