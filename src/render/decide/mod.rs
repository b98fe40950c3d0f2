//! Decides the settings that options leave to `auto`, by the cost model.

pub mod cost;
pub(crate) mod cull;
pub(crate) mod edge_on;
mod filtered_lights;
pub mod shadow_texels;
pub mod skip;
pub mod trace_choice;
pub mod view_estimate;
pub mod view_rays;
pub mod view_sample;

use std::collections::BTreeSet;

use serde::Serialize;

use reflet_scene::desc::{
    CameraDesc, Exposure, LightKind, Method, Samples, ShadowMode, Visibility,
};
use reflet_world::{Light, World, bvh::Trees};

use super::{
    decide::{
        cost::{Pair, Workload},
        cull::is_outside,
        edge_on::has_edge_on_surfaces,
        filtered_lights::filtered_lights,
        shadow_texels::{COARSE_PX, SeenSurfaces},
        view_estimate::ViewEstimate,
        view_sample::ViewSample,
    },
    lighting::lights::{CUBE_FACES, has_cube_map},
    plan::{reflects, traces_rays},
    settings::{options::RenderOptions, unit_costs::UnitCosts, view::View},
};

/// A value chosen for a setting that was left to `auto`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Decision {
    /// Scene key, or the lights that the choice is for.
    pub what: String,
    /// Chosen value.
    pub chosen: String,
    /// Reason for the choice, as text for users.
    pub why: String,
}

/// Options without `auto`, and the reasons of the choices.
#[derive(Clone, Debug, PartialEq)]
pub struct Decided {
    /// Options with a value for each setting that was `auto`.
    pub options: RenderOptions,
    /// One entry for each choice.
    pub decisions: Vec<Decision>,
    /// Whether the reflections of an instance are traced at once rather than marched, by index; empty: all are marched.
    pub traced: Vec<bool>,
}

/// Whether frames trace rays, or [`decide`] needs them.
pub fn needs_trees(world: &World, options: &RenderOptions) -> bool {
    let is_auto = |light: &Light| light.desc.shadow == ShadowMode::Auto;
    traces_rays(world, options)
        || options.image.exposure_ev == Exposure::Auto
        || world.lights.iter().any(is_auto)
}

/// Decides the options left to `auto` for a posed world, as its camera [`RenderOptions::camera`] shows it. `trees` come
/// from [`needs_trees`]; `software` tells the kind of the adapter. A draft gets the options of the whole picture.
pub fn decide(world: &World, trees: &Trees, options: &RenderOptions, software: bool) -> Decided {
    let options = &RenderOptions {
        filtered_lights: filtered_lights(world),
        ..*options
    };
    let mut decider = Decider {
        workload: None,
        world,
        trees,
        asked: *options,
        unit: options.costs.unwrap_or(UnitCosts::of_kind(software)),
        other: (options.costs.is_none() && !software).then_some(UnitCosts::CARD),
        decided: Decided {
            options: *options,
            decisions: Vec::new(),
            traced: Vec::new(),
        },
    };
    decider.method();
    decider.shadows();
    decider.visibility();
    decider.exposure();
    let mut decided = decider.decided;
    if let Some(draft) = decided.options.draft.take() {
        let image = &mut decided.options.image;
        (image.size, image.samples) = (draft.size, Samples::Count(draft.samples));
    }
    decided
}

struct Decider<'a> {
    /// Counts of the view, made on first use.
    workload: Option<Workload>,
    world: &'a World,
    trees: &'a Trees,
    asked: RenderOptions,
    unit: UnitCosts,
    /// Costs of another class of the same kind of adapter, which are shown where they would choose otherwise.
    other: Option<UnitCosts>,
    decided: Decided,
}

impl Decider<'_> {
    fn workload(&mut self) -> &Workload {
        let (world, trees, options) = (self.world, self.trees, &self.asked);
        (self.workload).get_or_insert_with(|| workload(world, trees, options))
    }

    fn choose(&mut self, what: &str, chosen: &str, why: String) {
        self.decided.decisions.push(Decision {
            what: what.to_owned(),
            chosen: chosen.to_owned(),
            why,
        });
    }

    fn method(&mut self) {
        let is_split = self.asked.reflection.marches_cheaper_only();
        if self.asked.reflection.method != Method::Auto && !is_split {
            return;
        }
        if !reflects(self.world, self.asked.reflection.reflects_below()) {
            self.decided.options.reflection.method = Method::Rt;
            return;
        }
        let view = view_of(self.world, &self.asked);
        if self.asked.reflection.verifies() && has_edge_on_surfaces(self.world, &view) {
            self.decided.options.reflection.method = Method::Rt;
            let why =
                "the camera sees surfaces edge-on, which no pixel shows, so no ray is marched";
            return self.choose("reflection.method", Method::Rt.name(), why.to_owned());
        }
        let (unit, other, instances) = (self.unit, self.other, self.world.instances.len());
        let workload = self.workload();
        let (traced, pair) = reflections(workload, &unit, instances, is_split);
        let view = &workload.view;
        let percent = |part: u32, of: u32| 100.0 * f64::from(part) / f64::from(of.max(1));
        let sampled = view.all_mirror();
        let marched = view
            .mirror
            .iter()
            .filter(|(instance, _)| !traced[**instance]);
        let marched_surfaces = marched.clone().count();
        let marched_rays = marched.map(|(_, rays)| rays.rays).sum();
        let mut why = format!(
            "{pair}; {:.0} % of the pixels reflect, of which the picture shows {:.0} %",
            percent(sampled.rays, view.rays),
            percent(sampled.shown, sampled.rays),
        );
        let others = other.map(|other| reflections(workload, &other, instances, is_split).1);
        if let Some(others) = others.filter(|others| others.cheaper() != pair.cheaper()) {
            let text = format!(
                "; a data-center chip's costs decide; by a graphics card's of 2013, hybrid takes {:.2} of the time of rt",
                others.ratio()
            );
            why.push_str(&text);
        }
        let part = format!("{marched_surfaces} of {} surfaces", view.mirror.len());
        let share = format!(
            "they have {:.0} % of the reflective pixels; rays of the others take less time to trace",
            percent(marched_rays, sampled.rays)
        );
        let chosen = match pair.cheaper() {
            "hybrid" => Method::Hybrid,
            _ => Method::Rt,
        };
        self.decided.options.reflection.method = chosen;
        self.choose("reflection.method", chosen.name(), why);
        if chosen == Method::Hybrid && marched_rays < sampled.rays {
            self.choose("reflection.marched", &part, share);
        }
        if chosen == Method::Hybrid {
            self.decided.traced = traced;
        }
    }

    fn shadows(&mut self) {
        let lights = self.world.lights.iter().enumerate();
        let mapped = lights.filter(|(_, l)| is_mapped(l));
        let filtered = mapped
            .clone()
            .filter(|(i, _)| self.asked.filtered_lights >> i & 1 != 0);
        if filtered.clone().next().is_some() {
            let why = format!(
                "light of {} of {} lights passes a surface, which one depth of a map cannot tell",
                filtered.count(),
                mapped.count()
            );
            self.choose("shadow maps", "ray", why);
        }
        let undecided = self.asked.undecided_lights(self.world);
        let kinds: BTreeSet<usize> = undecided.map(|l| l.desc.kind.index()).collect();
        for kind in kinds {
            let what = format!("shadow of {} lights", LightKind::NAMES[kind]);
            if let Some(span) = self.coarsest_px(kind).filter(|span| *span > COARSE_PX) {
                self.decided.options.auto_shadow[kind] = ShadowMode::Ray;
                let why = format!("a texel of a map would span {span:.0} pixels");
                self.choose(&what, "ray", why);
                continue;
            }
            if !traces_rays(self.world, &self.decided.options) {
                self.choose(&what, "map", NO_RAYS.to_owned());
                continue;
            }
            let unit = self.unit;
            let pair = self.workload().shadow(&unit, kind);
            let name = pair.cheaper();
            self.decided.options.auto_shadow[kind] = match name {
                "ray" => ShadowMode::Ray,
                _ => ShadowMode::Map,
            };
            self.choose(&what, name, pair.to_string());
        }
    }

    /// Largest number of pixels that a shadow map texel would span, over the `auto` lights of a kind.
    fn coarsest_px(&self, kind: usize) -> Option<f32> {
        let (world, trees) = (self.world, self.trees);
        let seen = SeenSurfaces::new(world, trees, &view_of(world, &self.asked));
        let undecided = self.asked.undecided_lights(world);
        let lights = undecided.filter(|l| l.desc.kind.index() == kind);
        let spans = lights.filter_map(|l| seen.texel_px(l, map_px(world, l) as u32));
        spans.max_by(f32::total_cmp)
    }

    fn visibility(&mut self) {
        let what = "image.visibility";
        let has_lines = (self.world.meshes.iter()).any(|mesh| mesh.at_least_a_pixel);
        if has_lines && self.asked.image.visibility != Visibility::Raster {
            self.decided.options.image.visibility = Visibility::Raster;
            let why = "points and lines are drawn at least a pixel wide, in trees they are as thin as they are";
            return self.choose(what, "raster", why.to_owned());
        }
        if self.asked.image.visibility != Visibility::Auto {
            return;
        }
        self.decided.options.image.visibility = Visibility::Raster;
        if !traces_rays(self.world, &self.decided.options) {
            return self.choose(what, "raster", NO_RAYS.to_owned());
        }
        let unit = self.unit;
        let pair = self.workload().visibility(&unit);
        if pair.cheaper() == "rays" {
            self.decided.options.image.visibility = Visibility::Rays;
        }
        self.choose(what, pair.cheaper(), pair.to_string());
    }

    fn exposure(&mut self) {
        if self.asked.image.exposure_ev != Exposure::Auto {
            return;
        }
        let (world, settings) = (self.world, &self.asked.reflection);
        let unit_m = self.asked.unit_m(world);
        let reach_m = settings.ray_length_u * unit_m;
        let view = View::new(&seen_by(world, &self.asked), self.asked.image.size, unit_m);
        let cutoff = settings.reflects_below();
        let estimate = ViewEstimate::new(world, self.trees, &view, cutoff, reach_m);
        let mut radiance = estimate.radiance;
        radiance.sort_by(f32::total_cmp);
        let bright = radiance
            .get(radiance.len() * 9 / 10)
            .copied()
            .unwrap_or(0.0);
        // Rounded to a tenth of a stop, so that different rounding errors give the same exposure.
        let stops = ((LIGHT_GRAY / bright).log2() * 10.0).round() / 10.0;
        let ev = if bright > 0.0 {
            stops.clamp(-20.0, 20.0)
        } else {
            0.0
        };
        self.decided.options.image.exposure_ev = Exposure::Ev(ev);
        let why = format!("a tenth of the first frame has a radiance of {bright:.3} or more");
        self.choose("image.exposure_ev", &ev.to_string(), why);
    }
}

/// Instances that are traced at once, and the expected costs of the methods then; `is_split`: only the surfaces are
/// marched for which that is cheaper.
fn reflections(
    workload: &Workload,
    unit: &UnitCosts,
    instances: usize,
    is_split: bool,
) -> (Vec<bool>, Pair) {
    let traced = match is_split {
        true => workload.cheaper_traced(unit, instances),
        false => vec![false; instances],
    };
    let pair = workload.reflections(unit, |instance| traced[instance]);
    (traced, pair)
}

/// Radiance after exposure of the 90th percentile of the view.
const LIGHT_GRAY: f32 = 0.6;

/// The camera whose view is used for decisions.
fn seen_by(world: &World, options: &RenderOptions) -> CameraDesc {
    let camera = options.camera.unwrap_or_else(|| world.main_camera());
    let camera = world.cameras.get(camera);
    camera.map(|c| c.value.clone()).unwrap_or_default()
}

const NO_RAYS: &str = "no other feature traces rays, so no BVH is built";

/// Whether a light has a shadow map unless rays stand in for it.
fn is_mapped(light: &Light) -> bool {
    matches!(light.desc.shadow, ShadowMode::Map | ShadowMode::Auto)
}

/// Width in texels of the shadow map that a light would have: all maps of a form are as large as the largest.
fn map_px(world: &World, light: &Light) -> f64 {
    let is_cube = has_cube_map(&light.desc.kind);
    let has_map = |l: &&Light| is_mapped(l) && has_cube_map(&l.desc.kind) == is_cube;
    let px = world
        .lights
        .iter()
        .filter(has_map)
        .map(|l| l.desc.shadow_px);
    px.max().unwrap_or(0).into()
}

/// The view of the options' camera.
pub(super) fn view_of(world: &World, options: &RenderOptions) -> View {
    View::new(
        &seen_by(world, options),
        options.image.size,
        options.unit_m(world),
    )
}

/// Sizes and counts of a world as the options' camera sees it.
pub fn workload(world: &World, trees: &Trees, options: &RenderOptions) -> Workload {
    let view = view_of(world, options);
    let clip_from_world = view.clip_from_world(glam::Vec2::ZERO);
    let (mut triangles, mut triangles_in_view) = (0.0, 0.0);
    for instance in &world.instances {
        let count = world.meshes[instance.mesh].triangles.len() as f64;
        triangles += count;
        if !is_outside(&clip_from_world, &world.bounds_of(instance)) {
            triangles_in_view += count;
        }
    }
    let mut map_pixels = [0.0; LightKind::NAMES.len()];
    let mut map_views = map_pixels;
    for light in options.undecided_lights(world) {
        let kind = light.desc.kind.index();
        // Most triangles lie in one or two faces of a cube.
        let (faces, views) = if has_cube_map(&light.desc.kind) {
            (CUBE_FACES.len() as f64, 1.5)
        } else {
            (1.0, 1.0)
        };
        map_pixels[kind] += faces * map_px(world, light).powi(2);
        map_views[kind] += views;
    }
    let [width, height] = options.image.size;
    Workload {
        pixels: f64::from(width) * f64::from(height),
        samples: f64::from(options.image.samples.count()),
        triangles_in_view,
        triangles,
        map_pixels,
        map_views,
        view: ViewSample::new(world, trees, &view, options),
    }
}
