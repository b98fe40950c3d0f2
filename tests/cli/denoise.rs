//! `--denoise`, with and without its library.

use reflet::metric::read::read_picture;

use super::*;

const RENDER: &str = "render scene.toml -o a.png --size 96x64 --denoise --aov=normal";

#[test]
fn without_its_library_denoising_says_what_to_install() {
    let folder = folder("denoise-missing");
    let mut command = reflet(&folder, words(RENDER));
    let output = command.env("REFLET_OIDN", "/nowhere").output();
    let output = output.expect("the program starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    for part in ["/nowhere", "REFLET_OIDN", "pip install"] {
        assert!(error.contains(part), "{error}");
    }
    assert_eq!(names(&folder), ["scene.toml"]);
}

/// Folder of the library: `REFLET_OIDN` of the tests, otherwise the folder of `tools/setup.sh`.
fn library() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os("REFLET_OIDN") {
        return Some(folder.into());
    }
    let lib = Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv/lib");
    let pythons = fs::read_dir(lib).ok()?.filter_map(Result::ok);
    let mut folders = pythons.map(|python| python.path().join("site-packages/pyoidn/oidn/lib"));
    folders.find(|folder| folder.is_dir())
}

/// The library, and a folder whose scene goes on with this text; `None` after saying what is missing.
fn prepared(name: &str, more: &str) -> Option<(PathBuf, PathBuf)> {
    let Some(library) = library() else {
        eprintln!(
            "SKIPPED: no Open Image Denoise in REFLET_OIDN or .venv (tools/setup.sh installs it)"
        );
        return None;
    };
    gpu_or_skip()?;
    let folder = folder(name);
    let scene = fs::read_to_string(folder.join("scene.toml")).expect("a scene");
    fs::write(folder.join("scene.toml"), scene + more).expect("a scene");
    Some((library, folder))
}

/// Runs the program with the library, which must succeed.
fn run(library: &Path, folder: &Path, arguments: &[&str]) {
    let output = reflet(folder, arguments)
        .env("REFLET_OIDN", library)
        .output();
    let output = output.expect("the program starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
}

fn luma(picture: &Path) -> image::ImageBuffer<image::Luma<f32>, Vec<f32>> {
    image::open(picture).expect("a picture").to_luma32f()
}

#[test]
fn with_its_library_grain_goes_and_edges_stay() {
    let (library, folder) = or_skip!(prepared(
        "denoise",
        "angle_deg = 40\nshadow = \"ray\"\n[image]\nlight_rays = 1\n",
    ));
    run(&library, &folder, &words(RENDER));
    let read = |name: &str| luma(&folder.join(name));
    let clean = read("a.png");
    assert_eq!(names(&folder), ["a.normal.png", "a.png", "scene.toml"]);
    let plain = RENDER.replace(" --denoise", "");
    let plain = words(&plain);
    exits(&folder, &plain, 0);
    let truth = [&plain[..], &["--samples", "256"]].concat();
    let grainy = read("a.png");
    exits(&folder, &truth, 0);
    let truth = read("a.png");
    let error = |picture: &image::ImageBuffer<image::Luma<f32>, Vec<f32>>| {
        let pairs = picture.pixels().zip(truth.pixels());
        pairs.map(|(a, b)| (a.0[0] - b.0[0]).powi(2)).sum::<f32>()
    };
    assert!(
        error(&clean) < 0.3 * error(&grainy),
        "{} of {}",
        error(&clean),
        error(&grainy)
    );
}

/// Denoising keeps the mean radiance, and edges that many samples smooth stay smooth.
#[test]
fn brightness_and_smooth_edges_stay() {
    let (library, folder) = or_skip!(prepared(
        "denoise-mean",
        "angle_deg = 40\nshadow = \"ray\"\n[image]\nlight_rays = 1\n",
    ));
    let render = |name: &str, further: &[&str]| {
        let fixed = ["render", "scene.toml", "--size", "96x64", "-o", name];
        run(&library, &folder, &[&fixed[..], further].concat());
        let read = read_picture(&folder.join(name)).expect("a picture");
        read.picture.pixels().to_vec()
    };
    let mean = |picture: &[[f32; 3]], channel: usize| -> f64 {
        let sum: f64 = picture.iter().map(|pixel| f64::from(pixel[channel])).sum();
        sum / picture.len() as f64
    };
    let grainy = render("a.exr", &["--samples", "8"]);
    let clean = render("b.exr", &["--samples", "8", "--denoise"]);
    assert_ne!(grainy, clean);
    for channel in 0..3 {
        let change = mean(&clean, channel) / mean(&grainy, channel) - 1.0;
        assert!(change.abs() < 0.0005, "{change}");
    }
    // The picture is made from that radiance, so it is as bright as the truth.
    let shown = render("b.png", &["--samples", "8", "--denoise"]);
    let truth = render("c.png", &["--samples", "128"]);
    for channel in 0..3 {
        let change = mean(&shown, channel) / mean(&truth, channel) - 1.0;
        assert!(change.abs() < 0.004, "{change}");
    }
}

/// A camera that moves past the scene for six frames, under a soft sun.
const MOVING: &str = "angle_deg = 40\nshadow = \"ray\"\n[image]\nlight_rays = 1\n[timeline]\nend = 5\n\
    [motion.camera.main]\neye = { keys = [{ at_s = 0, value = [1.6, 1.4, 2.6] }, { at_s = 0.2, value = [1.9, 1.4, 2.4] }] }\n";

#[test]
fn frames_of_a_film_are_denoised_with_their_neighbors() {
    let (library, folder) = or_skip!(prepared("denoise-film", MOVING));
    let scene = fs::read_to_string(folder.join("scene.toml")).expect("a scene");
    let mirror = "metallic = 1\nroughness = 0\nreflection = \"mirror\"";
    assert!(scene.contains(mirror));
    let scene = scene.replace(mirror, "roughness = 0.9");
    fs::write(folder.join("scene.toml"), scene).expect("a scene");
    let render = |name: &str, further: &[&str]| {
        let output = format!("{name}.#.png");
        let fixed = ["render", "scene.toml", "-o", &output, "--size", "96x64"];
        run(&library, &folder, &[&fixed[..], further].concat());
    };
    let denoised = ["--denoise", "--frames", "all"];
    render("film", &denoised);
    render(
        "alone",
        &[&denoised[..], &["--denoise-window", "0"]].concat(),
    );
    render("truth", &["--samples", "64", "--frames", "all"]);
    // Frames that are rendered apart equal the film's, and no neighbor is taken from across a cut.
    render("part", &["--denoise", "--frames", "3"]);
    render(
        "short",
        &["--denoise", "--frames", "2", "--set", "timeline.end=2"],
    );
    let cut = "timeline.cuts=[{ frame = 3, camera = \"top\" }]";
    render("cut", &["--denoise", "--frames", "2", "--set", cut]);
    let read = |name: &str| fs::read(folder.join(name)).expect("a picture");
    let pixels = |name: &str| luma(&folder.join(name));
    assert_eq!(pixels("film.3.png"), pixels("part.3.png"));
    assert_eq!(pixels("short.2.png"), pixels("cut.2.png"));
    assert_ne!(read("film.2.png"), read("cut.2.png"));
    // Edges, which one sample does not smooth, change with every frame and are left out.
    let flicker = |name: &str| -> f32 {
        let of = |name: &str, frame: u32| pixels(&format!("{name}.{frame}.png")).into_raw();
        let change = |name: &str, frame: u32| -> Vec<f32> {
            let pairs = of(name, frame + 1).into_iter().zip(of(name, frame));
            pairs.map(|(next, this)| next - this).collect()
        };
        let frame = |frame: u32| -> f32 {
            let pairs = change(name, frame).into_iter().zip(change("truth", frame));
            let still = pairs.filter(|(_, true_change)| true_change.abs() < 0.01);
            still
                .map(|(own, true_change)| (own - true_change).abs())
                .sum()
        };
        (0..5).map(frame).sum()
    };
    let (film, alone) = (flicker("film"), flicker("alone"));
    assert!(film < 0.85 * alone, "{film} of {alone}");
}

/// A film of one frame has no neighbors to average: it is the denoised picture of that frame.
#[test]
fn a_film_of_one_frame_is_denoised_as_a_picture() {
    let (library, folder) = or_skip!(prepared(
        "denoise-one",
        "angle_deg = 40\nshadow = \"ray\"\n[timeline]\nend = 0\n",
    ));
    let render = |further: &[&str]| {
        let fixed = ["render", "scene.toml", "--size", "48x32", "--denoise"];
        run(&library, &folder, &[&fixed[..], further].concat());
    };
    // Files differ by the fingerprint that frames of films hold, so values are compared.
    let values = |name: &str| {
        let read = read_picture(&folder.join(name)).expect("a picture");
        read.picture.pixels().to_vec()
    };
    for kind in ["png", "exr"] {
        let (still, film) = (format!("still.{kind}"), format!("film.#.{kind}"));
        render(&["-o", &still]);
        render(&["-o", &film, "--frames", "all"]);
        let frame = film.replace('#', "0");
        assert!(
            values(&still) == values(&frame),
            "{still} and {frame} differ"
        );
    }
}
