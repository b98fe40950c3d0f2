//! Copies of an instance in its grid: names and transforms.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use crate::scene::desc::InstanceDesc;

/// One copy of a placed model.
pub struct Copy {
    /// Suffix of its name.
    pub suffix: String,
    /// From where the instance stands to where the copy does, in the space of the parent.
    pub from_instance: Affine3A,
    /// The node on which the copies hang, if they do.
    pub parent: Option<usize>,
    /// Transform of this copy.
    pub world_from_model: Affine3A,
}

/// Where an instance stands: itself, and what it hangs on.
#[derive(Clone)]
pub struct Stand {
    /// World from model space, at rest.
    pub world: Affine3A,
    /// What it hangs on, and its transform at rest.
    pub parent: Option<(usize, Affine3A)>,
    /// Where its copies stand, from itself, if a file says so.
    pub points: Option<Arc<[Affine3A]>>,
}

/// The copies of an instance.
pub fn copies(instance: Option<&InstanceDesc>, stand: Stand) -> impl Iterator<Item = Copy> + use<> {
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
    let points = stand.points.clone();
    let rows = points
        .into_iter()
        .flat_map(|points| (0..points.len()).map(move |row| (format!("[{row}]"), points[row])));
    let has_points = stand.points.is_some();
    let cells = cells.take(if has_points { 0 } else { usize::MAX });
    let parent = stand.parent.filter(|_| repeat.is_some() || has_points);
    cells.chain(rows).map(move |(suffix, from_instance)| Copy {
        suffix,
        from_instance,
        parent: parent.map(|(node, _)| node),
        world_from_model: match parent {
            Some((_, parent)) => parent * from_instance * parent.inverse() * stand.world,
            None => from_instance * stand.world,
        },
    })
}
