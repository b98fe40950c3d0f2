//! Picking: the item under a click on the last picture of a session. A decal is selected before the surface that it covers.

use glam::{DVec2, Vec3};

use super::item::SceneItem;
use reflet_render::{
    PlaneData, RenderError, picture::aov::Aov, pipeline::targets::Target, runtime::Session,
    settings::view,
};
use reflet_scene::desc::CameraDesc;
use reflet_world::World;

/// Largest distance between two clicks at the same place, parts of the picture.
const SAME_PLACE: f32 = 0.01;

/// Points and normals of the surfaces that the last picture shows.
#[derive(Debug)]
pub struct Surfaces {
    view: view::View,
    depths: Vec<f32>,
    normals: Vec<f32>,
}

impl Surfaces {
    /// Surfaces of the last picture, which `camera` shows.
    ///
    /// # Errors
    /// A lost or unresponsive device.
    pub fn new(session: &Session, camera: &CameraDesc) -> Result<Self, RenderError> {
        let renderer = session.renderer();
        let plane = |aov: Aov| -> Result<Vec<f32>, RenderError> {
            Ok(match aov.plane(session.gpu(), renderer, camera)?.data {
                PlaneData::F32(all) => all,
                PlaneData::U32(_) => Vec::new(),
            })
        };
        let size = renderer.targets().size;
        Ok(Self {
            view: view::View::new(camera, size, renderer.unit_m()),
            depths: plane(Aov::Depth)?,
            normals: plane(Aov::Normal)?,
        })
    }

    /// Point and normal at a pixel, if it shows a surface.
    pub fn point_at(&self, pixel: usize) -> Option<(Vec3, Vec3)> {
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

impl SceneItem {
    /// Item of the scene text that places an instance of a world: an instance there, or a model that is shown without;
    /// `None` past the world's instances.
    pub fn of_instance(world: &World, instance: usize) -> Option<Self> {
        match *world.written.get(instance)? {
            Some(index) => Some(Self::Instance(index)),
            None => world.placed_models.get(instance).copied().map(Self::Model),
        }
    }

    /// Index of the first instance of a world that this item places.
    pub fn instance_in(self, world: &World) -> Option<usize> {
        (0..world.instances.len()).find(|index| Self::of_instance(world, *index) == Some(self))
    }
}

/// Result of a click on the last picture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hit {
    /// Indices of the instance and of its triangle at each pixel.
    pub ids: Vec<[u32; 2]>,
    /// The clicked pixel: an index into `ids`.
    pub pixel: usize,
    /// The selected item.
    pub item: Option<SceneItem>,
}

impl Hit {
    /// Index of the clicked instance of the world; an index past its instances for the sky.
    pub fn instance(&self) -> usize {
        self.ids[self.pixel][0] as usize
    }
}

/// Clicks on pictures, of which another one at the same place selects what is below.
#[derive(Clone, Copy, Debug, Default)]
pub struct Clicks {
    /// Place of the last click, 0 to 1 from the top left.
    last: Option<[f32; 2]>,
}

impl Clicks {
    /// Selects at a place, 0 to 1 from the top left, of the last picture, which `camera` shows: the topmost decal there,
    /// and by further clicks the decals below it, the instance, and the topmost again.
    ///
    /// # Errors
    /// A lost or unresponsive device.
    pub fn hit(
        &mut self,
        session: &Session,
        camera: &CameraDesc,
        at: [f32; 2],
        selected: Option<SceneItem>,
    ) -> Result<Hit, RenderError> {
        let (renderer, world) = (session.renderer(), &session.scene().world);
        let [width, height] = renderer.targets().size;
        let part = |part: f32, side: u32| ((part * side as f32) as u32).min(side - 1);
        let pixel = (part(at[1], height) * width + part(at[0], width)) as usize;
        let ids: Vec<[u32; 2]> = renderer.read(session.gpu(), Target::Ids)?;
        let before = self.last.replace(at);
        let item = None;
        let mut hit = Hit { ids, pixel, item };
        let instance = hit.instance();
        let below = SceneItem::of_instance(world, instance);
        let mut items = Vec::new();
        if world.decals.set_of(instance) != 0
            && let Some((point, normal)) = Surfaces::new(session, camera)?.point_at(pixel)
        {
            let covering = world.covering_decals(instance, point, normal);
            items.extend(covering.map(SceneItem::Decal));
        }
        items.extend(below);
        let is_again = before.is_some_and(|before| {
            let apart = [0, 1].map(|axis| (before[axis] - at[axis]).abs());
            apart.iter().all(|apart| *apart < SAME_PLACE)
        });
        let known = selected.filter(|_| is_again);
        let known = known.and_then(|known| items.iter().position(|other| *other == known));
        let next = known.map_or(0, |index| (index + 1) % items.len());
        hit.item = items.get(next).copied();
        Ok(hit)
    }
}
