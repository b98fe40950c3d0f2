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
    // Share of each pixel that white stripes cover; a pixel is 0.8 stripes wide.
    let white = |x: f32| (x / 2.0).floor() + (x % 2.0 - 1.0).max(0.0);
    let covered = |x: u32| (white((x + 1) as f32 * 0.8) - white(x as f32 * 0.8)) / 0.8;
    let boxed = contrast((0..80).map(covered));
    let [one, many] = [1, 16].map(|samples| {
        let samples = format!("image.samples={samples}");
        let (desc, world) = scene_of(&file.with_file_name("test.toml"), STRIPES, &[&samples]);
        let picture = renderer(gpu, &desc, &world, false).first_view(&world, &[]);
        contrast((0..80).map(|x| color(&picture, x, 2)[1])) / boxed
    });
    assert!(many > 0.97 && many < 1.03, "{many}");
    assert!(one < 1.03, "{one}");
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
