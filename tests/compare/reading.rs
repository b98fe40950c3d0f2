//! Picture formats: the same picture in different formats compares equal.

use image::{GrayAlphaImage, GrayImage, ImageBuffer, Luma, LumaA, Rgba, RgbaImage};

use super::*;

const SIZE: (u32, u32) = (24, 18);

fn gray(x: u32, y: u32) -> u8 {
    (x * 9 + y * 2) as u8
}

fn color(x: u32, y: u32) -> [u8; 3] {
    [gray(x, y), (x * y % 256) as u8, (y * 14) as u8]
}

fn rgb(folder: &Folder, name: &str) -> std::path::PathBuf {
    folder.png(
        name,
        RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| Rgb(color(x, y))),
    )
}

fn read(path: &Path) -> Picture {
    read_picture(path).expect("a picture").picture
}

fn notes(path: &Path) -> String {
    read_picture(path).expect("a picture").notes.join("\n")
}

#[test]
fn eight_and_sixteen_bits_agree() {
    let folder = Folder::new();
    let eight = rgb(&folder, "8.png");
    let sixteen: ImageBuffer<Rgb<u16>, Vec<u16>> = ImageBuffer::from_fn(SIZE.0, SIZE.1, |x, y| {
        Rgb(color(x, y).map(|v| u16::from(v) * 257))
    });
    let sixteen = folder.png("16.png", sixteen);
    assert_eq!(read(&eight), read(&sixteen));
    assert!(notes(&sixteen).contains("16 bits"));
    let report = run(&sixteen, &eight, &[]).expect("compares");
    assert!(report.identical && report.notes.iter().any(|n| n.contains("relMSE of PNG")));
}

#[test]
fn sixteen_bits_keep_their_fractions() {
    let folder = Folder::new();
    let make = |name: &str, value: u16| {
        let image = ImageBuffer::<Luma<u16>, Vec<u16>>::from_pixel(12, 12, Luma([value]));
        folder.png(name, image)
    };
    let (a, b) = (make("a.png", 25_700), make("b.png", 25_800));
    let found = run(&a, &b, &[]).expect("compares");
    assert!(!found.identical);
    assert!((found.frame.max_difference - 100.0 / 257.0).abs() < 1e-4);
    assert_eq!(found.frame.flip_mean, 0.0); // 8 bits
    assert!(found.frame.rel_mse > 0.0);
}

#[test]
fn gray_is_three_equal_channels() {
    let folder = Folder::new();
    let plain = folder.png(
        "l.png",
        GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| Luma([gray(x, y)])),
    );
    let alpha = GrayAlphaImage::from_fn(SIZE.0, SIZE.1, |x, y| LumaA([gray(x, y), 255]));
    let alpha = folder.png("la.png", alpha);
    let full = RgbImage::from_fn(SIZE.0, SIZE.1, |x, y| Rgb([gray(x, y); 3]));
    let full = folder.png("rgb.png", full);
    assert_eq!(read(&plain), read(&full));
    assert_eq!(read(&alpha), read(&full));
    assert_eq!(notes(&alpha), "");
}

#[test]
fn alpha_lies_over_black() {
    let folder = Folder::new();
    let rgba = |x, y| {
        let [r, g, b] = color(x, y);
        Rgba([
            r,
            g,
            b,
            if x < 4 {
                0
            } else if x < 9 {
                51
            } else {
                255
            },
        ])
    };
    let path = folder.png("rgba.png", RgbaImage::from_fn(SIZE.0, SIZE.1, rgba));
    let found = read(&path);
    for (i, pixel) in found.pixels().iter().enumerate() {
        let (x, y) = (i as u32 % SIZE.0, i as u32 / SIZE.0);
        let share = if x < 4 {
            0.0
        } else if x < 9 {
            0.2
        } else {
            1.0
        };
        for (found, value) in pixel.iter().zip(color(x, y)) {
            assert!((found - f32::from(value) * share).abs() < 1e-4, "{x}, {y}");
        }
    }
    assert!(
        notes(&path).contains("162 pixels are not opaque"),
        "{}",
        notes(&path)
    );
}

#[test]
fn open_exr_is_linear() {
    let folder = Folder::new();
    let values = |scale: f32| (0..12 * 12).map(|i| i as f32 * scale).collect::<Vec<f32>>();
    let channels = vec![("R", values(0.01)), ("G", values(0.02)), ("B", values(0.0))];
    let path = folder.exr("a.exr", [12, 12], channels);
    let found = read(&path);
    assert_eq!(found.encoding(), Encoding::Linear);
    assert_eq!(found.pixels()[50], [0.5, 1.0, 0.0]);
    // sRGB (IEC 61966-2-1): 0.5 encodes to 0.735357; values over 1 are clamped.
    let shown = found.display();
    assert!((shown[50][0] - 255.0 * 0.735_357).abs() < 1e-2 && shown[50][1] == 255.0);
    assert_eq!(shown[140][0], 255.0);
    assert!(notes(&path).contains("clamped at 1"));
    let report = run(&path, &path, &[]).expect("compares");
    assert!(
        report.identical
            && report
                .notes
                .iter()
                .any(|n| n.contains("exceed display white"))
    );
}

#[test]
fn open_exr_agrees_with_the_png_it_was_made_from() {
    let folder = Folder::new();
    let png = rgb(&folder, "a.png");
    let linear = read(&png).linear();
    let plane = |c: usize| linear.iter().map(|p| p[c]).collect::<Vec<f32>>();
    let channels = vec![
        ("R", plane(0)),
        ("G", plane(1)),
        ("B", plane(2)),
        ("A", plane(0)),
    ];
    let exr = folder.exr("a.exr", [SIZE.0 as usize, SIZE.1 as usize], channels);
    let found = run(&exr, &png, &[]).expect("compares");
    assert!(found.frame.max_difference < 1e-3 && found.frame.rel_mse < 1e-12);
    assert_eq!(found.frame.flip_mean, 0.0);
    assert!(notes(&exr).contains("alpha is left out"));
}

#[test]
fn open_exr_channels_are_found_or_asked_for() {
    let folder = Folder::new();
    let plane = |v: f32| vec![v; 4];
    let make = |name: &str, channels: &[(&str, f32)]| {
        let channels = channels
            .iter()
            .map(|(name, v)| (*name, plane(*v)))
            .collect();
        folder.exr(name, [2, 2], channels)
    };
    let first = |path: &Path| read(path).pixels()[0];
    assert_eq!(first(&make("y.exr", &[("Y", 0.3)])), [0.3; 3]);
    assert_eq!(first(&make("one.exr", &[("reflectance", 0.4)])), [0.4; 3]);
    assert_eq!(
        first(&make(
            "layer.exr",
            &[("l.R", 0.1), ("l.G", 0.2), ("l.B", 0.3)]
        )),
        [0.1, 0.2, 0.3]
    );
    let both = [
        ("R", 0.5),
        ("G", 0.6),
        ("B", 0.7),
        ("n.R", 0.1),
        ("n.G", 0.2),
        ("n.B", 0.3),
    ];
    assert_eq!(first(&make("both.exr", &both)), [0.5, 0.6, 0.7]);
    for channels in [
        &[("U", 0.1), ("V", 0.2)][..],
        &[("R", 0.1), ("G", 0.2)],
        &[("a.Y", 0.1), ("b.Y", 0.2)],
    ] {
        let error = read_picture(&make("unclear.exr", channels)).expect_err("unclear");
        assert_says(&error.message, &["unclear which channels"]);
        assert!(error.message.contains(channels[1].0), "{}", error.message);
    }
    for depth in ["Z", "depth", "layer.ZBack"] {
        let error = read_picture(&make("depth.exr", &[(depth, 0.1)])).expect_err("no light");
        assert!(error.message.contains(depth), "{}", error.message);
    }
}

#[test]
fn a_mask_is_reflectance_or_gray_and_never_colors() {
    let folder = Folder::new();
    let [width, height] = [32, 24];
    let plane = |v: f32| vec![v; width * height];
    let colors = [("R", 0.9), ("G", 0.8), ("B", 0.7)].map(|(name, v)| (name, plane(v)));
    let columns = |i: usize| if i % width < 16 { 0.5 } else { 0.0 };
    let weights: Vec<f32> = (0..width * height).map(columns).collect();
    let beauty = folder.exr("beauty.exr", [width, height], colors.to_vec());
    let mut layers = colors.to_vec();
    layers.push(("reflectance.Y", weights.clone()));
    layers.push(("depth.Z", plane(9.0)));
    let layered = folder.exr("layered.exr", [width, height], layers);
    let gray = folder.exr("gray.exr", [width, height], vec![("Y", weights)]);
    let bytes = GrayImage::from_fn(32, 24, |x, _| Luma([if x < 16 { 128 } else { 0 }]));
    let png = folder.png("gray.png", bytes);
    for (mask, says) in [
        (&layered, "its channel reflectance.Y,"),
        (&gray, "its channel Y,"),
        (&png, "its gray values"),
    ] {
        let mask = mask.to_str().expect("Unicode");
        let found = run(&beauty, &beauty, &["--mask", mask]).expect("compares");
        assert_eq!(found.mask.as_ref().expect("a mask").area_px, 6 * 14);
        let note = found.notes.iter().find(|note| note.contains(mask));
        assert!(note.expect("a note").contains(says), "{note:?}");
    }
    let color = folder.png(
        "color.png",
        RgbImage::from_fn(32, 24, |x, y| Rgb(color(x, y))),
    );
    for mask in [&beauty, &color] {
        let (name, file, message) = fails(
            &beauty,
            &beauty,
            &["--mask", mask.to_str().expect("Unicode")],
        );
        assert_eq!((name, &file), ("colored-mask", mask));
        assert!(message.contains("which are gray"), "{message}");
    }
}

#[test]
fn format_is_detected_by_content() {
    let folder = Folder::new();
    let png = rgb(&folder, "a.png");
    let renamed = folder.path("a.exr");
    std::fs::copy(&png, &renamed).expect("a copy");
    assert_eq!(read(&png), read(&renamed));
}
