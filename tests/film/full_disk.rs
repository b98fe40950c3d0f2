//! Full disk: the sequence ends, reports the missing frames and can be resumed. Uses a small tmpfs;
//! `SKIPPED` where it cannot be mounted.

use super::*;

/// Runs a shell command with an empty disk of so many KiB at `disk`; `None` if it cannot be
/// mounted.
fn with_disk(folder: &std::path::Path, kib: u32, line: &str) -> Option<(i32, String)> {
    let mount = format!("mkdir -p disk && mount -t tmpfs -o size={kib}k none disk");
    let run = |line: &str| {
        let shell = Command::new("unshare")
            .args(["-rm", "sh", "-c", line])
            .current_dir(folder)
            .output();
        shell.map(|out| {
            let text = String::from_utf8_lossy(&out.stderr).into_owned();
            (out.status.code().unwrap_or(-1), text)
        })
    };
    if !matches!(run(&mount), Ok((0, _))) {
        eprintln!("SKIPPED: no disk can be mounted here");
        return None;
    }
    run(&format!("{mount} && {line}")).ok()
}

#[test]
fn a_full_disk_ends_a_film_and_says_what_is_missing() {
    or_skip!(gpu_or_skip());
    let folder = folder("full");
    let reflet = env!("CARGO_BIN_EXE_reflet");
    let film = "render scene.toml --set timeline.end=39 -o disk/f.##.png";
    let line = format!("{reflet} {film}; code=$?; cp disk/*.png .; ls -A disk >&2; exit $code");
    let (code, text) = or_skip!(with_disk(&folder, 64, &line));
    assert_eq!(code, 5, "{text}");
    let written = pictures(&folder).len();
    assert!((1..40).contains(&written), "{written} written: {text}");
    let count = |part: &str| text.matches(part).count();
    assert_eq!(count("error: cannot write disk/f."), 1, "{text}");
    assert_eq!(count("No space left on device"), 1, "{text}");
    let missing = format!("{} frames are missing: ", 40 - written);
    assert!(text.contains(&missing), "{missing}: {text}");
    assert_says(&text, &["free disk space and add --resume to continue"]);
    assert!(!text.contains(".tmp"), "a half written file stays: {text}");
    // The reported frames are valid arguments of `--frames`.
    let list = text
        .split(&missing)
        .nth(1)
        .and_then(|rest| rest.split(';').next());
    let list = list.expect("a list");
    let rest = [
        "-o",
        "f.##.png",
        "--set",
        "timeline.end=39",
        "--frames",
        list,
    ];
    super::render(&folder, rest, 0);
    assert_eq!(pictures(&folder).len(), 40);
}

#[test]
fn a_full_disk_leaves_no_picture() {
    or_skip!(gpu_or_skip());
    let folder = folder("full-one");
    let reflet = env!("CARGO_BIN_EXE_reflet");
    let fill = "head -c 60000 /dev/zero > disk/filler";
    let line = format!(
        "{fill}; {reflet} render scene.toml --size 400x300 -o disk/f.png; code=$?; ls -A disk >&2; exit $code"
    );
    let (code, text) = or_skip!(with_disk(&folder, 64, &line));
    assert_eq!(code, 1, "{text}");
    assert_says(&text, &["error: cannot write disk/f.png: No space left"]);
    assert!(text.ends_with("filler\n"), "{text}");
    assert!(fs::read_dir(folder.join("disk")).is_ok_and(|mut d| d.next().is_none()));
}

#[test]
fn a_full_disk_leaves_no_film() {
    or_skip!(gpu_or_skip());
    let folder = folder("full-film");
    let reflet = env!("CARGO_BIN_EXE_reflet");
    for (name, encoder) in [
        ("f.apng", None),
        ("f.mp4", Some("ffmpeg")),
        ("f.webm", Some("ffmpeg")),
    ] {
        let is_there = |tool| Command::new(tool).arg("-version").output().is_ok();
        if encoder.is_some_and(|tool| !is_there(tool)) {
            eprintln!("SKIPPED: ffmpeg is not installed");
            continue;
        }
        let film = "render scene.toml --set timeline.end=39 --size 320x200";
        let line = format!(
            "{reflet} {film} -o disk/{name}; code=$?; ls -A disk | sed s/^/left:/ >&2; exit $code"
        );
        let (code, text) = or_skip!(with_disk(&folder, 8, &line));
        assert_eq!(code, 1, "{name}: {text}");
        let start = format!("error: cannot write disk/{name}: ");
        assert!(text.contains(&start), "{text}");
        for says in [
            "No space left on device",
            "there is no film",
            "disk/f.####.png",
        ] {
            assert!(text.contains(says), "{name}: {says}: {text}");
        }
        assert!(!text.contains("left:"), "{text}");
    }
}

#[test]
fn a_pack_for_which_the_disk_has_no_room_is_refused_before_a_file_is_written() {
    let folder = folder("full-pack");
    let noise = image::RgbImage::from_fn(256, 256, |x, y| {
        let bits = x.wrapping_mul(0x9E37_79B9) ^ y.wrapping_mul(0x85EB_CA6B);
        image::Rgb(
            (bits.wrapping_mul(bits | 1)).to_le_bytes()[1..]
                .try_into()
                .expect("three"),
        )
    });
    noise.save(folder.join("noise.png")).expect("written");
    let text = super::SCENE.replace(
        "base_color = [0.8, 0.1, 0.1]",
        "base_color_texture = \"noise.png\"",
    );
    fs::write(folder.join("scene.toml"), text).expect("written");
    let reflet = env!("CARGO_BIN_EXE_reflet");
    let line = format!(
        "{reflet} pack scene.toml -o show.zip && {reflet} unpack show.zip -o disk/made; \
         code=$?; ls -A disk | sed s/^/left:/ >&2; exit $code"
    );
    let (code, text) = or_skip!(with_disk(&folder, 64, &line));
    assert_eq!(code, 1, "{text}");
    assert!(text.contains("cannot write disk/made: it needs "), "{text}");
    assert!(!text.contains("left:"), "{text}");
    let line =
        format!("{reflet} pack scene.toml -o disk/show.zip; code=$?; ls -A disk >&2; exit $code");
    let (code, text) = with_disk(&folder, 64, &line).expect("as before");
    assert_eq!(code, 1, "{text}");
    assert!(
        text.starts_with("error: cannot write disk/show.zip: No space left"),
        "{text}"
    );
    assert_eq!(text.lines().count(), 1, "{text}");
}
