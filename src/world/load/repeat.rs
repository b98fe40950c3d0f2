//! Copies of an instance in its grid: names and transforms.

use glam::{Affine3A, Vec3};

use crate::scene::{desc::InstanceDesc, motion::transform};

/// One copy of a placed model.
pub struct Copy {
    /// Suffix of its name.
    pub suffix: String,
    /// Offset of its grid cell, meters.
    pub offset: Vec3,
    /// Transform of this copy.
    pub world_from_model: Affine3A,
}

/// The copies of an instance.
pub fn copies(instance: Option<&InstanceDesc>) -> impl Iterator<Item = Copy> + use<> {
    let base = instance.map_or(Affine3A::IDENTITY, |i| transform(&i.placement));
    let repeat = instance.and_then(|i| i.repeat);
    let [nx, ny, nz] = repeat.map_or([1; 3], |r| r.count);
    let step = repeat.map_or(Vec3::ZERO, |r| r.step);
    let cells =
        (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])));
    cells.map(move |[x, y, z]| {
        let offset = step * Vec3::new(x as f32, y as f32, z as f32);
        let suffix = if repeat.is_some() {
            format!("[{x},{y},{z}]")
        } else {
            String::new()
        };
        Copy {
            suffix,
            offset,
            world_from_model: Affine3A::from_translation(offset) * base,
        }
    })
}
