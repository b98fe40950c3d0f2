//! Sheen, rough diffuse reflection, and the strength and color of specular lobes, against integrals of their formulas.

use std::f64::consts::PI;

use reflet::world::{LAYER_SLOTS, LayerTexture};

use super::kit::*;

/// A floor seen from 3 m at an angle that a test sets, in even light.
const FLOOR: &str = include_str!("sheen/floor.toml");

/// Mean color of the floor seen at this angle from its normal.
fn seen(angle_deg: f64, material: &str, set: &[&str]) -> Option<[f32; 3]> {
    let (sine, cosine) = angle_deg.to_radians().sin_cos();
    let eye = format!("camera.main.eye=[{}, {}, 0]", 3.0 * sine, 3.0 * cosine);
    let text = FLOOR.replace("[material.floor]", &format!("[material.floor]\n{material}"));
    let set: Vec<&str> = set.iter().copied().chain([eye.as_str()]).collect();
    Some(mean(&render(gpu()?, &text, &set, &[])))
}

/// Lobe of KHR_materials_sheen for a color of 1, "Sheen distribution" and "Sheen visibility".
fn sheen(view: [f64; 3], light: [f64; 3], roughness: f64) -> f64 {
    let alpha = roughness * roughness;
    let half = [0, 1, 2].map(|k| view[k] + light[k]);
    let nh = half[2] / half.iter().map(|x| x * x).sum::<f64>().sqrt();
    let distribution = (2.0 + 1.0 / alpha) * (1.0 - nh * nh).powf(0.5 / alpha) / (2.0 * PI);
    let l = |x: f64| {
        let mix = |a: f64, b: f64| a + (b - a) * (1.0 - alpha).powi(2);
        mix(21.5473, 25.3245) / (1.0 + mix(3.82987, 3.32435) * x.powf(mix(0.19823, 0.16801)))
            + mix(-1.97760, -1.27393) * x
            + mix(-4.32054, -4.85967)
    };
    let lambda = |cosine: f64| match cosine < 0.5 {
        true => l(cosine).exp(),
        false => (2.0 * l(0.5) - l(1.0 - cosine)).exp(),
    };
    distribution / ((1.0 + lambda(view[2]) + lambda(light[2])) * 4.0 * view[2] * light[2])
}

/// Albedo of a lobe: the share of even light that it reflects, integrated over uniform directions.
fn albedo(cosine: f64, lobe: impl Fn([f64; 3], [f64; 3]) -> f64) -> f64 {
    let view = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
    let steps = 400;
    let sum: f64 = (0..steps * steps)
        .map(|i| {
            let up = (f64::from(i / steps) + 0.5) / f64::from(steps);
            let turn = 2.0 * PI * (f64::from(i % steps) + 0.5) / f64::from(steps);
            let flat = (1.0 - up * up).sqrt();
            lobe(view, [flat * turn.cos(), flat * turn.sin(), up]) * up
        })
        .sum();
    sum * 2.0 * PI / f64::from(steps * steps)
}

/// EON for a color (Portsmouth, Kutz & Hill 2025), with integrals in place of the paper's fits.
fn eon(view: [f64; 3], light: [f64; 3], roughness: f64, color: f64) -> f64 {
    let single = |view: [f64; 3], light: [f64; 3]| {
        let along = view[0] * light[0] + view[1] * light[1];
        let scale = if along > 0.0 {
            view[2].max(light[2])
        } else {
            1.0
        };
        (1.0 + roughness * along / scale) / (1.0 + roughness * (0.5 - 2.0 / (3.0 * PI))) / PI
    };
    let left = |cosine: f64| 1.0 - albedo(cosine, single);
    let mean = (0..40).map(|i| (f64::from(i) + 0.5) / 40.0);
    let mean = 1.0 - mean.map(|cosine| left(cosine) * cosine / 20.0).sum::<f64>();
    let multiple = color * color * mean / (1.0 - color * (1.0 - mean));
    color * single(view, light) + multiple / PI * left(view[2]) * left(light[2]) / (1.0 - mean)
}

#[test]
fn a_sheen_in_even_light_shows_its_directional_albedo() {
    let cloth = "base_color = [0, 0, 0]\nreflectivity = 0\nsheen_color = [1, 0.5, 0.25]";
    let check = |light: &str, roughness: f64, angle_deg: f64| {
        let own = format!("{cloth}\nsheen_roughness = {roughness}");
        let found = or_skip!(seen(angle_deg, &own, &[light, "image.samples=16"]));
        let lobe = |view, light| sheen(view, light, roughness);
        let expected = albedo(angle_deg.to_radians().cos(), lobe) as f32;
        for (found, share) in found.iter().zip([1.0, 0.5, 0.25]) {
            let error = (found - share * expected).abs();
            assert!(
                error < 0.02 * expected + 1e-3,
                "{found}, expected {share} x {expected}: {light}, {roughness}, {angle_deg}"
            );
        }
    };
    for (roughness, angle_deg) in [(0.3, 60.0), (0.3, 80.0), (0.6, 0.0), (1.0, 45.0)] {
        check("environment.shadow=none", roughness, angle_deg); // in closed form
    }
    check("environment.shadow=ray", 0.3, 75.0); // by samples
    check("reflection.diffuse_bounces=1", 0.6, 45.0);
}

#[test]
fn what_is_below_a_sheen_keeps_the_rest_of_the_light() {
    for below in [
        "",
        "metallic = 1\nroughness = 0.5",
        "metallic = 1\nroughness = 0",
    ] {
        for (roughness, angle_deg) in [(0.1, 80.0), (0.6, 50.0)] {
            let own = format!("{below}\nsheen_color = [1, 1, 1]\nsheen_roughness = {roughness}");
            let set = [
                "reflection.multiple_scattering=true",
                "reflection.roughness_cutoff=1",
            ];
            let found = or_skip!(seen(angle_deg, &own, &set));
            assert_close(found[0], 1.0, 0.015);
        }
    }
}

/// White paper that passes half of its diffuse light, of which the red is 0.6.
const PAPER: &str = "diffuse_transmission = 0.5\ndiffuse_transmission_color = [0.6, 1, 1]";
/// The same, with the lamp on its other side.
const BEHIND: &str = "diffuse_transmission_color = [0.6, 1, 1]\ndiffuse_transmission = 0.5";

#[test]
fn a_lamp_shows_the_formula_of_sheen_and_diffuse_light() {
    let lamp = "[light.lamp]\nkind = \"directional\"\nintensity_lux = 2\n\
                [material.floor]";
    let light = [1.0, -1.0, 1.0].map(|x| x / 3.0_f64.sqrt()); // z is up
    let dark = FLOOR
        .replace("[material.floor]", lamp)
        .replace("color = [1, 1, 1]", "color = [0, 0, 0]");
    let Some(gpu) = gpu() else { return };
    for side in [1.0, -1.0] {
        let view = [0.6 * side, 0.0, 0.8];
        let eye = format!("camera.main.eye=[{}, 2.4, 0]", 1.8 * side);
        for (cloth, lobe) in [
            (
                "base_color = [0, 0, 0]\nsheen_color = [1, 1, 1]\nsheen_roughness = 0.5",
                sheen(view, light, 0.5),
            ),
            (
                "base_color = [0.8, 0.8, 0.8]\ndiffuse_roughness = 1",
                eon(view, light, 1.0, 0.8),
            ),
            (PAPER, 0.5 / PI),
            (BEHIND, 0.5 * 0.6 / PI),
        ] {
            let own = format!("[material.floor]\nreflectivity = 0\n{cloth}");
            let text = dark.replace("[material.floor]", &own);
            let up = if cloth == BEHIND { 1 } else { -1 };
            let from = format!("light.lamp.direction=[-1, {up}, 1]");
            for angle in ["light.lamp.angle_deg=0", "light.lamp.angle_deg=1"] {
                let found = mean(&render(gpu, &text, &[&eye, &from, angle], &[]));
                assert_close(found[0], (2.0 * lobe * light[2]) as f32, 0.01);
            }
        }
    }
}

/// KHR_materials_specular: F0 = min(reflectivity x color, 1) x strength, F90 = strength.
#[test]
fn a_smooth_dielectric_has_the_strength_and_color_of_its_lobe() {
    for (strength, color, reflectivity) in [
        (1.0_f32, [1.0_f32, 0.5, 0.0], 0.04_f32),
        (0.5, [1.0; 3], 0.04),
        (0.75, [30.0, 10.0, 1.0], 0.08),
    ] {
        for angle_deg in [0.0_f64, 60.0, 80.0] {
            let own = format!(
                "base_color = [0, 0, 0]\nroughness = 0\nspecular = {strength}\nspecular_color = {color:?}\n\
                 reflectivity = {reflectivity}"
            );
            let found = or_skip!(seen(angle_deg, &own, &["image.samples=1"]));
            let schlick = (1.0 - angle_deg.to_radians().cos() as f32).powi(5);
            for (found, color) in found.iter().zip(color) {
                let f0 = (reflectivity * color).min(1.0) * strength;
                assert!(
                    (found - (f0 + (strength - f0) * schlick)).abs() < 2e-3,
                    "{found} at {angle_deg}"
                );
            }
        }
    }
}

#[test]
fn what_a_tinted_lobe_leaves_is_not_tinted() {
    let own = "roughness = 0.6\nspecular = 0.8\nspecular_color = [20, 5, 0]";
    for cutoff in ["0", "1"] {
        let cutoff = format!("reflection.roughness_cutoff={cutoff}");
        let set = [
            cutoff.as_str(),
            "reflection.multiple_scattering=true",
            "image.samples=16",
        ];
        let found = or_skip!(seen(40.0, own, &set));
        // All red light is reflected; green and blue have their lobe, and light that the strongest channel transmits.
        assert_close(found[0], 1.0, 0.01);
        assert!(found[1] < 0.9 && found[2] < found[1], "{found:?}");
    }
}

/// Transmission through glass is what the strongest channel of its reflection leaves, without a tint.
#[test]
fn tinted_glass_passes_no_tint() {
    let own = "transmission = 1\nior = 1.5\nroughness = 0\nspecular_color = [20, 5, 0]";
    // A black floor below, so that transmitted light is lost.
    let text = [
        &FLOOR.replace("[material.floor]", &format!("[material.floor]\n{own}")),
        include_str!("sheen/black.toml"),
    ]
    .concat();
    let Some(gpu) = gpu() else { return };
    let eye = "camera.main.eye=[0, 3, 0]";
    let reflected = mean(&render(gpu, &text, &[eye], &[]));
    let white = ["material.black.emission=[1, 1, 1]", eye];
    let both = mean(&render(gpu, &text, &white, &[]));
    assert_close(reflected[0], 0.8, 0.02); // .04 × 20
    assert_close(reflected[1], 0.2, 0.05);
    for channel in 0..3 {
        assert_close(both[channel] - reflected[channel], 0.2, 0.05);
    }
}

/// Mirrors show cloth as the camera sees it, by rays and by the march.
#[test]
fn reflections_show_sheen_and_tints_too() {
    let Some(gpu) = gpu() else { return };
    let own = "base_color = [0.1, 0.1, 0.1]\nsheen_color = [0, 0.8, 0]\nsheen_roughness = 0.4\nroughness = 0.3\n\
               specular_color = [10, 1, 1]";
    let text = FLOOR.replace("[material.floor]", &format!("[material.floor]\n{own}"));
    let mirror = include_str!("sheen/mirror.toml");
    let text = [text.as_str(), mirror].concat();
    // The mirrored camera sees the same point of the floor.
    let straight = [
        "camera.main.eye=[-9, 3, 0]",
        "instance.1.visible=false",
        "image.samples=16",
    ];
    let expected = mean(&render(gpu, &text, &straight, &[]));
    for (method, fov, size) in [
        ("rt", "1", "[8, 8]"),
        ("ssr", "70", "[64, 64]"),
        ("hybrid", "70", "[64, 64]"),
    ] {
        let set = [
            &*format!("reflection.method={method}"),
            &format!("camera.main.fov_deg={fov}"),
            &format!("image.size={size}"),
            "camera.main.eye=[3, 3, 0]",
            "camera.main.up=[0, 1, 0]",
            "camera.main.target=[-3, 1, 0]",
            "image.samples=64",
        ];
        let picture = render(gpu, &text, &set, &[]);
        // The middle lies between pixels.
        let half = picture.size[0] / 2;
        let around =
            [(1, 1), (1, 0), (0, 1), (0, 0)].map(|(x, y)| color(&picture, half - x, half - y));
        for (channel, expected) in expected.into_iter().enumerate() {
            let found = around.iter().map(|c| c[channel]).sum::<f32>() / 4.0;
            // Some rays of `ssr` meet the floor beside the picture.
            let tolerance = if method == "ssr" { 0.03 } else { 0.005 };
            assert_close(found, expected, tolerance);
        }
    }
}

/// A texture of one color acts as its channels do as numbers.
#[test]
fn textures_of_layers_multiply_their_numbers() {
    let Some(gpu) = gpu() else { return };
    let keys = include_str!("sheen/keys.txt");
    let text = FLOOR.replace("[material.floor]", &format!("[material.floor]\n{keys}"));
    let set = ["camera.main.eye=[2, 2, 0]", "image.samples=16"];
    let texel = [51_u8, 102, 204, 128];
    let [red, green, blue, alpha] = texel.map(|v| f32::from(v) / 255.0);
    let numbers = [
        format!("specular={alpha}"),
        format!(
            "specular_color=[{}, {}, {}]",
            9.0 * red,
            9.0 * green,
            9.0 * blue
        ),
        format!("sheen_color=[{red}, {green}, {blue}]"),
        format!("sheen_roughness={alpha}"),
        format!("transmission={red}"),
        format!("diffuse_transmission={alpha}"),
        format!("diffuse_transmission_color=[{red}, {green}, {blue}]"),
        format!("clearcoat={red}"),
        format!("clearcoat_roughness={green}"),
    ]
    .map(|number| format!("material.floor.{number}"));
    let both: Vec<&str> = (numbers.iter().map(String::as_str)).chain(set).collect();
    let expected = mean(&render(gpu, &text, &both, &[]));
    let (desc, mut world) = scene(&text, &set);
    world.textures.push(linear_image(2, 2, texel.repeat(4)));
    let material = world.instances[0].material;
    world.materials[material].layer_textures = [Some(FIRST_IMAGE); LAYER_SLOTS];
    // Texels of the normal map are no factors.
    world.materials[material].layer_textures[LayerTexture::ClearcoatNormal as usize] = None;
    let found = mean(&renderer(gpu, &desc, &world, false).first_view(&world, &[]));
    for (found, expected) in found.iter().zip(expected) {
        assert_close(*found, expected, 0.01);
    }
}

#[test]
fn what_no_material_has_is_no_part_of_the_frame() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(FLOOR, &[]);
    let with = renderer(gpu, &desc, &world, false);
    assert!(!with.plan().features.details && with.plan().layer_pools == 0);
    let (desc, world) = scene(FLOOR, &["material.floor.sheen_color=[0, 0, 0.5]"]);
    let plan = renderer(gpu, &desc, &world, false).plan().clone();
    assert!(plan.features.sheen && !plan.features.tints);
    let (desc, world) = scene(FLOOR, &["material.floor.specular_color=[0, 0, 0.5]"]);
    let plan = renderer(gpu, &desc, &world, false).plan().clone();
    assert!(plan.features.tints && plan.features.details && !plan.features.sheen);
}
