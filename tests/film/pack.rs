//! Packs: a scene packed with its files renders the same elsewhere, and a pack that was tampered with leaves
//! no files behind.

use std::io::{Cursor, Read as _, Write as _};

use serde_json::Value;
use zip::{ZipArchive, ZipWriter, write::SimpleFileOptions};

use super::*;
use crate::common::program::signal;
use reflet::output::pack::{Manifest, PackWriter};

/// Entries of a pack: name and content.
fn entries(path: &Path) -> Vec<(String, Vec<u8>)> {
    let bytes = fs::read(path).expect("the pack");
    let mut zip = ZipArchive::new(Cursor::new(bytes)).expect("a ZIP file");
    let count = zip.len();
    let read = |i| {
        let mut entry = zip.by_index(i).expect("an entry");
        let name = entry.name().expect("UTF-8").into_owned();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).expect("whole");
        (name, bytes)
    };
    (0..count).map(read).collect()
}

fn write(path: &Path, entries: &[(String, Vec<u8>)]) {
    let mut zip = ZipWriter::new(fs::File::create(path).expect("a file"));
    for (name, bytes) in entries {
        zip.start_file(name.as_str(), SimpleFileOptions::default())
            .expect("an entry");
        zip.write_all(bytes).expect("written");
    }
    zip.finish().expect("a ZIP file");
}

/// A scene in `shots` that takes its lights from a scene in `library`.
fn show(name: &str) -> std::path::PathBuf {
    let top = folder(name);
    for (folder, files) in [
        ("shots", &["scene.toml", "s.rhai"][..]),
        ("library", &["light.toml"]),
    ] {
        fs::create_dir_all(top.join(folder)).expect("a folder");
        for file in files {
            fs::rename(top.join(file), top.join(folder).join(file)).expect("moved");
        }
    }
    top
}

const OPTIONS: [&str; 5] = [
    "--assets",
    "library",
    "--set",
    "params.lift=0.9",
    "--strict",
];

fn pack(top: &Path, goal: &str) {
    let pack = ["pack", "shots/scene.toml", "-o", goal];
    exits(top, [&pack[..], &OPTIONS].concat(), 0);
}

#[test]
fn a_pack_renders_the_same_elsewhere() {
    let top = show("pack");
    pack(&top, "show.zip");
    pack(&top, "again.zip");
    let bytes = |name: &str| fs::read(top.join(name)).expect("a pack");
    assert_eq!(
        bytes("show.zip"),
        bytes("again.zip"),
        "equal files, equal packs"
    );
    let entries = entries(&top.join("show.zip"));
    let names: Vec<_> = entries.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        ["assets/light.toml", "s.rhai", "scene.toml", "pack.json"]
    );
    let list: Value = serde_json::from_slice(&entries[3].1).expect("JSON");
    assert_eq!(list["scene"], "scene.toml");
    assert_eq!(list["assets"], serde_json::json!(["assets"]));
    assert_eq!(list["frames"], serde_json::json!([0, 5]));
    assert_eq!(list["files"][1]["sha256"].as_str().map(str::len), Some(64));

    let elsewhere = folder("pack-elsewhere");
    let goal = elsewhere.join("made");
    let goal = goal.to_str().expect("UTF-8");
    let [command, _] = exits(&top, ["unpack", "show.zip", "-o", goal], 0);
    assert_says(
        &command,
        &["--set params.lift=0.9 --frames all", "--strict"],
    );
    or_skip!(gpu_or_skip());
    let frame = ["-o", "f.#.png", "--frames", "3"];
    fs::rename(top.join("shots/scene.toml"), top.join("scene.toml")).expect("moved");
    fs::rename(top.join("shots/s.rhai"), top.join("s.rhai")).expect("moved");
    render(&top, [&frame[..], &OPTIONS].concat(), 0);
    let library = format!("{goal}/assets");
    let arguments: Vec<_> = command
        .split_whitespace()
        .skip(1)
        .take(2)
        .chain(frame)
        .collect();
    let arguments = [&arguments[..], &["--assets", &library], &OPTIONS[2..]].concat();
    exits(&elsewhere, arguments, 0);
    assert_eq!(pictures(&top), pictures(&elsewhere));
}

#[test]
fn a_pack_that_was_tampered_with_leaves_no_folder() {
    let top = show("pack-tampered");
    pack(&top, "show.zip");
    let right = entries(&top.join("show.zip"));
    let list = String::from_utf8(right[3].1.clone()).expect("text");
    let with_list = |from: &str, to: &str| {
        assert!(list.contains(from), "{from}");
        let mut all = right.clone();
        all[3].1 = list.replace(from, to).into_bytes();
        all
    };
    let length = |bytes: u64| format!("\"bytes\": {bytes},");
    let huge = with_list(&length(right[0].1.len() as u64), &length(u64::MAX));
    let renamed = |name: &str| {
        let mut all = with_list("assets/light.toml", name);
        all[0].0 = name.to_owned();
        all
    };
    let mut changed = right.clone();
    changed[0].1[1] ^= 1;
    let mut longer = right.clone();
    longer[1].1.push(b' ');
    let mut more = right.clone();
    more.push(("extra.toml".to_owned(), Vec::new()));
    let cases = [
        (renamed("../light.toml"), "leaves the pack's folder"),
        (renamed("/tmp/light.toml"), "is empty or a dot"),
        (renamed("a\\\\..\\\\light.toml"), "backslash"),
        (changed, "not what was packed"),
        (longer, "not what was packed"),
        (more, "1 files that its list does not have"),
        (right[1..].to_vec(), "lacks files"),
        (right[..3].to_vec(), "has no pack.json"),
        (with_list("\"pack\": 1", "\"pack\": 2"), "version 2"),
        (
            with_list("\"scene\": \"scene.toml\"", "\"scene\": \"other.toml\""),
            "is missing",
        ),
        (with_list("{", "["), "pack.json is damaged"),
        (huge, "more than 200 times"),
    ];
    for (all, says) in &cases {
        write(&top.join("bad.zip"), all);
        let [_, errors] = exits(&top, "unpack bad.zip -o made", 3);
        assert!(errors.contains(says), "{says}: {errors}");
        let left: Vec<_> = fs::read_dir(&top)
            .expect("readable")
            .map(|e| e.expect("entry").file_name())
            .collect();
        let left = left.iter().filter(|name| {
            !["shots", "library", "show.zip", "bad.zip"]
                .iter()
                .any(|n| **name == **n)
        });
        assert_eq!(left.count(), 0, "{says}");
        assert!(!top.parent().expect("a folder").join("light.toml").exists());
    }
    let whole = fs::read(top.join("show.zip")).expect("a pack");
    for length in (0..whole.len()).step_by(97) {
        fs::write(top.join("cut.zip"), &whole[..length]).expect("written");
        exits(&top, "unpack cut.zip -o made", 3);
        assert!(!top.join("made").exists());
    }
    fs::create_dir(top.join("made")).expect("a folder");
    let [_, errors] = exits(&top, "unpack show.zip -o made", 2);
    assert!(errors.contains("it exists"), "{errors}");
    let [_, errors] = exits(&top, "unpack absent.zip -o new", 3);
    assert!(errors.contains("absent.zip"), "{errors}");
}

/// So many MiB of random bytes, one MiB again and again: compression looks less far back, and shortens nothing.
#[cfg(unix)]
fn noise(mib: usize) -> Vec<u8> {
    let mut state = 0x5EED_u64;
    let words = std::iter::repeat_with(|| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state.to_le_bytes()
    });
    words.take(1 << 17).collect::<Vec<_>>().concat().repeat(mib)
}

/// A pack with a file so long that a signal can come while it is extracted.
#[cfg(unix)]
fn long_pack(path: &Path) {
    let scene = b"version = 1\n".to_vec();
    let manifest = Manifest {
        variant: vec!["-dark".to_owned()],
        ..Manifest::new("scene.toml".to_owned(), "0")
    };
    let mut pack = PackWriter::new(fs::File::create(path).expect("a file"), manifest);
    for (name, bytes) in [("noise", noise(64)), ("scene.toml", scene)] {
        let added = pack.add(name, bytes.len() as u64, &bytes[..], |e| e, |e| e);
        added.expect("written");
    }
    pack.finish().expect("a ZIP file");
}

#[cfg(unix)]
#[test]
fn unpacking_leaves_nothing_after_a_signal() {
    use std::os::unix::process::ExitStatusExt as _;
    let top = folder("pack-signals");
    long_pack(&top.join("long.zip"));
    let mut command = reflet(&top, "unpack long.zip -o made");
    command.stderr(Stdio::piped()).stdout(Stdio::null());
    for (name, code) in [("-TERM", Some(143)), ("-INT", Some(130)), ("-KILL", None)] {
        // It may end before the signal comes.
        let stopped = (0..20).any(|_| {
            let mut child = command.spawn().expect("the program starts");
            while hidden(&top) == 0 && child.try_wait().expect("a child").is_none() {
                std::thread::yield_now();
            }
            signal(&child, name);
            let output = child.wait_with_output().expect("it ends");
            if output.status.success() {
                fs::remove_dir_all(top.join("made")).expect("it is made");
                return false;
            }
            let text = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), code, "{text}");
            assert!(!top.join("made").exists());
            match code {
                Some(_) => assert!(text.contains("no folder was made"), "{text}"),
                None => assert_eq!(output.status.signal(), Some(9)),
            }
            assert_eq!(hidden(&top), usize::from(code.is_none()), "{name}");
            true
        });
        assert!(stopped, "{name} always came too late");
    }
    // The leftover of the killed run goes with the next one.
    if cfg!(target_os = "linux") {
        ends(&mut command, 0);
        assert!(top.join("made/noise").is_file());
        assert_eq!(hidden(&top), 0);
    }
    let [printed, _] = exits(&top, "unpack long.zip -o -made", 2);
    assert_eq!(printed, "", "a value that looks like an option");
    let [printed, _] = exits(&top, "unpack long.zip --output=-made", 0);
    assert_eq!(
        printed,
        "reflet render ./-made/scene.toml --variant=-dark -o picture.png\n"
    );
}

/// A signal ends the writing of a pack, and nothing of it stays.
#[cfg(unix)]
#[test]
fn a_signal_leaves_no_part_of_a_pack() {
    let top = show("pack-signal");
    let gltf = include_str!("pack/a_signal_leaves_no_part_of_a_pack.json");
    let mut bytes: Vec<u8> = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(noise(32));
    fs::write(top.join("long.bin"), bytes).expect("written");
    fs::write(top.join("long.gltf"), gltf).expect("written");
    let mut command = reflet(&top, "pack long.gltf -o long.zip");
    command.stderr(Stdio::piped());
    let stopped = (0..20).any(|_| {
        let mut child = command.spawn().expect("the program starts");
        // The first hidden file only tests whether the folder can be written to.
        while !top.join("long.zip").exists()
            && !has_begun(&top)
            && child.try_wait().expect("a child").is_none()
        {
            std::thread::yield_now();
        }
        signal(&child, "-TERM");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(hidden(&top), 0);
        if output.status.success() {
            fs::remove_file(top.join("long.zip")).expect("it is made");
            return false;
        }
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(143), "{text}");
        assert!(text.contains("no pack was written") && !top.join("long.zip").exists());
        true
    });
    assert!(stopped, "the signal always came too late");
}

/// Number of hidden files in a folder.
#[cfg(unix)]
fn hidden(folder: &Path) -> usize {
    let names = names(folder).into_iter();
    names.filter(|name| name.starts_with('.')).count()
}

/// Whether a hidden file in a folder has some content.
#[cfg(unix)]
fn has_begun(folder: &Path) -> bool {
    let mut entries = fs::read_dir(folder).expect("readable").flatten();
    entries.any(|entry| {
        let is_hidden = entry.file_name().to_string_lossy().starts_with('.');
        is_hidden && entry.metadata().is_ok_and(|metadata| metadata.len() > 0)
    })
}
