//! Killed and interrupted runs: final files are complete, existing files are preserved, and a
//! resumed sequence equals an uninterrupted one.

use std::{
    io::{BufRead as _, BufReader, Read as _},
    os::unix::process::ExitStatusExt as _,
    process::{Child, ChildStderr},
    time::{Instant, SystemTime},
};

use super::*;
use crate::common::{Random, is_long, program::signal};

/// Many small frames, so that kills occur between, during and after them.
const FRAMES: &str = "-o f.##.png --set timeline.end=23 --aov depth --resume";

fn start(folder: &Path, arguments: &str) -> Child {
    let mut command = rendering(folder, arguments);
    let command = command.stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

/// Waits until a film of 2,001 frames has told the first one; returns its further errors.
fn first_frame(child: &mut Child) -> BufReader<ChildStderr> {
    let mut errors = BufReader::new(child.stderr.take().expect("piped"));
    let mut text = String::new();
    while !text.contains("(1 of 2001)") {
        let read = errors.read_line(&mut text).expect("readable");
        assert!(read > 0, "it has ended: {text}");
    }
    errors
}

/// Waits for the end of a process; returns exit code (negative: the signal) and standard error.
fn end(child: Child) -> (i32, String) {
    let output = child.wait_with_output().expect("it ends");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("panicked"), "{text}");
    let status = output.status;
    let code = status.code().or(status.signal().map(|signal| -signal));
    (code.expect("code or signal"), text)
}

fn hidden(folder: &Path) -> Vec<String> {
    let mut names = names(folder);
    names.retain(|name| name.starts_with('.'));
    names
}

/// Maximum number of extra rounds on a busy machine.
const PATIENCE: u32 = 60;

/// Ends a sequence at `rounds` random times, alternating SIGKILL and SIGTERM, and at some more times if
/// none of them left it incomplete.
fn end_at_random_moments(rounds: u32) {
    or_skip!(gpu_or_skip());
    let whole = folder("kills-whole");
    let started = Instant::now();
    let (code, text) = end(start(&whole, FRAMES));
    let run_s = started.elapsed().as_secs_f64();
    assert_eq!(code, 0, "{text}");
    let whole = pictures(&whole);
    assert_eq!(whole.len(), 48);

    let folder = folder("kills");
    let mut chance = Random(0x5EED);
    let mut before = BTreeMap::new();
    let (mut ended_early, mut part_done) = (0, 0);
    let mut round = 0;
    while round < rounds || part_done == 0 && round < rounds + PATIENCE {
        round += 1;
        let kill = round % 2 == 0;
        let child = start(&folder, FRAMES);
        std::thread::sleep(Duration::from_secs_f64(chance.unit() * run_s));
        signal(&child, if kill { "-KILL" } else { "-TERM" });
        let (code, text) = end(child);
        let context = format!("round {round}, code {code}: {text}");
        // Before its handler is installed, SIGTERM ends the program as SIGKILL does.
        let allowed: &[i32] = if kill { &[-9, 0] } else { &[143, -15, 0] };
        assert!(allowed.contains(&code), "{context}");
        if code == 143 {
            assert!(text.contains("add --resume to continue"), "{context}");
        }
        let now = pictures(&folder);
        for (name, bytes) in &now {
            assert!(*bytes == whole[name], "{name} is not whole; {context}");
        }
        let lost = before.keys().find(|name| !now.contains_key(*name));
        assert_eq!(lost, None, "{context}");
        ended_early += u32::from(code != 0);
        part_done += u32::from(!now.is_empty() && now.len() < whole.len());
        before = now;
        if before.len() == whole.len() {
            for name in std::mem::take(&mut before).keys() {
                fs::remove_file(folder.join(name)).expect("it is there");
            }
        }
    }
    assert!(ended_early > 0 && part_done > 0, "no moment was inside");
    let (code, text) = end(start(&folder, FRAMES));
    assert_eq!(code, 0, "{text}");
    assert!(pictures(&folder) == whole, "the resumed film is another");
    if cfg!(target_os = "linux") {
        assert_eq!(hidden(&folder), [] as [String; 0]);
    }
}

#[test]
fn kills_lose_nothing() {
    end_at_random_moments(if is_long() { 100 } else { 6 });
}

/// Ends a video file at random times: its path holds the complete old or the complete new film.
fn end_a_film_at_random_moments(rounds: u32) {
    if gpu_or_skip().is_none() || !super::ffmpeg::is_there("ffmpeg") {
        return;
    }
    for film in ["f.apng", "f.mp4"] {
        let folder = folder(&format!("film-kills-{film}"));
        let arguments = format!("-o {film} --set timeline.end=23");
        let started = Instant::now();
        assert_eq!(end(start(&folder, &arguments)).0, 0);
        let run_s = started.elapsed().as_secs_f64();
        let path = folder.join(film);
        let whole = fs::read(&path).expect("a film");
        let before = b"the film before".to_vec();
        let mut chance = Random(0x5EED);
        let (mut ended_early, mut done) = (0, 0);
        let mut round = 0;
        while round < rounds || ended_early == 0 && round < rounds + PATIENCE {
            round += 1;
            fs::write(&path, &before).expect("writable");
            let kill = round % 2 == 0;
            let child = start(&folder, &arguments);
            std::thread::sleep(Duration::from_secs_f64(1.1 * chance.unit() * run_s));
            signal(&child, if kill { "-KILL" } else { "-TERM" });
            let (code, text) = end(child);
            let context = format!("{film}, round {round}, code {code}: {text}");
            let allowed: &[i32] = if kill { &[-9, 0] } else { &[143, -15, 0] };
            assert!(allowed.contains(&code), "{context}");
            let now = fs::read(&path).expect(&context);
            assert!(now == whole || (now == before && code != 0), "{context}");
            ended_early += u32::from(code != 0);
            done += u32::from(now == whole);
        }
        assert!(ended_early > 0, "no moment was inside");
        eprintln!("{film}: {ended_early} of {round} ended early, {done} were done");
        let (code, text) = end(start(&folder, &arguments));
        assert_eq!(code, 0, "{text}");
        assert!(
            fs::read(&path).expect("a film") == whole,
            "{film} is another"
        );
        if cfg!(target_os = "linux") {
            assert_eq!(hidden(&folder), [] as [String; 0]);
        }
    }
}

#[test]
fn kills_leave_no_film_in_part() {
    end_a_film_at_random_moments(if is_long() { 50 } else { 4 });
}

/// Sends a signal after the first frame is reported, when the signal handler is installed.
#[test]
fn a_signal_ends_a_film_between_frames() {
    or_skip!(gpu_or_skip());
    let folder = folder("signal");
    for (output, name, code, says) in [
        ("f.####.png", "-TERM", 143, "add --resume to continue"),
        ("f.####.png", "-INT", 130, "add --resume to continue"),
        ("f.apng", "-TERM", 143, "no film was written"),
    ] {
        let mut child = start(&folder, &format!("-o {output} --set timeline.end=2000"));
        let mut errors = first_frame(&mut child);
        let mut text = String::new();
        signal(&child, name);
        errors.read_to_string(&mut text).expect("readable");
        let status = child.wait().expect("it ends");
        assert_eq!(status.code(), Some(code), "{text}");
        assert!(text.contains(says), "{text}");
        assert_eq!(hidden(&folder), [] as [String; 0], "{output}");
    }
    assert!(!folder.join("f.apng").exists());
    let told = pictures(&folder).len();
    assert!((1..2000).contains(&told), "{told} frames");
}

/// Temporary files of films and frames, with and without --resume. Files of running processes stay, and files of other
/// machines for a day.
#[cfg(target_os = "linux")]
#[test]
fn what_a_killed_run_has_left_is_removed_by_the_next() {
    or_skip!(gpu_or_skip());
    let folder = folder("leftovers");
    let mut child = start(&folder, "-o f.apng --set timeline.end=2000");
    let _errors = first_frame(&mut child);
    signal(&child, "-KILL");
    assert_eq!(end(child).0, -9);
    let left = hidden(&folder);
    assert_eq!(left.len(), 1, "{left:?}");
    // Name of a temporary file: .reflet-GOAL-PLACE-PROCESS.tmp
    let parts: Vec<_> = left[0].split('-').collect();
    let name = |place: &str, id: u32| format!("{}-{}-{place}-{id}.tmp", parts[0], parts[1]);
    let elsewhere = name("0123456789abcdef", u32::MAX);
    let alive = name(parts[2], std::process::id());
    let dead = name(parts[2], u32::MAX);
    // Temporary files of another machine, unmodified for a day, and for a little less.
    let abandoned = name("0123456789abcdef", 7);
    let written = name("0123456789abcdef", 8);
    for name in [&elsewhere, &alive, &dead, &abandoned, &written] {
        fs::write(folder.join(name), "half").expect("writable");
    }
    for (name, hours) in [(&abandoned, 25), (&written, 23), (&alive, 25)] {
        let file = fs::File::options().write(true).open(folder.join(name));
        let time = SystemTime::now() - Duration::from_secs(hours * 3600);
        file.expect("there").set_modified(time).expect("settable");
    }
    let told = super::render(&folder, "-o g.#.png", 0);
    assert_eq!(told.lines().count(), 6);
    assert_eq!(hidden(&folder).len(), 6, "those of another goal stay");
    super::render(&folder, "-o f.apng", 0);
    let stays = hidden(&folder);
    let mut wanted = [elsewhere, alive, written];
    wanted.sort();
    assert_eq!(stays, wanted);
}
