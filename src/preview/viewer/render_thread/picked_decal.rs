//! Picking of decals: the decals that cover a pixel, and the pixels that a selected decal covers.

use glam::{DVec2, Vec3};

use super::worker::Worker;
use crate::{
    viewer::protocol::{Picked, View},
    write_back::SceneItem,
};
use reflet_render::{PlaneData, RenderError, picture::aov::Aov, settings::view};

/// Largest distance between two clicks at the same place, parts of the picture.
const SAME_PLACE: f32 = 0.01;

/// Points and normals of the surfaces that the last picture shows.
struct Surfaces {
    view: view::View,
    depths: Vec<f32>,
    normals: Vec<f32>,
}

impl Surfaces {
    /// Point and normal at a pixel, if it shows a surface.
    fn point_at(&self, pixel: usize) -> Option<(Vec3, Vec3)> {
        let [width, height] = self.view.size;
        let (x, y) = (pixel as u32 % width, pixel as u32 / width);
        let depth = *self.depths.get(pixel)?;
        let normal = self.normals.get(3 * pixel..3 * pixel + 3)?;
        let part = |at: u32, side: u32| (f64::from(at) + 0.5) / f64::from(side) * 2.0 - 1.0;
        let (from, along) = self.view.ray(DVec2::new(part(x, width), -part(y, height)));
        let point = (from + along * f64::from(depth)).as_vec3();
        depth.is_finite().then(|| (point, Vec3::from_slice(normal)))
    }
}

impl Worker {
    fn surfaces(&self, view: &View) -> Result<Surfaces, RenderError> {
        let renderer = self.live.renderer();
        let camera = self.camera(&view.camera);
        let plane = |aov: Aov| -> Result<Vec<f32>, RenderError> {
            Ok(match aov.plane(&self.gpu, renderer, &camera)?.data {
                PlaneData::F32(all) => all,
                PlaneData::U32(_) => Vec::new(),
            })
        };
        let size = renderer.targets().size;
        Ok(Surfaces {
            view: view::View::new(&camera, size, renderer.unit_m()),
            depths: plane(Aov::Depth)?,
            normals: plane(Aov::Normal)?,
        })
    }

    /// Item that a click at a place of the picture selects: the topmost decal there, and by further clicks at the same
    /// place the decals below it, the instance, and the topmost again.
    pub(super) fn clicked(
        &mut self,
        view: &View,
        at: [f32; 2],
        (instance, pixel): (usize, usize),
    ) -> Result<Option<SceneItem>, RenderError> {
        let before = self.clicked_at.replace(at);
        let below = self.live.item_of(instance);
        if self.live.world().decals.set_of(instance) == 0 {
            return Ok(below);
        }
        let Some((point, normal)) = self.surfaces(view)?.point_at(pixel) else {
            return Ok(below);
        };
        let covering = self.live.world().covering_decals(instance, point, normal);
        let items: Vec<_> = covering.map(SceneItem::Decal).chain(below).collect();
        let is_again = before.is_some_and(|before| {
            let apart = [0, 1].map(|axis| (before[axis] - at[axis]).abs());
            apart.iter().all(|apart| *apart < SAME_PLACE)
        });
        let known = self.item.as_ref().filter(|_| is_again);
        let known = known.and_then(|(item, _)| items.iter().position(|other| other == item));
        let next = known.map_or(0, |index| (index + 1) % items.len().max(1));
        Ok(items.get(next).copied())
    }

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
        let surfaces = self.surfaces(view)?;
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
