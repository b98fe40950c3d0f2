//! `bench reload` on the built-in scene: every save is detected and shown, with the expected
//! phases. Durations are not tested.

use clap::Parser as _;
use reflet::app::{
    bench::{
        args::Experiment,
        progress::Progress,
        reload::{ReloadArgs, measure_all, measure_page},
    },
    cli::{Cli, Command},
};

use crate::kit::*;

/// Options of `bench reload`, one save of each kind.
fn parsed(words: &[&str]) -> ReloadArgs {
    let words = [&["reflet", "bench", "reload", "--n", "1"], words].concat();
    let Command::Bench(args) = Cli::parse_from(words).command else {
        panic!("another command");
    };
    match args.experiment {
        Some(Experiment::Reload(args)) => args,
        _ => panic!("another experiment"),
    }
}

#[test]
#[ignore = "long: the saves of a project are measured daily"]
fn saves_of_all_kinds_are_measured() {
    let Some(gpu) = gpu_or_skip() else { return };
    let args = parsed(&["--size", "64x36"]);
    let series = or_panic!(measure_all(&Arc::new(gpu), &args, &mut Progress::new()));
    let kinds: Vec<&str> = series.iter().map(|one| one.edit).collect();
    assert_eq!(kinds, ["text", "shader", "shader", "shader", "script"]);
    for one in &series {
        assert_eq!(one.samples.len(), 1, "{}", one.edit);
        for sample in &one.samples {
            let makes_pipelines = sample["pipelines"] > 0.0;
            assert_eq!(makes_pipelines, one.edit == "shader", "{}", one.file);
            assert_eq!(sample["driver_ms"] > 0.0, makes_pipelines);
            assert!(sample["notice_ms"] > 0.0 && sample["parse_ms"] > 0.0);
            assert!(sample["total_ms"] >= sample["ready_ms"] + sample["frame_ms"]);
        }
    }
}

/// A scene whose base lies above it, and a viewer of the page that gets the picture of each save.
#[test]
fn saves_of_a_project_are_measured_to_a_viewer_of_the_page() {
    let Some(gpu) = gpu_or_skip() else { return };
    let folder = Folder::new();
    folder.write("reflet.toml", "assets = \"lib\"\n");
    let floor = "[material.floor]\nbase_color = [0.4, 0.4, 0.4]\n";
    folder.write("lib/floor.toml", floor);
    let base = SCENE.replace(floor, "[material.floor]\n");
    folder.write(
        "base.toml",
        format!("include = \"floor.toml\"\n{base}").replace(
            "[material.floor]\nreflectivity = 0.5\nroughness = 0.02\n",
            "",
        ),
    );
    let text = "version = 1\nbase = \"../base.toml\"\n[material.red]\nroughness = 0.5\n";
    let path = folder.write("shots/close.toml", text);
    let args = parsed(&["--page", "--size", "48x32", path.to_str().expect("text")]);
    let series = or_panic!(measure_page(&Arc::new(gpu), &args, &mut Progress::new()));
    assert_eq!(series.len(), 5);
    for one in &series {
        let [sample] = one.samples.as_slice() else {
            panic!("one save is counted");
        };
        // The scene marches no rays, so that `ssr.wgsl` has no pipeline.
        let compiles = one.file == "shaders/tone.wgsl";
        let driver_ms = sample["driver_ms"];
        assert!(driver_ms > 0.0 || !compiles, "{}", one.file);
        assert!(driver_ms == 0.0 || one.edit == "shader", "{}", one.file);
        assert!(sample["frame_ms"] > 0.0 && sample["encode_ms"] > 0.0);
        assert!(sample["beyond_ms"] >= sample["encode_ms"], "{sample:?}");
    }
    let kept = std::fs::read_to_string(&path).expect("the scene is there");
    assert_eq!(kept, text, "the copy is edited, not the scene");
}
