//! Light behind panes that a probe sees: rough surfaces find it by light samples as well, and it counts once.

use crate::kit::{gpu, mean, render};

/// A floor of metal, with a probe above it.
const SCENE: &str = r#"
version = 1
[camera.main]
eye = [0, 1.2, 2.2]
target = [0, 0, 0]
fov_deg = 20
[image]
size = [24, 16]
samples = 16
tone_map = "none"
[reflection]
roughness_cutoff = 1
glint_limit = 0
bounces = 4
[material.metal]
base_color = [1, 1, 1]
metallic = 1
[model.floor]
shape = { kind = "plane", size = [4, 4] }
material = "metal"
[[instance]]
model = "floor"
[probe.middle]
position = [0, 0.3, 0]
[probes]
lookup = "infinity"
face_px = 64
samples = 4
"#;

/// A case of glass around the floor and the probe that lets all light pass, or a share.
fn pane(share: f32) -> String {
    format!(
        "[material.pane]\nbase_color = [{share}, {share}, {share}]\nroughness = 0\ntransmission = 1\nreflectivity = 0\n\
         double_sided = true\n\
         [model.pane]\nshape = {{ kind = \"box\", size = [6, 6, 6] }}\nmaterial = \"pane\"\n\
         [[instance]]\nmodel = \"pane\"\n"
    )
}

const ROOM: &str = r#"
[environment]
zenith = [0, 0, 0]
horizon = [0, 0, 0]
ground = [0, 0, 0]
[material.glow]
base_color = [0, 0, 0]
reflectivity = 0
emission = [1, 1, 1]
light = true
double_sided = true
[model.room]
shape = { kind = "box", size = [8, 8, 8] }
material = "glow"
[[instance]]
model = "room"
"#;

const LAMP: &str = r#"
[environment]
zenith = [0, 0, 0]
horizon = [0, 0, 0]
ground = [0, 0, 0]
[light.lamp]
kind = "rect"
position = [0, 5, -5]
direction = [0, -1, 1]
size = [4, 4]
intensity_cd = 100
"#;

const SKY: &str = r#"
[environment]
zenith = [1, 1, 1]
horizon = [1, 1, 1]
ground = [1, 1, 1]
"#;

/// A case that lets all light pass changes nothing, and one that lets half pass leaves half, of a room that glows, of a lamp
/// with a size, and of the environment.
#[test]
fn light_behind_panes_counts_once() {
    check_panes(&[("room", ROOM)], &[0.7], &[0.5]);
}

#[test]
#[ignore = "long: each light, roughness and pane needs pipelines of its own"]
fn light_of_all_kinds_behind_panes_counts_once() {
    let lights = [("room", ROOM), ("lamp", LAMP), ("sky", SKY)];
    check_panes(&lights, &[0.0, 0.7], &[1.0, 0.5]);
}

/// Compares floors of these roughnesses in these lights with and without a case that lets these shares pass.
fn check_panes(lights: &[(&str, &str)], roughnesses: &[f32], shares: &[f32]) {
    let Some(gpu) = gpu() else { return };
    for ((name, light), roughness) in lights
        .iter()
        .flat_map(|light| roughnesses.iter().map(move |roughness| (light, roughness)))
    {
        let of = |pane: &str| {
            let set = [
                "reflection.method=probe",
                &format!("material.metal.roughness={roughness}"),
            ];
            mean(&render(gpu, &format!("{SCENE}{light}{pane}"), &set, &[]))[1]
        };
        let open = of("");
        assert!(open > 0.01, "{name}, roughness {roughness}: {open}");
        for share in shares {
            let seen = of(&pane(*share));
            assert!(
                (seen / (share * open) - 1.0).abs() < 0.03,
                "{name}, roughness {roughness}: {open} alone, {seen} behind a pane that lets {share} pass"
            );
        }
    }
}

/// A mirror floor shows what a pane reflects, 4 % of its light, where the maps have samples enough to choose it: with one
/// they follow what the pane lets through alone, which is black.
#[test]
fn maps_hold_what_panes_reflect_weakly() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("../../docs/data/probe-pane-reflection.toml");
    let of = |method: &str, samples: u32| {
        let set = [
            "image.size=[16, 9]",
            "probes.face_px=32",
            &format!("reflection.method={method}"),
            &format!("probes.samples={samples}"),
        ];
        mean(&render(gpu, text, &set, &[]))[1]
    };
    let truth = of("rt", 1);
    assert!(truth > 0.02, "{truth}");
    assert_eq!(of("probe", 1), 0.0);
    let seen = of("probe", 64);
    assert!(
        (seen / truth - 1.0).abs() < 0.1,
        "{truth} by rays, {seen} on the maps"
    );
}
