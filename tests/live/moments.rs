//! Motion blur of few sub-frames: pixels of one sub-frame show different moments of the open shutter.

use reflet::render::{Picture, PlaneData};

use crate::kit::*;

/// A ball that falls by 1.6 m while the shutter is open, before a wall and above a mirror.
const SCENE: &str = include_str!("moments/scene.toml");

/// A session at frame 1, in a folder of this name.
fn opened(name: &str, scene: &str, set: &[&str]) -> Session {
    let mut session = session(name, scene, set);
    session.pose(1).expect("poses");
    session
}

/// The picture after further settings.
fn picture(session: &mut Session, set: &[&str], aovs: &[&str]) -> Picture {
    session.set(set.iter().copied()).expect("is set");
    session.render(aovs).expect("renders")
}

/// Brightness of each pixel, with the column and row.
fn lit(picture: &Picture) -> impl Iterator<Item = ([usize; 2], f32)> {
    let width = picture.size[0] as usize;
    let pixels = picture.color.chunks_exact(4).enumerate();
    pixels.map(move |(i, pixel)| ([i % width, i / width], pixel[0]))
}

fn mean(picture: &Picture) -> f64 {
    lit(picture).map(|(_, value)| f64::from(value)).sum::<f64>() / picture.color.len() as f64 * 4.0
}

/// Root mean square of the difference of the means of 4 × 4 pixels.
fn blurred_difference(a: &Picture, b: &Picture) -> f64 {
    let mut sums = vec![0.0; a.color.len() / 16 + 1];
    let squares = a.size[0] as usize / 4;
    for (([x, y], a), (_, b)) in lit(a).zip(lit(b)) {
        sums[y / 4 * squares + x / 4] += f64::from(a - b) / 16.0;
    }
    (sums.iter().map(|sum| sum * sum).sum::<f64>() / sums.len() as f64).sqrt()
}

/// One sub-frame shows the whole streak, in the mirror too, and four show it smoothly: the average is closer to the
/// converged picture than with a moment for each sub-frame.
#[test]
fn few_samples_show_streaks_and_not_copies() {
    show_streaks(&["rt"]);
}

#[test]
#[ignore = "long: the same by other methods"]
fn few_samples_show_streaks_by_other_methods() {
    show_streaks(&["hybrid", "path"]);
}

fn show_streaks(methods: &[&str]) {
    or_skip!(gpu_or_skip());
    for method in methods {
        let set = format!("reflection.method={method:?}");
        let mut session = opened(&format!("streaks-{method}"), SCENE, &[&set]);
        let mut of = |set: &str| picture(&mut session, &[set], &[]);
        let [converged, four, one] =
            ["image.samples=32", "image.samples=4", "image.samples=1"].map(&mut of);
        let sharp = of("image.shutter=0");
        let [copies, streak] = [&sharp, &one].map(|p| blurred_difference(p, &converged));
        assert!(streak < 0.45 * copies, "{method}: {streak} of {copies}");
        let smooth = blurred_difference(&four, &converged);
        assert!(smooth < 0.5 * streak, "{method}: {smooth} of {streak}");
        let brightness = mean(&four) / mean(&converged);
        assert!((brightness - 1.0).abs() < 0.02, "{method}: {brightness}");
    }
}

/// AOVs belong to the frame's own moment, for all pixels, and statistics count all pixels.
#[test]
fn depth_and_counts_are_those_of_the_whole_picture() {
    or_skip!(gpu_or_skip());
    let mut session = opened("counts", SCENE, &["image.samples=2"]);
    for method in ["reflection.method=\"rt\"", "reflection.method=\"hybrid\""] {
        let aovs = ["depth", "ids", "normal"];
        let blurred = picture(&mut session, &[method, "image.shutter=1"], &aovs);
        let sharp = picture(&mut session, &["image.shutter=0"], &aovs);
        assert_ne!(blurred.color, sharp.color);
        assert_eq!(blurred.planes, sharp.planes, "{method}");
        let [blurred, sharp] = [&blurred, &sharp].map(|picture| picture.stats.shares.reflective);
        assert!(blurred.abs_diff(sharp) < 20, "{blurred} and {sharp}");
    }
}

/// A shadow map shows the moment of each sub-frame, as shadow rays do.
#[test]
fn shadow_maps_move_while_the_shutter_is_open() {
    or_skip!(gpu_or_skip());
    let lamp = "[light.lamp]\nkind = \"directional\"\ndirection = [0, 0, -1]\nintensity_lux = 3\n";
    let scene = format!("{SCENE}{lamp}shadow = \"map\"\nshadow_px = 512\n");
    let scene = scene.replace("emission = [1, 1, 1]", "");
    // Four moments in each sample.
    let set = ["reflection.method=\"rt\"", "image.samples=8"];
    let mut session = opened("shadow-moments", &scene, &set);
    let [map, ray] = ["light.lamp.shadow=map", "light.lamp.shadow=ray"]
        .map(|shadow| picture(&mut session, &[shadow], &[]));
    let difference = blurred_difference(&map, &ray);
    assert!(difference < 0.02, "{difference}");
}

/// Coverage adds up over moments, and pictures of odd sizes have all their pixels.
#[test]
fn alpha_and_odd_sizes_work_with_moments() {
    or_skip!(gpu_or_skip());
    let scene = SCENE.replace("size = [8, 8]", "size = [0.01, 0.01]");
    let scene = scene.replace("radius = 0.2", "radius = 0.7");
    let set = ["image.size=[47, 63]", "image.alpha=true"];
    let mut session = opened("alpha-moments", &scene, &set);
    let [few, many] = ["image.samples=3", "image.samples=64"]
        .map(|samples| picture(&mut session, &[samples], &[]));
    let covered = |p: &Picture| p.color.chunks_exact(4).map(|pixel| pixel[3]).sum::<f32>();
    let share = covered(&few) / covered(&many);
    assert!((share - 1.0).abs() < 0.05, "{share}");
    let ids = picture(&mut session, &["image.samples=1"], &["ids"]);
    assert!(matches!(&ids.planes[0].data, PlaneData::U32(ids) if ids.len() == 2 * 47 * 63));
}
