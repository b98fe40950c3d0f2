//! The second depth layer of the march: its answers equal `rt`, and scenes without it are as before.

use crate::kit::*;

/// A board that hangs above a mirror hides the part of the wall that the mirror behind it shows.
const SCENE: &str = include_str!("second_layer/scene.toml");

const AOVS: [Aov; 4] = [Aov::Cause, Aov::HitDistance, Aov::HitIds, Aov::Reflection];

fn shown(text: &str, set: &[&str]) -> Option<Picture> {
    Some(render(gpu()?, text, set, &AOVS))
}

fn count(picture: &Picture, cause: Cause) -> usize {
    let causes = integers(picture, Aov::Cause).iter();
    causes.filter(|found| **found == cause as u32).count()
}

/// Number of pixels that the second layer answers, of answers whose light is not the ray's, and of answers whose hit is
/// not.
fn answered(picture: &Picture, truth: &Picture) -> [usize; 3] {
    let causes = integers(picture, Aov::Cause).iter().enumerate();
    let behind = causes.filter(|(_, cause)| **cause == Cause::HitBehind as u32);
    let mut counts = [0; 3];
    for (i, _) in behind {
        let ids = |p: &Picture| integers(p, Aov::HitIds)[2 * i..2 * i + 2].to_vec();
        let distance_m = |p: &Picture| floats(p, Aov::HitDistance)[i];
        let light = |p: &Picture| floats(p, Aov::Reflection)[3 * i..3 * i + 3].to_vec();
        let (lit, expected) = (light(picture), light(truth));
        let apart = lit.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        let is_lit_alike = apart.fold(0.0, f32::max) < 2e-3;
        let is_met =
            ids(picture) == ids(truth) && (distance_m(picture) - distance_m(truth)).abs() < 1e-3;
        counts[0] += 1;
        counts[1] += usize::from(!is_lit_alike);
        counts[2] += usize::from(!is_met);
    }
    counts
}

#[test]
fn what_the_board_hides_is_found_behind_it() {
    for visibility in ["image.visibility=raster", "image.visibility=rays"] {
        let set = [visibility, "reflection.separation_m=0.2"];
        let with = |further: &[&str]| shown(SCENE, &[&set, further].concat());
        let truth = or_skip!(with(&["reflection.method=rt"]));
        let one = with(&["reflection.method=hybrid"]).expect("a GPU");
        let two = with(&["reflection.method=hybrid", "reflection.layers=2"]).expect("a GPU");
        let hidden = count(&one, Cause::Hidden);
        assert!(
            hidden > 400 && count(&one, Cause::HitBehind) == 0,
            "{hidden}"
        );
        let [answers, unlike, wrong] = answered(&two, &truth);
        assert!(answers * 10 > hidden * 8, "{answers} of {hidden}");
        assert_eq!([unlike, wrong], [0, 0], "of {answers}");
        assert!(two.stats.rays + 300 < one.stats.rays);
        let second = two.stats.second_layer.expect("rays go behind the board");
        assert_eq!(second.behind as usize, hidden);
        assert_eq!(second.hits as usize, answers);
        assert_eq!(one.stats.second_layer, None);

        // `ssr` shows black there with one layer. Its hits are up to a pixel away, at edges of the wall too.
        let ssr = with(&["reflection.method=ssr", "reflection.layers=2"]).expect("a GPU");
        let [answers, unlike, _] = answered(&ssr, &truth);
        assert!(answers * 10 > hidden * 8, "{answers} of {hidden}");
        assert!(unlike * 3 < answers, "{unlike} of {answers}");
    }
}

#[test]
fn layers_farther_apart_than_the_scene_is_large_answer_nothing() {
    let with = |set: &[&str]| shown(SCENE, &[&["reflection.method=hybrid"], set].concat());
    let Some(one) = with(&[]) else { return };
    let far = with(&["reflection.layers=2", "reflection.separation_m=1e6"]).expect("a GPU");
    assert_eq!(one.display, far.display);
    assert_eq!(integers(&one, Aov::Cause), integers(&far, Aov::Cause));
    // Without a separation the second layer is the far side of the board.
    let near = with(&["reflection.layers=2", "reflection.separation_m=0"]).expect("a GPU");
    let truth = with(&["reflection.method=rt"]).expect("a GPU");
    assert_eq!(answered(&near, &truth)[1..], [0, 0]);
}

/// Number of hits on the screen, and of those where the ray hits something else.
fn hits(picture: &Picture, truth: &Picture) -> [usize; 2] {
    let mut counts = [0; 2];
    for (i, cause) in integers(picture, Aov::Cause).iter().enumerate() {
        let is_hit = [Cause::Hit, Cause::HitBehind].map(|hit| hit as u32);
        if !is_hit.contains(cause) {
            continue;
        }
        let [found, meant] = [picture, truth].map(|p| integers(p, Aov::HitIds)[2 * i]);
        let [found_m, true_m] = [picture, truth].map(|p| floats(p, Aov::HitDistance)[i]);
        counts[0] += 1;
        counts[1] += usize::from(found != meant || (found_m - true_m).abs() > 0.01 * true_m);
    }
    counts
}

#[test]
fn the_second_layer_adds_hits_and_hardly_any_wrong_ones() {
    const ATRIUM: &str = include_str!("../../scenes/atrium.toml");
    let with = |set: &[&str]| shown(ATRIUM, &[&["image.size=[160, 90]"], set].concat());
    let truth = or_skip!(with(&["reflection.method=rt"]));
    let of = |set: &[&str]| hits(&with(set).expect("a GPU"), &truth);
    let [one, one_wrong] = of(&["reflection.method=hybrid"]);
    let [two, two_wrong] = of(&["reflection.method=hybrid", "reflection.layers=2"]);
    assert!(two >= one + 20, "{one} and {two} hits");
    assert!(
        two_wrong <= one_wrong + 1,
        "{one_wrong} and {two_wrong} are wrong"
    );
}
