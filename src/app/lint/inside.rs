//! Lights, cameras and probes inside of closed shapes.

use std::{cell::Cell, collections::HashMap, f64::consts::TAU};

use glam::{DVec3, Vec3};

use super::{
    emits, shines,
    solids::{may_change, transmits},
    text::related,
};
use crate::{
    math::{in_f64, invertible},
    scene::{
        desc::{LightKind, PatternedKey, ShadowMode},
        diagnostic::Diagnostic,
        stages::Scene,
    },
    world::{Instance, Material, Posed, World, bvh::capsule::Capsule},
};

/// Largest mesh that is tested for being closed, triangles.
const MOST_TRIANGLES: usize = 500_000;
/// Largest number of boxes and triangles that the tests of one lint may look at; what is left is not tested, so that
/// scenes with many instances and cameras are checked in seconds.
const MOST_WORK: usize = 50_000_000;

/// Warnings about lights of the scene text inside of a closed shape that their light cannot leave, while no
/// camera is inside of it too.
pub fn lights(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let mut closed = Closed::new(world);
    let mut found = Vec::new();
    let cameras: Vec<Vec3> = world.cameras.iter().map(|c| c.value.eye).collect();
    for (entry, light) in scene.lights.iter().zip(world.all_lights()) {
        let has_shadow = light.desc.shadow != ShadowMode::None;
        let Some(position) = light.desc.kind.position().filter(|_| has_shadow) else {
            continue;
        };
        let mut around = closed.around(position);
        let surface = surface(&light.desc.kind, position);
        around.retain(|i| {
            let around = &world.instances[*i];
            let material = &world.materials[around.material];
            around.shown.casts_shadow
                && !lets_out(scene, material, &light.desc.kind)
                && !cameras.iter().any(|eye| closed.contains(*i, *eye))
                && surface.iter().all(|at| closed.contains(*i, *at))
        });
        if closed.is_exhausted() {
            break;
        }
        if let Some(&shape) = around.first() {
            let message = format!(
                "light \"{}\" is inside of \"{}\", which is closed, so nothing outside is lit",
                entry.name, world.instances[shape].name
            );
            let help = "if the shape is the lamp's bulb or shade, write `casts_shadow = false` in its instance; else \
                        move one of them";
            found.push(related(
                Diagnostic::new("light-inside", entry.at.clone(), message).help(help),
                scene,
                world,
                shape,
            ));
        }
    }
    found
}

/// Whether the shell around a light lets some of its light out.
fn lets_out(scene: &Scene, shell: &Material, light: &LightKind) -> bool {
    let is_met = !shell.scatters() || has_walks(scene) && light.has_size();
    if may_change(scene, &shell.name) {
        return shell.passes_light() || shell.diffuse_transmission.is_some() && is_met;
    }
    shell.blended
        || transmits(shell, PatternedKey::Transmission)
        || transmits(shell, PatternedKey::DiffuseTransmission) && is_met
}

/// Whether walks follow light inside of solids that scatter, which find lights with a size.
fn has_walks(scene: &Scene) -> bool {
    scene.reflection.settled().diffuse_bounces > 0
}

/// Whether light comes out of a solid that scatters, which walks find and straight rays miss.
pub fn shines_by_walks(scene: &Scene, world: &World) -> bool {
    let mut closed = Closed::new(world);
    let lights = world.all_lights().filter(|light| shines(light));
    let lamps = lights.map(|light| &light.desc.kind);
    let lamps = lamps.filter_map(|kind| kind.position().filter(|_| kind.has_size()));
    let emitters = world.instances.iter().filter(|i| emits(world, i));
    let emitters = emitters.map(|i| world.bounds_of(i).center());
    let is_in_wax = |at| {
        let mut around = closed.around(at).into_iter();
        around.any(|i| world.materials[world.instances[i].material].scatters())
    };
    has_walks(scene) && lamps.chain(emitters).any(is_in_wax)
}

/// Warnings about cameras of the scene text inside of a closed shape with nothing else in it, so that it is
/// not a room.
pub fn cameras(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let mut closed = Closed::new(world);
    let mut found = Vec::new();
    let cameras = scene.cameras.iter().zip(&world.cameras);
    // Cameras of placed scenes are skipped: they come with those scenes.
    for (entry, camera) in cameras.filter(|(e, _)| !scene.placed_cameras.contains(&e.name)) {
        for shape in closed.around(camera.value.eye) {
            let around = &world.instances[shape];
            let is_seen = around.shown.visible && world.materials[around.material].double_sided;
            if !is_seen || closed.holds_something(shape) {
                continue;
            }
            if closed.is_exhausted() {
                return found;
            }
            let name = &world.instances[shape].name;
            let message = format!(
                "camera \"{}\" is inside of \"{name}\", which is closed, so it sees nothing else",
                entry.name
            );
            let help = "move `eye` out of it, or move the instance";
            found.push(related(
                Diagnostic::new("camera-inside", entry.at.clone(), message).help(help),
                scene,
                world,
                shape,
            ));
            break;
        }
    }
    found
}

/// Warnings about probes of the scene text inside of a closed shape that is not seen from within, so that all faces of
/// their maps look through its back, or that is no room, because nothing else is inside.
pub fn probes(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let mut closed = Closed::new(world);
    let mut found = Vec::new();
    for entry in &scene.probes {
        let mut around = closed.around(entry.value.position);
        let is_seen = |i: usize| world.materials[world.instances[i].material].double_sided;
        let is_room = |i: usize| {
            let mut cameras = world.cameras.iter();
            closed.holds_something(i) || cameras.any(|c| closed.contains(i, c.value.eye))
        };
        around.retain(|i| !(world.instances[*i].dynamic || is_seen(*i) && is_room(*i)));
        if closed.is_exhausted() {
            return found;
        }
        let Some(&shape) = around.first() else {
            continue;
        };
        let name = &world.instances[shape].name;
        let (why, help) = match is_seen(shape) {
            true => (
                "closed, with nothing else in it: all six faces of its map see its inside alone",
                "move `position` out of it, or move the instance",
            ),
            false => (
                "closed: all six faces of its map look through the back of it",
                "move `position` out of it; for a room, write `double_sided = true` in its material",
            ),
        };
        let message = format!(
            "probe \"{}\" is inside of \"{name}\", which is {why}",
            entry.name
        );
        found.push(related(
            Diagnostic::new("probe-inside", entry.at.clone(), message).help(help),
            scene,
            world,
            shape,
        ));
    }
    found
}

/// Points at the edge of a light with a size, on both sides of its center along each axis.
fn surface(kind: &LightKind, position: Vec3) -> Vec<Vec3> {
    let steps = match kind.edges() {
        Some(edges) => edges.map(|edge| 0.5 * edge).to_vec(),
        None => Vec3::AXES.map(|axis| axis * kind.radius_m()).to_vec(),
    };
    let both = steps
        .iter()
        .flat_map(|step| [position + *step, position - *step]);
    both.collect()
}

/// Tests whether points are inside of closed instances; remembers which meshes are closed.
struct Closed<'a> {
    world: &'a World,
    meshes: HashMap<usize, bool>,
    /// Boxes and triangles that may still be looked at, see [`MOST_WORK`].
    work_left: Cell<usize>,
}

impl<'a> Closed<'a> {
    fn new(world: &'a World) -> Self {
        Self {
            world,
            meshes: HashMap::new(),
            work_left: Cell::new(MOST_WORK),
        }
    }

    /// Whether the work was not enough, so that later answers are "outside" without a test.
    fn is_exhausted(&self) -> bool {
        self.work_left.get() == 0
    }

    /// Takes some of the work that is left; false if it does not suffice.
    fn take(&self, work: usize) -> bool {
        let left = self.work_left.get().checked_sub(work);
        self.work_left.set(left.unwrap_or(0));
        left.is_some()
    }

    /// Indices of the closed, opaque instances that contain a point.
    fn around(&mut self, point: Vec3) -> Vec<usize> {
        let world = self.world;
        let mut found = Vec::new();
        for (index, instance) in world.instances.iter().enumerate() {
            let is_opaque = world.materials[instance.material].alpha_cutoff.is_none();
            if !is_opaque || !self.is_in_box(instance, point) {
                continue;
            }
            let mesh = &world.meshes[instance.mesh];
            let is_closed = self.meshes.entry(instance.mesh);
            let is_closed = *is_closed
                .or_insert_with(|| mesh.triangles.len() <= MOST_TRIANGLES && mesh.edges_cancel());
            if is_closed && self.contains(index, point) {
                found.push(index);
            }
        }
        found
    }

    /// Whether a lamp or the middle of another instance is inside of a closed instance, as in a room.
    fn holds_something(&self, index: usize) -> bool {
        let world = self.world;
        let inner = |(i, other): (usize, &Instance)| {
            let center = world.bounds_of(other).center();
            i != index && !other.is_hidden() && self.contains(index, center)
        };
        let mut lamps = world.all_lights().filter_map(|l| l.desc.kind.position());
        lamps.any(|at| self.contains(index, at)) || world.instances.iter().enumerate().any(inner)
    }

    /// Whether the box around an instance contains a point.
    fn is_in_box(&self, instance: &Instance, point: Vec3) -> bool {
        let bounds = self.world.bounds_of(instance);
        self.take(1) && point.cmpge(bounds.min).all() && point.cmple(bounds.max).all()
    }

    /// Whether a closed instance contains a point.
    fn contains(&self, index: usize, point: Vec3) -> bool {
        let instance = &self.world.instances[index];
        let mesh = &self.world.meshes[instance.mesh];
        let triangles = &mesh.triangles;
        if !self.is_in_box(instance, point)
            || !invertible(&instance.world_from_object)
            || !self.take(triangles.len())
        {
            return false;
        }
        let object_from_world = in_f64(&instance.world_from_object).inverse();
        let posed = self.world.posed(instance.mesh);
        let point = object_from_world.transform_point3(point.as_dvec3());
        let mut capsules = (0..triangles.len() as u32).map_while(|i| Capsule::of_mesh(mesh, i));
        capsules.any(|capsule| capsule.height(point).0 < 0.0)
            || winding_number(triangles, &posed, point).abs() > 0.5
    }
}

/// Winding number of a mesh around a point: the sum of the solid angles of its triangles over 4π (Jacobson,
/// Kavan, Sorkine-Hornung, "Robust Inside-Outside Segmentation using Generalized Winding Numbers",
/// SIGGRAPH 2013; solid angle of a triangle by van Oosterom and Strackee 1983).
fn winding_number(triangles: &[[u32; 3]], posed: &Posed<'_>, point: DVec3) -> f64 {
    let half_angles = triangles.iter().map(|triangle| {
        let [a, b, c] = posed.corners(*triangle).map(|p| p.as_dvec3() - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let volume = a.dot(b.cross(c));
        volume.atan2(la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb)
    });
    half_angles.sum::<f64>() / TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        scene::desc::{BevelDesc, ShapeDesc},
        world::shape,
    };

    #[test]
    fn shapes_surround_what_is_inside() {
        let size = Vec3::new(1.0, 2.0, 3.0);
        let bevel = BevelDesc::default();
        let (radius, height, segments) = (1.0, 2.0, 16);
        let cuboid = ShapeDesc::Box { size, bevel };
        let sphere = ShapeDesc::Sphere {
            radius,
            segments: Some(segments),
        };
        let cone = ShapeDesc::Cone {
            radius,
            height,
            segments,
        };
        for (shape, inner) in [
            (cuboid, DVec3::new(0.4, -0.9, 1.4)),
            (sphere, DVec3::splat(0.5)),
            (cone, DVec3::new(0.0, 1.5, 0.1)),
        ] {
            let made = shape::make(&shape, &shape::Supplies::default());
            let mesh = made.expect("a shape").mesh;
            let around = |point| winding_number(&mesh.triangles, &mesh.at_rest(), point);
            let [inside, outside] = [inner, DVec3::new(0.0, -1.6, 0.0)].map(around);
            assert!((inside - 1.0).abs() < 1e-9, "{shape:?}: {inside}");
            assert!(outside.abs() < 0.5, "{shape:?}: {outside}");
        }
    }
}
