//! Scene summary for the window: plain values, while the rendering thread owns the world.

use super::view_channel::ShadowLight;
pub use crate::write_back::outline::OutlineRow;
use crate::{
    live::{Edit, Live, Problems},
    write_back::{KeyTrack, MaterialOrigin, outline::outline},
};
use reflet_base::{math::Bounds, unique_names::unique_names};
use reflet_render::{
    picture::debug_readback::shadow_faces, runtime::parameters::DeclaredParameters,
};
use reflet_scene::{
    desc::{CameraDesc, MaterialDesc, Method, TimelineDesc},
    diagnostic::Diagnostic,
};

/// One material of the material panel.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialRow {
    /// Name in the scene or file, numbered where it is not unique.
    pub name: String,
    /// Values of the material in the displayed frame.
    pub numbers: MaterialDesc,
    /// Values changed in the panel.
    pub edit: Edit,
    /// Table of the scene text that says its values, or can override them; `None` if there is none.
    pub origin: Option<String>,
    /// Number of instances that use it.
    pub uses: usize,
    /// Bounds of those instances.
    pub bounds: Bounds,
}

/// Everything that the window shows about the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// Timeline, if the scene has one.
    pub timeline: Option<TimelineDesc>,
    /// Cuts: first frame and camera index of each; the first begins at frame 0.
    pub cuts: Vec<(u32, usize)>,
    /// Tracks with keys.
    pub tracks: Vec<KeyTrack>,
    /// The script's parameters.
    pub declared: DeclaredParameters,
    /// Output of the script.
    pub log: Vec<String>,
    /// Name and value of each camera, in the displayed frame.
    pub cameras: Vec<(String, CameraDesc)>,
    /// Materials, indexed like the world's.
    pub materials: Vec<MaterialRow>,
    /// Lights with shadow maps.
    pub shadow_lights: Vec<ShadowLight>,
    /// Rows of the scene's outline.
    pub items: Vec<OutlineRow>,
    /// Bounds of the scene.
    pub bounds: Bounds,
    /// Width and height of the rendered image, pixels.
    pub image_size: [u32; 2],
    /// Method set in the scene, which may be `auto`.
    pub method: Method,
    /// The length U, meters.
    pub unit_m: f32,
    /// Features that the plan drops, and why.
    pub dropped: Vec<String>,
    /// Errors that keep the newest content from being shown.
    pub problems: Problems,
    /// Warnings about the displayed scene.
    pub warnings: Vec<Diagnostic>,
}

impl SceneSummary {
    /// Whether the scene has no instances.
    pub fn is_nothing(&self) -> bool {
        self.materials.iter().all(|row| row.uses == 0)
    }

    /// Camera index of the cut at a frame.
    pub fn cut_at(&self, frame: u32) -> Option<usize> {
        let before = self.cuts.iter().rev().find(|(from, _)| *from <= frame);
        before.map(|(_, camera)| *camera)
    }

    /// Summary of a live scene.
    pub fn from_live(live: &Live) -> Self {
        let world = live.world();
        let names = unique_names(world.materials.iter().map(|m| m.name.as_str()));
        let origin_of = |material, shown| MaterialOrigin::of(world, live.desc(), material, shown);
        let row = |(material, m): (usize, &reflet_world::Material)| MaterialRow {
            name: names[material].clone(),
            numbers: *m.numbers(),
            edit: live.edit_of(material),
            origin: None,
            uses: 0,
            bounds: Bounds::EMPTY,
        };
        let mut materials: Vec<MaterialRow> = world.materials.iter().enumerate().map(row).collect();
        let mut bounds = Bounds::EMPTY;
        for (index, instance) in world.instances.iter().enumerate() {
            let around = world.bounds_of(instance);
            let row = &mut materials[instance.material];
            if row.uses == 0
                && let Some(origin) = origin_of(instance.material, Some(index))
            {
                row.origin = Some(origin.label(live.desc()));
                row.numbers = origin.as_written(live.desc(), &row.numbers);
            }
            row.uses += 1;
            row.bounds = row.bounds.union(around);
            bounds = bounds.union(around);
        }
        for decal in &world.decals.list {
            let row = &mut materials[decal.material];
            row.bounds = row.bounds.union(decal.bounds());
            if let (None, Some(origin)) = (&row.origin, origin_of(decal.material, None)) {
                row.origin = Some(origin.label(live.desc()));
                row.numbers = origin.as_written(live.desc(), &row.numbers);
            }
        }
        let lights = unique_names(world.lights.iter().map(|light| light.name.as_str()));
        let dropped = live.renderer().plan().dropped.iter();
        Self {
            timeline: live.timeline().cloned(),
            cuts: live.cuts(),
            tracks: live.key_tracks(),
            declared: live.declared().clone(),
            log: live.log().cloned().collect(),
            cameras: (world.cameras.iter())
                .map(|entry| (entry.name.clone(), entry.value.clone()))
                .collect(),
            materials,
            shadow_lights: (world.lights.iter().enumerate())
                .map(|(light, lamp)| ShadowLight {
                    light,
                    name: lights[light].clone(),
                    faces: shadow_faces(light, lamp, live.renderer().options()),
                })
                .filter(|shadow_light| shadow_light.faces > 0)
                .collect(),
            items: outline(live.desc()),
            bounds,
            image_size: live.desc().image.size,
            method: live.desc().reflection.method,
            unit_m: live.renderer().unit_m(),
            dropped: dropped.map(|d| format!("{}: {}", d.what, d.why)).collect(),
            problems: live.problems.clone(),
            warnings: live.warnings().to_vec(),
        }
    }
}
