//! Light trees: their probabilities, and light in proportion to brightness.

use std::{collections::HashMap, f64::consts::PI, sync::Arc};

use glam::DVec3;
use reflet::world::light_tree::{Chosen, LightTrees};

use super::kit::*;

/// A camera above a floor.
pub const FLOOR: &str = "version = 1\n[camera.main]\neye = [0, 2.5, 0.2]\ntarget = [0, 0, 0]\nfov_deg = 40\n\
    [image]\nsize = [16, 16]\ntone_map = \"none\"\n[material.floor]\nbase_color = [0.7, 0.7, 0.7]\n\
    [model.floor]\nshape = { kind = \"plane\", size = [40, 40] }\nmaterial = \"floor\"\n[[instance]]\nmodel = \"floor\"\n";

/// Lamps of all kinds: closed ones, on one side and on both, turned, mirrored, distorted, small and large.
pub const LAMPS: &str = include_str!("light_tree/lamps.toml");

/// Surfaces: positions and normals.
fn surfaces() -> Vec<(Vec3, Vec3)> {
    let at = |x: f32, y: f32, z: f32, n: Vec3| (Vec3::new(x, y, z), n.normalize());
    vec![
        at(0.0, 0.0, 0.0, Vec3::Y),
        at(0.2, 0.0, -1.2, Vec3::Y),
        at(-1.2, 0.15, 0.0, Vec3::Y),
        at(-1.2, 0.5, 0.0, Vec3::X),
        at(0.5, 3.0, 0.5, Vec3::NEG_Y),
        at(4.0, 1.0, 0.0, Vec3::new(-1.0, 0.3, 0.2)),
        at(0.0, 0.5, 30.0, Vec3::Z),
    ]
}

/// Emitting triangles of a world.
fn triangles(world: &World) -> Vec<Chosen> {
    let emitters = world.emitters().into_iter();
    let chosen = emitters.map(|e| Chosen::Triangle {
        instance: e.instance,
        triangle: e.triangle,
    });
    chosen.collect()
}

/// Instance and triangle that a tree of triangles chose.
fn parts(chosen: Chosen) -> (u32, u32) {
    match chosen {
        Chosen::Triangle { instance, triangle } => (instance, triangle),
        Chosen::Lamp(lamp) => panic!("lamp {lamp} in a scene without lamps"),
    }
}

#[test]
fn triangles_are_chosen_as_often_as_their_chance_says() {
    let (_, world) = scene(&[FLOOR, LAMPS].concat(), &[]);
    let trees = LightTrees::new(&world, None);
    for (point, normal) in surfaces() {
        let chances: HashMap<_, _> = (triangles(&world).into_iter())
            .map(|t| (t, trees.chances(t, point, normal)))
            .collect();
        for (by_power, chance) in [(false, 0), (true, 1)] {
            let sum: f32 = chances.values().map(|c| c[chance]).sum();
            let chosen = trees.choose([0.5; 2], by_power, point, normal);
            let expected = f32::from(u8::from(chosen.is_some()));
            assert!((sum - expected).abs() < 1e-4, "{sum} at {point}");
            let count = 20_000;
            let mut found: HashMap<Chosen, u32> = HashMap::new();
            for k in (0..count).filter(|_| chosen.is_some()) {
                let u = (k as f32 + 0.5) / count as f32;
                let one = trees
                    .choose([u, 0.5], by_power, point, normal)
                    .expect("chosen");
                let known = chances[&one.what];
                for (a, b) in known.into_iter().zip(one.chances) {
                    assert!((a - b).abs() <= 1e-4 * a + 1e-9, "{a}, not {b}");
                }
                *found.entry(one.what).or_default() += 1;
            }
            for (triangle, known) in &chances {
                let often = f64::from(found.get(triangle).copied().unwrap_or(0)) / f64::from(count);
                let off = (often - f64::from(known[chance])).abs() * f64::from(expected);
                assert!(off <= 3.0 / f64::from(count), "{off} at {point}");
            }
        }
    }
}

#[test]
fn what_can_light_a_surface_has_a_chance() {
    let (_, world) = scene(&[FLOOR, LAMPS].concat(), &[]);
    let trees = LightTrees::new(&world, None);
    let mut lit = 0;
    for (point, normal) in surfaces() {
        for chosen in triangles(&world) {
            let (index, triangle) = parts(chosen);
            let instance = &world.instances[index as usize];
            let mesh = &world.meshes[instance.mesh];
            let corners = world
                .posed(instance.mesh)
                .corners(mesh.triangles[triangle as usize]);
            let [a, b, c] = corners.map(|p| instance.world_from_object.transform_point3(p));
            let mirrored = instance.world_from_object.matrix3.determinant() < 0.0;
            let front = (b - a).cross(c - a) * if mirrored { -1.0 } else { 1.0 };
            let to = (a + b + c) / 3.0 - point;
            let is_seen = world.materials[instance.material].double_sided || front.dot(to) < 0.0;
            if is_seen && to.dot(normal) > 0.0 {
                lit += 1;
                let [by_place, by_power] = trees.chances(chosen, point, normal);
                assert!(
                    by_place > 0.0 && by_power > 0.0,
                    "{index} {triangle} from {point}"
                );
            }
        }
    }
    assert!(lit > 200, "{lit}");
}

#[test]
fn moved_lamps_keep_the_trees_of_their_meshes() {
    let text = [
        FLOOR.replace("version = 1", "version = 1\ntimeline = { fps = 1, end = 2 }"),
        LAMPS.to_owned(),
        "[motion.instance.first]\ntranslation = { keys = [{ at_s = 0, value = [-1.2, 0.5, 0] }, { at_s = 1, value = \
         [1, 2, 0] }] }\nrotation_deg = { keys = [{ at_s = 0, value = [0, 0, 0] }, { at_s = 1, value = [0, 70, 0] }] }\n"
            .to_owned(),
    ]
    .concat();
    let (film, mut world) = film_of("test.toml".as_ref(), &text, &[]);
    let before = LightTrees::new(&world, None);
    pose(&film, &mut world, 1);
    let moved = LightTrees::new(&world, Some(&before));
    let anew = LightTrees::new(&world, None);
    let are_kept = |(a, b): (&Arc<_>, &Arc<_>)| Arc::ptr_eq(a, b);
    assert!(moved.meshes.iter().zip(&before.meshes).all(are_kept));
    assert_ne!(moved.top, before.top);
    for (point, normal) in surfaces() {
        for triangle in triangles(&world) {
            let [a, b, old] = [&moved, &anew, &before].map(|t| t.chances(triangle, point, normal));
            assert_eq!(a, b);
            // Power does not move, but for the order in which it is added up.
            assert!((a[1] - old[1]).abs() <= 1e-5 * old[1]);
        }
    }
}

#[test]
fn what_emits_nothing_is_never_chosen() {
    let (_, mut world) = scene(&[FLOOR, LAMPS].concat(), &[]);
    let lamps: Vec<_> = world.lighting_instances().map(|(i, _)| i).collect();
    let choice = |world: &World| {
        let trees = LightTrees::new(world, None);
        trees.choose([0.3; 2], true, Vec3::ZERO, Vec3::Y)
    };
    // A material that is no number, then one without light.
    let [both, front] = ["both", "front"].map(|name| {
        let named = world.materials.iter().position(|m| m.name == name);
        named.expect("it is in the scene")
    });
    world.materials[both].emission = Vec3::NAN;
    let one = choice(&world).expect("the others emit");
    assert_eq!(world.instances[parts(one.what).0 as usize].material, front);
    world.materials[front].emission = Vec3::ZERO;
    assert_eq!(choice(&world), None);
    world.materials[front].emission = Vec3::ONE;
    world.materials[both].emission = Vec3::ZERO;
    // Triangles without an area.
    for lamp in &lamps {
        world.instances[*lamp].world_from_object.matrix3.z_axis *= 0.0;
        world.instances[*lamp].world_from_object.matrix3.x_axis *= 0.0;
    }
    assert_eq!(choice(&world), None);
    assert_eq!(LightTrees::new(&World::default(), None).top, None);
}

#[test]
fn chosen_lamps_light_as_rays_that_meet_them() {
    let Some(gpu) = gpu() else { return };
    for (floor, method) in [
        ("reflectivity = 0\n", "reflection.method=path"),
        ("metallic = 1\nroughness = 0.45\n", "reflection.method=rt"),
    ] {
        let text = [FLOOR, LAMPS].concat();
        let text = text.replace("[model.floor]", &format!("{floor}[model.floor]"));
        let with = |set: &[&str]| {
            let set = [&["reflection.roughness_cutoff=1"][..], set].concat();
            mean(&render(gpu, &text, &set, &[]))
        };
        let aimed = with(&[method, "image.samples=64"]);
        // Rays in the directions of the surface alone, which know no tree.
        let met = with(&[
            "reflection.method=path",
            "image.samples=256",
            "material.both.light=false",
            "material.front.light=false",
        ]);
        for (found, expected) in aimed.into_iter().zip(met) {
            assert_close(found, expected, 0.03);
        }
    }
}

/// Radiance that a floor of rough metal without color sends from (x, 0, z) to the eye, of a glowing box before it, by
/// the midpoint rule: GGX with the height-correlated Smith term.
fn seen_of_box([x, z]: [f64; 2], eye: DVec3, roughness: f64) -> f64 {
    let (point, alpha2) = (DVec3::new(x, 0.0, z), roughness.powi(4));
    let view = (eye - point).normalize();
    let smith = |cosine: f64| (cosine * cosine * (1.0 - alpha2) + alpha2).sqrt();
    let of_face = |corner: DVec3, u: DVec3, v: DVec3, normal: DVec3| -> f64 {
        let steps = 200;
        let area = u.cross(v).length() / f64::from(steps * steps);
        let places = (0..steps * steps)
            .map(|k| [k % steps, k / steps].map(|i| (f64::from(i) + 0.5) / f64::from(steps)));
        let light = places.map(|[a, b]| {
            let offset = corner + u * a + v * b - point;
            let to = offset.normalize();
            let half = (view + to).normalize();
            let facets = alpha2 / (PI * (half.y * half.y * (alpha2 - 1.0) + 1.0).powi(2));
            let seen = 0.5 / (to.y * smith(view.y) + view.y * smith(to.y));
            facets * seen * to.y * -to.dot(normal) / offset.length_squared()
        });
        light.sum::<f64>() * area
    };
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    of_face(DVec3::new(-0.6, 0.35, -1.35), x * 1.2, y * 0.5, z)
        + of_face(DVec3::new(-0.6, 0.35, -1.45), x * 1.2, z * 0.1, -y)
}

/// Rays of the lobe and rays towards emitters, each by its share, make up the integral over the emitter: the shares sum
/// to 1. The roughness and the color are exact in 16 bits, as pixels store them.
#[test]
fn rough_metal_below_an_emitter_is_as_bright_as_the_closed_form() {
    let Some(gpu) = gpu() else { return };
    let eye = DVec3::new(0.0, 2.5, 0.2);
    for (point, roughness, within) in [
        ([-0.3, 0.3], 0.5, 1e-3),
        ([0.1, -0.4], 0.5, 3e-3),
        // Here both kinds of rays find about as much.
        ([0.2, -1.0], 0.25, 6e-3),
    ] {
        let text = include_str!("light_tree.toml")
            .replace("TARGET_X", &point[0].to_string())
            .replace("TARGET_Z", &point[1].to_string())
            .replace("ROUGHNESS", &roughness.to_string());
        let expected = seen_of_box(point, eye, roughness);
        let found = f64::from(mean(&render(gpu, &text, &[], &[]))[1]) / 4.0;
        let off = found / expected - 1.0;
        assert!(off.abs() < within, "{off} at {point:?}");
    }
}

/// Balls of rough metal in a room that glows evenly: whatever the shares of lobe and emitters are, over all points and
/// directions and from ball to ball, they sum to 1, and the balls cannot be seen.
#[test]
fn rough_metal_in_a_glowing_room_cannot_be_seen() {
    let Some(gpu) = gpu() else { return };
    let mut text =
        include_str!("light_tree/rough_metal_in_a_glowing_room_cannot_be_seen.toml").to_owned();
    for (roughness, x) in [(0.25, -1.1), (0.5, 0.0), (0.8, 1.1)] {
        let name = format!("ball{x}").replace(['.', '-'], "_");
        text += &format!(
            "[material.{name}]\nbase_color = [1, 1, 1]\nmetallic = 1\nroughness = {roughness}\n[model.{name}]\n\
             shape = {{ kind = \"sphere\", radius = 0.5, segments = 48 }}\nmaterial = \"{name}\"\n[[instance]]\n\
             model = \"{name}\"\ntranslation = [{x}, 0.3, 0]\n"
        );
    }
    // Two fifths of the pixels show a ball; a probability that is wrong by 3 % makes them 0.5 % brighter.
    for value in mean(&render(gpu, &text, &[], &[])) {
        assert_close(value, 1.0, 1e-3);
    }
}
