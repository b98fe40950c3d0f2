//! Instances of a top level in one pose.

use obvhs::aabb::Aabb;

use super::{NONE, TraceInstance};
use crate::{World, reach::is_within_reach};

/// The instances of a top level in one pose.
pub(super) struct PlacedInstances {
    /// Instance records, parallel to [`Trees::top_instances`], without the roots of their trees.
    pub records: Vec<TraceInstance>,
    /// Index of each instance that rays can hit.
    pub ids: Vec<u32>,
    /// World-space boxes of these instances.
    pub boxes: Vec<Aabb>,
}

impl PlacedInstances {
    pub fn new(world: &World, top_instances: &[u32]) -> Self {
        let mut placed = Self {
            records: Vec::with_capacity(top_instances.len()),
            ids: Vec::new(),
            boxes: Vec::new(),
        };
        for id in top_instances {
            let instance = &world.instances[*id as usize];
            let record = TraceInstance::new(instance, world, NONE);
            placed.records.push(record);
            let bounds = world.bounds_of(instance);
            let rows = record.object_from_world;
            let rows_finite = rows.as_flattened().iter().all(|x| x.is_finite());
            if rows_finite && is_within_reach(&bounds) {
                // Corners were rounded when transformed: keep the box conservative.
                let slack = bounds.min.abs().max(bounds.max.abs()) * (4.0 * f32::EPSILON);
                placed.ids.push(*id);
                placed.boxes.push(Aabb::new(
                    (bounds.min - slack).into(),
                    (bounds.max + slack).into(),
                ));
            }
        }
        placed
    }
}
