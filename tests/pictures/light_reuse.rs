//! Reuse of the picture's light visibility at hits.

use reflet::{render::picture::aov::Aov, world::World};

use crate::kit::{gpu, render, renderer, scene, share_differing};

/// A shiny floor under a ball and a pillar, with lights whose shadows cross.
fn scene_with(lights: usize) -> String {
    let mut text = String::from(
        r#"
version = 1
[camera.main]
eye = [0, 1.6, 4]
target = [0, 0.4, 0]
[image]
size = [160, 90]
[environment]
color = [0.2, 0.2, 0.25]
[material.floor]
base_color = [0.3, 0.3, 0.3]
roughness = 0.05
reflectivity = 0.3
[material.wall]
base_color = [0.8, 0.6, 0.4]
[model.floor]
shape = { kind = "plane", size = [8, 8] }
material = "floor"
[model.wall]
shape = { kind = "box", size = [6, 3, 0.2] }
material = "wall"
[model.pillar]
shape = { kind = "cylinder", radius = 0.2, height = 1.5, segments = 24 }
material = "wall"
[[instance]]
model = "floor"
[[instance]]
model = "wall"
translation = [0, 1.5, -1.5]
[[instance]]
model = "pillar"
translation = [0.6, 0.75, -0.4]
"#,
    );
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

/// Number of BVH traversals of one counted frame, by pass.
fn traversals(text: &str, set: &[&str], pass: &str) -> u64 {
    let Some(gpu) = gpu() else { return 0 };
    let (desc, world): (_, World) = scene(text, set);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let counts = renderer.counts(gpu, &world.cameras[0].value);
    let counts = counts.unwrap_or_else(|e| panic!("{e}"));
    let of = counts.iter().find(|c| c.pass == pass);
    of.expect("a pass that counts").counts.traversals
}

#[test]
fn shadows_in_reflections_are_the_same_for_less_work() {
    let Some(gpu) = gpu() else { return };
    let text = scene_with(4);
    for method in ["hybrid", "rt", "ssr"] {
        let method = format!("reflection.method={method}");
        let lent = render(gpu, &text, &[&method], &[Aov::Cause]);
        let anew = render(gpu, &text, &[&method, ANEW], &[Aov::Cause]);
        // Only details smaller than a pixel may be lost.
        let differing = share_differing(&lent, &anew, 2);
        assert!(differing < 1e-3, "{method}: {differing}");
    }
    for (method, pass) in [("hybrid", "hits"), ("rt", "trace")] {
        let method = format!("reflection.method={method}");
        let lent = traversals(&text, &[&method], pass);
        let anew = traversals(&text, &[&method, ANEW], pass);
        assert!(
            lent * 4 < anew * 3 && anew > 1000,
            "{method}: {lent} of {anew}"
        );
    }
}

#[test]
fn lights_past_the_32nd_are_followed_anew() {
    let Some(gpu) = gpu() else { return };
    let text = scene_with(40);
    let lent = render(gpu, &text, &["image.size=[96, 54]"], &[]);
    let anew = render(gpu, &text, &["image.size=[96, 54]", ANEW], &[]);
    assert!(share_differing(&lent, &anew, 2) < 1e-3);
}

/// The camera sees the lit side of a thin sheet, the mirror behind it the dark one: both are at the
/// same position.
#[test]
fn the_other_side_of_a_sheet_lends_nothing() {
    let Some(gpu) = gpu() else { return };
    let text = r#"
version = 1
[camera.main]
eye = [1.2, 0.8, 3]
target = [0, 0.3, 0]
[image]
size = [160, 90]
[material.sheet]
base_color = [1, 1, 1]
double_sided = true
[material.mirror]
base_color = [1, 1, 1]
metallic = 1
roughness = 0
reflection = "mirror"
[model.sheet]
shape = { kind = "plane", size = [1, 1] }
material = "sheet"
[model.mirror]
shape = { kind = "plane", size = [6, 6] }
material = "mirror"
[[instance]]
model = "sheet"
translation = [0, 0.3, 0]
rotation_deg = [70, 0, 0]
[[instance]]
model = "mirror"
translation = [0, 0, -1]
rotation_deg = [90, 0, 0]
[light.front]
kind = "point"
shadow = "ray"
position = [0, 1.5, 3]
intensity_cd = 20
"#;
    for method in ["reflection.method=hybrid", "reflection.method=rt"] {
        let lent = render(gpu, text, &[method], &[]);
        let anew = render(gpu, text, &[method, ANEW], &[]);
        assert_eq!(lent.display, anew.display, "{method}");
    }
}
