//! Numbers of sub-frames that an error bound takes: `samples = { error = … }`.

use std::{fs, path::Path};

use super::{open, with_set};
use crate::common::{assert_says, folder::kept_folder, gpu_or_skip, program::exits};

/// A wide lamp behind a post, whose shadow is soft: every sub-frame is grainy. The lamp turns up in the second frame.
const SCENE: &str = include_str!("error_bound/scene.toml");

fn folder(name: &str) -> std::path::PathBuf {
    kept_folder(&format!("error-bound-{name}"), &[("scene.toml", SCENE)])
}

/// Largest error of a tile of 16 × 16 pixels against a picture of many sub-frames, as the bound counts it.
fn true_error(color: &[f32], truth: &[f32], width: usize) -> f32 {
    let mut tiles = [0.0_f32; 4];
    for (index, (found, want)) in color.chunks(4).zip(truth.chunks(4)).enumerate() {
        let difference: f32 = (0..3).map(|c| (found[c] - want[c]).abs()).sum();
        let brightness: f32 = want[..3].iter().sum();
        let tile = index / width / 16 * 2 + index % width / 16;
        tiles[tile] += difference / brightness.max(1e-4).sqrt() / 256.0;
    }
    tiles.into_iter().fold(0.0, f32::max)
}

#[test]
fn the_error_is_within_the_bound_and_the_count_makes_the_same_picture() {
    or_skip!(gpu_or_skip());
    let folder = folder("estimate");
    let mut session = open(&folder, &with_set(&[])).expect("it opens");
    let found = session.render(&["depth"]).expect("it renders");
    let estimate = found.stats.error.expect("an estimate").error;
    assert!(estimate <= 0.006, "{estimate}");
    let count = found.stats.samples;
    assert!((17..400).contains(&count), "{count}");
    session.set(["image.samples=1024"]).expect("it is set");
    let truth = session.render(&[]).expect("it renders");
    assert_eq!(truth.stats.error, None, "a written number is not estimated");
    let error = true_error(&found.color, &truth.color, 32);
    // Both halves are spread evenly, so the whole is better than two random halves tell.
    assert!(
        error < estimate * 1.2 && error > estimate * 0.2,
        "{error}, {estimate}"
    );

    let counted = format!("image.samples={count}");
    session.set([counted]).expect("it is set");
    let counted = session.render(&["depth"]).expect("it renders");
    assert!(counted.color == found.color && counted.display == found.display);
    assert!(counted.planes == found.planes);

    session
        .set(["image.samples={ error = 0.0005, at_most = 20 }"])
        .expect("it is set");
    let stopped = session.render(&[]).expect("it renders").stats;
    assert_eq!(stopped.samples, 20);
    assert!(
        stopped
            .error
            .is_some_and(|estimate| estimate.error > 0.0005)
    );
}

fn render(folder: &Path, args: &[&str]) -> String {
    let [_, said] = exits(folder, [&["render", "scene.toml"], args].concat(), 0);
    said
}

#[test]
fn files_hold_the_count_of_each_frame_alone() {
    or_skip!(gpu_or_skip());
    let folder = folder("files");
    let read = |name: &str| fs::read(folder.join(name)).expect(name);
    let said = render(&folder, &["-o", "bound.png"]);
    let (count, rest) = said.split_once(" samples, error ").expect(&said);
    assert!(rest.contains("(`error = 0.006`)"), "{said}");
    render(&folder, &["-o", "counted.png", "--samples", count]);
    assert!(read("bound.png") == read("counted.png"));
    let is_named =
        |bytes: &[u8], text: &str| bytes.windows(text.len()).any(|w| w == text.as_bytes());
    assert!(is_named(
        &read("bound.png"),
        &format!("reflet-samples\0{count}")
    ));

    // The second frame is brighter, so the same share of grain is a larger error.
    render(&folder, &["-o", "all.#.png", "--frames", "0-1"]);
    render(&folder, &["-o", "alone.#.png", "--frames", "1"]);
    assert!(read("all.1.png") == read("alone.1.png"));
    let first = format!("reflet-samples\0{count}");
    assert!(is_named(&read("all.0.png"), &first) && !is_named(&read("all.1.png"), &first));

    let bound = "image.samples={ error = 0.0005, at_most = 18 }";
    let said = render(
        &folder,
        &["-o", "short.#.png", "--frames", "1", "--set", bound],
    );
    let advice = [
        "frame 1: warning: 18 samples leave an error of",
        "`--denoise`",
    ];
    assert_says(&said, &advice);
}
