//! `sheet`: pictures of cameras, variants and frames on one page.

use super::*;

#[test]
fn a_sheet_has_the_pictures_that_render_writes() {
    or_skip!(gpu_or_skip());
    let folder = folder("sheet");
    let more = "[variant.dark]\nlight.sun.intensity_lux = 0.5\n[timeline]\nend = 1\n";
    fs::write(folder.join("scene.toml"), format!("{SCENE}{more}")).expect("written");
    let settings = ["--size", "16x9"];
    let all = words("sheet scene.toml -o all.png --variants all --camera all");
    let [_, said] = exits(&folder, [&all[..], &settings].concat(), 0);
    for label in [
        "1 of 4: plain / main",
        "2 of 4: plain / top",
        "4 of 4: dark / top",
    ] {
        assert!(said.contains(label), "{said}");
    }
    let sheet = image::open(folder.join("all.png"))
        .expect("a PNG")
        .to_rgba8();
    assert_eq!(sheet.dimensions(), (8 + 2 * 24, 8 + 2 * 40));
    let one = words("render scene.toml -o one.png --camera top --variant dark");
    exits(&folder, [&one[..], &settings].concat(), 0);
    let one = image::open(folder.join("one.png"))
        .expect("a PNG")
        .to_rgba8();
    let cell = image::imageops::crop_imm(&sheet, 8 + 24, 8 + 40, 16, 9).to_image();
    assert!(
        cell.as_raw() == one.as_raw(),
        "the last picture is that of render"
    );
    let frames = ["sheet", "scene.toml", "-o", "frames.png", "--frames", "all"];
    let [_, said] = exits(&folder, [&frames[..], &settings].concat(), 0);
    assert!(said.contains("2 of 2: frame 1"), "{said}");
    assert_eq!(
        names(&folder),
        ["all.png", "frames.png", "one.png", "scene.toml"]
    );
}
