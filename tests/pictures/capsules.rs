//! Capsules: equal for rasterization and rays of the CPU, for the march and traced rays, and for shadow maps and shadow
//! rays.

use glam::{Affine3A, UVec2};
use reflet::{
    metric::flip::flip_map,
    render::{decide::view_rays::ViewRays, pipeline::cause::Source, settings::view::View},
    world::{Instance, Mesh, bvh::Trees},
};

use crate::{kit, kit::*};

/// A mirror below things that are replaced by capsules, and a lamp.
pub const SCENE: &str = include_str!("capsules/scene.toml");

/// A helix as spheres or as capsules from each point to the next.
pub fn helix(are_spheres: bool) -> Mesh {
    let point = |k: u8| {
        let angle = f32::from(k) * 0.7;
        Vec3::new(
            0.6 * angle.cos(),
            f32::from(k) / 12.0 - 0.8,
            0.6 * angle.sin(),
        )
    };
    let mut mesh = Mesh {
        positions: (0..20).map(point).collect(),
        capsule_radius_m: Some(0.07),
        ..Mesh::default()
    };
    let next = |k: u32| if are_spheres { k } else { k + 1 };
    mesh.triangles = (0..19).map(|k| [k, next(k), next(k)]).collect();
    mesh.bounds = mesh.bounds_at_rest();
    mesh
}

fn things(set: &[&str]) -> (SceneDesc, World) {
    let (desc, mut world) = scene(SCENE, set);
    let things = world.instances[1].mesh;
    world.meshes[things] = helix(false);
    world.meshes.push(helix(true));
    world.instances[3].mesh = world.meshes.len() - 1;
    (desc, world)
}

fn picture(set: &[&str], change: impl Fn(&mut World)) -> Option<Picture> {
    let (desc, mut world) = things(set);
    change(&mut world);
    let aovs = [Aov::Ids, Aov::Source, Aov::HitIds, Aov::HitDistance];
    kit::picture(&desc, &world, &aovs)
}

fn is_capsule(id: u32) -> bool {
    (1..=3).contains(&id)
}

#[test]
fn capsules_are_rasterized_where_rays_meet_them() {
    let views = [
        "image.samples=1",
        "camera.main={ eye=[0.5, 2, 5], target=[0, 0.6, 0], orthographic_height_m=3.5 }",
        // Between the capsules of one thing, inside their boxes.
        "camera.main.eye=[-0.6, 1, 0.45]",
        // Beside the surface of a capsule, within it, and along its axis.
        "camera.main={ eye=[0, 0.28, 0], target=[-0.2, 0.4, 0.5] }",
        "camera.main={ eye=[-0.05, 0.23, 0.15], target=[-0.6, 1, 0] }",
        "camera.main={ eye=[0.212, 0.075, -0.58], target=[0, 0.2, 0] }",
    ];
    for view in views {
        let raster = or_skip!(picture(&[view], |_| {}));
        let raster = integers(&raster, Aov::Ids).chunks(2);
        let (desc, world) = things(&[view]);
        let (camera, size) = (&world.cameras[0].value, desc.image.size);
        let rays = ViewRays {
            world: &world,
            trees: &Trees::build(&world, u64::MAX).expect("trees"),
            view: &View::new(camera, size, world.unit_m()),
        };
        let met = |pixel: u32| {
            let pixel = UVec2::new(pixel % size[0], pixel / size[0]).as_dvec2() + 0.5;
            let ray = rays.primary(pixel / UVec2::from(size).as_dvec2());
            let hit = rays.trees.nearest(&ray, |_, _, _| true);
            hit.map_or([u32::MAX; 2], |hit| [hit.instance, hit.triangle])
        };
        let pairs: Vec<_> = (0..).map(met).zip(raster).collect();
        for thing in 1..=3 {
            let shown = pairs.iter().filter(|(_, id)| id[0] == thing).count();
            let is_close = views[2..].contains(&view);
            assert!(shown > 20 || is_close, "{view}: {shown} of {thing}");
        }
        // Neighbors of a strip share the spheres at their ends.
        let differs = |a: &[u32], b: &[u32]| a[0] != b[0] || a[1].abs_diff(b[1]) > 1;
        let differing = pairs.iter().filter(|(a, b)| differs(a, b)).count();
        assert!(differing <= 10, "{view}: {differing} pixels differ");
    }
}

#[test]
fn the_march_accepts_capsules_where_rays_meet_them() {
    let of = |set: &[&str]| picture(set, |_| {});
    let one = &["reflection.method=hybrid"][..];
    let two = &[
        "reflection.method=hybrid",
        "reflection.layers=2",
        "reflection.separation_m=0.05",
    ];
    for set in [one, two] {
        let hybrid = or_skip!(of(set));
        let rt = or_skip!(of(&["reflection.method=rt"]));
        assert_capsules_are_met(&hybrid, &rt);
    }
}

fn assert_capsules_are_met(hybrid: &Picture, rt: &Picture) {
    let (sources, ids) = (integers(hybrid, Aov::Source), integers(hybrid, Aov::HitIds));
    let (mut accepted, mut wrong) = (0, 0);
    for (i, (id, truth)) in ids
        .chunks(2)
        .zip(integers(rt, Aov::HitIds).chunks(2))
        .enumerate()
    {
        if sources[i] == Source::Traced as u32 || !is_capsule(id[0]) {
            continue;
        }
        accepted += 1;
        let distances = [hybrid, rt].map(|p| floats(p, Aov::HitDistance)[i]);
        // Neighbors of a strip share the spheres at their ends.
        wrong += usize::from(id[0] != truth[0] || (distances[0] - distances[1]).abs() > 1e-3);
    }
    // A ray may meet the edge of a capsule between the centers of pixels.
    println!("{wrong} of {accepted}");
    assert!(
        accepted > 100 && wrong <= accepted / 50,
        "{wrong} of {accepted}"
    );
    assert!(share_differing(hybrid, rt, 8) < 0.01);
}

#[test]
fn shadows_of_capsules_are_those_of_rays() {
    let sun = r#"light.lamp={ kind="directional", direction=[-0.2, -1, -0.3], intensity_lux=10 }"#;
    for light in ["image.samples=1", sun] {
        let of = |shadow: &str, casts: bool| {
            let shadow = format!("light.lamp.shadow=\"{shadow}\"");
            let hide = |instance: &mut Instance| instance.shown.casts_shadow = casts;
            let set = [light, &shadow, "material.floor.reflectivity=0.0"];
            picture(&set, |world| world.instances.iter_mut().for_each(hide))
        };
        let (map, ray) = (or_skip!(of("map", true)), or_skip!(of("ray", true)));
        let none = or_skip!(of("ray", false));
        let shadowed = share_differing(&ray, &none, 24);
        let differing = share_differing(&map, &ray, 24);
        assert!(shadowed > 0.015, "{shadowed} of the pixels are shadowed");
        // Texels of the map at the edges of thin shadows.
        println!("{differing} of {shadowed}");
        assert!(differing < 0.25 * shadowed, "{differing} of {shadowed}");
    }
}

/// Exact shapes and fine meshes of the same form look the same, directly, in a mirror, by their shadow and from within.
#[test]
fn exact_shapes_look_like_fine_meshes() {
    let glass = "material.red={ transmission=1, ior=1.5, roughness=0 }";
    let checker = "material.red.checker={ colors=[[1, 0.2, 0.1], [0.1, 0.2, 1]], size_m=0.1 }";
    let within = "camera.main={ eye=[-0.6, 1, 0], target=[0, 0.8, 0.6] }";
    let both = "material.red.double_sided=true";
    // The middle of the ball is before the near plane, or behind the eye.
    let cut = "camera.main={ eye=[-0.6, 1, 0.3], target=[-0.6, 1, 0], near_m=0.5 }";
    let flat = "camera.main={ eye=[-0.6, 1, -0.2], target=[-0.6, 1, -1], orthographic_height_m=2 }";
    let bulb =
        r#"light.lamp={ kind="point", position=[-0.55, 1, 0], intensity_cd=50, shadow="map" }"#;
    let capsule = r#"kind="capsule", radius=0.2"#;
    let sphere = r#"kind="sphere", radius=0.4"#;
    let cases = [
        (capsule, &[checker][..]),
        (sphere, &[glass]),
        (sphere, &[checker, both, cut]),
        (sphere, &[checker, both, within]),
        (sphere, &[checker, both, flat]),
        (sphere, &[bulb]),
    ];
    for &(shape, set) in first_or_all(&cases, 1) {
        let of = |segments: &str, visibility: &str| {
            let shape = format!("model.thing.shape={{ {shape}{segments} }}");
            let visibility = format!("image.visibility=\"{visibility}\"");
            let (desc, world) = scene(SCENE, &[set, &[&shape, &visibility]].concat());
            let is_exact = world.meshes[world.instances[1].mesh]
                .capsule_radius_m
                .is_some();
            assert_eq!(is_exact, segments.is_empty(), "{shape}");
            kit::picture(&desc, &world, &[Aov::Ids])
        };
        let exact = or_skip!(of("", "raster"));
        let traced = or_skip!(of("", "rays"));
        let mesh = or_skip!(of(", segments=256", "raster"));
        let things = integers(&exact, Aov::Ids).chunks(2);
        let share = things.filter(|id| is_capsule(id[0])).count() as f64
            / f64::from(exact.size[0] * exact.size[1]);
        assert!(share > 0.04, "{share} of the pixels show things");
        let display = |picture: &Picture| -> Vec<[f32; 3]> {
            let pixels = picture.display.chunks_exact(4);
            pixels.map(|p| [p[0], p[1], p[2]].map(f32::from)).collect()
        };
        let [width, height] = exact.size.map(|side| side as usize);
        let flip = flip_map(width, height, &display(&exact), &display(&mesh));
        let mean = flip.iter().map(|v| f64::from(*v)).sum::<f64>() / flip.len() as f64;
        let differing = share_differing(&exact, &mesh, 16);
        println!("FLIP {mean}, {differing} differ, {share} show things");
        // Pixels at the edges of things and shadows.
        assert!(mean < 0.005, "{shape}: {mean}");
        assert!(differing < 0.08 * share, "{shape}: {differing} of {share}");
        let differing = share_differing(&exact, &traced, 4);
        assert!(differing < 0.001, "{shape}, by rays: {differing}");
    }
}

/// Materials that need triangles keep them.
#[test]
fn round_shapes_have_triangles_where_a_material_needs_them() {
    let varies =
        "material.red={ alpha_cutoff=0.5, alpha={ pattern=\"dots\", from=1, to=0, size_m=0.1 } }";
    for (set, is_exact) in [
        ("material.red.roughness=0.5", true),
        ("material.red.emission=[1, 1, 1]", true),
        ("material.red={ emission=[1, 1, 1], light=true }", false),
        ("material.red.anisotropy=0.5", false),
        (varies, false),
    ] {
        let shape = "model.thing.shape={ kind=\"sphere\" }";
        let (_, world) = scene(SCENE, &[shape, set]);
        let mesh = &world.meshes[world.instances[1].mesh];
        assert_eq!(mesh.triangles.len() == 1, is_exact, "{set}");
    }
}

#[test]
fn meshes_alone_carry_no_code_of_capsules() {
    let Some(gpu) = gpu() else { return };
    let (desc, mut world) = scene(SCENE, &[]);
    assert!(!renderer(gpu, &desc, &world, false).plan().features.capsules);
    world.meshes.push(helix(true));
    world.instances.push(Instance {
        mesh: world.meshes.len() - 1,
        world_from_object: Affine3A::IDENTITY,
        ..world.instances[1].clone()
    });
    assert!(renderer(gpu, &desc, &world, false).plan().features.capsules);
}

/// More capsules than a software adapter draws in one submission.
#[test]
fn capsules_of_several_submissions_are_drawn_as_those_of_one() {
    // The first capsule stays visible, and so do the last drawn ones; the others are behind the camera.
    let with_hidden = |count: u32| {
        picture(&["material.floor.reflectivity=0.0"], |world| {
            let mesh = &mut world.meshes[world.instances[1].mesh];
            let hidden = mesh.positions.len() as u32;
            mesh.positions.push(Vec3::new(0.0, 0.0, 30.0));
            let copies = (0..count).map(|_| [hidden; 3]);
            mesh.triangles.splice(1..1, copies);
            mesh.bounds = mesh.bounds_at_rest();
        })
    };
    let one = or_skip!(with_hidden(1));
    let several = or_skip!(with_hidden(300_000));
    assert!(
        one.display == several.display,
        "pixels of the two pictures differ"
    );
}
