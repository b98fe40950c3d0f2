//! The show in `scenes/show`: its shots in chunks as a farm renders them, killed and resumed, against
//! one run; its variants.

use std::time::Instant;

use super::*;

fn show() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/show")
}

#[test]
fn every_shot_and_variant_of_the_show_is_right() {
    for shot in ["base", "lamp", "shot010", "shot020", "shot030"] {
        let path = show().join(format!("{shot}.toml"));
        let path = path.to_str().expect("text");
        let [_, errors] = exits(&show(), ["check", path], 0);
        assert!(errors.is_empty(), "{shot}: {errors}");
    }
}

#[test]
#[ignore = "long: renders a shot twice; kills and chunks are tested apart daily"]
fn a_shot_in_chunks_killed_and_resumed_gives_the_bytes_of_one_run() {
    or_skip!(gpu_or_skip());
    let folder = folder("show");
    let shot = show().join("shot020.toml");
    let shot = shot.to_str().expect("text");
    let look = words("--frames 4-11 --size 64x36 --variant night --variant brass");
    fs::create_dir(folder.join("whole")).expect("a folder");
    let run = ["render", shot, "-o", "whole/f.##.png"];
    exits(&folder, [&run[..], &look].concat(), 0);

    let bundle = folder.join("bundle");
    let write = words("-o bundle --pictures parts/f.##.png --chunk 4");
    let write = [&["job", "openjd", shot][..], &write, &look].concat();
    exits(&folder, write, 0);
    // The first task is killed when some of its frames are written.
    let parts = folder.join("parts");
    let mut task = job::task(&bundle, "4-7");
    let mut child = (task.stdout(Stdio::null()).stderr(Stdio::null()).spawn()).expect("it starts");
    let begun = Instant::now();
    let written = || fs::read_dir(&parts).map_or(0, |files| files.count());
    while written() < 2 && child.try_wait().expect("a child").is_none() {
        assert!(
            begun.elapsed() < Duration::from_secs(300),
            "nothing is written"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().expect("it can be killed");
    child.wait().expect("it has ended");
    job::run_task(&bundle, "8-11");
    let again = job::run_task(&bundle, "4-7");
    assert!(again.contains("openjd_status: kept"), "{again}");
    let (parts, whole) = (pictures(&parts), pictures(&folder.join("whole")));
    assert_eq!(parts.len(), 8);
    assert!(parts == whole, "the frames differ");
    assert_ne!(parts["f.07.png"], parts["f.08.png"]);
}
