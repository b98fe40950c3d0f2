//! Outputs and thresholds of `compare`.

use reflet::{
    files::{Goal, write_whole},
    metric::{difference::difference_picture, picture::Pair},
};

use super::*;

/// A picture, and a copy with a square that is 3 levels brighter.
fn pair(folder: &Folder) -> [PathBuf; 2] {
    let base = |x: u32, y: u32| [(x * 3) as u8, (y * 4) as u8, 90];
    let a = folder.png("a.png", RgbImage::from_fn(48, 40, |x, y| Rgb(base(x, y))));
    let b = folder.png(
        "b.png",
        RgbImage::from_fn(48, 40, |x, y| {
            let inside = (10..40).contains(&x) && (8..34).contains(&y);
            Rgb(base(x, y).map(|v| v + if inside { 3 } else { 0 }))
        }),
    );
    [a, b]
}

fn text(path: &std::path::Path) -> &str {
    path.to_str().expect("Unicode")
}

#[test]
fn pictures_of_the_error_are_written_whole() {
    let folder = Folder::new();
    let [a, b] = pair(&folder);
    let (difference, heat) = (folder.path("difference.png"), folder.path("heat.png"));
    let options = ["--difference", text(&difference), "--flip-map", text(&heat)];
    let found = run(&b, &a, &options).expect("compares");
    assert_eq!(found.difference_gain, Some(64)); // 3 × 64 = 192
    let difference = image::open(&difference).expect("a PNG").into_rgb8();
    assert_eq!(difference.dimensions(), (48, 40));
    assert_eq!(difference.get_pixel(20, 20).0, [192; 3]);
    assert_eq!(difference.get_pixel(9, 20).0, [0; 3]);
    let heat = image::open(&heat).expect("a PNG").into_rgb8();
    let brightness = |x, y| {
        heat.get_pixel(x, y)
            .0
            .iter()
            .map(|v| u32::from(*v))
            .sum::<u32>()
    };
    assert!(brightness(20, 20) > brightness(0, 0));
    assert_eq!(
        folder.names(),
        ["a.png", "b.png", "difference.png", "heat.png"]
    );
    let found = run(&a, &a, &options).expect("compares");
    assert_eq!(found.difference_gain, Some(2));
}

#[test]
fn the_difference_of_large_errors_is_not_clipped_away() {
    let folder = Folder::new();
    let a = folder.png("a.png", RgbImage::from_pixel(20, 20, Rgb([40; 3])));
    let b = folder.png("b.png", RgbImage::from_pixel(20, 20, Rgb([71; 3])));
    let out = folder.path("d.png");
    let found = run(&a, &b, &["--difference", text(&out)]).expect("compares");
    assert_eq!(found.difference_gain, Some(8)); // 31 × 8 = 248
    assert_eq!(
        image::open(&out)
            .expect("a PNG")
            .into_rgb8()
            .get_pixel(3, 3)
            .0,
        [248; 3]
    );
}

#[test]
fn the_gain_is_a_power_of_two_for_all_but_one_channel_in_a_hundred() {
    let gain = |difference: f32, outliers: usize| {
        let reference = vec![[10.0; 3]; 400];
        let mut test = vec![[10.0 + difference; 3]; 400];
        test[..outliers].fill([255.0; 3]);
        let picture = |p| Picture::new(20, 20, Encoding::Display, p).expect("a picture");
        let [test, reference] = [test, reference].map(picture);
        let (gain, rgb) = difference_picture(&Pair::new(&test, &reference).expect("one size"));
        (gain, rgb[rgb.len() - 1])
    };
    assert_eq!(gain(0.1, 0), (64, 6)); // 6.4
    assert_eq!(gain(0.15, 0), (64, 10)); // 9.6
    assert_eq!(gain(1.0, 0), (64, 64));
    assert_eq!(gain(4.0, 0), (32, 128)); // 4 × 64 would be 256
    assert_eq!(gain(100.0, 0), (2, 200));
    assert_eq!(gain(4.0, 3), (32, 128)); // three of 400 pixels may clip
    assert_eq!(gain(4.0, 4), (2, 8));
}

#[test]
fn invalid_outputs_leave_no_file() {
    let folder = Folder::new();
    let [a, b] = pair(&folder);
    let before = folder.names();
    let missing = folder.path("no/such/folder.png");
    assert_eq!(
        fails(&a, &b, &["--difference", text(&missing)]).0,
        "unwritable-picture"
    );
    let cases = [
        (vec!["--difference", text(&a)], "would replace"),
        (vec!["--flip-map", text(&b)], "would replace"),
        (
            vec!["--mask", text(&a), "--flip-map", text(&a)],
            "would replace",
        ),
        (vec!["--difference", "x.jpg"], "written as PNG"),
        (
            vec!["--difference", "x.png", "--flip-map", "x.png"],
            "both pictures",
        ),
        (
            vec!["--difference", "x.png", "--flip-map", "./x.png"],
            "both pictures",
        ),
        (
            vec!["--difference", "x.png", "--flip-map", "src/../x.png"],
            "both pictures",
        ),
    ];
    for (options, expected) in cases {
        let (name, _, message) = fails(&a, &b, &options);
        assert_eq!(name, "bad-output");
        assert!(message.contains(expected), "{message}");
    }
    // If one output is not writable, none is written.
    let ok = folder.path("ok.png");
    for [good, bad] in [
        ["--difference", "--flip-map"],
        ["--flip-map", "--difference"],
    ] {
        let both = [good, text(&ok), bad, text(&missing)];
        assert_eq!(fails(&a, &b, &both).0, "unwritable-picture");
    }
    // A folder with the name of the output file.
    fs::create_dir(folder.path("taken.png")).expect("a folder");
    let taken = folder.path("taken.png");
    assert_eq!(
        fails(&a, &b, &["--flip-map", text(&taken)]).0,
        "unwritable-picture"
    );
    fs::remove_dir(taken).expect("still empty");
    assert_eq!(folder.names(), before);
}

#[test]
fn existing_file_stays_until_the_new_one_is_complete() {
    let folder = Folder::new();
    let path = folder.write("file", b"old");
    write_whole(&Goal::typed(path.clone()), b"new and longer").expect("written");
    assert_eq!(fs::read(&path).expect("the file"), b"new and longer");
    assert!(write_whole(&Goal::typed(folder.path("..")), b"x").is_err());
    assert_eq!(folder.names(), ["file"]);
}

#[test]
fn thresholds_hold_for_frame_and_mask() {
    let folder = Folder::new();
    let [a, b] = pair(&folder);
    let mask = RgbImage::from_fn(48, 40, |x, y| {
        let inside = (8..42).contains(&x) && (6..36).contains(&y);
        Rgb([if inside { 60 } else { 0 }; 3])
    });
    let mask = folder.png("m.png", mask);
    let score = run(&b, &a, &["--mask", text(&mask)]).expect("compares");
    let reflet::metric::comparison::MaskScores::Scored(inside) =
        &score.mask.as_ref().expect("a mask").scores
    else {
        panic!("not scored")
    };
    assert_eq!(inside.area_px, 24 * 20);
    let between = |a: f64, b: f64| ((a + b) / 2.0).to_string();
    let flip = between(score.frame.flip_mean, inside.flip_mean);
    let without = run(&b, &a, &["--max-flip", &flip]).expect("compares");
    assert!(without.passed());
    let with = run(&b, &a, &["--max-flip", &flip, "--mask", text(&mask)]).expect("compares");
    assert_eq!(with.crossed.len(), 1);
    assert_says(&with.crossed[0], &["inside the mask"]);
    assert!(
        with.to_string()
            .contains("FAILED: mean FLIP inside the mask")
    );
    // A value equal to the limit does not exceed it.
    let exact = score.frame.flip_mean.to_string();
    assert!(
        run(&b, &a, &["--max-flip", &exact])
            .expect("compares")
            .passed()
    );
    let exact = score.frame.ssim.expect("scored").to_string();
    assert!(
        run(&b, &a, &["--min-ssim", &exact])
            .expect("compares")
            .passed()
    );
    assert!(
        !run(&b, &a, &["--min-ssim", "1"])
            .expect("compares")
            .passed()
    );
}

#[test]
fn table_and_json_have_equal_values() {
    let folder = Folder::new();
    let [a, b] = pair(&folder);
    let found = run(&b, &a, &[]).expect("compares");
    let json: serde_json::Value = serde_json::from_str(&found.to_json()).expect("JSON");
    let [written, exact] = [json["frame"]["ssim"].as_f64(), found.frame.ssim];
    assert!((written.expect("a number") - exact.expect("scored")).abs() < 1e-12);
    assert_eq!(json["frame"]["max_difference"], 3.0);
    assert_eq!(json["width"], 48);
    assert_eq!(json["mask"], serde_json::Value::Null);
    let table = found.to_string();
    for part in [
        "SSIM",
        "FLIP p99",
        "PSNR, dB",
        "relMSE",
        "48 × 40 px",
        "1920",
        "3.00",
    ] {
        assert!(table.contains(part), "{part} is missing:\n{table}");
    }
    let same = run(&a, &a, &[]).expect("compares");
    let json: serde_json::Value = serde_json::from_str(&same.to_json()).expect("JSON");
    assert_eq!(
        (&json["identical"], &json["frame"]["psnr_db"]),
        (&true.into(), &serde_json::Value::Null)
    );
    assert!(same.to_string().contains("equal in every pixel"));
}
