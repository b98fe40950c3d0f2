//! Visible things of a picture, by a grid of rays; hidden things, by points spread over their surfaces.

use glam::{DVec2, UVec2};
use rayon::prelude::*;

use super::{
    POINTS,
    answer::{Share, Thing, UnseenFor},
    rounded, surfaces,
    things::Things,
};
use crate::decide::view_rays::{SurfacePoint, ViewRays};
use reflet_world::sight::{Sight, Unseen};

/// Number of rays through the picture; a smaller picture has one through the middle of each pixel.
const RAYS: f64 = 160.0 * 90.0;
/// Largest distance at which two depths are of one surface, as a share of the depth.
const SAME_PLACE: f64 = 1e-4;

/// Visible and hidden things in the picture of a camera.
pub struct Visibility<'a> {
    rays: ViewRays<'a>,
    things: &'a Things,
    /// Columns and rows of the grid.
    pub grid: [u32; 2],
    /// Share of the picture without a surface.
    pub background: f64,
    /// Index of the camera.
    camera: usize,
    /// Views of all cameras.
    sights: Vec<Sight>,
    /// First surface of each ray that meets one.
    first: Vec<SurfacePoint>,
    /// Hits of each thing.
    seen: Vec<Seen>,
}

/// Hits of a thing in the grid.
#[derive(Clone, Copy)]
struct Seen {
    rays: u32,
    /// Least and greatest cell.
    cells: [UVec2; 2],
    nearest_m: f64,
}

impl<'a> Visibility<'a> {
    /// Follows the rays of the view of a camera, by its index.
    pub fn new(rays: ViewRays<'a>, things: &'a Things, camera: usize, unit_m: f32) -> Self {
        let size = rays.view.size;
        let pixels = f64::from(size[0]) * f64::from(size[1]);
        let step = (pixels / RAYS).sqrt().max(1.0);
        let grid = size.map(|side| ((f64::from(side) / step).round() as u32).max(1));
        let cell = |index: u32| UVec2::new(index % grid[0], index / grid[0]);
        let follow = |index: u32| {
            let place = (cell(index).as_dvec2() + 0.5) / UVec2::from(grid).as_dvec2();
            let ray = rays.primary(place);
            let hits: Vec<_> = surfaces::along(&rays, ray).collect();
            let first = hits.first().map(|hit| rays.point(hit, ray.direction));
            let length = ray.direction.length();
            let met = hits
                .iter()
                .map(|hit| (things.of(hit.instance as usize), hit.t * length));
            (index, first, met.collect::<Vec<_>>())
        };
        let followed: Vec<_> = (0..grid[0] * grid[1]).into_par_iter().map(follow).collect();
        let nothing = Seen {
            rays: 0,
            cells: [UVec2::MAX, UVec2::ZERO],
            nearest_m: f64::MAX,
        };
        let mut seen = vec![nothing; things.len()];
        for (index, _, met) in &followed {
            for (k, (thing, distance_m)) in met.iter().enumerate() {
                let own = &mut seen[*thing];
                // Both walls of a glass are one thing.
                own.rays += u32::from(met[..k].iter().all(|(other, _)| other != thing));
                own.cells = [
                    own.cells[0].min(cell(*index)),
                    own.cells[1].max(cell(*index)),
                ];
                own.nearest_m = own.nearest_m.min(*distance_m);
            }
        }
        let count = followed.len() as f64;
        let first: Vec<_> = followed
            .into_iter()
            .filter_map(|(_, first, _)| first)
            .collect();
        Self {
            rays,
            things,
            grid,
            camera,
            sights: (rays.world.cameras.iter())
                .map(|c| Sight::new(&c.value, c.value.near_in(unit_m), size))
                .collect(),
            background: 1.0 - first.len() as f64 / count,
            first,
            seen,
        }
    }

    /// Share of the picture that shows a thing.
    pub fn share(&self, thing: usize) -> f64 {
        f64::from(self.seen[thing].rays) / f64::from(self.grid[0] * self.grid[1])
    }

    /// At most `most` visible points, of a thing or of all; of a thing that is not visible, points spread over its
    /// surface.
    pub fn points(&self, thing: Option<usize>, most: usize) -> Vec<SurfacePoint> {
        let is_of =
            |p: &&SurfacePoint| thing.is_none_or(|thing| self.things.of(p.instance) == thing);
        let shown: Vec<_> = self.first.iter().filter(is_of).copied().collect();
        match (thing, shown.len()) {
            (Some(thing), 0) => surfaces::points(&self.rays, self.things.instances(thing), most),
            (_, count) => shown
                .into_iter()
                .step_by(count.div_ceil(most).max(1))
                .collect(),
        }
    }

    /// Adds the visible and the hidden share of a thing, and the things that hide it.
    pub fn describe(&self, thing: usize, to: &mut Thing) {
        let seen = self.seen[thing];
        let cell =
            DVec2::from(self.rays.view.size.map(f64::from)) / UVec2::from(self.grid).as_dvec2();
        let edges = [
            seen.cells[0].as_dvec2() * cell,
            (seen.cells[1].as_dvec2() + 1.0) * cell,
        ];
        let mut shown = (seen.rays > 0).then_some((edges, seen.nearest_m));
        let mut hidden_by = vec![0; self.things.len()];
        let mut in_picture = 0;
        for point in surfaces::points(&self.rays, self.things.instances(thing), POINTS) {
            let (place, depth_m) = self.rays.view.place(point.position);
            let part = DVec2::new(place.x, -place.y) * 0.5 + 0.5;
            let ray = self.rays.primary(part);
            let instance = &self.rays.world.instances[point.instance];
            let is_back = ray.direction.dot(point.normal) >= 0.0
                && !self.rays.world.materials[instance.material].double_sided;
            let is_inside = part.cmpge(DVec2::ZERO).all() && part.cmplt(DVec2::ONE).all();
            let is_cut = depth_m <= ray.t_min || depth_m >= ray.t_max;
            if !is_inside || is_cut || is_back || !instance.shown.visible {
                continue;
            }
            let before: Vec<_> = surfaces::all_along(&self.rays, ray)
                .take_while(|hit| hit.t < depth_m * (1.0 - SAME_PLACE))
                .map(|hit| (self.things.of(hit.instance as usize), hit))
                .collect();
            if before.iter().any(|(other, _)| *other == thing) {
                continue; // its own far side
            }
            let mut before = before.into_iter();
            match before.find(|(_, hit)| !surfaces::passes_light(&self.rays, hit)) {
                Some((other, _)) => hidden_by[other] += 1,
                None if seen.rays == 0 => {
                    let at = part * DVec2::from(self.rays.view.size.map(f64::from));
                    let distance_m = depth_m * ray.direction.length();
                    let ([low, high], nearest_m) = shown.unwrap_or(([at, at], distance_m));
                    shown = Some(([low.min(at), high.max(at)], nearest_m.min(distance_m)));
                }
                None => {}
            }
            in_picture += 1;
        }
        let why = self.unseen(self.camera, thing);
        let shown = shown.filter(|_| why != Some(Unseen::Transparent));
        let part = |count: u32| rounded(f64::from(count) / f64::from(in_picture));
        let mut shares: Vec<_> = (hidden_by.iter().enumerate())
            .filter(|(_, count)| **count > 0)
            .map(|(other, count)| Share {
                name: self.things.name(other).to_owned(),
                share: part(*count),
            })
            .collect();
        shares.sort_by(|a, b| b.share.total_cmp(&a.share));
        let all = hidden_by.iter().sum();
        to.share = rounded(self.share(thing));
        to.visible = shown.is_some();
        to.box_px = shown.map(|([low, high], _)| [low.x, low.y, high.x, high.y].map(rounded));
        to.distance_m = shown.map(|(_, nearest_m)| rounded(nearest_m));
        to.hidden = if all > 0 { part(all) } else { 0.0 };
        to.hidden_by = shares;
        to.unseen = shown.is_none().then_some(match why {
            None => UnseenFor::Hidden,
            Some(Unseen::Nothing | Unseen::Hidden) => UnseenFor::SwitchedOff,
            Some(Unseen::Outside) => UnseenFor::Outside,
            Some(Unseen::TooNear(_)) => UnseenFor::TooNear,
            Some(Unseen::CutAway) => UnseenFor::CutAway,
            Some(Unseen::Transparent) => UnseenFor::Transparent,
            Some(Unseen::Backs) => UnseenFor::Backs,
            Some(Unseen::Small) => UnseenFor::Small,
        });
        let cameras = (0..self.sights.len()).filter(|camera| self.is_in_picture(*camera, thing));
        let world = self.rays.world;
        to.in_pictures_of = cameras
            .map(|camera| world.cameras[camera].name.clone())
            .collect();
    }

    /// Names of the things that are in no camera's picture.
    pub fn outside_of_all(&self) -> Vec<String> {
        let is_outside = |thing: &usize| {
            let mut cameras = 0..self.sights.len();
            cameras.all(|camera| self.unseen(camera, *thing) == Some(Unseen::Outside))
        };
        let outside = (0..self.things.len()).filter(is_outside);
        outside
            .map(|thing| self.things.name(thing).to_owned())
            .collect()
    }

    /// Whether a thing is in the picture of a camera, hidden by others or not.
    fn is_in_picture(&self, camera: usize, thing: usize) -> bool {
        let why = self.unseen(camera, thing);
        why.is_none_or(|why| !matches!(why, Unseen::Nothing | Unseen::Hidden | Unseen::Outside))
    }

    /// Why the picture of a camera would show nothing of a thing that no other hides; `None` where it would.
    fn unseen(&self, camera: usize, thing: usize) -> Option<Unseen> {
        let world = self.rays.world;
        let mut why = Unseen::Nothing;
        for index in self.things.instances(thing) {
            let instance = &world.instances[*index];
            let mesh = &world.meshes[instance.mesh];
            let own = self.sights[camera].unseen_instance(world, mesh, instance)?;
            why = if own > why { own } else { why };
        }
        Some(why)
    }
}
