//! Light and rays over short and long distances: lamps close to surfaces, and scenes of all sizes.

use super::kit::*;

/// A white floor without a specular lobe below a lamp at the height `AT`, seen from the side.
const LAMP: &str = include_str!("near/lamp.toml");

#[test]
fn lamps_close_to_a_surface_light_it_as_the_inverse_square() {
    let Some(gpu) = gpu() else { return };
    for shadow in ["map", "ray", "none"] {
        for height in [0.1_f32, 0.02, 0.005, 0.001] {
            // Intensities that make the middle of the floor equally bright.
            let lamp = format!(
                "[light.lamp]\nkind = \"point\"\nposition = [0, {height}, 0]\nshadow = \"{shadow}\"\n\
                 intensity_cd = {}\n",
                std::f32::consts::PI * height * height
            );
            let picture = render(gpu, &[LAMP, &lamp].concat(), &[], &[]);
            assert_close(color(&picture, 4, 4)[0], 0.8, 0.01);
        }
    }
}

#[test]
fn things_close_to_a_lamp_shade_in_a_large_world() {
    let Some(gpu) = gpu() else { return };
    let picture = render(gpu, include_str!("near/large.toml"), &[], &[]);
    assert_close(color(&picture, 4, 4)[0], 0.0, 0.01);
}

/// A scene with all lengths, written `<LENGTH>`, and intensities, `<<INTENSITY>>`: glass, curved mirrors, lamps with
/// and without a size, and shadows by maps and by rays.
const STAGE: &str = include_str!("near/stage.toml");
const GLASS: &str = include_str!("near/glass.toml");

/// The text with all its lengths times `scale`, and its intensities times the square of that.
fn scaled(text: &str, scale: f64) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('<') {
        out.push_str(before);
        let is_intensity = after.starts_with('<');
        let (number, end) =
            (after.trim_start_matches('<').split_once('>')).expect("a closed length");
        let factor = if is_intensity { scale * scale } else { scale };
        let number: f64 = number.parse().expect("a number");
        out.push_str(&format!("{:e}", number * factor));
        rest = if is_intensity { &end[1..] } else { end };
    }
    out + rest
}

/// The 99th percentile of the difference of display colors, 0 to 1.
fn p99(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.display.chunks_exact(4).zip(b.display.chunks_exact(4));
    let most = pairs.map(|(a, b)| (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap_or(0));
    let mut differences: Vec<u8> = most.collect();
    differences.sort_unstable();
    f32::from(differences[differences.len() * 99 / 100]) / 255.0
}

#[test]
fn scenes_of_all_sizes_give_the_same_picture() {
    check_scales("", "hybrid", "raster", &[1e-6, 0.1, 1e6]);
    if is_long() {
        check_scales("", "rt", "rays", &[1e-6]);
        check_scales(GLASS, "hybrid", "raster", &[1e-6]);
    }
}

/// Compares the stage with more things at these scales with itself at 1.
fn check_scales(more: &str, method: &str, visibility: &str, scales: &[f64]) {
    let Some(gpu) = gpu() else { return };
    let of = |scale: f64| {
        let set = [
            &*format!("reflection.method={method}"),
            &format!("image.visibility={visibility}"),
        ];
        let text = scaled(&STAGE.replace("MORE", more), scale);
        render(gpu, &text, &set, &[])
    };
    let truth = of(1.0);
    for scale in scales {
        let error = p99(&of(*scale), &truth);
        assert!(error <= 0.03, "{method}, {scale:e}: p99 {error}");
    }
}

#[test]
fn the_unit_counts_what_moves_where_the_rest_is_small() {
    let of = |still: f32| {
        let text = format!(
            "version = 1\n[timeline]\nfps = 24\nend = 2\n[model.ball]\n\
             shape = {{ kind = \"box\", size = [{still}, {still}, {still}] }}\n[model.room]\n\
             shape = {{ kind = \"box\", size = [8, 8, 8] }}\n[[instance]]\nmodel = \"ball\"\n[[instance]]\nname = \"room\"\n\
             model = \"room\"\n[motion.instance.room]\ntranslation = {{ keys = [{{ at_s = 0, value = [0, 0, 0] }}, {{ at_s = 2, value = [1, 0, 0] }}] }}\n"
        );
        scene(&text, &[]).1.unit_m()
    };
    let diagonal = 3f32.sqrt() / 16.0;
    assert_close(of(0.1), 8.0 * diagonal, 1e-4);
    assert_close(of(4.0), 4.0 * diagonal, 1e-4);
}
