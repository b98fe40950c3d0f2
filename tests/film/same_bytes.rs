//! Two runs of one command write the same bytes, whatever the number of threads and the load of the machine.

use std::{
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::SystemTime,
};

use super::*;

/// Runs a command with so many threads, beside so many busy threads; returns the files that it wrote.
fn files_of(
    folder: &Path,
    arguments: &[&str],
    threads: u32,
    busy: u32,
) -> BTreeMap<String, Vec<u8>> {
    let before = names(folder);
    let done = AtomicBool::new(false);
    thread::scope(|scope| {
        for _ in 0..busy {
            scope.spawn(|| {
                while !done.load(Ordering::Relaxed) {
                    std::hint::spin_loop()
                }
            });
        }
        let output = reflet(folder, arguments)
            .env("RAYON_NUM_THREADS", threads.to_string())
            .env("LP_NUM_THREADS", threads.to_string())
            .output();
        done.store(true, Ordering::Relaxed);
        let output = output.expect("the program starts");
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {text}");
    });
    let new = names(folder)
        .into_iter()
        .filter(|name| !before.contains(name));
    let taken = new.map(|name| {
        let path = folder.join(&name);
        let bytes = fs::read(&path).expect("readable");
        fs::remove_file(&path).expect("removable");
        (name, bytes)
    });
    taken.collect()
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("readable").flatten();
    let files = entries.filter(|entry| entry.path().is_file());
    files
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect()
}

fn check(folder: &Path, arguments: &[&str], count: usize) {
    let first = files_of(folder, arguments, 1, 0);
    assert_eq!(first.len(), count, "{arguments:?}: {:?}", first.keys());
    let second = files_of(folder, arguments, 2, 1);
    let other = |name: &&String| second.get(*name) != first.get(*name);
    let others: Vec<_> = first.keys().filter(other).collect();
    assert!(
        others.is_empty() && second.len() == count,
        "{arguments:?}: others are {others:?}"
    );
}

#[test]
fn packs_and_jobs_are_the_same_bytes() {
    let folder = folder("same-packs");
    check(&folder, &["pack", "scene.toml", "-o", "show.zip"], 1);
    let job = words("job openjd scene.toml -o . --pictures f.#.exr");
    check(&folder, &job, 3);
    let job = words("job slurm scene.toml -o film.sh --pictures f.#.exr");
    check(&folder, &job, 1);
}

#[test]
fn frames_and_films_are_the_same_bytes() {
    or_skip!(gpu_or_skip());
    let folder = folder("same-films");
    let film = words("render scene.toml --set timeline.end=3 --size 64x36 -o");
    let aov = ["--aov", "depth,normal,cause"];
    let exr = [&film[..], &["f.##.exr"], &aov].concat();
    check(&folder, &exr, 4);
    let png = [&film[..], &["f.##.png"], &aov].concat();
    check(&folder, &png, 4 * 4);
    check(&folder, &[&film[..], &["f.apng"]].concat(), 1);
    #[cfg(unix)]
    if super::ffmpeg::is_there("ffmpeg") {
        for name in ["f.mp4", "f.mov", "f.mkv", "f.webm", "f.gif", "f.webp"] {
            check(&folder, &[&film[..], &[name]].concat(), 1);
        }
    }
}

/// Times of a clock that was set back: files from before are in its future.
#[test]
fn files_from_the_future_end_no_film() {
    or_skip!(gpu_or_skip());
    let folder = folder("clock");
    let film = ["render", "scene.toml", "--frames", "0-1", "-o"];
    let commands = ["f.#.png", "f.apng"].map(|name| [&film[..], &[name]].concat());
    let run = || {
        commands
            .clone()
            .map(|command| files_of(&folder, &command, 2, 0))
    };
    let before = run();
    // A temporary file of another machine, named .reflet-GOAL-PLACE-PROCESS.tmp.
    let other = ".reflet-0123456789abcdef-0123456789abcdef-7.tmp";
    fs::write(folder.join(other), "half").expect("writable");
    let hour = Duration::from_secs(3600);
    let now = SystemTime::now();
    let times = [now + 100_000 * hour, now - 100_000 * hour, now + hour];
    for &time in first_or_all(&times, 2) {
        for name in names(&folder) {
            let file = fs::File::options().write(true).open(folder.join(name));
            file.expect("there").set_modified(time).expect("settable");
        }
        assert!(run() == before, "files of {time:?}");
        assert!(names(&folder).contains(&other.to_owned()));
    }
}
