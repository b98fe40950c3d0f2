//! Tests of picture files: contents and atomic writing.

use std::{
    fs,
    path::{Path, PathBuf},
};

use ::exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
use tempfile::TempDir;

use super::picture_file::PictureFile;
use crate::error::OutputError;
use reflet_base::files::{Goal, Temporary};
use reflet_render::{
    Picture, Plane, PlaneData,
    picture::tone_map::Tone,
    renderer::stats::{FrameStats, Shares},
};
use reflet_scene::desc::Method;

fn goal(path: impl Into<PathBuf>) -> Goal {
    Goal::typed(path.into())
}

/// A new folder, the path of a file in it, and the file as an output.
fn output(name: &str) -> (TempDir, PathBuf, PictureFile) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    let output = PictureFile::new(&goal(path.clone())).expect("writable");
    (folder, path, output)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("readable").flatten();
    let names = entries.map(|entry| entry.file_name().into_string().expect("UTF-8"));
    let mut names: Vec<_> = names.collect();
    names.sort();
    names
}

fn picture() -> Picture {
    Picture {
        alpha: false,
        size: [2, 1],
        color: vec![0.25, 4.0, -1.0, 1.0, 0.5, 0.0, 1e-4, 1.0],
        display: vec![10, 20, 30, 255, 40, 50, 60, 255],
        tone: Tone::default(),
        guides: Vec::new(),
        planes: vec![Plane {
            name: "cause".into(),
            channels: &["cause"],
            data: PlaneData::U32(vec![0, 7]),
        }],
        stats: FrameStats {
            size: [2, 1],
            samples: 1,
            method: Method::Hybrid,
            unit_m: 1.0,
            shares: Shares::new(&[], [2, 1], Method::Hybrid),
            ..FrameStats::default()
        },
    }
}

#[test]
fn a_png_and_its_planes_are_written_whole() {
    let (folder, path, output) = output("out.png");
    assert!(names(folder.path()).is_empty(), "checking leaves nothing");
    output.write(&picture()).expect("written");
    output.write(&picture()).expect("written over");
    assert_eq!(names(folder.path()), ["out.cause.png", "out.png"]);
    let read = image::open(path).expect("a PNG").into_rgb8();
    assert_eq!(read.into_raw(), [10, 20, 30, 40, 50, 60]);
}

#[test]
fn an_exr_keeps_floats_and_codes() {
    let (folder, path, output) = output("out.EXR");
    output.write(&picture()).expect("written");
    assert_eq!(names(folder.path()), ["out.EXR"]);
    let read = read_first_flat_layer_from_file(&path).expect("an EXR");
    let channels = &read.layer_data.channel_data.list;
    let found: Vec<_> = channels.iter().map(|c| c.name.to_string()).collect();
    assert_eq!(found, ["A", "B", "G", "R", "cause.cause"]);
    let values: Vec<f32> = channels[1].sample_data.values_as_f32().collect();
    assert_eq!(values, [-1.0, 1e-4]);
    assert!(matches!(&channels[4].sample_data, FlatSamples::U32(codes) if codes == &[0, 7]));
}

#[test]
fn an_exr_that_was_cut_or_changed_is_not_done() {
    let (_folder, path, output) = output("out.exr");
    let side = 64;
    let texels = (side * side) as usize;
    let picture = Picture {
        size: [side, side],
        color: (0..texels * 4).map(|i| (i * i % 8191) as f32).collect(),
        display: vec![9; texels * 4],
        planes: Vec::new(),
        ..picture()
    };
    output
        .write_marked(&picture, Some("mark"))
        .expect("written");
    assert!(output.is_done(&[], "mark") && !output.is_done(&[], "other"));
    let whole = fs::read(&path).expect("it is there");
    let is_done = |bytes: &[u8]| {
        fs::write(&path, bytes).expect("writable");
        output.is_done(&[], "mark")
    };
    assert!(is_done(&whole));
    assert!(!is_done(&whole[..whole.len() - 200]), "cut");
    let mut changed = whole.clone();
    let from = whole.len() - 700;
    changed[from..from + 280]
        .iter_mut()
        .for_each(|b| *b ^= 0x55);
    assert!(!is_done(&changed), "changed");
}

#[test]
fn failed_output_leaves_no_file() {
    let (folder, path, output) = output("out.png");
    // A folder blocks the second file's temporary name: that fails after the first file is complete.
    let hidden = Temporary::create(&goal(path.with_file_name("out.cause.png")));
    let obstacle = hidden.expect("creatable").path().to_owned();
    fs::create_dir(&obstacle).expect("folder");
    let error = output.write(&picture()).expect_err("unwritable plane");
    assert!(
        matches!(&error, OutputError::Internal(text)
            if text.starts_with("cannot write") && text.contains("out.cause.png")),
        "{error:?}"
    );
    let obstacle = obstacle.file_name().expect("a name").to_string_lossy();
    assert_eq!(names(folder.path()), [obstacle]);
}

#[test]
fn a_transparent_background_is_in_the_file() {
    let (_folder, path, output) = output("out.png");
    let mut transparent = Picture {
        alpha: true,
        ..picture()
    };
    transparent.display[3] = 64;
    output.write(&transparent).expect("written");
    let read = image::open(path).expect("a PNG");
    let image::DynamicImage::ImageRgba8(read) = read else {
        panic!("the PNG has no alpha");
    };
    assert_eq!(read.into_raw(), transparent.display);
}

/// Neither a hash map nor threads may decide the order of an EXR's attributes and compressed blocks.
#[test]
fn the_bytes_of_a_picture_are_the_same_every_time() {
    let [width, height] = [96, 54];
    let count = (width * height) as usize;
    let planes = vec![Plane {
        name: "depth".into(),
        channels: &["Z"],
        data: PlaneData::F32((0..count).map(|i| (i as f32).sqrt()).collect()),
    }];
    let picture = Picture {
        size: [width, height],
        color: (0..4 * count).map(|i| (i as f32).sin()).collect(),
        display: (0..4 * count).map(|i| i as u8).collect(),
        planes,
        ..picture()
    };
    for ending in ["png", "exr"] {
        let (_folder, path, output) = output(&format!("out.{ending}"));
        let mut first = None;
        for run in 0..30 {
            output
                .write_marked(&picture, Some("0123456789abcdef"))
                .expect("written");
            let bytes = fs::read(&path).expect("there");
            assert!(output.is_done(&[], "0123456789abcdef"), "{ending}");
            let first = first.get_or_insert_with(|| bytes.clone());
            assert!(*first == bytes, "{ending}: run {run} is another");
        }
    }
}
