//! The cut-off of roughness: which surfaces reflect, and pictures on both sides of it.

use std::fmt::Write as _;

use reflet::render::{aov::Aov, cause::Cause, cutoff::can_reflect};

use super::kit::{assert_close, gpu, integers, mean, render, scene};

/// Columns and rows of square cells, a material each.
const GRID: [usize; 2] = [20, 13];

/// Cells with materials of roughness 0 to 1 in steps of 1/255, and a mirror behind the camera, so that rays are
/// followed whatever the cut-off.
fn grid(material: &str) -> String {
    let mut text = String::from(
        "version = 1\n[camera.main]\neye = [10, 6.5, 5]\ntarget = [10, 6.5, 0]\northographic_height_m = 13\n\
         [image]\nsize = [96, 54]\n[model.cell]\nshape = { kind = \"plane\", size = [1, 1] }\n\
         [[instance]]\nmodel = \"cell\"\nmaterial = \"mirror\"\ntranslation = [0, 0, 99]\n\
         [material.mirror]\nmetallic = 1\nroughness = 0\n",
    );
    for k in 0..256 {
        let [x, y] = [k % GRID[0], k / GRID[0]].map(|i| i as f64 + 0.5);
        let own = material.replace("VALUE", &format!("{}", k as f64 / 255.0));
        let _ = write!(
            text,
            "[material.m{k}]\n{own}\n[[instance]]\nmodel = \"cell\"\nmaterial = \"m{k}\"\n\
             translation = [{x}, {y}, 0]\nrotation_deg = [90, 0, 0]\n",
        );
    }
    text
}

/// Asserts that shaders and plan agree for each of 256 values of roughness.
fn assert_agreement(material: &str, cutoffs: &[&str]) {
    let Some(gpu) = gpu() else { return };
    let text = grid(material);
    for cutoff in cutoffs {
        let set = [
            format!("reflection.roughness_cutoff={cutoff}"),
            "reflection.method=rt".to_owned(),
        ];
        let set = set.each_ref().map(String::as_str);
        let (desc, world) = scene(&text, &set);
        let picture = render(gpu, &text, &set, &[Aov::Cause]);
        let causes = integers(&picture, Aov::Cause);
        let mut counts = [0; 2];
        for k in 0..256 {
            let at = [k % GRID[0], k / GRID[0]].map(|i| (i as f64 + 0.5) * 54.0 / 13.0);
            let (x, y) = (
                (at[0] + 48.0 - 10.0 * 54.0 / 13.0) as usize,
                (54.0 - at[1]) as usize,
            );
            let name = format!("m{k}");
            let material = world.materials.iter().find(|m| m.name == name);
            let expected = can_reflect(
                material.expect("each cell has a material"),
                desc.reflection.reflects_below(),
            );
            let is_rough = causes[y * 96 + x] == Cause::Rough as u32;
            assert_eq!(!is_rough, expected, "{name} at {x}, {y}, cut-off {cutoff}");
            counts[usize::from(expected)] += 1;
        }
        assert!(counts.iter().all(|c| *c > 4), "{counts:?}");
    }
}

#[test]
fn shaders_and_plan_agree_who_reflects() {
    // Values of the grid, their neighbors in 32 bits, and their roundings to 16 bits.
    let cutoffs = ["0.2", "0.199999988", "0.19995117", "0.5019608", "0.5019531"];
    assert_agreement("roughness = VALUE", &cutoffs);
    assert_agreement("roughness = VALUE\nmetallic = 0.4", &["0.2", "0.1"]);
    // Values of coats are 127ths.
    let coat = "clearcoat = 1\nclearcoat_roughness = VALUE";
    assert_agreement(coat, &["0.2", "0.5019608", "0.5039370078740157"]);
}

/// A floor in even white light, which nothing else reflects.
const FURNACE: &str = r#"
version = 1
[camera.main]
eye = [2, 2, 0]
target = [0, 0, 0]
fov_deg = 1
[image]
size = [8, 8]
tone_map = "none"
[environment]
color = [1, 1, 1]
[reflection]
method = "rt"
[material.floor]
[model.floor]
shape = { kind = "plane", size = [20, 20] }
material = "floor"
"#;

#[test]
fn no_light_is_lost_at_the_cutoff() {
    let Some(gpu) = gpu() else { return };
    let kinds = [
        ("material.floor.reflectivity=0.5", "roughness"),
        ("material.floor.transmission=1", "roughness"),
        ("material.floor.clearcoat=1", "clearcoat_roughness"),
    ];
    for (kind, key) in kinds {
        let of = |roughness: &str| {
            let own = format!("material.floor.{key}={roughness}");
            mean(&render(
                gpu,
                FURNACE,
                &["image.samples=16", kind, &own],
                &[],
            ))[0]
        };
        let at = of("0.2");
        assert_close(of("0.199"), at, 0.01);
        assert_close(of("0.2001"), at, 0.01);
        assert!(at > 0.9, "{kind}: {at}");
    }
}
