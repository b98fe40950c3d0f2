//! Seams between probes in a picture: where neighboring pixels of a surface take their reflections from other probes.

use glam::{DVec2, Vec3};

use super::score::{Reference, View, plane_f32, plane_u32};
use reflet_metric::borders;
use reflet_render as render;
use reflet_render::{
    methods::probes::{
        boxes::probe_boxes,
        choice::{MOST_BLENDED, ProbeChoice},
    },
    picture::aov::Aov,
    pipeline::cause::{Cause, Source},
    settings::view,
};
use reflet_scene::desc::{CameraDesc, ReflectionDesc, SelectBy};
use reflet_world::World;

/// Planes that tell which probes a pixel takes, beside the scored planes.
pub const PLANES: [Aov; 3] = [Aov::Depth, Aov::Normal, Aov::Ids];

/// A picture that looks reflections up in probes.
#[derive(Clone, Copy, Debug)]
pub struct Looked<'a> {
    /// Scene in the pose of the picture.
    pub world: &'a World,
    /// Camera of the picture.
    pub camera: &'a CameraDesc,
    /// Settings of the picture.
    pub settings: &'a ReflectionDesc,
    /// The picture, with [`PLANES`] and the scored planes.
    pub picture: &'a render::Picture,
}

/// Probes of a pixel, as far as a change of them makes a border. Weights of pixels change everywhere, and little from
/// one to the next; weights of instances change at joints alone, and by any amount.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Probes {
    /// The probes that take part, as bits.
    which: u64,
    strongest: u32,
    /// Weights, where the instance chooses.
    weights: Option<[f32; MOST_BLENDED]>,
}

impl Looked<'_> {
    /// Mean step of the picture along the borders between probes, beyond the steps beside them and the reference's: see
    /// [`borders::Maps::step`]. A border is where the set of blended probes changes, or which of them weighs most. None
    /// where the picture has no or few such pixels, or lacks a plane.
    pub fn seam_step(&self, view: &View, reference: &Reference) -> Option<f64> {
        let (positions, normals) = (self.positions()?, self.normals()?);
        let maps = borders::Maps {
            mask: &reference.mask,
            parts: &self.probes(&positions)?,
            positions: &positions,
            normals: &normals,
            test: view.display.pixels(),
            reference: reference.view.display.pixels(),
        };
        (maps.mask.is_scorable() && maps.test.len() == positions.len())
            .then(|| maps.step())
            .flatten()
    }

    /// Position of the surface of each pixel; the eye where there is none.
    fn positions(&self) -> Option<Vec<Vec3>> {
        let depths_m = plane_f32(&self.picture.planes, Aov::Depth)?;
        let [width, height] = self.picture.size;
        let view = view::View::new(self.camera, [width, height], self.world.unit_m());
        let at = |(i, depth_m): (usize, &f32)| {
            let depth_m = if depth_m.is_finite() { *depth_m } else { 0.0 };
            let [x, y] = [i as u32 % width, i as u32 / width].map(|i| f64::from(i) + 0.5);
            let right = 2.0 * x / f64::from(width) - 1.0;
            let up = 1.0 - 2.0 * y / f64::from(height);
            let (origin, direction) = view.ray(DVec2::new(right, up));
            (origin + direction * f64::from(depth_m)).as_vec3()
        };
        Some(depths_m.iter().enumerate().map(at).collect())
    }

    fn normals(&self) -> Option<Vec<Vec3>> {
        let channels = plane_f32(&self.picture.planes, Aov::Normal)?;
        Some(channels.chunks_exact(3).map(Vec3::from_slice).collect())
    }

    /// Probes of each pixel; none of a pixel that takes its reflection from elsewhere.
    fn probes(&self, positions: &[Vec3]) -> Option<Vec<Option<Probes>>> {
        let causes = plane_u32(&self.picture.planes, Aov::Cause)?;
        let ids = plane_u32(&self.picture.planes, Aov::Ids)?;
        let settings = &self.settings.probes;
        let boxes = probe_boxes(self.world, settings, 1.0).ok()?;
        let of = |i: usize| {
            let cause = Cause::from_number(causes[i])?;
            if cause.source(self.settings.method) != Source::Probe {
                return None;
            }
            let point = match settings.select {
                SelectBy::Pixel => positions[i],
                SelectBy::Instance => {
                    let instance = self.world.instances.get(ids[2 * i] as usize)?;
                    instance.world_from_object.translation.into()
                }
            };
            let choice = ProbeChoice::at_point(&boxes, point, settings.nearest);
            let taking = choice.probes.iter().zip(choice.weights);
            let which = taking.filter(|(_, weight)| *weight > 0.0);
            Some(Probes {
                which: which.fold(0, |bits, (probe, _)| bits | 1 << probe),
                strongest: choice.probes[0],
                weights: (settings.select == SelectBy::Instance).then_some(choice.weights),
            })
        };
        Some((0..causes.len()).map(of).collect())
    }
}
