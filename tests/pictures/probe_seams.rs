//! Seams between probes: the CPU chooses the same probes as the look-up, and one probe alone leaves larger steps than
//! several.

use reflet::{
    bench::{
        score,
        score::{Reference, View},
        seams,
        seams::Looked,
    },
    render::methods::probes::{boxes::probe_boxes, choice::ProbeChoice},
    scene::desc::ReflectionDesc,
};

use crate::kit::*;

/// A mirror below panels that glow red, green and blue, seen from straight above; above each probe is one panel.
const PANELS: &str = include_str!("probe_seams/panels.toml");

#[test]
fn the_cpu_chooses_the_probes_that_the_look_up_shows() {
    let Some(gpu) = gpu() else { return };
    for nearest in 1..=4 {
        let nearest_set = format!("probes.nearest={nearest}");
        let set = ["reflection.method=probe", nearest_set.as_str()];
        let picture = render(gpu, PANELS, &set, &[]);
        let (desc, world) = scene(PANELS, &set);
        let settings = RenderOptions::for_scene(&desc).reflection.probes;
        let boxes = probe_boxes(&world, &settings, 1.0).expect("three boxes");
        let mut blended = 0;
        for (x, y) in (0..36).flat_map(|y| (0..64).map(move |x| (x, y))) {
            // A pixel is 1 / 9 m wide; the picture's lower edge is nearer to the reader, at larger z.
            let [right, down] = [x - 32, y - 18].map(|i| (i as f32 + 0.5) / 9.0);
            let point = Vec3::new(right, 0.0, down);
            let choice = ProbeChoice::at_point(&boxes, point, nearest);
            let mut expected = [0.0; 3];
            for (probe, weight) in choice.probes.iter().zip(choice.weights) {
                let channel = world.probes[*probe as usize].name.as_str();
                let channel = ["red", "green", "blue"].iter().position(|c| *c == channel);
                expected[channel.expect("a color")] += 0.8 * weight;
            }
            blended += usize::from(choice.weights[1] > 0.1);
            let found = color(&picture, x as u32, y as u32);
            let is_near = found
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 4e-3);
            assert!(
                is_near,
                "K = {nearest}, {point}: {found:?}, not {expected:?}"
            );
        }
        assert!(nearest == 1 || blended > 300, "K = {nearest}: {blended}");
    }
}

/// Step along the seams of `scenes/fail/30-probe-seams.toml`.
fn step(set: &[&str]) -> Option<f64> {
    const SEAMS: &str = include_str!("../../scenes/fail/30-probe-seams.toml");
    let gpu = gpu()?;
    let file = Path::new("scenes/fail/30-probe-seams.toml");
    let all = [&["image.size=[96, 54]", "probes.face_px=32"], set].concat();
    let (desc, world) = scene_of(file, SEAMS, &all);
    let camera = &world.cameras[0].value;
    let planes = [&score::PLANES[..], &seams::PLANES].concat();
    let shown = |method: Method| {
        let mut desc = desc.clone();
        desc.reflection.method = method;
        let mut renderer = renderer(gpu, &desc, &world, false);
        or_panic!(renderer.picture(gpu, camera, &planes))
    };
    let truth = shown(Method::Rt);
    let picture = shown(Method::Probe);
    let settings = ReflectionDesc {
        method: Method::Probe,
        ..desc.reflection
    };
    let looked = Looked {
        world: &world,
        camera,
        settings: &settings,
        picture: &picture,
    };
    let view = View::new(&picture, picture.size).expect("finite pixels");
    let reference = Reference::new(&truth).expect("a reference");
    looked.seam_step(&view, &reference)
}

#[test]
fn one_probe_alone_steps_and_several_hardly_do_but_objects_step_at_joints() {
    let one = or_skip!(step(&["probes.nearest=1"]));
    let by = |set: &[&str]| step(set).expect("borders");
    let four = by(&["probes.nearest=4"]);
    assert!(one > 10.0 && four.abs() < 0.3 * one, "{one} and {four}");
    let [one, four] = ["probes.nearest=1", "probes.nearest=4"]
        .map(|nearest| by(&[nearest, "probes.select=instance"]));
    assert!(
        one > 10.0 && four > 0.4 * one,
        "{one} and {four} by instance"
    );
    // With one probe there is no border.
    let alone = step(&[
        "probes.nearest=1",
        "probes.lookup=infinity",
        "probe.front_left.box_max=[40, 30, 35]",
        "probe.front_left.box_min=[-40, -30, -35]",
    ]);
    assert_eq!(alone, None);
}
