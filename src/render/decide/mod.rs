//! Decides the settings that options leave to `auto`: the method by rule, visibility and shadows by the cost model.

pub mod cost;
pub(crate) mod cull;
pub(crate) mod edge_on;
mod filtered_lights;
pub mod map_work;
pub mod shadow_texels;
pub mod skip;
pub mod trace_choice;
pub mod unit_costs;
pub mod view_estimate;
pub mod view_rays;
pub mod view_sample;

use std::{cell::OnceCell, cmp::Reverse};

use serde::Serialize;

use reflet_scene::desc::{Exposure, LightKind, Method, Samples, ShadowMode, Visibility};
use reflet_world::{Light, World, bvh::Trees};

use super::{
    decide::{
        cost::Workload,
        cull::is_outside,
        filtered_lights::filtered_lights,
        map_work::{
            DEAR, MAP_BUDGET_BYTES, MapWork, REFERENCE_PX, are_slow, doubtful_maps,
            drawn_triangles, is_mapped,
        },
        shadow_texels::{COARSE_PX, SeenSurfaces},
        unit_costs::{TREE_INSTANCE, TREE_TRIANGLE, UnitCosts},
        view_estimate::ViewEstimate,
    },
    lighting::lights::ShadowSizes,
    plan::{reflects, traces_rays},
    settings::{options::RenderOptions, view::View},
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
        || draws_longer_than_trees(world, options, &UnitCosts::of_kind(software))
        || doubtful_maps(world, &with_filtered(world, options)) != 0
}

/// The options with rays in place of the maps of lights that may shine on a surface that lets light pass.
pub fn with_filtered(world: &World, options: &RenderOptions) -> RenderOptions {
    RenderOptions {
        rays_for_maps: filtered_lights(world),
        ..*options
    }
}

/// Expected time to build the trees, milliseconds.
fn trees_ms(world: &World) -> f64 {
    let triangles: usize = world.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let instances = world.instances.len() as f64;
    1e-6 * (triangles as f64 * TREE_TRIANGLE + instances * TREE_INSTANCE)
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
    let traced = pixels * PRIMARY_NODES * unit.primary.1;
    1e-6 * drawn > trees_ms(world) + 1e-6 * traced
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
        unit: UnitCosts::of_kind(software),
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
        let counted = || Workload::new(self.world, self.trees, &self.asked);
        self.workload.get_or_init(counted)
    }

    fn reference(&self) -> &Workload {
        let mut options = self.asked;
        options.image.size = REFERENCE_PX;
        options.image.samples = Samples::Count(1);
        let counted = || Workload::new(self.world, self.trees, &options);
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
        if reflects(self.world, settings.reflects_below()) {
            let why = "where it was measured, hybrid was never faster by more than 2 % of a frame";
            self.choose("reflection.method", Method::Rt.name(), why.to_owned());
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
        let auto = self.maps.iter().copied().filter(|map| self.is_auto(map));
        let mut auto: Vec<MapWork> = auto.collect();
        auto.sort_by_key(|map| map.kind);
        for maps in auto.chunk_by(|a, b| a.kind == b.kind) {
            let (chosen, why) = self.shadow(maps);
            if chosen == "ray" {
                self.decided.options.rays_for_maps |= bits(maps);
            }
            let what = format!("shadow of {} lights", LightKind::NAMES[maps[0].kind]);
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

    /// The way of the shadows of lights, and why.
    fn shadow(&self, maps: &[MapWork]) -> (&'static str, String) {
        let world = self.world;
        let seen = SeenSurfaces::new(world, self.trees, &view_of(world, &self.asked));
        let spans = maps.iter();
        let spans = spans.filter_map(|map| seen.texel_px(&world.lights[map.light], map.px));
        let coarsest = spans.max_by(f32::total_cmp);
        if let Some(span) = coarsest.filter(|span| *span > COARSE_PX) {
            let why = format!("a texel of a map would span {span:.0} pixels");
            return ("ray", why);
        }
        let traces = traces_rays(world, &self.decided.options);
        if !traces && !are_slow(&self.maps, world, &self.asked) {
            return ("map", NO_RAYS.to_owned());
        }
        cheaper(["ray", "map"], self.workload().shadow(&self.unit, maps))
    }

    /// Has lights take rays where a processor would draw their map much longer, alike on every adapter.
    fn dear_maps(&mut self) {
        if !are_slow(&self.maps, self.world, &self.asked) {
            return;
        }
        let shadow = |map| (self.reference()).shadow(&UnitCosts::PROCESSOR, [map]);
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
        left.sort_by_key(|i| Reverse(seen.get(i).map_or(0, |to| to.rays)));
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
        let (chosen, why) = cheaper(["rays", "raster"], self.workload().visibility(&self.unit));
        if chosen == "rays" {
            self.decided.options.image.visibility = Visibility::Rays;
        }
        self.choose(what, chosen, why);
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

/// The cheaper of two ways by their expected milliseconds, the second if they cost the same, and why.
fn cheaper(ways: [&'static str; 2], ms: [f64; 2]) -> (&'static str, String) {
    let [first, second] = ms;
    let why = format!(
        "{} {first:.2} ms, {} {second:.2} ms expected",
        ways[0], ways[1]
    );
    (if first < second { ways[0] } else { ways[1] }, why)
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
