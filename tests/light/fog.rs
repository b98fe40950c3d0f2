//! Fog: transmitted and scattered light, against closed forms and integrals.

use std::f64::consts::PI;

use reflet::render::passes;

use super::kit::*;

/// A glowing wall 10 m before the camera, which is in a corner of the box of the fog.
const WALL: &str = include_str!("fog/wall.toml");

/// Unit direction of a pixel's center in a square picture, for a camera that looks along -Z, turned up by an angle.
fn direction(x: u32, y: u32, size: u32, fov_deg: f64, up_deg: f64) -> [f64; 3] {
    let tan = (0.5 * fov_deg).to_radians().tan();
    let at = |p: u32| ((f64::from(p) + 0.5) / f64::from(size) * 2.0 - 1.0) * tan;
    let (right, up) = (at(x), -at(y));
    let (s, c) = up_deg.to_radians().sin_cos();
    let d = [right, up * c + s, up * s - c];
    let length = d.iter().map(|v| v * v).sum::<f64>().sqrt();
    d.map(|v| v / length)
}

/// Integral of a function over an interval (midpoint rule).
fn integral(from: f64, to: f64, steps: u32, f: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / f64::from(steps);
    let at = |k: u32| f(from + (f64::from(k) + 0.5) * step);
    (0..steps).map(at).sum::<f64>() * step
}

#[test]
fn a_wall_is_dimmed_by_its_distance() {
    let Some(gpu) = gpu() else { return };
    let picture = render(gpu, WALL, &[], &[]);
    let moved = "translation = [3e5, 0, -10]";
    let far = WALL
        .replace("translation = [0, 0, -10]", moved)
        .replace("eye = [0, 0, 0]", "eye = [3e5, 0, 0]")
        .replace("target = [0, 0, -1]", "target = [3e5, 0, -1]");
    let small = WALL
        .replace("-10]", "-0.001]")
        .replace("size = [40, 40]", "size = [0.004, 0.004]")
        .replace("density = 0.1", "density = 1000");
    for (name, picture) in [
        ("near", picture),
        ("far from the origin", render(gpu, &far, &[], &[])),
        ("1e-4 of the size", render(gpu, &small, &[], &[])),
    ] {
        for (x, y) in (0..17).flat_map(|y| (0..17).map(move |x| (x, y))) {
            let length = 10.0 / -direction(x, y, 17, 60.0, 0.0)[2];
            let expected = (-0.1 * length).exp() as f32;
            let found = color(&picture, x, y)[0];
            assert!(
                (found - expected).abs() < 1e-3,
                "{name}: {found}, expected {expected}"
            );
        }
    }
}

/// The camera below the top of the layer, in the thin fog above it, and far above; it looks up, straight and down.
#[test]
fn fog_that_thins_out_dims_by_its_integral() {
    let Some(gpu) = gpu() else { return };
    let [density, top, falloff] = [0.2, 1.0, 1.5];
    for (eye, up_deg) in [
        (0.2, 30.0),
        (0.2, -5.0),
        (2.5, -12.0),
        (2.5, 0.0),
        (40.0, -40.0),
        (40.0, 20.0),
    ] {
        let (s, c) = f64::to_radians(up_deg).sin_cos();
        let text = WALL
            .replace(
                "density = 0.1",
                "density = 0.2, height_m = 1, falloff_m = 1.5",
            )
            .replace("eye = [0, 0, 0]", &format!("eye = [0, {eye}, 0]"))
            .replace(
                "target = [0, 0, -1]",
                &format!("target = [0, {}, {}]", eye + s, -c),
            )
            .replace("size = [40, 40]", "size = [400, 400]");
        let picture = render(gpu, &text, &["image.size=[9, 9]"], &[]);
        let mut seen = 0;
        for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (x, y))) {
            let d = direction(x, y, 9, 60.0, up_deg);
            let length = 10.0 / -d[2];
            if d[2] >= 0.0 || length > 100.0 {
                continue;
            }
            let depth = integral(0.0, length, 4000, |t| {
                density * (-f64::max(eye + d[1] * t - top, 0.0) / falloff).exp()
            });
            assert_color(&picture, x, y, [(-depth).exp() as f32; 3], 2e-3);
            seen += 1;
        }
        assert!(seen > 50, "{seen}");
    }
}

/// Phase function of Henyey and Greenstein.
fn phase(g: f64, cosine: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5))
}

/// A dark wall 10 m away, a lamp between, and the light that the fog scatters on the way.
#[test]
fn fog_scatters_the_light_of_a_lamp() {
    let Some(gpu) = gpu() else { return };
    let lamp = [0.6, 0.3, -4.0];
    for (g, shadow) in [(0.0, "map"), (0.7, "ray"), (-0.5, "none")] {
        let text = WALL.replace("emission = [1, 1, 1]", "").replace(
            ", color = [0, 0, 0]",
            &format!(", color = [1, 0.5, 0.25], anisotropy = {g}"),
        ) + "[light.l]\nkind = \"point\"\nposition = [0.6, 0.3, -4]\nintensity_cd = 10\n";
        let shadow = format!("light.l.shadow={shadow}");
        let set = ["image.size=[15, 15]", "image.samples=64", &shadow];
        let picture = render(gpu, &text, &set, &[]);
        let (mut all, mut truth) = (0.0, 0.0);
        for (x, y) in (0..15).flat_map(|y| (0..15).map(move |x| (x, y))) {
            let d = direction(x, y, 15, 60.0, 0.0);
            let offset = |t: f64| [0, 1, 2].map(|i| lamp[i] - d[i] * t);
            let length = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
            let along = (0..3).map(|i| d[i] * lamp[i]).sum();
            // Sub-frames cover the pixel: near the lamp, its center says little.
            if length(offset(along)) < 1.2 {
                continue;
            }
            let expected = integral(0.0, 10.0 / -d[2], 4000, |t| {
                let distance = length(offset(t));
                let passed = (-0.1 * (t + distance)).exp();
                0.1 * passed * phase(g, (along - t) / distance) * 10.0 / distance.powi(2)
            }) as f32;
            let found = color(&picture, x, y);
            for (found, albedo) in found.into_iter().zip([1.0, 0.5, 0.25]) {
                assert_close(found, albedo * expected, 0.15);
            }
            (all, truth) = (all + found[0], truth + expected);
        }
        assert_close(all, truth, 0.01);
    }
}

/// A sun above fog that thins out: its light is dimmed on the way in and on the way to the eye.
#[test]
fn fog_scatters_the_light_of_the_sun() {
    let Some(gpu) = gpu() else { return };
    let text = WALL.replace("emission = [1, 1, 1]", "").replace(
        ", color = [0, 0, 0]",
        ", color = [1, 1, 1], height_m = -1, falloff_m = 2",
    ) + "[light.l]\nkind = \"directional\"\ndirection = [0, -0.6, -0.8]\nintensity_lux = 5\nshadow = \"none\"\n";
    let set = [
        "image.size=[5, 5]",
        "image.samples=64",
        "camera.main.fov_deg=20",
    ];
    let picture = render(gpu, &text, &set, &[]);
    let thinness = |y: f64| (-f64::max(y + 1.0, 0.0) / 2.0).exp();
    // Depth of the fog above a height, along the sun's light.
    let above = |y: f64| (f64::max(-1.0 - y, 0.0) + 2.0 * thinness(y)) / 0.6;
    for (x, y) in (0..5).flat_map(|y| (0..5).map(move |x| (x, y))) {
        let d = direction(x, y, 5, 20.0, 0.0);
        let cosine = 0.6 * d[1] + 0.8 * d[2];
        let depth = |t: f64| integral(0.0, t, 200, |t| thinness(d[1] * t));
        let expected = integral(0.0, 10.0 / -d[2], 400, |t| {
            let y = d[1] * t;
            0.1 * thinness(y) * (-0.1 * (depth(t) + above(y))).exp() * 5.0
        }) * phase(0.0, cosine);
        let found = color(&picture, x, y)[0];
        assert_close(found, expected as f32, 0.01);
    }
}

/// White things in white fog under even light: nothing can be seen.
const FURNACE: &str = include_str!("fog/furnace.toml");

#[test]
fn white_fog_in_even_light_cannot_be_seen() {
    let Some(gpu) = gpu() else { return };
    for method in first_or_all(&["rt", "hybrid"], 1) {
        let method = format!("reflection.method={method}");
        let picture = render(gpu, FURNACE, &[&method], &[]);
        for (x, y) in (0..16).flat_map(|y| (0..24).map(move |x| (x, y))) {
            assert_color(&picture, x, y, [1.0; 3], 2e-3);
        }
    }
    let set = ["reflection.method=path", "image.samples=64"];
    for found in mean(&render(gpu, FURNACE, &set, &[])) {
        assert_close(found, 1.0, 0.01);
    }
}

/// A mirror that shows a glowing wall behind the camera: the way over the mirror counts, 4 m and 6 m.
#[test]
fn reflections_are_dimmed_by_the_way_over_the_mirror() {
    let Some(gpu) = gpu() else { return };
    let text = WALL.replace("translation = [0, 0, -10]", "translation = [0, 0, 2]")
        + "rotation_deg = [-90, 0, 0]\n[material.mirror]\nbase_color = [1, 1, 1]\nmetallic = 1\nroughness = 0\n\
           reflection = \"mirror\"\n[model.mirror]\nshape = { kind = \"plane\", size = [9, 9] }\n\
           material = \"mirror\"\n[[instance]]\nmodel = \"mirror\"\ntranslation = [0, 0, -4]\nrotation_deg = [90, 0, 0]\n";
    let text = text.replacen("rotation_deg = [90, 0, 0]\nrotation_deg", "rotation_deg", 1);
    for method in ["rt", "hybrid"] {
        let method = format!("reflection.method={method}");
        let picture = render(gpu, &text, &["camera.main.fov_deg=20", &method], &[]);
        for (x, y) in [(8, 8), (0, 8), (16, 16)] {
            let length = 10.0 / -direction(x, y, 17, 20.0, 0.0)[2];
            assert_color(&picture, x, y, [(-0.1 * length).exp() as f32; 3], 1e-3);
        }
    }
}

/// The wall behind a pane of half coverage, and behind a thin pane of glass: each part of the way counts once.
#[test]
fn what_is_behind_a_pane_is_dimmed_by_the_whole_way() {
    let Some(gpu) = gpu() else { return };
    for (material, passed) in [
        ("alpha = 0.5", 0.5),
        ("transmission = 1\nroughness = 0", 1.0),
    ] {
        let text = format!(
            "{WALL}[material.pane]\nbase_color = [1, 1, 1]\nreflectivity = 0\n{material}\n[model.pane]\n\
             shape = {{ kind = \"plane\", size = [9, 9] }}\nmaterial = \"pane\"\n[[instance]]\nmodel = \"pane\"\n\
             translation = [0, 0, -4]\nrotation_deg = [90, 0, 0]\n"
        );
        let picture = render(gpu, &text, &["camera.main.fov_deg=20"], &[]);
        for (x, y) in [(8, 8), (0, 8), (16, 16)] {
            let length = 10.0 / -direction(x, y, 17, 20.0, 0.0)[2];
            let expected = passed * (-0.1 * length).exp() as f32;
            assert_color(&picture, x, y, [expected; 3], 4e-3);
        }
    }
}

/// Shadows in the fog are the lamp's: a map shows the same as rays.
#[test]
fn beams_end_where_things_block_the_light() {
    let Some(gpu) = gpu() else { return };
    let text = WALL
        .replace("emission = [1, 1, 1]", "")
        .replace(", color = [0, 0, 0]", ", color = [1, 1, 1]")
        + include_str!("fog/beams_end_where_things_block_the_light.toml");
    let of = |shadow: &str, spot_cd: f32| {
        let set = [
            &*format!("light.l.shadow={shadow}"),
            &format!("light.s.shadow={shadow}"),
            &format!("light.s.intensity_cd={spot_cd}"),
        ];
        render(
            gpu,
            &text,
            &["image.samples=64", set[0], set[1], set[2]],
            &[],
        )
    };
    let [map, ray, none] = ["map", "ray", "none"].map(|shadow| of(shadow, 50.0));
    let (a, b, open) = (mean(&map)[0], mean(&ray)[0], mean(&none)[0]);
    assert_close(a, b, 0.02);
    assert!(open > 1.1 * b, "{b} with shadows, {open} without");
    // The block hides the lamp, and no lamplight falls between it and the camera.
    let [ray, none] = ["ray", "none"].map(|shadow| color(&of(shadow, 0.0), 8, 8)[0]);
    assert!(ray < 0.5 * none, "{ray} with shadows, {none} without");
}

/// Fog of density 0 is none: no pass, no part of a shader, the same bytes.
#[test]
fn fog_of_density_0_costs_nothing() {
    let Some(gpu) = gpu() else { return };
    let none = WALL.replace("fog = { density = 0.1, color = [0, 0, 0] }", "");
    let zero = WALL.replace("density = 0.1", "density = 0.0");
    assert_eq!(
        render(gpu, &none, &[], &[]).color,
        render(gpu, &zero, &[], &[]).color
    );
    let names = |text: &str| {
        let (desc, world) = scene(text, &[]);
        let renderer = renderer(gpu, &desc, &world, false);
        let passes = passes::needed_passes(renderer.plan(), &RenderOptions::for_scene(&desc));
        passes.iter().map(|pass| pass.name).collect::<Vec<_>>()
    };
    assert_eq!(names(&none), names(&zero));
    assert!(!names(&zero).contains(&"fog"));
    assert!(names(WALL).contains(&"fog"));
}

/// Numbers at the ends of their ranges, and cameras within fog and far above it, give finite light.
#[test]
fn extreme_fog_gives_finite_light() {
    let Some(gpu) = gpu() else { return };
    let lit = WALL.to_owned()
        + "[light.l]\nkind = \"point\"\nposition = [0, 0, -4]\nintensity_cd = 10\n[light.s]\nkind = \"spot\"\n\
           position = [0, 3, -4]\ntarget = [0, 0, -4]\nintensity_cd = 10\nshadow = \"ray\"\n[light.sun]\n\
           kind = \"directional\"\ndirection = [0, -1, 0.001]\nintensity_lux = 1\n";
    for fog in [
        "density = 1e12",
        "density = 1e-30",
        "density = 1e12, falloff_m = 1e-30",
        "density = 1e-6, falloff_m = 1e12, height_m = 1e12",
        "density = 1, falloff_m = 1e-3, height_m = -1e12, anisotropy = 0.95",
        "density = 1, falloff_m = 0.5, height_m = -500, anisotropy = -0.95",
        "density = 0.1, color = [1, 0, 1]",
    ] {
        let text = lit.replace("density = 0.1, color = [0, 0, 0]", fog);
        for eye in ["[0, 0, 0]", "[0, 500, 0]", "[0, 0, -4]"] {
            let text = text
                .replace("eye = [0, 0, 0]", &format!("eye = {eye}"))
                .replace("target = [0, 0, -1]", "target = [0.1, 0.2, -10]");
            let picture = render(gpu, &text, &["image.size=[8, 8]"], &[]);
            let is_good = |c: &f32| c.is_finite() && *c >= 0.0;
            assert!(picture.color.iter().all(is_good), "{fog}, eye {eye}");
        }
    }
}
