//! Textures and normal maps in pixels that hold many texels.

use super::kit::*;

/// A sheet of 64 stripes, each of 32 texels, in 80 pixels.
const STRIPES: &str = include_str!("footprints/stripes.toml");
/// Two floors of steep bumps, one smoother and one rougher than traced reflections.
const FLOORS: &str = include_str!("footprints/floors.toml");

/// Mean distance from the middle value.
fn contrast(values: impl Iterator<Item = f32>) -> f32 {
    values.map(|value| (value - 0.5).abs()).sum()
}

#[test]
fn many_samples_show_stripes_as_a_box_filter_does() {
    let Some(gpu) = gpu() else { return };
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stripes.png");
    let stripes =
        image::GrayImage::from_fn(2048, 4, |x, _| image::Luma([255 * (x / 32 % 2) as u8]));
    stripes.save(&file).expect("a PNG");
    // Scale of the texture, samples, and the least contrast beside a box filter; stripes of pixels that see many rows of the
    // texture keep the contrast that they have where a pixel sees few.
    let cases = [
        ([1.0, 1.0], 1, 0.9),
        ([1.0, 1.0], 16, 0.97),
        ([0.5, 8.0], 1, 0.9),
        ([0.5, 32.0], 16, 0.97),
        ([0.01, 10.0], 16, 0.9),
    ];
    for (scale, samples, least) in cases {
        let wide = 0.8 * scale[0]; // stripes in a pixel
        let white = |x: f32| (x / 2.0).floor() + (x % 2.0 - 1.0).max(0.0);
        let covered = |x: u32| (white((x + 1) as f32 * wide) - white(x as f32 * wide)) / wide;
        let set = [
            format!("image.samples={samples}"),
            format!("material.stripes.uv_scale={scale:?}"),
        ];
        let (desc, world) = scene_of(
            &file.with_file_name("test.toml"),
            STRIPES,
            &set.each_ref().map(String::as_str),
        );
        let picture = renderer(gpu, &desc, &world, false).first_view(&world, &[]);
        let found =
            contrast((0..80).map(|x| color(&picture, x, 2)[1])) / contrast((0..80).map(covered));
        assert!(
            (least..1.03).contains(&found),
            "{scale:?}, {samples} samples: {found}"
        );
    }
}

#[test]
fn floors_of_averaged_bumps_shine_alike_by_all_methods() {
    let Some(gpu) = gpu() else { return };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fail/floors.toml");
    // Left and right, in the glitter of the sun.
    let [traced, path] = ["rt", "path"].map(|method| {
        let (desc, world) = scene_of(&file, FLOORS, &[&format!("reflection.method={method}")]);
        let picture = renderer(gpu, &desc, &world, false).first_view(&world, &[]);
        [14..19, 21..26].map(|x| x.map(|x| color(&picture, x, 8)[1]).sum::<f32>() / 5.0)
    });
    assert_close(traced[0], path[0], 0.02);
    assert_close(traced[1], path[1], 0.02);
    assert_close(traced[0], traced[1], 0.2);
}
