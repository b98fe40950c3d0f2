//! Indirect light between surfaces, and the method `path` that follows all of it, against closed forms.

use super::kit::*;

/// The camera in a closed box whose walls all emit and scatter alike.
const OVEN: &str = include_str!("indirect/oven.toml");

#[test]
fn an_oven_shines_by_the_sum_of_its_bounces() {
    let Some(gpu) = gpu() else { return };
    for (set, orders, tolerance) in [
        ("reflection.diffuse_bounces=0", 0, 1e-3),
        ("reflection.diffuse_bounces=1", 1, 1e-3),
        ("reflection.diffuse_bounces=4", 4, 1e-3),
        ("reflection.method=path", 40, 5e-2),
    ] {
        // Every ray meets the same light, so that the only noise is from random ends of paths.
        let found = mean(&render(
            gpu,
            OVEN,
            &[set, "image.size=[16, 16]", "image.samples=16"],
            &[],
        ))[0];
        let expected: f32 = (0..=orders).map(|k| 0.25 * 0.5_f32.powi(k)).sum();
        assert_close(found, expected, tolerance);
    }
    // Emissive surfaces are found by rays towards them, one order of bounces earlier.
    for (bounces, orders) in [(0, 1), (2, 3)] {
        let bounces = format!("reflection.diffuse_bounces={bounces}");
        let set = [
            "material.wall.light=true",
            "image.size=[32, 32]",
            "image.samples=16",
            &bounces,
        ];
        let found = mean(&render(gpu, OVEN, &set, &[]))[0];
        let expected: f32 = (0..=orders).map(|k| 0.25 * 0.5_f32.powi(k)).sum();
        assert_close(found, expected, 0.02);
    }
}

/// A floor below an emissive ceiling, both much wider than their distance.
const PLATES: &str = include_str!("indirect/plates.toml");

#[test]
fn two_plates_light_each_other() {
    let Some(gpu) = gpu() else { return };
    let found = mean(&render(gpu, PLATES, &["reflection.method=path"], &[]));
    for (found, albedo) in found.iter().zip([0.8_f32, 0.5, 0.2]) {
        assert_close(*found, albedo / (1.0 - 0.5 * albedo), 0.02);
    }
}

/// White objects that occlude each other, in even light.
const WHITE: &str = include_str!("indirect/white.toml");

#[test]
fn white_things_in_white_light_cannot_be_seen_by_all_paths() {
    let Some(gpu) = gpu() else { return };
    let found = mean(&render(gpu, WHITE, &["reflection.method=path"], &[]))[0];
    assert_close(found, 1.0, 0.01);
    if !is_long() {
        return;
    }
    let few = ["reflection.diffuse_bounces=8", "reflection.bounces=8"];
    let few = mean(&render(gpu, WHITE, &few, &[]))[0];
    assert_close(few, 1.0, 0.01);
    let direct = mean(&render(gpu, WHITE, &["environment.shadow=ray"], &[]))[0];
    assert!(direct < 0.98, "{direct}");
}

#[test]
fn mirrors_show_scattered_light_whatever_finds_it() {
    let Some(gpu) = gpu() else { return };
    // A mirror shows a floor that an emissive wall tints.
    let mirror = "[material.mirror]\nbase_color = [1, 1, 1]\nmetallic = 1\nroughness = 0\n[model.mirror]\n\
                  shape = { kind = \"plane\", size = [2, 2] }\nmaterial = \"mirror\"\n[[instance]]\n\
                  model = \"mirror\"\ntranslation = [0.6, 0.4, 0]\nrotation_deg = [0, 0, 90]\n";
    let text = [PLATES, mirror].concat();
    let picture = |set: &[&str]| {
        let all = [
            &[
                "camera.main.eye=[-0.5, 0.7, 0]",
                "camera.main.target=[0.5, 0.25, 0]",
                "camera.main.fov_deg=60",
                "image.size=[96, 64]",
                "image.samples=16",
                "reflection.diffuse_bounces=2",
            ],
            set,
        ];
        mean(&render(gpu, &text, &all.concat(), &[]))
    };
    let traced = picture(&["reflection.method=rt"]);
    let hybrid = picture(&["reflection.method=hybrid"]);
    let direct = picture(&["reflection.method=rt", "reflection.diffuse_bounces=0"]);
    for channel in 0..3 {
        assert_close(hybrid[channel], traced[channel], 0.01);
        assert!(traced[channel] > 1.05 * direct[channel]);
    }
}

#[test]
#[ignore = "long: renders by path with several settings"]
fn the_truth_depends_on_no_setting_of_the_others() {
    let Some(gpu) = gpu() else { return };
    let path = |set: &[&str]| {
        let all = [&["reflection.method=path", "image.samples=2"], set].concat();
        render(gpu, WHITE, &all, &[]).color
    };
    let others = path(&[
        "reflection.bounces=1",
        "reflection.roughness_cutoff=0",
        "reflection.diffuse_bounces=1",
        "reflection.fade=true",
        "reflection.ray_length_u=1",
    ]);
    assert_eq!(path(&[]), others);
    let (desc, world) = scene(WHITE, &["reflection.method=path"]);
    let renderer = renderer(gpu, &desc, &world, false);
    assert!(renderer.plan().precision.full && renderer.plan().features.unbiased);
    let (desc, world) = scene(WHITE, &[]);
    assert!(
        !super::kit::renderer(gpu, &desc, &world, false)
            .plan()
            .features
            .indirect
    );
}

#[test]
fn light_behind_solid_glass_is_found_by_what_is_refracted() {
    let Some(gpu) = gpu() else { return };
    // A slab that bends no light: only the search for light differs.
    let slab = "[material.slab]\ntransmission = 1\nthickness_m = 1\nior = 1\nreflectivity = 0\nroughness = 0\n\
                [model.slab]\nshape = { kind = \"box\", size = [9, 0.2, 9] }\nmaterial = \"slab\"\n[[instance]]\n\
                model = \"slab\"\ntranslation = [0, 1, 0]\n";
    let lamp =
        "[light.lamp]\nkind = \"point\"\nposition = [0, 2, 0]\nintensity_cd = 10\nradius_m = 0.7\n";
    let floor = PLATES
        .replace("emission = [1, 1, 1]", "")
        .replace("translation = [0, 1, 0]", "translation = [0, -1, 0]");
    let set = [
        "reflection.method=path",
        "image.size=[32, 32]",
        "image.samples=64",
    ];
    let of = |parts: &[&str]| mean(&render(gpu, &parts.concat(), &set, &[]))[0];
    let (open, behind) = (of(&[&floor, lamp]), of(&[&floor, lamp, slab]));
    assert!(open > 0.1);
    assert_close(behind, open, 0.03);
}

#[test]
fn a_limit_takes_away_what_paths_find_seldom() {
    let Some(gpu) = gpu() else { return };
    // Paths through matte surfaces find all light of the box after a random bounce; direct sampling finds none.
    let set = [
        "reflection.diffuse_bounces=2",
        "material.wall.emission_strength=4",
    ];
    let open = mean(&render(gpu, OVEN, &set, &[]))[0];
    assert_close(open, 1.0 + 0.5 + 0.25, 1e-3);
    // The limit is relative to white at the exposure, by default the square root of the samples; groups have none.
    for (limit, last) in [
        (["reflection.glint_limit=0.4", "image.exposure_ev=2"], 0.1),
        (["image.samples=4", "image.exposure_ev=4.321928"], 0.1),
        (["material.wall.light_group=a", "image.exposure_ev=6"], 0.25),
    ] {
        let limited = [&set[..], &limit].concat();
        let found = mean(&render(gpu, OVEN, &limited, &[]))[0];
        assert_close(found, 1.0 + 0.5 + last, 1e-3);
    }
    let path = ["reflection.method=path", "reflection.glint_limit=0.1"];
    assert_eq!(
        render(gpu, OVEN, &path, &[]).color,
        render(gpu, OVEN, &path[..1], &[]).color
    );
}

/// A mirror that shows a matte wall, lit only by a ceiling that is farther away than the ray length of reflections.
const MIRRORED: &str = include_str!("indirect/mirrored.toml");

#[test]
fn screen_hits_gather_what_traced_ones_do() {
    let Some(gpu) = gpu() else { return };
    for limit in ["reflection.glint_limit=0", "reflection.glint_limit=0.02"] {
        let [hybrid, rt] = ["hybrid", "rt"].map(|method| {
            let method = format!("reflection.method={method}");
            mean(&render(gpu, MIRRORED, &[limit, &method], &[]))[0]
        });
        assert!(rt > 0.01, "{limit}: the wall is lit, {rt}");
        assert_close(hybrid, rt, 0.02);
    }
    // Rays that curved surfaces scatter find patterns through cones as wide, by either method.
    let mirrors = include_str!("../../scenes/mirrors.toml");
    let [hybrid, rt] = ["hybrid", "rt"].map(|method| {
        let method = format!("reflection.method={method}");
        let set = [
            "image.size=[48, 27]",
            "reflection.diffuse_bounces=1",
            &method,
        ];
        render(gpu, mirrors, &set, &[]).color
    });
    let apart = hybrid.iter().zip(&rt).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f32::max) < 2e-3);
}
