//! Copies of an instance in its grid or from its file of points: names and transforms.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use reflet_scene::desc::InstanceDesc;

/// One copy of a placed model.
pub struct Copy {
    /// Suffix of the copy's name.
    pub suffix: String,
    /// Transform from the instance to the copy, in the space of the parent.
    pub from_instance: Affine3A,
    /// Index of the instance or group that is the parent of the copies, if any.
    pub parent: Option<usize>,
    /// Transform of the copy from the model's space to the world.
    pub world_from_model: Affine3A,
}

/// Placement of an instance at rest: its transform, its parent and its copies.
#[derive(Clone)]
pub struct InstancePlacement {
    /// Transform from the model's space to the world at rest.
    pub world: Affine3A,
    /// Index and rest transform of the parent, if any.
    pub parent: Option<(usize, Affine3A)>,
    /// Transforms of the copies relative to the instance, if a file gives them.
    pub points: Option<Arc<[Affine3A]>>,
}

/// The copies of an instance.
pub fn copies(
    instance: Option<&InstanceDesc>,
    placement: InstancePlacement,
) -> impl Iterator<Item = Copy> + use<> {
    let repeat = instance.and_then(|i| i.repeat);
    let [nx, ny, nz] = repeat.map_or([1; 3], |r| r.count);
    let step = repeat.map_or(Vec3::ZERO, |r| r.step);
    let cells =
        (0..nx).flat_map(move |x| (0..ny).flat_map(move |y| (0..nz).map(move |z| [x, y, z])));
    let cells = cells.map(move |[x, y, z]| {
        let offset = step * Vec3::new(x as f32, y as f32, z as f32);
        let suffix = match repeat {
            Some(_) => format!("[{x},{y},{z}]"),
            None => String::new(),
        };
        (suffix, Affine3A::from_translation(offset))
    });
    let points = placement.points.clone();
    let rows = points
        .into_iter()
        .flat_map(|points| (0..points.len()).map(move |row| (format!("[{row}]"), points[row])));
    let has_points = placement.points.is_some();
    let cells = cells.take(if has_points { 0 } else { usize::MAX });
    let parent = placement.parent.filter(|_| repeat.is_some() || has_points);
    cells.chain(rows).map(move |(suffix, from_instance)| Copy {
        suffix,
        from_instance,
        parent: parent.map(|(node, _)| node),
        world_from_model: match parent {
            Some((_, parent)) => parent * from_instance * parent.inverse() * placement.world,
            None => from_instance * placement.world,
        },
    })
}
