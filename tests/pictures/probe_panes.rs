//! Light behind panes that a probe sees: rough surfaces find it by light samples as well, and it counts once.

use crate::kit::*;

/// A floor of metal, with a probe above it.
const SCENE: &str = include_str!("probe_panes/scene.toml");

/// A case of glass around the floor and the probe that lets all light pass, or a share.
fn pane(share: f32) -> String {
    format!(
        "[material.pane]\nbase_color = [{share}, {share}, {share}]\nroughness = 0\ntransmission = 1\nreflectivity = 0\n\
         double_sided = true\n\
         [model.pane]\nshape = {{ kind = \"box\", size = [6, 6, 6] }}\nmaterial = \"pane\"\n\
         [[instance]]\nmodel = \"pane\"\n"
    )
}

const ROOM: &str = include_str!("probe_panes/room.toml");

const LAMP: &str = include_str!("probe_panes/lamp.toml");

const SKY: &str = include_str!("probe_panes/sky.toml");

/// A case that lets all light pass changes nothing, and one that lets half pass leaves half, of a room that glows, of a
/// lamp with a size, and of the environment.
#[test]
fn light_behind_panes_counts_once() {
    // Each light, roughness and pane needs pipelines of its own.
    let lights = [("room", ROOM), ("lamp", LAMP), ("sky", SKY)];
    check_panes(
        first_or_all(&lights, 1),
        first_or_all(&[0.7, 0.0], 1),
        first_or_all(&[0.5, 1.0], 1),
    );
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

/// A mirror floor shows what a pane reflects, 4 % of its light, where the maps have samples enough to choose it: with
/// one they follow what the pane lets through alone, which is black.
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
