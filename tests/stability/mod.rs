//! `bench stability`: the ratchet over the failure modes, scenes of one's own, and bad input.

use std::{
    fs,
    path::{Path, PathBuf},
};

use crate::common::{
    assert_says,
    folder::kept_folder,
    gpu_or_skip, is_long,
    program::{reflet, texts},
};
use reflet::gpu::ShaderLibrary;

/// A floor that reflects a ball which moves for three frames.
const SCENE: &str = include_str!("scene.toml");

fn folder(name: &str) -> PathBuf {
    kept_folder(&format!("stability-{name}"), &[])
}

/// Runs `bench stability` in the repository, with a folder for its output; returns exit code and standard error.
fn stability(into: &Path, arguments: &[&str]) -> (i32, String) {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut command = reflet(repository, "bench stability -o");
    let output = command.arg(into).args(arguments).output();
    let output = output.expect("the program starts");
    let [out, error] = texts(&output);
    assert!(!error.contains("panicked"), "{error}");
    (
        output.status.code().expect("an exit code"),
        out + error.as_str(),
    )
}

/// Cells of a row of `stability.csv` by mode and method.
fn row(folder: &Path, mode: &str, method: &str) -> Vec<String> {
    let text = fs::read_to_string(folder.join("stability.csv")).expect("a table");
    let start = format!("{mode},{method},");
    let row = text.lines().find(|line| line.starts_with(&start));
    let row = row.unwrap_or_else(|| panic!("no {start} in {text}"));
    row.split(',').map(str::to_owned).collect()
}

/// Failure modes of different causes, one in ten, by methods that can fail. Other tests here take 3, 15 and 18.
const SOME: [&str; 5] = ["1", "20", "28", "--methods", "ssr,hybrid"];
/// Methods that the ratchet has scores of.
const METHODS: &str = "ssr,probe,ssr+probe,ssr+box,near-far,hybrid,rt";

#[test]
fn no_score_is_worse_than_the_ratchet_allows() {
    or_skip!(gpu_or_skip());
    let modes = if is_long() {
        &["--methods", METHODS][..]
    } else {
        &SOME
    };
    let ratchet = ["--ratchet", "tests/stability.toml"];
    let (code, says) = stability(&folder("ratchet"), &[modes, &ratchet].concat());
    assert_eq!(code, 0, "{says}");
    assert!(says.contains("no score is worse"), "{says}");
}

/// Without the scores of a mode the ratchet allows any.
#[test]
fn the_ratchet_has_scores_of_all_modes_and_methods() {
    let text = fs::read_to_string("tests/stability.toml").expect("readable");
    let ratchet: toml::Table = text.parse().expect("a ratchet");
    let cells = ratchet["cell"].as_array().expect("cells");
    let scenes = fs::read_dir("scenes/fail").expect("a folder");
    let scenes = scenes.map(|entry| entry.expect("an entry").path());
    for scene in scenes.filter(|path| path.extension().is_some_and(|e| e == "toml")) {
        let mode = scene
            .file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        let of_mode = cells
            .iter()
            .filter(|cell| cell["mode"].as_str() == Some(&mode));
        let held: Vec<_> = of_mode.filter_map(|cell| cell["method"].as_str()).collect();
        for method in METHODS.split(',') {
            assert!(held.contains(&method), "{mode}, {method}");
        }
    }
}

#[test]
fn a_regression_fails_and_is_named() {
    or_skip!(gpu_or_skip());
    let folder = folder("regression");
    let worse = ["--set", "reflection.bounces=1", "--methods", "rt"];
    let ratchet = ["15", "--ratchet", "tests/stability.toml"];
    let (code, says) = stability(&folder, &[&ratchet[..], &worse[..]].concat());
    assert_eq!(code, 6, "{says}");
    assert_says(&says, &["worse: 15-facing-mirrors, rt: flip is"]);
}

#[test]
fn a_planted_fault_of_a_shader_turns_cells_red() {
    or_skip!(gpu_or_skip());
    let folder = folder("planted");
    let shaders = folder.join("shaders");
    let verified = "if (support < SUPPORT || !is_near) { m.cause = CAUSE_UNCONFIRMED; }";
    let library = ShaderLibrary::embedded();
    let mut planted = 0;
    for (name, text) in library.texts() {
        let path = shaders.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        planted += text.matches(verified).count();
        fs::write(path, text.replace(verified, "")).expect("a shader");
    }
    assert_eq!(planted, 1, "the march confirms its hits in one place");
    let march = shaders.join("ssr.wgsl");
    let shaders = shaders.to_str().expect("Unicode");
    let ratchet = ["3", "18", "--ratchet", "tests/stability.toml"];
    let own = ["--methods", "hybrid", "--shaders", shaders];
    let (code, says) = stability(&folder, &[&ratchet[..], &own[..]].concat());
    assert_eq!(code, 6, "{says}");
    for cell in ["03-rails", "18-fence"] {
        let worse = format!("worse: {cell}, hybrid: ");
        assert!(says.contains(&worse), "{says}");
    }
    fs::write(&march, "no shader").expect("a shader");
    fs::remove_file(folder.join("samples.csv")).expect("samples");
    let (code, says) = stability(&folder, &[&ratchet[..], &own[..]].concat());
    assert_eq!(code, 2, "{says}");
    assert_says(&says, &["--shaders: ", "ssr.wgsl:1"]);
}

#[test]
fn a_film_of_ones_own_is_scored_and_resumed() {
    or_skip!(gpu_or_skip());
    let folder = folder("film");
    let scene = folder.join("mine.toml");
    fs::write(&scene, SCENE).expect("a scene");
    let scene = scene.to_str().expect("Unicode");
    let (code, says) = stability(&folder, &[scene, "--methods", "ssr,rt"]);
    assert_eq!(code, 0, "{says}");
    let [ssr, rt] = ["ssr", "rt"].map(|method| row(&folder, "mine", method));
    let number = |cell: &str| cell.parse::<f64>().unwrap_or_else(|_| panic!("{ssr:?}"));
    // mode, method, against, frames, mask_px, flip, flip_p99, worst (with a comma), …, flicker
    assert_eq!((ssr[3].as_str(), rt[3].as_str()), ("3", "3"));
    assert!(
        number(&ssr[5]) > 0.1 && number(&rt[5]) == 0.0,
        "{ssr:?} {rt:?}"
    );
    let report = fs::read_to_string(folder.join("stability.html")).expect("a report");
    for part in [
        "<td><a href=\"#mine\">mine</a></td><td style=\"background:#ee8277\">",
        "<p>A ball that rolls. Frame ",
        "ssr: wrong (p99 ",
        "flicker in reflections",
    ] {
        assert!(report.contains(part), "no {part:?} in {report}");
    }
    assert!(
        !report.contains("<img"),
        "pictures are shown with --pictures"
    );
    let samples = fs::read(folder.join("samples.csv")).expect("samples");
    let (code, says) = stability(&folder, &[scene, "--methods", "ssr,rt", "--resume"]);
    assert_eq!(code, 0, "{says}");
    assert!(says.contains("6 frames were measured before"), "{says}");
    assert_eq!(
        fs::read(folder.join("samples.csv")).expect("samples"),
        samples
    );
}

#[test]
fn what_has_no_score_is_named_and_never_good() {
    or_skip!(gpu_or_skip());
    let folder = folder("empty");
    let scene = folder.join("dull.toml");
    let dull = "roughness = 0\nreflection = \"none\"";
    fs::write(&scene, SCENE.replace("roughness = 0", dull)).expect("a scene");
    let scene = scene.to_str().expect("Unicode");
    let (code, says) = stability(&folder, &[scene, "--methods", "ssr", "--stills"]);
    assert_eq!(code, 0, "{says}");
    assert!(says.contains("dull, ssr: not scored: frame 0"), "{says}");
    let ratchet = folder.join("ratchet.toml");
    let cell =
        "size = [96, 54]\n[[cell]]\nmode = \"dull\"\nmethod = \"ssr\"\nflip = 1\nflip_p99 = 1\n";
    fs::write(&ratchet, cell).expect("a ratchet");
    let ratchet = ratchet.to_str().expect("Unicode");
    let options = [scene, "--methods", "ssr", "--ratchet", ratchet, "--resume"];
    let (code, says) = stability(&folder, &options);
    assert_eq!(code, 6, "{says}");
    assert_says(&says, &["worse: dull, ssr: no score: frame 0"]);
}

#[test]
fn bad_input_is_named() {
    let folder = folder("bad");
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, text).expect("written");
        path.to_str().expect("Unicode").to_owned()
    };
    let broken = write("broken.toml", "version = 1\n[camera.main]\nfov = 3\n");
    let torn = write(
        "torn/ratchet.toml",
        "size = [160, 90]\n[[cell]]\nmode = 3\n",
    );
    let gone = write(
        "gone/ratchet.toml",
        "size = [160, 90]\n[[cell]]\nmode = \"29-gone\"\nmethod = \"rt\"\nflip = 0\nflip_p99 = 0\n",
    );
    write("gap/01-a.toml", SCENE);
    let second = write("gap/03-b.toml", SCENE);
    let gap = Path::new(&second).parent().expect("a folder");
    let gap = gap.to_str().expect("Unicode");
    let output = folder.join("out");
    for (arguments, code, parts) in [
        (
            &["99"][..],
            2,
            &["99: scenes/fail has no such mode", "03-rails"][..],
        ),
        (&["rails"], 2, &["rails: scenes/fail has no such mode"]),
        (&[&broken], 3, &["broken.toml:3:1", "fov_deg"]),
        (&["none.toml"], 3, &["none.toml"]),
        (&["--suite", "none"], 2, &["--suite none"]),
        (&["--suite", gap], 2, &["mode 2 is missing"]),
        (
            &["3", "--methods", "auto"],
            2,
            &["invalid value 'auto' for '--methods"],
        ),
        (
            &["--ratchet", "none.toml"],
            2,
            &["none.toml: there is no such file"],
        ),
        (&["--ratchet", &torn], 2, &["ratchet.toml", "line 3"]),
        (
            &["--ratchet", &gone],
            2,
            &["29-gone: scenes/fail has no such mode"],
        ),
        (&["3", "scenes/fail/03-rails.toml"], 2, &["the same name"]),
        (
            &["--ratchet", "tests/stability.toml", "--size", "99x9"],
            2,
            &["not of 99 x 9"],
        ),
    ] {
        let (found, says) = stability(&output, arguments);
        assert_eq!(found, code, "{arguments:?}: {says}");
        for part in parts {
            assert!(says.contains(part), "{arguments:?}: no {part:?} in {says}");
        }
    }
    assert!(!output.exists(), "nothing was begun");
}
