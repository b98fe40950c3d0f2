//! Reuse of the picture's light visibility at hits.

use crate::kit::*;

/// A shiny floor under a ball and a pillar, with lights whose shadows cross.
fn scene_with(lights: usize) -> String {
    let mut text = String::from(include_str!("light_reuse/scene_with.toml"));
    for i in 0..lights {
        let angle = i as f32 * 2.4;
        let (x, z) = (2.0 * angle.cos(), 1.5 + angle.sin());
        let intensity = 20.0 / lights as f32;
        text += &format!(
            "[light.l{i}]\nkind = \"point\"\nshadow = \"ray\"\n\
             position = [{x}, 2.5, {z}]\nintensity_cd = {intensity}\n"
        );
    }
    text
}

const ANEW: &str = "reflection.reuse_light=false";

/// Number of BVH traversals of the trace pass of one counted frame.
fn traversals(text: &str, set: &[&str]) -> u64 {
    let Some(gpu) = gpu() else { return 0 };
    let (desc, world): (_, World) = scene(text, set);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let counts = or_panic!(renderer.counts(gpu, &world.cameras[0].value));
    let of = counts.iter().find(|c| c.pass == "trace");
    of.expect("a pass that counts").counts.traversals
}

#[test]
fn shadows_in_reflections_are_the_same_for_less_work() {
    let Some(gpu) = gpu() else { return };
    let text = scene_with(4);
    for method in ["hybrid", "rt", "ssr"] {
        let method = format!("reflection.method={method}");
        let reused = render(gpu, &text, &[&method], &[Aov::Cause]);
        let anew = render(gpu, &text, &[&method, ANEW], &[Aov::Cause]);
        // Only details smaller than a pixel may be lost.
        let differing = share_differing(&reused, &anew, 2);
        assert!(differing < 1e-3, "{method}: {differing}");
    }
    for method in ["hybrid", "rt"] {
        let method = format!("reflection.method={method}");
        let reused = traversals(&text, &[&method]);
        let anew = traversals(&text, &[&method, ANEW]);
        assert!(
            reused * 4 < anew * 3 && anew > 1000,
            "{method}: {reused} of {anew}"
        );
    }
}

#[test]
fn lights_past_the_32nd_are_followed_anew() {
    let Some(gpu) = gpu() else { return };
    let text = scene_with(40);
    let reused = render(gpu, &text, &["image.size=[96, 54]"], &[]);
    let anew = render(gpu, &text, &["image.size=[96, 54]", ANEW], &[]);
    assert!(share_differing(&reused, &anew, 2) < 1e-3);
}

/// The camera sees the lit side of a thin sheet, the mirror behind it the dark one: both are at the
/// same position.
#[test]
fn the_other_side_of_a_sheet_lends_nothing() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("light_reuse/the_other_side_of_a_sheet_lends_nothing.toml");
    for method in ["reflection.method=hybrid", "reflection.method=rt"] {
        let reused = render(gpu, text, &[method], &[]);
        let anew = render(gpu, text, &[method, ANEW], &[]);
        assert_eq!(reused.display, anew.display, "{method}");
    }
}
