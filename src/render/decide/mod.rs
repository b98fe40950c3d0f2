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

use std::{cell::OnceCell, cmp::Reverse, collections::BTreeSet};

use serde::Serialize;

use reflet_scene::desc::{Exposure, LightKind, Method, Samples, ShadowMode, Visibility};
use reflet_world::{Light, World, bvh::Trees};

use super::{
    decide::{
        cost::Workload,
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

/// Work of drawing the instances that the options' camera sees, in triangles of a fine mesh.
fn triangles_in_view(world: &World, options: &RenderOptions) -> f64 {
    let clip_from_world = view_of(world, options).clip_from_world(glam::Vec2::ZERO);
    let seen = world.instances.iter();
    let seen = seen.filter(|i| !is_outside(&clip_from_world, &world.bounds_of(i)));
    seen.map(|i| drawn_triangles(&world.meshes[i.mesh])).sum()
}

/// Decides the options left to `auto` for a posed world, as its camera [`RenderOptions::camera`] shows it. `trees` come
/// from [`needs_trees`]; `software` tells the kind of the adapter. A draft gets the options of the whole picture.
pub fn decide(world: &World, trees: &Trees, options: &RenderOptions, software: bool) -> Decided {
    let options = with_filtered(world, options);
    let mut decider = Decider {
        workload: OnceCell::new(),
        reference: OnceCell::new(),
        maps: MapWork::of_world(world, &options),
        world,
        trees,
        asked: options,
        unit: unit_costs(&options, software),
        decided: Decided {
            options,
            decisions: Vec::new(),
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
    /// Counts of the view.
    workload: OnceCell<Workload>,
    /// Counts of the reference picture, by which the budget of shadow maps decides for all sizes and samples.
    reference: OnceCell<Workload>,
    /// Shadow maps that undecided lights would have.
    maps: Vec<MapWork>,
    world: &'a World,
    trees: &'a Trees,
    asked: RenderOptions,
    unit: UnitCosts,
    decided: Decided,
}

impl Decider<'_> {
    fn workload(&self) -> &Workload {
        let counted = || workload(self.world, self.trees, &self.asked);
        self.workload.get_or_init(counted)
    }

    fn reference(&self) -> &Workload {
        let mut options = self.asked;
        options.image.size = REFERENCE_PX;
        options.image.samples = Samples::Count(1);
        let counted = || workload(self.world, self.trees, &options);
        self.reference.get_or_init(counted)
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
        let settings = &self.asked.reflection;
        if settings.method != Method::Auto {
            return;
        }
        self.decided.options.reflection.method = Method::Rt;
        if !reflects(self.world, settings.reflects_below()) {
            return;
        }
        let view = view_of(self.world, &self.asked);
        if settings.verifies() && has_edge_on_surfaces(self.world, &view) {
            let why =
                "the camera sees surfaces edge-on, which no pixel shows, so no ray is marched";
            return self.choose("reflection.method", Method::Rt.name(), why.to_owned());
        }
        let workload = self.workload();
        let pair = workload.reflections(&self.unit);
        let (view, sampled) = (&workload.view, &workload.view.mirror);
        let percent = |part: u32, of: u32| 100.0 * f64::from(part) / f64::from(of.max(1));
        let why = format!(
            "{pair}; {:.0} % of the pixels reflect, of which the picture shows {:.0} %",
            percent(sampled.rays, view.rays),
            percent(sampled.shown, sampled.rays),
        );
        self.choose("reflection.method", pair.cheaper(), why);
        if pair.cheaper() == Method::Hybrid.name() {
            self.decided.options.reflection.method = Method::Hybrid;
        }
    }

    fn shadows(&mut self) {
        let lights = self.world.lights.iter().enumerate();
        let mapped = lights.filter(|(_, l)| is_mapped(l));
        let is_filtered = |(i, _): &(usize, &Light)| self.asked.rays_for_maps >> i & 1 != 0;
        let filtered = mapped.clone().filter(is_filtered).count();
        if filtered > 0 {
            let why = format!(
                "light of {filtered} of {} lights passes a surface, which one depth of a map cannot tell",
                mapped.count()
            );
            self.choose("shadow maps", "ray", why);
        }
        let auto = self.maps.iter().filter(|map| self.is_auto(map));
        for kind in auto.map(|map| map.kind).collect::<BTreeSet<_>>() {
            let (chosen, why) = self.shadow(kind);
            if chosen == "ray" {
                let maps = self.maps.iter();
                let of_kind = maps.filter(|map| map.kind == kind && self.is_auto(map));
                self.decided.options.rays_for_maps |= bits(of_kind);
            }
            let what = format!("shadow of {} lights", LightKind::NAMES[kind]);
            self.choose(&what, chosen, why);
        }
        if self.trees.is_built() {
            self.dear_maps();
            self.spare_maps();
        }
    }

    /// Whether the light of a map asks for the cheaper way.
    fn is_auto(&self, map: &MapWork) -> bool {
        self.world.lights[map.light].desc.shadow == ShadowMode::Auto
    }

    /// The way of the shadows of the `auto` lights of a kind, and why.
    fn shadow(&self, kind: usize) -> (&'static str, String) {
        let maps = self.maps.iter();
        let maps = maps.filter(|map| map.kind == kind && self.is_auto(map));
        let world = self.world;
        let seen = SeenSurfaces::new(world, self.trees, &view_of(world, &self.asked));
        let span = |map: &MapWork| {
            let light = &world.lights[map.light];
            seen.texel_px(light, map_px(world, light))
        };
        let coarsest = maps.clone().filter_map(span).max_by(f32::total_cmp);
        if let Some(span) = coarsest.filter(|span| *span > COARSE_PX) {
            return (
                "ray",
                format!("a texel of a map would span {span:.0} pixels"),
            );
        }
        let traces = traces_rays(world, &self.decided.options);
        if !traces && !are_slow(&self.maps, world, &self.asked) {
            return ("map", NO_RAYS.to_owned());
        }
        let pair = self.workload().shadow(&self.unit, maps);
        (pair.cheaper(), pair.to_string())
    }

    /// Has lights take rays where a processor would draw their map much longer, alike on every adapter.
    fn dear_maps(&mut self) {
        if !are_slow(&self.maps, self.world, &self.asked) {
            return;
        }
        let shadow = |map| (self.reference()).shadow(&UnitCosts::PROCESSOR, [map]).ms();
        let maps = self.maps.iter().filter(|map| !self.is_auto(map));
        let dear = maps.map(|map| (map, shadow(map)));
        let dear: Vec<_> = dear.filter(|(_, [ray, map])| *map > DEAR * ray).collect();
        if dear.is_empty() {
            return;
        }
        let [ray, map] = [0, 1].map(|way| dear.iter().map(|(_, ms)| ms[way]).sum::<f64>());
        let [width, height] = REFERENCE_PX;
        let why = format!(
            "maps of {} of {} lights would take a processor {map:.0} ms, their rays in {width} x {height} pixels {ray:.0} ms",
            dear.len(),
            self.world.lights.len()
        );
        self.decided.options.rays_for_maps |= bits(dear.into_iter().map(|(map, _)| map));
        self.choose("shadow maps", "ray", why);
    }

    /// Has lights of which the picture shows least take rays until all maps have room in their budget.
    fn spare_maps(&mut self) {
        let (lights, mut options) = (&self.world.lights, self.decided.options);
        let bytes = |options: &RenderOptions| ShadowSizes::for_lights(lights, options).bytes();
        let all_mib = bytes(&options) >> 20;
        if bytes(&options) <= MAP_BUDGET_BYTES {
            return;
        }
        let seen = &self.reference().view.shadows;
        let has_map = |i: &usize| options.shadow_of(*i, &lights[*i]) == ShadowMode::Map;
        let undecided = options.undecided_lights(self.world).map(|(i, _)| i);
        let mut left: Vec<usize> = undecided.filter(has_map).collect();
        // The last of equally seen lights goes first.
        left.sort_by_key(|i| Reverse(seen.get(i).map_or(0, |(rays, _)| *rays)));
        let before = left.len();
        while bytes(&options) > MAP_BUDGET_BYTES
            && let Some(least) = left.pop()
        {
            options.rays_for_maps |= 1 << least;
        }
        let count = before - left.len();
        if count == 0 {
            return;
        }
        self.decided.options = options;
        let why = format!(
            "all maps would take {all_mib} MiB, above {}: {count} of {} lights, of which the camera sees least, take rays",
            MAP_BUDGET_BYTES >> 20,
            lights.len()
        );
        self.choose("shadow maps", "ray", why);
    }

    fn visibility(&mut self) {
        let what = "image.visibility";
        let asked = self.asked.image.visibility;
        if has_lines(self.world) && asked != Visibility::Raster {
            self.decided.options.image.visibility = Visibility::Raster;
            let why = "points and lines are drawn at least a pixel wide, in trees they are as thin as they are";
            return self.choose(what, "raster", why.to_owned());
        }
        if asked != Visibility::Auto {
            return;
        }
        self.decided.options.image.visibility = Visibility::Raster;
        let world = self.world;
        if !traces_rays(world, &self.decided.options)
            && !draws_longer_than_trees(world, &self.asked, &self.unit)
        {
            return self.choose(what, "raster", NO_RAYS.to_owned());
        }
        let pair = self.workload().visibility(&self.unit);
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
        let reach_m = settings.ray_length_u * self.asked.unit_m(world);
        let (view, cutoff) = (view_of(world, &self.asked), settings.reflects_below());
        let mut radiance = ViewEstimate::new(world, self.trees, &view, cutoff, reach_m).radiance;
        radiance.sort_by(f32::total_cmp);
        let bright = radiance.get(radiance.len() * 9 / 10);
        let bright = bright.copied().unwrap_or(0.0);
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

/// The lights of maps, a bit for each by its index.
fn bits<'a>(maps: impl IntoIterator<Item = &'a MapWork>) -> u64 {
    maps.into_iter().fold(0, |mask, map| mask | 1 << map.light)
}

/// Radiance after exposure of the 90th percentile of the view.
const LIGHT_GRAY: f32 = 0.6;

const NO_RAYS: &str = "no other feature traces rays, so no BVH is built";

/// The view of the options' camera.
pub(super) fn view_of(world: &World, options: &RenderOptions) -> View {
    let camera = options.camera.unwrap_or_else(|| world.main_camera());
    let camera = world.cameras.get(camera);
    let camera = camera.map(|c| c.value.clone()).unwrap_or_default();
    View::new(&camera, options.image.size, options.unit_m(world))
}

/// Sizes and counts of a world as the options' camera sees it.
pub fn workload(world: &World, trees: &Trees, options: &RenderOptions) -> Workload {
    let [width, height] = options.image.size.map(f64::from);
    Workload {
        pixels: width * height,
        samples: f64::from(options.image.samples.count()),
        triangles_in_view: triangles_in_view(world, options),
        view: ViewSample::new(world, trees, &view_of(world, options), options),
    }
}
