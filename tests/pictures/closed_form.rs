//! Scenes with radiance in closed form.

use reflet::{math::srgb_from_linear, render::pipeline::cause::Source};

use crate::kit::*;

/// A mirror in the plane z = 0 that faces the camera, and a surface with radiance (0.2, 0.5, 0.8)
/// behind the camera.
pub const MIRROR: &str = include_str!("closed_form/mirror.toml");

#[test]
fn a_perfect_mirror_shows_the_color_that_it_reflects() {
    let Some(gpu) = gpu() else { return };
    for method in ["rt", "hybrid"] {
        let picture = render(gpu, MIRROR, &[&format!("reflection.method={method}")], &[]);
        for (x, y) in [(0, 0), (16, 8), (32, 16), (5, 11)] {
            assert_color(&picture, x, y, [0.2, 0.5, 0.8], 1e-3);
        }
    }
}

#[test]
fn a_mirror_that_screen_space_cannot_serve_stays_black_with_ssr() {
    let Some(gpu) = gpu() else { return };
    let picture = render(gpu, MIRROR, &["reflection.method=ssr"], &[]);
    assert_color(&picture, 16, 8, [0.0; 3], 0.0);
}

/// A card before the mirror, red towards the camera and green towards the mirror: the screen shows
/// the wrong side, wherever the crossing is.
#[test]
fn a_side_that_is_turned_away_is_not_taken_from_the_screen() {
    let Some(gpu) = gpu() else { return };
    let card =
        include_str!("closed_form/a_side_that_is_turned_away_is_not_taken_from_the_screen.toml");
    let text = format!("{MIRROR}{card}");
    let shown = |method: &str| {
        let set = [
            "image.size=[165, 85]",
            "reflection.accept=threshold",
            "reflection.threshold_u=1",
            &format!("reflection.method={method}"),
        ];
        render(gpu, &text, &set, &[Aov::Cause])
    };
    let (hybrid, rt) = (shown("hybrid"), shown("rt"));
    let back = Cause::ALL.iter().position(|c| *c == Cause::BackFace);
    let back = back.expect("a cause") as u32;
    let causes = integers(&hybrid, Aov::Cause);
    let seen_from_behind = (0..causes.len()).filter(|&i| causes[i] == back);
    let of = |picture: &Picture, i: usize| [0, 1, 2].map(|c| picture.color[4 * i + c]);
    let green = seen_from_behind.filter(|&i| of(&rt, i) == [0.0, 1.0, 0.0]);
    assert!(green.count() > 20);
    assert!(hybrid.color == rt.color);
}

#[test]
fn a_mirror_under_the_open_sky_shows_the_sky() {
    let Some(gpu) = gpu() else { return };
    let sky = [
        "instance.1.scale=0.001",
        "environment.color=[0.3, 0.6, 0.9]",
    ];
    for method in ["ssr", "rt", "hybrid"] {
        let set = [sky[0], sky[1], &format!("reflection.method={method}")];
        let picture = render(gpu, MIRROR, &set, &[]);
        // Rays towards the camera's own side cannot be marched: only tracers find the sky.
        if method != "ssr" {
            assert_color(&picture, 2, 2, [0.3, 0.6, 0.9], 1e-3);
        }
    }
}

#[test]
fn a_white_lambert_sphere_vanishes_in_a_furnace() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("closed_form/a_white_lambert_sphere_vanishes_in_a_furnace.toml");
    for set in [&[][..], &["image.samples=3"][..]] {
        let picture = render(gpu, text, set, &[]);
        for y in 0..36 {
            for x in 0..64 {
                assert_color(&picture, x, y, [1.0; 3], 1.0 / 255.0);
            }
        }
    }
}

/// A Lambert floor of albedo 1/2 seen from above.
const FLOOR: &str = include_str!("closed_form/floor.toml");

#[test]
fn a_lambert_floor_gives_albedo_times_irradiance_over_pi() {
    let Some(gpu) = gpu() else { return };
    let cosine = (60.0f32).to_radians().cos();
    for shadow in ["map", "ray", "none"] {
        let sun = format!(
            "{FLOOR}\n[light.sun]\nkind = \"directional\"\ndirection = [0.8660254, -0.5, 0]\n\
             intensity_lux = 3\nshadow = \"{shadow}\"\n"
        );
        let picture = render(gpu, &sun, &[], &[]);
        assert_color(&picture, 16, 16, [0.5 * 3.0 * cosine / PI; 3], 5e-4);

        let lamp = format!(
            "{FLOOR}\n[light.lamp]\nkind = \"point\"\nposition = [0, 2, 0]\n\
             intensity_cd = 10\nshadow = \"{shadow}\"\n"
        );
        let picture = render(gpu, &lamp, &[], &[]);
        assert_color(&picture, 16, 16, [0.5 * 10.0 / 4.0 / PI; 3], 5e-4);

        let spot = format!(
            "{FLOOR}\n[light.spot]\nkind = \"spot\"\nposition = [0, 2, 0]\ndirection = [0, -1, 0]\n\
             outer_deg = 5\ninner_deg = 4\nintensity_cd = 10\nshadow = \"{shadow}\"\n"
        );
        let picture = render(gpu, &spot, &[], &[]);
        assert_color(&picture, 16, 16, [0.5 * 10.0 / 4.0 / PI; 3], 5e-4);
        assert_color(&picture, 0, 0, [0.0; 3], 1e-6);
    }
}

#[test]
fn a_box_between_light_and_floor_darkens_it_by_map_and_by_ray() {
    let Some(gpu) = gpu() else { return };
    let lights = [
        "kind = \"directional\"\ndirection = [0, -1, 0]\nintensity_lux = 3",
        "kind = \"point\"\nposition = [0, 3, 0]\nintensity_cd = 20",
        "kind = \"spot\"\nposition = [0, 3, 0]\ndirection = [0, -1, 0]\nouter_deg = 40\nintensity_cd = 20",
    ];
    let cover = "[model.cover]\nshape = { kind = \"box\", size = [0.5, 0.1, 0.5] }\nmaterial = \"gray\"\n\
                 [[instance]]\nmodel = \"cover\"\ntranslation = [0.35, 1, 0]\n[[instance]]\nmodel = \"floor\"\n";
    for light in lights {
        for shadow in ["map", "ray"] {
            let text = format!("{FLOOR}\n{cover}\n[light.l]\n{light}\nshadow = \"{shadow}\"\n");
            // Seen from below, past the cover: the floor is double sided, so look at its shadow
            // from above at a point that the cover does not hide from the camera.
            let center = |target: &str| {
                let target = format!("camera.main.target=[{target}, 0, 0]");
                let picture = render(gpu, &text, &["camera.main.eye=[-2.5, 3, 0]", &target], &[]);
                crate::kit::color(&picture, 16, 16)
            };
            let [dark, lit] = ["0.35", "-0.8"].map(center);
            let is_right = dark.iter().all(|c| *c < 1e-4) && lit.iter().all(|c| *c > 0.05);
            assert!(
                is_right,
                "{light} {shadow}: {dark:?} in the shadow, {lit:?} in the light"
            );
        }
    }
}

#[test]
fn fading_ends_in_the_environment() {
    let Some(gpu) = gpu() else { return };
    // The lamp is 7 m from the mirror along the ray; with a ray of 14 m half of it is left.
    let set = [
        "camera.main.eye=[0, 0, 2]",
        "reflection.fade=true",
        "reflection.unit_m=1",
        "reflection.ray_length_u=10",
        "reflection.method=rt",
        "environment.color=[1, 0, 0]",
    ];
    let picture = render(gpu, MIRROR, &set, &[]);
    let rest = 1.0 - 5.0 / 10.0;
    let expected = [0.2 * rest + (1.0 - rest), 0.5 * rest, 0.8 * rest];
    assert_color(&picture, 16, 8, expected, 2e-3);
}

/// Tone curves: Khronos PBR Neutral, Hill's ACES, by the rows of its matrices, and the sRGB curve.
#[test]
fn tone_curves_are_those_of_their_papers() {
    let Some(gpu) = gpu() else { return };
    let neutral = |c: Vec3| {
        let least = c.min_element().min(0.08);
        let c = c - (least - 6.25 * least * least);
        let peak = c.max_element();
        if peak < 0.76 {
            return c;
        }
        let compressed = 1.0 - 0.24 * 0.24 / (peak + 0.24 - 0.76);
        let white = 1.0 - 1.0 / (0.15 * (peak - compressed) + 1.0);
        (c * compressed / peak).lerp(Vec3::splat(compressed), white)
    };
    let aces = |c: Vec3| {
        let film = Vec3::new(
            c.dot(Vec3::new(0.59719, 0.35458, 0.04823)),
            c.dot(Vec3::new(0.07600, 0.90834, 0.01566)),
            c.dot(Vec3::new(0.02840, 0.13383, 0.83777)),
        );
        let c = film.map(|v| {
            (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081)
        });
        Vec3::new(
            c.dot(Vec3::new(1.60475, -0.53108, -0.07367)),
            c.dot(Vec3::new(-0.10208, 1.10813, -0.00605)),
            c.dot(Vec3::new(-0.00327, -0.07276, 1.07602)),
        )
    };
    let none = |c: Vec3| c;
    type Curve<'a> = &'a dyn Fn(Vec3) -> Vec3;
    let curves: [(&str, Curve); 3] = [("neutral", &neutral), ("aces", &aces), ("none", &none)];
    for emission in [
        [0.001, 0.002, 0.05],
        [0.3, 0.5, 0.2],
        [0.9, 0.4, 0.1],
        [6.0, 2.0, 0.5],
    ] {
        for (name, curve) in &curves {
            let set = [
                &*format!("material.lamp.emission={emission:?}"),
                &format!("image.tone_map=\"{name}\""),
                "image.exposure_ev=0.5",
                "reflection.method=\"rt\"",
            ];
            let picture = render(gpu, MIRROR, &set, &[]);
            let shown = curve(Vec3::from_array(emission) * 2f32.sqrt());
            let expected = shown.map(|v| 255.0 * srgb_from_linear(v.clamp(0.0, 1.0)));
            let at = 4 * (8 * 33 + 16);
            for (found, expected) in picture.display[at..].iter().zip(expected.to_array()) {
                let off = (f32::from(*found) - expected).abs();
                assert!(
                    off < 1.0,
                    "{name} of {emission:?}: {found}, expected {expected}"
                );
            }
        }
    }
}

/// A mirror floor before an emissive wall: where the march finds the wall, it shows the wall's light.
#[test]
fn what_the_march_finds_has_the_color_that_it_has_on_screen() {
    let Some(gpu) = gpu() else { return };
    let text = MIRROR
        .replace("eye = [0.3, 0.2, 2]", "eye = [0, 1, 4]")
        .replace("target = [0, 0, 0]", "target = [0, 0.6, 0]")
        .replace("size = [33, 17]", "size = [64, 48]")
        .replace("fov_deg = 30", "fov_deg = 50");
    let set = [
        "instance.0.rotation_deg=[0, 0, 0]",
        "instance.1.translation=[0, 0, -1.5]",
        "instance.1.rotation_deg=[90, 0, 0]",
        "environment.color=[0, 0, 0]",
    ];
    for method in ["ssr", "hybrid"] {
        let method = format!("reflection.method={method}");
        let set = [&set[..], &[method.as_str()]].concat();
        let picture = render(gpu, &text, &set, &[Aov::Source]);
        let sources = integers(&picture, Aov::Source);
        let mut found = 0;
        for (i, source) in sources.iter().enumerate() {
            if *source == Source::Screen as u32 {
                let (x, y) = (i as u32 % 64, i as u32 / 64);
                assert_color(&picture, x, y, [0.2, 0.5, 0.8], 2e-3);
                found += 1;
            }
        }
        assert!(found > 200, "{method}: {found} of {}", sources.len());
    }
}
