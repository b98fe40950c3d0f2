//! Depth of field: blurred and sharp distances of a lens.

use super::kit::*;

/// A glowing disk of 10 cm radius on a dark world, 4 m before a camera whose lens has a radius of 0.1 m.
const DISK: &str = include_str!("lens/disk.toml");

/// Light of the disk, and root mean square of its distance from the middle, pixels.
fn light_and_spread(set: &[&str]) -> Option<(f32, f32)> {
    let picture = render(gpu()?, DISK, set, &[]);
    let (mut sum, mut square) = (0.0, 0.0);
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        let light = color(&picture, x, y)[0];
        let [x, y] = [x, y].map(|i| i as f32 + 0.5 - 32.0);
        sum += light;
        square += light * (x * x + y * y);
    }
    Some((sum, (square / sum).sqrt()))
}

#[test]
fn a_lens_spreads_what_is_out_of_focus_over_its_circle_of_confusion() {
    // A focal length of 24 mm; half the picture is as wide as half the distance.
    let lens_m = 0.5 * 0.024 / 0.12;
    let pixel_m = 4.0 / 64.0;
    let (sharp, at_focus) = or_skip!(light_and_spread(&[]));
    assert_close(sharp * pixel_m * pixel_m, PI * 0.1 * 0.1, 0.05);
    assert_close(at_focus, 0.1 / pixel_m / 2.0_f32.sqrt(), 0.1);
    for focus_m in [1.0_f32, 2.0] {
        let focus = format!("camera.main.focus_m={focus_m}");
        let (light, spread) = or_skip!(light_and_spread(&[&focus]));
        // Cone of the lens, cut 4 m away; a disk spreads by its radius over √2.
        let circle_px = lens_m * (4.0 - focus_m) / focus_m / pixel_m;
        assert_close(light, sharp, 0.05);
        let expected = (circle_px * circle_px / 2.0 + at_focus * at_focus).sqrt();
        assert_close(spread, expected, 0.05);
    }
}

#[test]
fn one_sub_frame_looks_through_the_middle_of_the_lens_wherever_it_is_shifted() {
    let Some(gpu) = gpu() else { return };
    let one = ["image.samples=1", "camera.main.focus_m=2"];
    let through_lens = render(gpu, DISK, &one, &[]);
    let pinhole = DISK.replace("aperture_f = 0.12\n", "");
    let (samples, shift) = ("image.samples=4", "camera.main.lens_shift=[0.25, 0.125]");
    assert!(through_lens.color == render(gpu, &pinhole, &one, &[]).color);
    for kind in ["", "camera.main.orthographic_height_m=4"] {
        let sets: Vec<_> = [samples, kind]
            .into_iter()
            .filter(|set| !set.is_empty())
            .collect();
        let middle = render(gpu, &pinhole, &sets, &[]);
        let shifted = render(gpu, &pinhole, &[&sets[..], &[shift]].concat(), &[]);
        assert!(mean(&middle)[0] > 0.0);
        for (x, y) in (0..48).flat_map(|y| (0..48).map(move |x| (x, y))) {
            assert_eq!(
                color(&shifted, x, y + 8),
                color(&middle, x + 16, y),
                "{x}, {y}"
            );
        }
    }
}

#[test]
fn hybrid_looks_through_the_same_lens_as_rt() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("../../scenes/mirrors.toml");
    let through = |method: &str| {
        let method = format!("reflection.method=\"{method}\"");
        let lens = "camera.main.aperture_f=0.12";
        let shift = "camera.main.lens_shift=[0.1, -0.2]";
        let sets = [
            "image.size=[64, 36]",
            "image.samples=8",
            lens,
            shift,
            &method,
        ];
        render(gpu, text, &sets, &[])
    };
    let [rt, hybrid] = ["rt", "hybrid"].map(through);
    let apart: f32 = (rt.color.iter().zip(&hybrid.color))
        .map(|(a, b)| (a - b).abs())
        .sum();
    let mean = apart / rt.color.len() as f32;
    assert!(mean < 0.003, "{mean}");
    let screen = (hybrid.stats.shares.sources.iter()).find(|share| share.name == "screen");
    assert!(
        screen.is_some_and(|share| share.percent > 1.0),
        "{screen:?}"
    );
}

#[test]
fn clip_planes_in_the_space_of_a_parent_cut_the_view() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("lens/cut.toml");
    let flat = text.replace("-2]", "-2.2]");
    let cut_box = "[[1, 0, 0, 0.25], [-1, 0, 0, 1], [0, -1, 0, 0.1], [0, 1, 0, 0.75]]";
    let [large, small] =
        ["[4, 4, 4]", "[1.7, 4, 2.5]"].map(|size| format!("{{ kind = \"box\", size = {size} }}"));
    let ball = r#"{ kind = "sphere", radius = 1 }"#;
    // A ball without the part nearest to the camera shows its inside, through a round hole.
    let hole = r#"{ kind = "disk", radius = 0.9798, segments = 1024 }"#;
    let pairs = [
        (text, &*large, cut_box, &*small),
        (&flat, ball, "[[0, 0, -1, -1.6]]", hole),
    ];
    for (whole, shape, planes, expected) in pairs {
        for view in ["fov_deg=60", "orthographic_height_m=4.17", "aperture_f=0.5"] {
            for visibility in ["raster", "rays"] {
                let sets = [
                    format!("image.visibility=\"{visibility}\""),
                    format!("camera.main.{view}"),
                ];
                let shown = |text: &str, shape: &str, planes: &str| {
                    let shape = format!("model.thing.shape={shape}");
                    let planes = format!("camera.main.clip_planes={planes}");
                    let sets = [&sets[0], &sets[1], &shape, &planes].map(String::as_str);
                    mean(&render(gpu, text, &sets, &[]))[0]
                };
                let [cut, smaller] = [shown(text, shape, planes), shown(whole, expected, "[]")];
                assert!(smaller > 0.03, "{smaller}");
                assert_close(cut, smaller, 0.01);
            }
        }
    }
}

#[test]
fn mirrors_show_what_clip_planes_cut_off_the_view() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("lens/cut_mirror.toml");
    let light = |method: &str| {
        let method = format!("reflection.method=\"{method}\"");
        mean(&render(gpu, text, &[&method], &[]))[0]
    };
    let [rt, hybrid] = ["rt", "hybrid"].map(light);
    assert!(rt > 0.05 && rt < 0.2, "{rt}");
    assert_close(hybrid, rt, 0.01);
}
