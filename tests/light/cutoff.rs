//! The cut-off of roughness: which surfaces reflect, and pictures on both sides of it.

use std::fmt::Write as _;

use reflet::render::settings::cutoff::can_reflect;

use super::kit::*;

/// Columns and rows of square cells, a material each.
const GRID: [usize; 2] = [20, 13];

/// Cells with materials of roughness 0 to 1 in steps of 1/255, and a mirror behind the camera, so that rays are
/// followed whatever the cut-off.
fn grid(material: &str) -> String {
    let mut text = String::from(include_str!("cutoff/grid.toml"));
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
            &*format!("reflection.roughness_cutoff={cutoff}"),
            "reflection.method=rt",
        ];
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
    let cutoffs = ["0.2", "0.19995117", "0.5019608"];
    assert_agreement("roughness = VALUE", &cutoffs);
    assert_agreement("roughness = VALUE\nmetallic = 0.4", &["0.2"]);
    // Values of coats are 127ths.
    let coat = "clearcoat = 1\nclearcoat_roughness = VALUE";
    assert_agreement(coat, &["0.2", "0.5039370078740157"]);
}

/// A floor in even white light, which nothing else reflects.
const FURNACE: &str = include_str!("cutoff/furnace.toml");

#[test]
fn no_light_is_lost_at_the_cutoff() {
    let Some(gpu) = gpu() else { return };
    // Glass with a coat that is out of sight, so that floors of all kinds share their pipelines.
    let text = [FURNACE, include_str!("cutoff/unseen.toml")].concat();
    let kinds = [
        ("material.floor.reflectivity=0.5", "roughness"),
        ("material.floor.transmission=1", "roughness"),
        ("material.floor.clearcoat=1", "clearcoat_roughness"),
    ];
    for (kind, key) in kinds {
        let of = |roughness: &str| {
            let own = format!("material.floor.{key}={roughness}");
            mean(&render(gpu, &text, &["image.samples=16", kind, &own], &[]))[0]
        };
        let at = of("0.2");
        assert_close(of("0.199"), at, 0.01);
        assert_close(of("0.2001"), at, 0.01);
        assert!(at > 0.9, "{kind}: {at}");
    }
}

/// A lamp before the environment, dimmer than that and wider than the lobe, and a pane before both.
const LAMP: &str = include_str!("cutoff/lamp.toml");
const PANE: &str = include_str!("cutoff/pane.toml");

#[test]
fn lamps_and_panes_hide_the_environment_alike_on_both_sides_of_the_cutoff() {
    let Some(gpu) = gpu() else { return };
    // The lamp alone needs pipelines of its own.
    for pane in first_or_all(&[PANE, ""], 1) {
        check_lamp_and(gpu, pane);
    }
}

fn check_lamp_and(gpu: &Gpu, pane: &str) {
    let text = [FURNACE, LAMP, pane].concat();
    let of = |roughness: &str| {
        let set = [
            "image.samples=64",
            "environment.shadow=ray",
            "material.floor.base_color=[0, 0, 0]",
            "material.floor.reflectivity=0.5",
            &format!("material.floor.roughness={roughness}"),
        ];
        mean(&render(gpu, &text, &set, &[]))[0]
    };
    let past = of("0.2001");
    assert_close(of("0.1999"), past, 0.02);
    // The lamp hides the environment from rays that keep all that they find.
    assert!(of("0.15") < 0.5 * past, "{past}");
}

/// A floor below a red ceiling, in light that comes from everywhere.
const ROOM: &str = include_str!("cutoff/room.toml");
/// Even light, light that casts shadows, a lamp with a size, and a glowing block that is sampled.
const LIGHTS: [&str; 4] = [
    "[environment]\ncolor = [0.5, 0.5, 1]\n",
    "[environment]\ncolor = [0.5, 0.5, 1]\nshadow = \"ray\"\n",
    "[environment]\ncolor = [0.5, 0.5, 1]\n[light.lamp]\nkind = \"point\"\nposition = [-2, 1, 0.3]\nradius_m = 0.3\n\
     intensity_cd = 2\n",
    "[environment]\ncolor = [0.5, 0.5, 1]\n[material.lamp]\nemission = [4, 4, 1]\nlight = true\n\
     [model.lamp]\nshape = { kind = \"box\", size = [0.3, 0.3, 0.3] }\nmaterial = \"lamp\"\n\
     [[instance]]\nmodel = \"lamp\"\ntranslation = [-2, 1, 0.3]\n",
];

/// Roughness in the fade, which clear coats hold exactly, and the share of the reflection that is kept there.
const IN_FADE: (f32, f32) = (23.0 / 127.0, (0.2 - 23.0 / 127.0) / 0.04);

#[test]
fn reflections_fade_into_the_environment_towards_the_cutoff() {
    let Some(gpu) = gpu() else { return };
    // Each light needs pipelines of its own. A coat is lit by the first.
    let lights = first_or_all(&LIGHTS, 1);
    let dielectric = [
        "material.floor.reflectivity=0.5",
        "material.floor.clearcoat=0",
        "roughness",
    ];
    let coat = [
        "material.floor.reflectivity=0",
        "material.floor.clearcoat=1",
        "clearcoat_roughness",
    ];
    let kinds = lights.iter().map(|light| (*light, dielectric));
    let coats = [(lights[0], coat)];
    for (light, [reflectivity, clearcoat, key]) in kinds.chain(coats) {
        let text = [ROOM, light].concat();
        let of = |roughness: f32, cutoff: f32| {
            let own = format!("material.floor.{key}={roughness}");
            let cutoff = format!("reflection.roughness_cutoff={cutoff}");
            mean(&render(
                gpu,
                &text,
                &[reflectivity, clearcoat, &own, &cutoff],
                &[],
            ))
        };
        let (roughness, kept) = IN_FADE;
        let sides = [of(0.1999, 0.2), of(0.2001, 0.2)];
        let [found, all, far] = [0.2, 1.0, 0.0].map(|cutoff| of(roughness, cutoff));
        let most = all.into_iter().fold(0.0, f32::max);
        for channel in 0..3 {
            let jump = (sides[0][channel] - sides[1][channel]).abs();
            assert!(jump < 0.02 * most, "{light}{clearcoat}: {sides:?}");
            let expected = kept * all[channel] + (1.0 - kept) * far[channel];
            let off = (found[channel] - expected).abs();
            assert!(
                off < 0.02 * most,
                "{light}{clearcoat}: {found:?} {all:?} {far:?}"
            );
        }
        let differs = (0..3).any(|k| (all[k] - far[k]).abs() > 0.05 * most);
        assert!(differs, "{light}: {all:?} {far:?}");
    }
}

#[test]
fn reflections_below_the_fade_are_whole() {
    let Some(gpu) = gpu() else { return };
    let text = [ROOM, LIGHTS[0]].concat();
    let metal = "material.floor.metallic=1";
    for (kind, roughness) in [
        ("material.floor.metallic=0", 0.159),
        (metal, 0.9),
        (metal, 1.0),
    ] {
        let own = format!("material.floor.roughness={roughness}");
        let of = |cutoff: &str| {
            mean(&render(
                gpu,
                &text,
                &[kind, &own, "image.samples=4", cutoff],
                &[],
            ))
        };
        let whole = of("reflection.roughness_cutoff=1");
        let found = of("reflection.roughness_cutoff=0.2");
        for channel in 0..3 {
            assert_close(found[channel], whole[channel], 1e-4);
        }
    }
}
