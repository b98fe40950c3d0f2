//! Files and folders that a bench cannot use, and options without effect.

use reflet::bench::log::Log;

use super::*;

#[test]
fn a_table_that_another_run_writes_is_refused() {
    let folder = folder("locked");
    let csv = folder.join("samples.csv");
    let first = Log::create(&csv).expect("a new table");
    let before = fs::read(&csv).expect("a header");
    let error = Log::resume(&csv).expect_err("in use");
    assert_eq!(error.name, "samples-in-use");
    let name = folder.display().to_string();
    assert!(error.message.contains(&name), "{}", error.message);
    assert_eq!(fs::read(&csv).expect("a header"), before);
    drop(first);
    assert!(Log::resume(&csv).expect("free again").samples().is_empty());
    // Truncated within its header.
    fs::write(&csv, &before[..30]).expect("torn");
    Log::resume(&csv).expect("begun again");
    assert_eq!(fs::read(&csv).expect("a header"), before);
}

#[cfg(unix)]
#[test]
fn a_table_that_is_no_regular_file_is_refused() {
    let folder = folder("devices");
    let [_, error] = exits(&folder, "--samples /dev/zero", 2);
    assert!(error.contains("not a regular file"), "{error}");
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 0);
    let csv = folder.join("samples.csv");
    std::os::unix::fs::symlink("/dev/full", &csv).expect("a link");
    let error = Log::resume(&csv).expect_err("a device");
    assert!(error.message.contains("not a regular file"));
}

#[test]
fn unwritable_output_is_a_usage_error() {
    let folder = folder("unwritable");
    let csv = write(&folder, &synthetic_samples());
    for taken in ["report.html", "chart-1-flip.svg"] {
        let out = folder.join(format!("out-{taken}"));
        fs::create_dir_all(out.join(taken)).expect("a folder in its place");
        let out = out.to_str().expect("Unicode");
        let [_, error] = exits(&folder, ["--samples", &csv, "-o", out], 2);
        assert!(error.contains(taken), "{error}");
    }
    exits(&folder, "--samples none.csv -o new", 2);
    exits(&folder, ["--adapter", "no such adapter", "-o", "new"], 4);
    assert!(!folder.join("new").exists());
}

#[test]
fn options_that_would_do_nothing_are_refused() {
    let folder = folder("idle");
    let csv = write(&folder, &synthetic_samples());
    for option in [
        &["--methods", "ssr"][..],
        &["--frames", "20"],
        &["--counters"],
        &["--camera", "main"],
        &["--set", "reflection.steps=8"],
    ] {
        let arguments = [&["--samples", &csv, "-o", "new"], option].concat();
        let [_, error] = exits(&folder, &arguments, 2);
        assert!(error.contains("cannot be used with"), "{error}");
    }
}

#[test]
fn a_choice_says_what_was_bounded() {
    let folder = folder("bounded");
    let mut rows = synthetic_samples();
    for row in &mut rows {
        (row.psnr_db, row.mask_psnr_db) = (Some(60.0), Some(30.0));
    }
    let choose = |rows: &[_], bound, code| {
        let csv = write(&folder, rows);
        let arguments = ["--samples", &csv, "-o", ".", "--choose", bound];
        exits(&folder, arguments, code)
    };
    let [block, _] = choose(&rows, "psnr>=30", 0);
    assert!(block.contains("# in reflections against rt"), "{block}");
    assert!(block.contains("PSNR 30.0 dB"), "{block}");
    let [_, error] = choose(&rows, "psnr>=31", 6);
    assert!(error.contains("meets the bound in reflections"), "{error}");
    for row in &mut rows {
        (row.mask_px, row.mask_flip, row.mask_ssim) = (60, None, None);
        row.mask_psnr_db = None;
    }
    let [block, _] = choose(&rows, "psnr>=31", 0);
    assert!(block.contains("# of the frame against rt"), "{block}");
    assert!(block.contains("PSNR 60.0 dB"), "{block}");
    let mut walk = Vec::new();
    for frame in [0, 95] {
        let mut row = sample("rt", 3.0, 5.0, 0.1);
        row.fingerprint += &frame.to_string();
        row.frame = frame;
        row.mask_psnr_db = Some(30.0);
        walk.push(row);
    }
    let [_, error] = choose(&walk, "psnr>=20", 6);
    assert!(error.contains("PSNR has no mean"), "{error}");
    choose(&walk, "flip<=0.5", 0);
}
