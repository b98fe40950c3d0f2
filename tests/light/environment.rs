//! The environment as background, in mirrors and as a light, against closed forms and integrals.

use std::path::PathBuf;

use super::{extent::METAL, kit::*};

/// Folder for the files of one test.
pub fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("reflet-{name}-{}", std::process::id()));
    or_panic!(fs::create_dir_all(&folder));
    folder
}

/// Writes a panorama whose texels are these.
pub fn write_sky(file: &Path, size: [usize; 2], texel: impl Fn(usize, usize) -> [f32; 3] + Sync) {
    let texel = |x, y| texel(x, y).into();
    or_panic!(exr::prelude::write_rgb_file(file, size[0], size[1], texel));
}

/// Renders scene text with the panorama `sky.exr`, filled by `texel`.
fn render_under(
    name: &str,
    size: [usize; 2],
    texel: impl Fn(usize, usize) -> [f32; 3] + Sync,
    text: &str,
    set: &[&str],
) -> Option<Picture> {
    let folder = folder(name);
    let file = folder.join("sky.exr");
    write_sky(&file, size, texel);
    let (desc, world) = scene_of(&folder.join("scene.toml"), text, set);
    let shown = picture(&desc, &world, &[]);
    or_panic!(fs::remove_dir_all(folder));
    shown
}

/// A floor that fills the picture, seen from above.
pub const FLOOR: &str = include_str!("environment/floor.toml");

/// Scene text that refers to the panorama.
pub const SKY: &str = "[environment]\nfile = \"sky.exr\"\n";

#[test]
fn a_constant_environment_on_a_matte_floor_is_albedo_times_radiance() {
    let Some(gpu) = gpu() else { return };
    let text = format!("{FLOOR}[environment]\ncolor = [0.3, 0.6, 0.9]\nshadow = \"ray\"\n");
    // The result is exact even with one ray, which follows the cosine distribution.
    for set in [&[][..], &["image.light_rays=1"][..]] {
        let picture = render(gpu, &text, set, &[]);
        for (x, y) in [(0, 0), (8, 4), (15, 7)] {
            assert_color(&picture, x, y, [0.15, 0.3, 0.45], 1e-3);
        }
    }
    let twice = render(gpu, &text, &["environment.intensity=2"], &[]);
    assert_color(&twice, 8, 4, [0.3, 0.6, 0.9], 2e-3);
}

#[test]
fn a_panorama_of_one_texel_is_a_constant() {
    let text = format!("{FLOOR}{SKY}");
    let one = |_, _| [0.3, 0.6, 0.9];
    let floor = or_skip!(render_under("one-texel", [1, 1], one, &text, &[]));
    assert_color(&floor, 8, 4, [0.15, 0.3, 0.45], 1e-3);
    let up = ["camera.main.target=[0, 9, 0]"];
    let sky = or_skip!(render_under("one-texel-sky", [1, 1], one, &text, &up));
    assert_color(&sky, 8, 4, [0.3, 0.6, 0.9], 1e-3);
    let hidden = [up[0], "environment.visible=false"];
    let sky = or_skip!(render_under(
        "one-texel-hidden",
        [1, 1],
        one,
        &text,
        &hidden
    ));
    assert_color(&sky, 8, 4, [0.0; 3], 0.0);
}

#[test]
fn a_sun_behind_a_surface_leaves_no_grain_on_it() {
    // The sun, 100,000 times as bright as the rest, is one texel below the floor. It takes no samples from the floor's
    // view: light of one brightness, which a sample by the cosine finds exactly.
    let sun = |x, y| {
        if (x, y) == (20, 46) {
            [4e4; 3]
        } else {
            [0.4; 3]
        }
    };
    let text = format!("{FLOOR}{SKY}");
    for turn in ["0", "77"] {
        let turn = format!("environment.rotation_deg={turn}");
        let set = ["image.light_rays=1", turn.as_str()];
        let picture = or_skip!(render_under("sun-behind", [128, 64], sun, &text, &set));
        for (x, y) in [(0, 0), (8, 4), (9, 4), (15, 7)] {
            assert_color(&picture, x, y, [0.2; 3], 1e-3);
        }
    }
}

/// Panorama: red in the middle, green left of it, blue at both ends, white to its right.
fn quarters(x: usize, y: usize) -> [f32; 3] {
    match (x + 4) % 32 / 8 {
        _ if y < 4 => [0.1, 0.2, 0.3],
        0 => [0.0, 0.0, 1.0],
        1 => [0.0, 1.0, 0.0],
        2 => [1.0, 0.0, 0.0],
        _ => [1.0, 1.0, 1.0],
    }
}

#[test]
fn a_panorama_stands_as_its_convention_says_and_turns() {
    let mirror =
        include_str!("environment/a_panorama_stands_as_its_convention_says_and_turns.toml");
    let sky = format!("{mirror}{SKY}");
    let (red, green, blue) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let white = [1.0; 3];
    for (turn, target, expected) in [
        (0, "[0, 0, 1]", red),
        (0, "[1, 0, 0]", green),
        (0, "[0, 0, -1]", blue),
        (0, "[-1, 0, 0]", white),
        (90, "[1, 0, 0]", red),
        (-90, "[1, 0, 0]", blue),
    ] {
        let target = format!("camera.main.target={target}");
        let turn = format!("environment.rotation_deg={turn}");
        let away = "instance=[{model=\"mirror\", translation=[0, -9, 0]}]";
        let set = [target.as_str(), &turn, away];
        let picture = or_skip!(render_under("quarters", [32, 16], quarters, &sky, &set));
        assert_color(&picture, 4, 4, expected, 1e-3);
    }
    // A mirror at the origin that faces +Z, seen from +Z, shows the panorama at +Z.
    let set = [
        "camera.main.eye=[0, 0, 2]",
        "camera.main.target=[0, 0, 0]",
        "instance=[{model=\"mirror\", rotation_deg=[90, 0, 0]}]",
    ];
    for method in ["rt", "hybrid"] {
        let method = format!("reflection.method={method}");
        let set = [set[0], set[1], set[2], &method];
        let picture = or_skip!(render_under(
            "quarters-mirror",
            [32, 16],
            quarters,
            &sky,
            &set
        ));
        assert_color(&picture, 4, 4, red, 1e-3);
    }
}

/// A dim sky with a small, bright sun at 45°.
fn sunny(x: usize, y: usize) -> [f32; 3] {
    if (30..32).contains(&x) && (16..18).contains(&y) {
        [2000.0, 1500.0, 1000.0]
    } else {
        [0.2, 0.3, 0.5 + 0.01 * y as f32]
    }
}

/// Irradiance of `sunny` on a floor, over π: the integral of its texels, interpolated as they are.
fn irradiance_over_pi(size: [usize; 2]) -> [f32; 3] {
    let finer = 16;
    let (width, height) = (size[0] * finer, size[1] * finer);
    let mut sum = [0.0_f64; 3];
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let latitude = PI * (0.5 - (y as f32 + 0.5) / height as f32);
        if latitude <= 0.0 {
            continue;
        }
        let solid = latitude.cos() * (PI / height as f32) * (2.0 * PI / width as f32);
        let at = [x, y].map(|i| (i as f32 + 0.5) / finer as f32 - 0.5);
        let low = at.map(f32::floor);
        let place = |i: f32, edge: usize, wraps: bool| {
            let (i, edge) = (i as i64, edge as i64);
            let i = if wraps {
                i.rem_euclid(edge)
            } else {
                i.clamp(0, edge - 1)
            };
            i as usize
        };
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let part = [(at[0] - low[0], dx), (at[1] - low[1], dy)];
            let part = part.map(|(f, d)| if d == 1 { f } else { 1.0 - f });
            let texel = sunny(
                place(low[0] + dx as f32, size[0], true),
                place(low[1] + dy as f32, size[1], false),
            );
            for (sum, value) in sum.iter_mut().zip(texel) {
                let weight = solid * latitude.sin() / PI * part[0] * part[1];
                *sum += f64::from(value * weight);
            }
        }
    }
    sum.map(|sum| sum as f32)
}

#[test]
fn samples_of_a_panorama_converge_to_its_irradiance() {
    let text = format!("{FLOOR}{SKY}");
    let expected = irradiance_over_pi([128, 64]).map(|e| 0.5 * e);
    // Limits for the mean over all pixels, which few samples suffice for, and for single pixels, which need many.
    for (samples, together, alone) in [("4", 0.15, 10.0), ("64", 0.03, 0.5), ("512", 0.01, 0.1)] {
        let set = [&*format!("image.samples={samples}"), "image.light_rays=1"];
        let picture = render_under("sunny", [128, 64], sunny, &text, &set);
        let Some(picture) = picture else { return };
        for (c, expected) in expected.into_iter().enumerate() {
            assert_close(mean(&picture)[c], expected, together);
            for (x, y) in [(3, 3), (9, 5)] {
                assert_close(color(&picture, x, y)[c], expected, alone);
            }
        }
    }
}

#[test]
fn a_wall_takes_half_of_the_sky() {
    let wall = include_str!("environment/a_wall_takes_half_of_the_sky.toml");
    let Some(gpu) = gpu() else { return };
    let text = format!("{FLOOR}{wall}");
    // The point under the camera is 1 m from a wall that reaches 998 m up.
    let set = ["image.samples=64", "camera.main.fov_deg=1"];
    let picture = render(gpu, &text, &set, &[]);
    // A floor at distance d from a wall sees (1 + cos 90°) / 2 of the sky.
    assert_close(mean(&picture)[0], 0.25, 0.02);
    let open = [set[0], set[1], "environment.shadow=none"];
    assert_color(&render(gpu, &text, &open, &[]), 8, 4, [0.5; 3], 1e-3);
}

/// Directional albedo of GGX with reflectance 1 for a view at `cosine`, by
/// integration over visible facets.
pub fn directional_albedo(cosine: f64, roughness: f64) -> f64 {
    let a2 = roughness.powi(4);
    let view = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
    let (steps, mut sum) = (600, 0.0);
    for i in 0..steps {
        // Samples uniform in u, where tan² of the facet's slope is a² u / (1 − u).
        let u = (f64::from(i) + 0.5) / f64::from(steps);
        let c = 1.0 / (1.0 + a2 * u / (1.0 - u)).sqrt();
        let s = (1.0 - c * c).sqrt();
        for k in 0..steps {
            let phi = 2.0 * std::f64::consts::PI * (f64::from(k) + 0.5) / f64::from(steps);
            let h = [s * phi.cos(), s * phi.sin(), c];
            let vh = view[0] * h[0] + view[2] * h[2];
            let nl = 2.0 * vh * h[2] - view[2];
            if vh <= 0.0 || nl <= 0.0 {
                continue;
            }
            let lambda = |n: f64| (a2 + (1.0 - a2) * n * n).sqrt();
            let visible = 0.5 / (nl * lambda(cosine) + cosine * lambda(nl));
            sum += visible * 4.0 * nl * vh / h[2];
        }
    }
    sum / f64::from(steps * steps)
}

#[test]
fn a_rough_metal_in_a_furnace_shows_its_directional_albedo() {
    let Some(gpu) = gpu() else { return };
    let metal =
        include_str!("environment/a_rough_metal_in_a_furnace_shows_its_directional_albedo.toml");
    let sampled = format!("{FLOOR}{metal}");
    // By samples of the environment, and by rays of either method.
    for (text, method) in [(sampled.as_str(), "rt"), (METAL, "rt"), (METAL, "hybrid")] {
        for roughness in first_or_all(&["0.1", "0.7", "1", "0.4"], 3) {
            for angle_deg in [5.0_f64, 60.0] {
                let (sine, cosine) = angle_deg.to_radians().sin_cos();
                let set = [
                    &*format!("material.metal.roughness={roughness}"),
                    &format!("camera.main.eye=[{}, {}, 0]", 3.0 * sine, 3.0 * cosine),
                    "camera.main.target=[0, 0, 0]",
                    "camera.main.fov_deg=1",
                    "image.samples=32",
                    &format!("reflection.method={method}"),
                ];
                let found = mean(&render(gpu, text, &set, &[]))[0];
                let number = roughness.parse().unwrap_or(0.0);
                assert_close(found, directional_albedo(cosine, number) as f32, 0.01);
            }
        }
    }
}
