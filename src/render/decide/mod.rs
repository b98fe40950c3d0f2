//! Decides the settings that options leave to `auto`, by the cost model.

pub mod cost;
pub(crate) mod cull;
pub(crate) mod edge_on;
mod filtered_lights;
pub mod map_work;
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
        map_work::{
            DEAR, MAP_BUDGET_BYTES, MapWork, REFERENCE_PX, are_slow, doubtful_maps,
            drawn_triangles, is_mapped, map_px,
        },
        shadow_texels::{COARSE_PX, SeenSurfaces},
        view_estimate::ViewEstimate,
        view_sample::ViewSample,
    },
    lighting::lights::ShadowSizes,
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

/// Whether frames trace rays, or [`decide`] needs them, on an adapter that is `software` or a GPU.
pub fn needs_trees(world: &World, options: &RenderOptions, software: bool) -> bool {
    let is_auto = |light: &Light| light.desc.shadow == ShadowMode::Auto;
    traces_rays(world, options)
        || options.image.exposure_ev == Exposure::Auto
        || world.lights.iter().any(is_auto)
        || draws_longer_than_trees(world, options, &unit_costs(options, software))
        || doubtful_maps(world, &with_filtered(world, options)) != 0
}

/// The options with rays in place of the maps of lights that may shine on a surface that lets light pass.
pub fn with_filtered(world: &World, options: &RenderOptions) -> RenderOptions {
    RenderOptions {
        rays_for_maps: filtered_lights(world),
        ..*options
    }
}

/// Costs that decide.
fn unit_costs(options: &RenderOptions, software: bool) -> UnitCosts {
    options.costs.unwrap_or(UnitCosts::of_kind(software))
}

/// Expected time to build the trees, milliseconds.
fn trees_ms(world: &World, unit: &UnitCosts) -> f64 {
    let triangles: usize = world.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    1e-6 * (triangles as f64 * unit.tree_triangle
        + world.instances.len() as f64 * unit.tree_instance)
}

/// Number of nodes that a primary ray is expected to visit, before there is a tree.
const PRIMARY_NODES: f64 = 20.0;

/// Whether the picture is expected to take longer to draw than trees to build and primary rays to trace, with
/// `visibility = "auto"`.
fn draws_longer_than_trees(world: &World, options: &RenderOptions, unit: &UnitCosts) -> bool {
    if options.image.visibility != Visibility::Auto || has_lines(world) {
        return false;
    }
    let samples = f64::from(options.image.samples.count());
    let pixels = samples * options.image.size.map(f64::from).iter().product::<f64>();
    let drawn = samples * triangles_in_view(world, options) * unit.raster_triangle;
    let traced = pixels * PRIMARY_NODES * unit.primary_node;
    1e-6 * drawn > trees_ms(world, unit) + 1e-6 * traced
}

/// Whether something is drawn at least a pixel wide.
fn has_lines(world: &World) -> bool {
    world.meshes.iter().any(|mesh| mesh.at_least_a_pixel)
}

/// Number of triangles of the instances that the options' camera sees.
fn triangles_in_view(world: &World, options: &RenderOptions) -> f64 {
    let clip_from_world = view_of(world, options).clip_from_world(glam::Vec2::ZERO);
    let seen = world.instances.iter();
    let seen = seen.filter(|i| !is_outside(&clip_from_world, &world.bounds_of(i)));
    seen.map(|i| drawn_triangles(&world.meshes[i.mesh])).sum()
}

/// Decides the options left to `auto` for a posed world, as its camera [`RenderOptions::camera`] shows it. `trees` come
/// from [`needs_trees`]; `software` tells the kind of the adapter. A draft gets the options of the whole picture.
pub fn decide(world: &World, trees: &Trees, options: &RenderOptions, software: bool) -> Decided {
    let options = &with_filtered(world, options);
    let mut decider = Decider {
        workload: None,
        reference: None,
        world,
        trees,
        asked: *options,
        unit: unit_costs(options, software),
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
    /// Counts of the reference picture, made on first use.
    reference: Option<Workload>,
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

    /// Counts by which the budget of shadow maps decides, the same for all sizes and samples.
    fn reference(&mut self) -> &Workload {
        let (world, trees, mut options) = (self.world, self.trees, self.asked);
        options.image.size = REFERENCE_PX;
        options.image.samples = Samples::Count(1);
        (self.reference).get_or_insert_with(|| workload(world, trees, &options))
    }

    /// Notes a choice; further reasons of the same choice join its first.
    fn choose(&mut self, what: &str, chosen: &str, why: String) {
        let mut made = self.decided.decisions.iter_mut();
        if let Some(same) = made.find(|d| d.what == what && d.chosen == chosen) {
            same.why = format!("{}; {why}", same.why);
            return;
        }
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
            .filter(|(i, _)| self.asked.rays_for_maps >> i & 1 != 0);
        if filtered.clone().next().is_some() {
            let why = format!(
                "light of {} of {} lights passes a surface, which one depth of a map cannot tell",
                filtered.count(),
                mapped.count()
            );
            self.choose("shadow maps", "ray", why);
        }
        for kind in self
            .auto_lights()
            .map(|l| l.desc.kind.index())
            .collect::<BTreeSet<_>>()
        {
            let what = format!("shadow of {} lights", LightKind::NAMES[kind]);
            if let Some(span) = self.coarsest_px(kind).filter(|span| *span > COARSE_PX) {
                self.take_rays(kind);
                let why = format!("a texel of a map would span {span:.0} pixels");
                self.choose(&what, "ray", why);
                continue;
            }
            if !traces_rays(self.world, &self.decided.options) && !self.are_slow() {
                self.choose(&what, "map", NO_RAYS.to_owned());
                continue;
            }
            let (unit, world) = (self.unit, self.world);
            let is_auto = |map: &&MapWork| {
                map.kind == kind && world.lights[map.light].desc.shadow == ShadowMode::Auto
            };
            let workload = self.workload();
            let pair = workload.shadow(&unit, workload.maps.iter().filter(is_auto));
            let name = pair.cheaper();
            if name == "ray" {
                self.take_rays(kind);
            }
            self.choose(&what, name, pair.to_string());
        }
        if self.trees.is_built() {
            self.dear_maps();
            self.spare_maps();
        }
    }

    /// Has the `auto` lights of a kind take rays.
    fn take_rays(&mut self, kind: usize) {
        let lights = self.asked.undecided_lights(self.world);
        let is_of = |l: &Light| l.desc.shadow == ShadowMode::Auto && l.desc.kind.index() == kind;
        let lights = lights.filter(|(_, l)| is_of(l));
        self.decided.options.rays_for_maps |= lights.fold(0, |mask, (i, _)| mask | 1 << i);
    }

    /// Has lights take rays where a processor would draw their map much longer, alike on every adapter.
    fn dear_maps(&mut self) {
        if !self.are_slow() {
            return;
        }
        let lights = &self.world.lights;
        let workload = self.reference();
        let shadow = |map: &MapWork| workload.shadow(&UnitCosts::PROCESSOR, [map]).ms();
        let maps = workload.maps.iter();
        let maps = maps.filter(|map| lights[map.light].desc.shadow == ShadowMode::Default);
        let dear: Vec<(usize, [f64; 2])> = (maps.map(|map| (map.light, shadow(map))))
            .filter(|(_, [ray, map])| *map > DEAR * ray)
            .collect();
        if dear.is_empty() {
            return;
        }
        let [ray, map] = [0, 1].map(|way| dear.iter().map(|(_, ms)| ms[way]).sum::<f64>());
        let [width, height] = REFERENCE_PX;
        let why = format!(
            "maps of {} of {} lights would take a processor {map:.0} ms, their rays in {width} x {height} pixels {ray:.0} ms",
            dear.len(),
            lights.len()
        );
        for (light, _) in dear {
            self.decided.options.rays_for_maps |= 1 << light;
        }
        self.choose("shadow maps", "ray", why);
    }

    /// Whether a processor is expected to draw the maps of undecided lights for long.
    fn are_slow(&self) -> bool {
        let maps = MapWork::of_world(self.world, &self.asked);
        are_slow(&maps, self.world, &self.asked)
    }

    /// Has lights of which the picture shows least take rays until all maps have room in their budget.
    fn spare_maps(&mut self) {
        let (lights, before) = (&self.world.lights, self.decided.options);
        let bytes = |options: &RenderOptions| ShadowSizes::for_lights(lights, options).bytes();
        if bytes(&before) <= MAP_BUDGET_BYTES {
            return;
        }
        let seen = self.reference().view.shadows.clone();
        let has_map = |i: &usize| before.shadow_of(*i, &lights[*i]) == ShadowMode::Map;
        let undecided = before.undecided_lights(self.world).map(|(i, _)| i);
        let mut left: Vec<usize> = undecided.filter(has_map).collect();
        // The last of equally seen lights goes first.
        left.sort_by_key(|i| std::cmp::Reverse(seen.get(i).map_or(0, |(rays, _)| *rays)));
        let mut options = before;
        while bytes(&options) > MAP_BUDGET_BYTES
            && let Some(least) = left.pop()
        {
            options.rays_for_maps |= 1 << least;
        }
        let count = (options.rays_for_maps & !before.rays_for_maps).count_ones();
        if count == 0 {
            return;
        }
        self.decided.options = options;
        let why = format!(
            "all maps would take {} MiB, above {}: {count} of {} lights, of which the camera sees least, take rays",
            bytes(&before) >> 20,
            MAP_BUDGET_BYTES >> 20,
            lights.len()
        );
        self.choose("shadow maps", "ray", why);
    }

    /// Lights with `shadow = "auto"` that may have a map.
    fn auto_lights(&self) -> impl Iterator<Item = &Light> {
        let undecided = self.asked.undecided_lights(self.world);
        let lights = undecided.map(|(_, light)| light);
        lights.filter(|light| light.desc.shadow == ShadowMode::Auto)
    }

    /// Largest number of pixels that a shadow map texel would span, over the `auto` lights of a kind.
    fn coarsest_px(&self, kind: usize) -> Option<f32> {
        let (world, trees) = (self.world, self.trees);
        let seen = SeenSurfaces::new(world, trees, &view_of(world, &self.asked));
        let lights = self.auto_lights().filter(|l| l.desc.kind.index() == kind);
        let spans = lights.filter_map(|l| seen.texel_px(l, map_px(world, l)));
        spans.max_by(f32::total_cmp)
    }

    fn visibility(&mut self) {
        let what = "image.visibility";
        if has_lines(self.world) && self.asked.image.visibility != Visibility::Raster {
            self.decided.options.image.visibility = Visibility::Raster;
            let why = "points and lines are drawn at least a pixel wide, in trees they are as thin as they are";
            return self.choose(what, "raster", why.to_owned());
        }
        if self.asked.image.visibility != Visibility::Auto {
            return;
        }
        self.decided.options.image.visibility = Visibility::Raster;
        let (unit, world) = (self.unit, self.world);
        if !traces_rays(world, &self.decided.options)
            && !draws_longer_than_trees(world, &self.asked, &unit)
        {
            return self.choose(what, "raster", NO_RAYS.to_owned());
        }
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
    let [width, height] = options.image.size;
    Workload {
        pixels: f64::from(width) * f64::from(height),
        samples: f64::from(options.image.samples.count()),
        triangles_in_view: triangles_in_view(world, options),
        maps: MapWork::of_world(world, options),
        view: ViewSample::new(world, trees, &view_of(world, options), options),
    }
}
