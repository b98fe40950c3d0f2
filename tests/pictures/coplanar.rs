//! Surfaces at the same place: rasterization and rays show the same one, the lower instance.

use reflet::world::Mesh;

use crate::kit::*;

/// Two floors at the same place below a mirror that shows them; the mirror is instance 0.
const FLOORS: &str = include_str!("coplanar/floors.toml");

#[test]
fn the_lower_of_coplanar_instances_is_shown_by_pixels_and_rays() {
    let Some(gpu) = gpu() else { return };
    // An instance that may move is in another tree, where rounding differs.
    let still = "rotation_deg = [3, 17, 5]\n";
    let moving = |name: &str| {
        format!(
            "{FLOORS}[motion.instance.{name}]\nrotation_deg = {{ keys = [{{ at_s = 0, value = [3, 17, 5] }}, {{ at_s = 2, value = [9, 17, 5] }}] }}\n"
        )
    };
    assert!(FLOORS.contains(still));
    for text in [FLOORS.to_owned(), moving("first"), moving("second")] {
        let cases = [("hybrid", "raster"), ("rt", "rays"), ("rt", "raster")];
        for (method, visibility) in first_or_all(&cases, 2) {
            let set = [
                &*format!("reflection.method={method}"),
                &format!("image.visibility={visibility}"),
            ];
            let picture = render(gpu, &text, &set, &[Aov::Ids, Aov::HitIds]);
            for aov in [Aov::Ids, Aov::HitIds] {
                let mut counts = [0; 3];
                for id in integers(&picture, aov).chunks_exact(2).map(|ids| ids[0]) {
                    if let Some(count) = counts.get_mut(id as usize) {
                        *count += 1;
                    }
                }
                assert!(counts[1] > 40, "{counts:?}");
                assert_eq!(
                    counts[2],
                    0,
                    "{method} {visibility} {}: {counts:?}",
                    aov.name()
                );
            }
        }
    }
}

/// A floor of patches below a mirror; instance 0 is the mirror, the next ones are out of sight.
const PATCHES: &str = include_str!("coplanar/patches.toml");

/// Classes of things that are drawn or traced apart: a material, `moving` in another tree, `points` as capsules.
const CLASSES: [&str; 7] = [
    "hole", "points", "cutout", "double", "glass", "moving", "solid",
];
const MATERIALS: [&str; 4] = ["hole", "cutout", "double", "glass"];
/// Classes of two copies at the same place, and whether the first shows.
const PAIRS: [(&str, &str, bool); 10] = [
    ("solid", "cutout", true),
    ("cutout", "solid", true),
    ("double", "solid", true),
    ("moving", "cutout", true),
    ("cutout", "moving", true),
    ("glass", "moving", true),
    ("moving", "glass", true),
    ("hole", "double", false),
    ("hole", "moving", false),
    ("points", "moving points", true),
];

#[test]
fn copies_of_different_classes_show_the_lower_of_them() {
    let Some(gpu) = gpu() else { return };
    let mut text = PATCHES.to_owned();
    let mut add = |class: &str, x: f32, z: f32| {
        let material = MATERIALS.iter().find(|name| **name == class);
        text += &format!(
            "[[instance]]\nmodel = \"patch\"\nmaterial = \"{}\"\ntranslation = [{x}, 0.013, {z}]\n\
             rotation_deg = [3, 17, 5]\ndynamic = {}\n",
            material.unwrap_or(&"solid"),
            class.contains("moving"),
        );
    };
    // First the classes whose pipelines come first where draw calls are sorted by pipeline.
    for class in CLASSES {
        add(class, 40.0, 40.0);
    }
    for (k, (first, second, _)) in PAIRS.iter().enumerate() {
        let place = [-1.7 + 0.97 * (k % 5) as f32, 1.1 * (k / 5) as f32 - 0.2];
        for class in [first, second] {
            add(class, place[0], place[1]);
        }
    }
    let first_pair = 1 + CLASSES.len();
    let cases = [("hybrid", "raster"), ("rt", "rays"), ("rt", "raster")];
    for (method, visibility) in first_or_all(&cases, 2) {
        let set = [
            format!("reflection.method={method}"),
            format!("image.visibility={visibility}"),
        ];
        let (desc, mut world) = scene(&text, &set.each_ref().map(String::as_str));
        world.meshes.push(points());
        for k in [2, first_pair + 18, first_pair + 19] {
            world.instances[k].mesh = world.meshes.len() - 1;
        }
        let picture =
            renderer(gpu, &desc, &world, false).first_view(&world, &[Aov::Ids, Aov::HitIds]);
        for aov in [Aov::Ids, Aov::HitIds] {
            let mut counts = vec![0; first_pair + 2 * PAIRS.len()];
            for id in integers(&picture, aov).chunks_exact(2).map(|ids| ids[0]) {
                if let Some(count) = counts.get_mut(id as usize) {
                    *count += 1;
                }
            }
            for (found, (first, second, is_first)) in
                counts[first_pair..].chunks_exact(2).zip(PAIRS)
            {
                let [shown, hidden] = if is_first { [0, 1] } else { [1, 0] };
                let what = format!("{method} {visibility} {}: {first}, {second}", aov.name());
                assert_eq!(found[hidden], 0, "{what}: {found:?}");
                assert!(found[shown] > 4, "{what}: {found:?}");
            }
        }
    }
}

/// Spheres in a row.
fn points() -> Mesh {
    let mut mesh = Mesh {
        positions: (0..5)
            .map(|k| Vec3::new(0.15 * k as f32 - 0.3, 0.1, 0.0))
            .collect(),
        triangles: (0..5).map(|k| [k; 3]).collect(),
        capsule_radius_m: Some(0.12),
        ..Mesh::default()
    };
    mesh.bounds = mesh.bounds_at_rest();
    mesh
}
