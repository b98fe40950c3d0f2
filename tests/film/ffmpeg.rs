//! Films through ffmpeg: output of the real program (`SKIPPED` without it), and failures with fake
//! programs.

use std::{
    env,
    io::{BufRead as _, BufReader, Read as _},
    os::unix::{fs::PermissionsExt as _, process::CommandExt as _},
    time::Instant,
};

use image::AnimationDecoder as _;

use super::*;
use crate::common::program::signal;

pub fn is_there(tool: &str) -> bool {
    let found = Command::new(tool).arg("-version").output().is_ok();
    if !found {
        eprintln!("SKIPPED: {tool} is not installed");
    }
    found
}

/// Runs with only this folder in `PATH`, checks the exit code; returns standard error.
#[track_caller]
fn with_path(folder: &Path, path: &str, arguments: &str, code: i32) -> String {
    let [_, error] = ends(rendering(folder, arguments).env("PATH", path), code);
    error
}

#[test]
fn films_have_every_frame_at_its_time() {
    if gpu_or_skip().is_none() || !is_there("ffmpeg") {
        return;
    }
    let folder = folder("ffmpeg");
    super::render(&folder, ["-o", "f.webp"], 0);
    let bytes = fs::read(folder.join("f.webp")).expect("it is there");
    let film = image::codecs::webp::WebPDecoder::new(std::io::Cursor::new(bytes));
    let frames = film.expect("WebP").into_frames().collect_frames();
    let frames = frames.expect("whole");
    let times = frames.iter().map(|frame| frame.delay().numer_denom_ms());
    assert_eq!(times.collect::<Vec<_>>(), [(100, 1); 6]);
    if !is_there("ffprobe") {
        return;
    }
    // ffmpeg could read text before a colon as a protocol.
    fs::create_dir(folder.join("take:2")).expect("new");
    let video: &[&str] = &["pix_fmt=yuv420p", "color_space=bt709"];
    for (name, colors) in [
        ("f.mp4", video),
        ("take:2/f.webm", video),
        ("take:2/f.mov", video),
        ("f.mkv", video),
        ("f.gif", &["pix_fmt=bgra"]),
    ] {
        super::render(&folder, ["-o", name], 0);
        let shown = "stream=nb_read_frames,width,height,r_frame_rate,pix_fmt,color_space";
        let probe = Command::new("ffprobe")
            .current_dir(&folder)
            .args(["-v", "error", "-count_frames", "-of", "default=nk=0:nw=1"])
            .args(["-show_entries", shown])
            .arg(folder.join(name))
            .output()
            .expect("it starts");
        let facts = String::from_utf8_lossy(&probe.stdout).into_owned();
        let all = ["width=24", "height=16", "nb_read_frames=6"];
        for fact in all.iter().chain(&["r_frame_rate=10/1"]).chain(colors) {
            assert!(facts.lines().any(|line| line == *fact), "{name}: {facts}");
        }
    }
    // Playback can start before the download ends.
    let bytes = fs::read(folder.join("f.mp4")).expect("it is there");
    let place = |tag: &[u8]| bytes.windows(4).position(|part| part == tag);
    assert!(place(b"moov").is_some() && place(b"moov") < place(b"mdat"));
    let text = super::render(&folder, "-o odd.mp4 --size 25x15", 2);
    assert_says(&text, &["choose --size 26x16, or write .apng"]);
    assert!(!folder.join("odd.mp4").exists());
}

/// Output on a terminal, which `script` provides.
#[test]
fn script_output_has_its_own_lines() {
    let has_script = Command::new("script").arg("--version").output().is_ok();
    if gpu_or_skip().is_none() || !has_script {
        eprintln!("SKIPPED: there is no script command");
        return;
    }
    let folder = folder("terminal");
    let prints = "fn frame(ctx) { print(`at ${ctx.frame}`); }";
    fs::write(folder.join("s.rhai"), prints).expect("writable");
    let line = format!(
        "{} render scene.toml -o f.#.png",
        env!("CARGO_BIN_EXE_reflet")
    );
    let output = Command::new("script")
        .current_dir(&folder)
        .args(["-qec", &line, "/dev/null"])
        // Without it the terminal counts as one that has no progress bar.
        .env("TERM", "xterm")
        .stdin(Stdio::null())
        .output()
        .expect("it starts");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}");
    assert!(text.contains("6/6 frame"), "{text}");
    let mut told = 0;
    for line in text
        .split('\n')
        .filter(|line| line.contains("s.rhai:1: at"))
    {
        let shown = line.rsplit("\u{1b}[2K").next().unwrap_or_default();
        assert!(shown.starts_with("frame "), "{line:?} in {text}");
        told += 1;
    }
    assert_eq!(told, 6, "{text}");
}

/// Ctrl-C as a terminal sends it: to the whole process group.
#[test]
fn ctrl_c_in_a_terminal_ends_a_film_and_leaves_nothing() {
    if gpu_or_skip().is_none() || !is_there("ffmpeg") {
        return;
    }
    let folder = folder("ffmpeg-stopped");
    let before = names(&folder);
    let mut command = rendering(&folder, "-o f.mp4 --set timeline.end=2000");
    command.stderr(Stdio::piped()).process_group(0);
    let mut child = command.spawn().expect("the program starts");
    let mut errors = BufReader::new(child.stderr.take().expect("piped"));
    let mut text = String::new();
    while !text.contains("(2 of 2001)") {
        let read = errors.read_line(&mut text).expect("readable");
        assert!(read > 0, "it has ended: {text}");
    }
    let group = format!("-{}", child.id());
    let sent = Command::new("kill").args(["-INT", "--", &group]).status();
    assert!(sent.is_ok_and(|status| status.success()));
    errors.read_to_string(&mut text).expect("readable");
    assert_eq!(child.wait().expect("it ends").code(), Some(130), "{text}");
    assert!(text.contains("no film was written"), "{text}");
    assert_eq!(names(&folder), before);
}

#[test]
fn an_ffmpeg_that_fails_is_quoted_and_leaves_nothing() {
    or_skip!(gpu_or_skip());
    let folder = folder("ffmpeg-fails");
    let tools = folder.join("tools");
    fs::create_dir(&tools).expect("new");
    let path = format!(
        "{}:{}",
        tools.display(),
        env::var("PATH").unwrap_or_default()
    );
    let before = names(&folder);
    let text = with_path(&folder, "/nowhere", "-o f.mp4", 2);
    assert_says(&text, &["ffmpeg is not installed", "write .apng or frames"]);
    let film = "-o f.mp4";
    // A frame size whose pixels the pipe cannot hold at once.
    let large = "-o f.mp4 --size 160x120";
    let last = "for last; do :; done";
    let cases = [
        (
            film,
            "echo \"Unknown encoder 'libx264'\" >&2; exit 8",
            "ffmpeg says: Unknown encoder 'libx264'; there is no film: fix that, or write .apng \
             or frames (f.####.png)",
        ),
        (
            film,
            "head -c 2000 > /dev/null; kill -9 $$",
            "ffmpeg ended with signal: 9",
        ),
        (film, "cat > /dev/null", "the encoder has written nothing"),
        // Fake program that writes more to standard error than a pipe holds, before it reads pixels.
        (
            film,
            "yes noise | head -c 300000 >&2; echo the end >&2; cat > /dev/null",
            "noise; the end; there is no film",
        ),
        // Fake program that exits with 0 though the disk is full at the end, as the real ffmpeg does.
        (
            film,
            "cat > \"$last\"; echo Error writing trailer >&2",
            "ffmpeg says: Error writing trailer",
        ),
        (large, "exec 0<&-; sleep 0.2", "ffmpeg accepts no input: "),
        (film, "exit 7", "ffmpeg ended with exit status: 7"),
    ];
    for &(arguments, script, says) in first_or_all(&cases, 6) {
        let stub = tools.join("ffmpeg");
        fs::write(&stub, format!("#!/bin/sh\n{last}\n{script}\n")).expect("writable");
        fs::set_permissions(&stub, fs::Permissions::from_mode(0o755)).expect("settable");
        let text = with_path(&folder, &path, arguments, 1);
        assert!(
            text.contains("error: cannot write f.mp4: "),
            "{script}: {text}"
        );
        assert!(text.contains(says) && text.len() < 4000, "{script}: {text}");
        assert_eq!(names(&folder), before, "{script}");
    }
    let stub = tools.join("ffmpeg");
    fs::write(&stub, format!("#!/bin/sh\n{last}\ncat > \"$last\"\n")).expect("writable");
    with_path(&folder, &path, film, 0);
    let pixels = fs::read(folder.join("f.mp4")).expect("it is there");
    assert_eq!(pixels.len(), 6 * 24 * 16 * 3);
}

/// Fake programs that read nothing, at once or at the end, in frames that a pipe cannot hold.
#[test]
fn a_signal_ends_a_film_whose_ffmpeg_has_stopped() {
    or_skip!(gpu_or_skip());
    let folder = folder("ffmpeg-stuck");
    let path = format!(
        "{}:{}",
        folder.display(),
        env::var("PATH").unwrap_or_default()
    );
    let stub = folder.join("ffmpeg");
    for (script, last) in [
        ("exec sleep 1000", 2000),
        ("cat > /dev/null; exec sleep 1000", 2),
    ] {
        fs::write(&stub, format!("#!/bin/sh\necho > started; {script}\n")).expect("writable");
        fs::set_permissions(&stub, fs::Permissions::from_mode(0o755)).expect("settable");
        let arguments = format!("-o f.mp4 --size 256x200 --set timeline.end={last}");
        let before = names(&folder);
        let mut command = rendering(&folder, &arguments);
        command.env("PATH", &path).stderr(Stdio::piped());
        let mut child = command.spawn().expect("the program starts");
        let mut errors = BufReader::new(child.stderr.take().expect("piped"));
        let mut text = String::new();
        while !text.contains("(1 of ") {
            assert!(errors.read_line(&mut text).expect("readable") > 0, "{text}");
        }
        signal(&child, "-TERM");
        let sent = Instant::now();
        let code = loop {
            if let Some(status) = child.try_wait().expect("a child") {
                break status.code();
            }
            if sent.elapsed() > Duration::from_secs(60) {
                child.kill().expect("a child");
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        errors.read_to_string(&mut text).expect("readable");
        assert_eq!(code, Some(143), "{script}: {text}");
        assert!(text.contains("no film was written"), "{script}: {text}");
        fs::remove_file(folder.join("started")).expect("it has started");
        assert_eq!(names(&folder), before, "{script}");
    }
}
