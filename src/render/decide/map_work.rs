//! Work of drawing the shadow maps that lights may have, counted without tracing a ray.

use rayon::prelude::*;

use reflet_base::math::Bounds;
use reflet_scene::desc::ShadowMode;
use reflet_world::{Instance, Light, Mesh, World};

use super::{bits, cull::is_outside, trees_ms, unit_costs::UnitCosts};
use crate::{
    lighting::lights::{CUBE_FACES, ShadowSizes, flat_view, has_cube_map, map_near_m, map_texel_m},
    plan::traces_rays,
    settings::options::RenderOptions,
};

/// Memory for all shadow maps of a scene, bytes; maps that a scene asks for by name may take more.
pub const MAP_BUDGET_BYTES: u64 = 256 << 20;

/// Expected time that a processor may take to draw all maps, milliseconds, before maps give way to rays.
const MANY_MS: f64 = 500.0;

/// Multiple of the time of its rays in the reference picture from which a map gives way to them: maps serve all pictures
/// in which nothing moves, and costs are expected only.
pub(super) const DEAR: f64 = 2.0;

/// Width and height of the picture of one sample whose rays are weighed against maps, so that pictures of any size and
/// number of samples have the same shadows.
pub(super) const REFERENCE_PX: [u32; 2] = [1280, 720];

/// Work of drawing the quadrilateral around a capsule, in triangles of a fine mesh, which has about half as many vertices.
const CAPSULE_TRIANGLES: f64 = 4.0;
/// Work of drawing a triangle without its vertices, in such triangles: on llvmpipe each of a hundred thousand squares, boxes
/// and spheres takes .9, 4.2 and 27 µs.
const TRIANGLE_ALONE: f64 = 0.73;
/// Work of drawing a vertex, by the same times.
const VERTEX_TRIANGLES: f64 = 0.54;
/// Work of drawing an instance beside its triangles and vertices, by the same times.
const INSTANCE_TRIANGLES: f64 = 1.8;

/// Work of drawing the shadow map of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapWork {
    /// Index into [`World::lights`].
    pub light: usize,
    /// Index of the kind of light.
    pub kind: usize,
    /// Width in texels that it would have: all maps of a form are as large as the largest.
    pub px: u32,
    /// Texels of all its faces.
    texels: f64,
    /// Work of drawing the things that cast shadows, over all faces, in triangles of a fine mesh.
    triangles: f64,
    /// Texels that spheres and capsules cover, each by itself.
    capsule_texels: f64,
}

impl MapWork {
    /// Work of the maps of the lights that neither their scene nor glass in their way decides.
    pub fn of_world(world: &World, options: &RenderOptions) -> Vec<Self> {
        let undecided = options.undecided_lights(world);
        if undecided.clone().next().is_none() {
            return Vec::new();
        }
        let instances = world.instances.iter();
        let casters: Vec<_> = instances.filter(|i| i.shown.casts_shadow).collect();
        let drawn = casters
            .iter()
            .map(|i| drawn_triangles(&world.meshes[i.mesh]));
        let triangles: f64 = drawn.sum();
        let capsules: Vec<_> = casters
            .par_iter()
            .filter(|i| world.meshes[i.mesh].capsule_radius_m.is_some())
            .map(|i| Capsules::of(world, i))
            .collect();
        let around = |all: Bounds, i: &&Instance| all.union(world.bounds_of(i));
        let bounds = casters.iter().fold(Bounds::EMPTY, around);
        let sizes = ShadowSizes::for_lights(&world.lights, &RenderOptions::default());
        let work = |(light, of): (usize, &Light)| {
            let px = sizes.px_of(&of.desc.kind);
            // Most triangles lie in one or two faces of a cube.
            let (faces, views) = match has_cube_map(&of.desc.kind) {
                true => (CUBE_FACES.len() as f64, 1.5),
                false => (1.0, 1.0),
            };
            let covered = capsules.par_iter().map(|c| c.texels(of, px, &bounds));
            Self {
                light,
                kind: of.desc.kind.index(),
                px,
                texels: faces * f64::from(px).powi(2),
                triangles: triangles * views,
                capsule_texels: covered.sum(),
            }
        };
        undecided.map(work).collect()
    }

    /// Expected time to draw it, nanoseconds.
    pub fn draw_ns(&self, unit: &UnitCosts) -> f64 {
        self.triangles * unit.map_triangle
            + self.texels * unit.map_pixel
            + self.capsule_texels * unit.map_capsule
    }
}

/// Work of drawing an instance of a mesh, in triangles of a fine mesh.
pub(super) fn drawn_triangles(mesh: &Mesh) -> f64 {
    let triangles = mesh.triangles.len() as f64;
    let vertices = mesh.positions.len() as f64;
    match mesh.capsule_radius_m {
        Some(_) => triangles * CAPSULE_TRIANGLES,
        None => INSTANCE_TRIANGLES + triangles * TRIANGLE_ALONE + vertices * VERTEX_TRIANGLES,
    }
}

/// Capsules of an instance.
struct Capsules {
    bounds: Bounds,
    count: f64,
    /// Sum of the distances of their ends, meters.
    length_m: f64,
    radius_m: f64,
    least_px: f64,
}

impl Capsules {
    fn of(world: &World, instance: &Instance) -> Self {
        let mesh = &world.meshes[instance.mesh];
        let place =
            |i: u32| (instance.world_from_object).transform_point3(mesh.positions[i as usize]);
        let length = |[a, b, _]: &[u32; 3]| f64::from(place(*a).distance(place(*b)));
        let radius_m = mesh.placed_radius_m(&instance.world_from_object);
        Self {
            bounds: world.bounds_of(instance),
            count: mesh.triangles.len() as f64,
            length_m: mesh.triangles.iter().map(length).sum(),
            radius_m: radius_m.unwrap_or(0.0).into(),
            least_px: if mesh.at_least_a_pixel { 0.5 } else { 0.0 },
        }
    }

    /// Number of texels that they cover in the map of a light, as if all were at their middle.
    fn texels(&self, light: &Light, px: u32, casters: &Bounds) -> f64 {
        let kind = &light.desc.kind;
        let is_aside = self.bounds.is_empty()
            || !has_cube_map(kind)
                && is_outside(
                    &flat_view(kind, px, casters, map_near_m(1.0)).0,
                    &self.bounds,
                );
        if is_aside {
            return 0.0;
        }
        // A light among them sees most of them from a quarter of their extent.
        let least_m = 0.5 * self.bounds.diagonal() / px as f32;
        let texel_m = map_texel_m(kind, px, casters, self.bounds.center()).max(least_m);
        let texel_m = f64::from(texel_m).max(f64::MIN_POSITIVE);
        let radius_px = (self.radius_m / texel_m).max(self.least_px);
        let disks = self.count * std::f64::consts::PI * radius_px;
        radius_px * (disks + 2.0 * self.length_m / texel_m)
    }
}

/// Whether a processor is expected to draw the maps of undecided lights for long.
pub(super) fn are_slow(works: &[MapWork], world: &World, options: &RenderOptions) -> bool {
    let draw_ns = works.iter().map(|work| work.draw_ns(&UnitCosts::PROCESSOR));
    let trees_ms = match traces_rays(world, options) {
        true => 0.0,
        false => trees_ms(world),
    };
    1e-6 * draw_ns.sum::<f64>() > MANY_MS.max(DEAR * trees_ms)
}

/// Lights, a bit for each by its index, whose maps a scene does not ask for by name and that may take more time or
/// memory than they are worth; rays must tell which of them do.
pub fn doubtful_maps(world: &World, options: &RenderOptions) -> u64 {
    let works = MapWork::of_world(world, options);
    let bytes = ShadowSizes::for_lights(&world.lights, options).bytes();
    match bytes > MAP_BUDGET_BYTES || are_slow(&works, world, options) {
        true => bits(&works),
        false => 0,
    }
}

/// Whether a light has a shadow map unless rays stand in for it.
pub(super) fn is_mapped(light: &Light) -> bool {
    !matches!(light.desc.shadow, ShadowMode::Ray | ShadowMode::None)
}
