//! The pixels that a selected decal covers.

use super::worker::Worker;
use crate::{viewer::protocol::Picked, write_back::picking::Surfaces};
use reflet_render::RenderError;

impl Worker {
    /// The selected decal as the last picture shows it, and which of its pixels it covers.
    pub(super) fn picked_decal(
        &self,
        index: usize,
        ids: &[[u32; 2]],
    ) -> Result<Option<(Picked, Vec<bool>)>, RenderError> {
        let world = self.live.world();
        let (Some(decal), Some(view)) = (world.decals.list.get(index), &self.rendered_view) else {
            return Ok(None);
        };
        let surfaces = Surfaces::new(&self.live, &self.camera(&view.camera))?;
        let bounds = decal.bounds();
        let covers = |(pixel, ids): (usize, &[u32; 2])| {
            let instance = ids[0] as usize;
            if world.decals.set_of(instance) == 0 {
                return false;
            }
            surfaces.point_at(pixel).is_some_and(|(point, normal)| {
                bounds.min.cmple(point).all()
                    && point.cmple(bounds.max).all()
                    && (world.covering_decals(instance, point, normal)).any(|other| other == index)
            })
        };
        let inside = ids.iter().enumerate().map(covers).collect();
        let picked = Picked {
            label: format!("decal {}", decal.name),
            material: decal.material,
            bounds,
            triangles: Some(0),
            outline: None,
        };
        Ok(Some((picked, inside)))
    }
}
