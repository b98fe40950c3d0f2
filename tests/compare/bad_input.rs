//! Bad files and options of `compare`: an error that names the file, never a score, never a panic.

use super::files::parses;
use super::*;

fn good(folder: &Folder, name: &str) -> std::path::PathBuf {
    folder.png(
        name,
        RgbImage::from_fn(20, 16, |x, y| Rgb([x as u8 * 12, y as u8 * 15, 80])),
    )
}

fn good_exr(folder: &Folder, name: &str) -> std::path::PathBuf {
    let plane: Vec<f32> = (0..320).map(|i| (i % 37) as f32 / 30.0).collect();
    folder.exr(
        name,
        [20, 16],
        ["R", "G", "B"].map(|c| (c, plane.clone())).to_vec(),
    )
}

#[test]
fn refuses_files_that_are_not_pictures() {
    let folder = Folder::new();
    let a = good(&folder, "a.png");
    fs::create_dir(folder.path("folder")).expect("a folder");
    let cases = [
        (folder.path("missing.png"), "cannot be read"),
        (folder.path("folder"), "not a regular file"),
        (folder.write("empty.png", b""), "the file is empty"),
        (
            folder.write("text.png", b"not a picture"),
            "neither a PNG nor an OpenEXR",
        ),
        (
            folder.write("jpeg.png", b"\xff\xd8\xff\xe0"),
            "neither a PNG nor an OpenEXR",
        ),
    ];
    for (bad, expected) in cases {
        let (name, file, message) = fails(&bad, &a, &[]);
        assert_eq!((name, &file), ("unreadable-picture", &bad));
        assert!(message.contains(expected), "{message}");
        assert_eq!(fails(&a, &bad, &[]).1, bad);
        let mask = bad.to_str().expect("Unicode");
        assert_eq!(fails(&a, &a, &["--mask", mask]).1, bad);
    }
}

#[test]
fn sizes_must_agree() {
    let folder = Folder::new();
    let a = good(&folder, "a.png");
    let b = folder.png("b.png", RgbImage::new(16, 20));
    let (name, file, message) = fails(&b, &a, &[]);
    assert_eq!((name, &file), ("different-sizes", &b));
    assert!(message.contains("16 × 20 against 20 × 16"), "{message}");
    let mask = b.to_str().expect("Unicode");
    assert_eq!(fails(&a, &a, &["--mask", mask]).0, "different-sizes");
}

#[test]
fn pixels_must_be_light() {
    let folder = Folder::new();
    for (bad, text) in [(f32::NAN, "NaN"), (f32::INFINITY, "inf"), (-0.5, "-0.5")] {
        let mut plane = vec![0.5; 12];
        plane[6] = bad;
        let path = folder.exr("bad.exr", [4, 3], vec![("Y", plane)]);
        let (name, file, message) = fails(&path, &path, &[]);
        assert_eq!((name, &file), ("bad-pixels", &path));
        assert_says(&message, &["column 2, row 1", text]);
    }
}

#[test]
fn a_cropped_data_window_is_refused() {
    use exr::prelude::*;
    let folder = Folder::new();
    let path = folder.path("cropped.exr");
    let channels = SpecificChannels::rgb(|_| (0.5_f32, 0.5_f32, 0.5_f32));
    let attributes = LayerAttributes::default().with_position(Vec2(2, 1));
    let layer = Layer::new((4, 3), attributes, Encoding::FAST_LOSSLESS, channels);
    let whole = ImageAttributes::new(IntegerBounds::from_dimensions((8, 8)));
    Image::new(whole, layer)
        .write()
        .to_file(&path)
        .expect("a file");
    assert!(fails(&path, &path, &[]).2.contains("data window"));
}

/// Counts errors and decoded pictures for every prefix and for many changed bytes.
fn damage(path: &Path, folder: &Folder, changes: usize) -> [usize; 2] {
    let whole = fs::read(path).expect("the file");
    let damaged = folder.path("damaged");
    let mut outcomes = [0, 0];
    let mut check = |bytes: &[u8]| {
        fs::write(&damaged, bytes).expect("a file");
        let result = read_picture(&damaged);
        if let Err(error) = &result {
            assert_eq!(error.file.as_deref(), Some(damaged.as_path()));
            assert!(error.help.is_some());
        }
        outcomes[usize::from(result.is_err())] += 1;
        result.is_err()
    };
    for length in (0..whole.len() - 12).step_by(7) {
        assert!(
            check(&whole[..length]),
            "the first {length} bytes alone were taken"
        );
    }
    let mut random = crate::common::Random(0x9E37_79B9_7F4A_7C15);
    for _ in 0..changes {
        let mut bytes = whole.clone();
        for _ in 0..3 {
            let at = random.below(bytes.len());
            bytes[at] = random.below(256) as u8;
        }
        check(&bytes);
    }
    outcomes
}

#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new();
    let changes = if crate::common::is_long() { 1000 } else { 300 };
    let png = damage(&good(&folder, "a.png"), &folder, changes);
    let exr = damage(&good_exr(&folder, "a.exr"), &folder, changes);
    println!("[read, refused]: PNG {png:?}, OpenEXR {exr:?}");
    assert!(2 * png[1] > changes && 10 * exr[1] > changes);
}

#[test]
fn a_header_cannot_ask_for_the_memory() {
    let folder = Folder::new();
    let mut bytes = fs::read(good(&folder, "a.png")).expect("the file");
    bytes[16..24].copy_from_slice(&[0, 0, 0xff, 0xff, 0, 0, 0xff, 0xff]); // IHDR: 65535 × 65535
    let crc = png_crc(&bytes[12..29]);
    bytes[29..33].copy_from_slice(&crc.to_be_bytes());
    let path = folder.write("bomb.png", &bytes);
    let (name, _, message) = fails(&path, &path, &[]);
    assert_eq!(name, "unreadable-picture");
    assert!(message.contains("asks for more than"), "{message}");
}

/// CRC-32 of a PNG chunk (PNG specification, annex D).
fn png_crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            if c & 1 == 1 {
                0xEDB8_8320 ^ (c >> 1)
            } else {
                c >> 1
            }
        })
    })
}

#[test]
fn thresholds_are_numbers_from_0_to_1() {
    for option in ["--max-flip", "--min-ssim"] {
        for bad in ["nan", "inf", "-0.1", "1.5", "much", ""] {
            assert!(!parses(&[&format!("{option}={bad}")]), "{option} {bad}");
        }
        for good in ["0", "1", "0.98"] {
            assert!(parses(&[option, good]), "{option} {good}");
        }
    }
}

#[test]
fn small_masks_and_frames_are_not_scored() {
    let folder = Folder::new();
    let a = good(&folder, "a.png");
    for (name, weight) in [("empty.png", 0), ("full.png", 255)] {
        let mask = folder.png(name, RgbImage::from_pixel(20, 16, Rgb([weight; 3])));
        let mask = mask.to_str().expect("Unicode");
        // Erosion leaves 10 × 6 pixels of the full mask.
        let area = if weight == 0 { 0 } else { 60 };
        let found = run(&a, &a, &["--mask", mask]).expect("compares");
        assert!(found.passed());
        let json = found.to_json();
        assert_says(
            &json,
            &[&format!("{area} px are left of the mask, under 100")],
        );
        assert!(!json.contains("scored"), "{json}");
        assert!(found.to_string().contains("too small"));
        // A threshold fails for a region without valid pixels.
        let gated = run(
            &a,
            &a,
            &["--mask", mask, "--max-flip", "1", "--min-ssim", "0"],
        );
        assert_eq!(gated.expect("compares").crossed.len(), 2);
    }
    let tiny = folder.png("tiny.png", RgbImage::new(10, 30));
    let found = run(&tiny, &tiny, &[]).expect("compares");
    assert_eq!(found.frame.ssim, None);
    assert!(found.to_string().contains("needs 11 × 11 px"));
    assert!(
        !run(&tiny, &tiny, &["--min-ssim", "0"])
            .expect("compares")
            .passed()
    );
}
