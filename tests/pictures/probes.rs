//! Reflections that are looked up in probes.

use reflet::scene::desc::Lookup;

use crate::kit::*;

/// Colors of the walls of a room: +X, -X, +Z, -Z, ceiling.
pub const WALLS: [[f32; 3]; 5] = [
    [0.8, 0.2, 0.1],
    [0.1, 0.7, 0.2],
    [0.2, 0.3, 0.9],
    [0.7, 0.6, 0.1],
    [0.5, 0.5, 0.5],
];

/// A room of 8 × 4 × 8 m whose walls glow in these colors, with a floor that mirrors, and a probe in its middle.
pub fn room(colors: [[f32; 3]; 5]) -> String {
    let places = [
        ("[4, 2, 0]", "[0, 0, 90]", "[4, 8]"),
        ("[-4, 2, 0]", "[0, 0, -90]", "[4, 8]"),
        ("[0, 2, 4]", "[-90, 0, 0]", "[8, 4]"),
        ("[0, 2, -4]", "[90, 0, 0]", "[8, 4]"),
        ("[0, 4, 0]", "[180, 0, 0]", "[8, 8]"),
    ];
    let mut text = include_str!("probes/room.toml").to_owned();
    for (k, ((at, turn, size), color)) in places.iter().zip(colors).enumerate() {
        text.push_str(&format!(
            "[material.wall{k}]\nbase_color = [0, 0, 0]\nreflectivity = 0\nemission = {color:?}\n\
             [model.wall{k}]\nshape = {{ kind = \"plane\", size = {size} }}\nmaterial = \"wall{k}\"\n\
             [[instance]]\nmodel = \"wall{k}\"\ntranslation = {at}\nrotation_deg = {turn}\n"
        ));
    }
    text
}

fn by(text: &str, set: &[&str], aovs: &[Aov]) -> Option<Picture> {
    Some(render(gpu()?, text, set, aovs))
}

/// The mirror shows the wall that its ray meets: a box of the room's shape finds the place exactly, up to the pixels of
/// the map at edges between walls; the ray's direction alone does not.
#[test]
fn a_box_look_up_in_a_box_shows_what_a_mirror_shows() {
    let text = room(WALLS);
    let aovs = [Aov::HitDistance];
    let rt = or_skip!(by(&text, &["reflection.method=rt"], &aovs));
    let of = |lookup: &str| {
        let set = [
            "reflection.method=probe",
            &format!("probes.lookup={lookup}"),
        ];
        by(&text, &set, &aovs).expect("a GPU")
    };
    let truth = floats(&rt, Aov::HitDistance);
    for (lookup, most_wrong) in [("box", 0.03), ("distance", 0.03)] {
        let picture = of(lookup);
        let wrong = share_differing(&picture, &rt, 2);
        assert!(wrong < most_wrong, "{lookup}: {wrong}");
        // A pixel of the map is 2 / 64 of the distance to its face, and seen at a slant.
        let found = floats(&picture, Aov::HitDistance);
        let pairs = found
            .iter()
            .zip(truth)
            .filter(|(_, truth)| truth.is_finite());
        let far = pairs
            .clone()
            .filter(|(found, truth)| (*found - *truth).abs() > 0.15);
        let (far, all) = (far.count(), pairs.count());
        assert!(
            all > 800 && far * 50 < all,
            "{lookup}: {far} of {all} hits are elsewhere"
        );
    }
    let wrong = share_differing(&of("infinity"), &rt, 2);
    assert!(wrong > 0.1, "infinity: {wrong}");
}

/// A capture of so many paths that it is dispatched face by face has all faces.
#[test]
#[ignore = "long: faces of 1,024 pixels"]
fn a_capture_in_parts_shows_what_one_in_a_piece_shows() {
    let of = |size: &str| {
        by(
            &room(WALLS),
            &["reflection.method=probe", "probes.lookup=box", size],
            &[],
        )
    };
    let whole = or_skip!(of("probes.face_px=512"));
    let parts = of("probes.face_px=1024").expect("a GPU");
    let wrong = share_differing(&parts, &whole, 2);
    assert!(wrong < 0.02, "{wrong}");
}

/// In a room of one color every probe shows it, so that the sum of the weights is the brightness.
#[test]
fn weights_of_probes_sum_to_one() {
    let text = room([[0.2, 0.5, 0.8]; 5]);
    let boxes = "[probe.left]\nposition = [-2, 1, 0]\nbox_min = [-4, 0, -4]\nbox_max = [1, 4, 4]\n\
                 [probe.near]\nposition = [2, 1, 2]\nbox_min = [-1, 0, -1]\nbox_max = [4, 4, 4]\n\
                 [probe.away]\nposition = [3, 3, -3]\nbox_min = [2, 2, -4]\nbox_max = [4, 4, -2]\n";
    let text = format!("{text}{boxes}");
    for set in [
        "probes.nearest=1",
        "probes.nearest=2",
        "probes.nearest=4",
        "probes.spacing_m=3",
        "probes.select=instance",
    ] {
        let picture = or_skip!(by(&text, &["reflection.method=probe", set], &[]));
        for (x, y) in [(5, 30), (32, 20), (60, 35), (32, 35)] {
            assert_color(&picture, x, y, [0.2, 0.5, 0.8], 2e-3);
        }
    }
}

/// Where probes meet, one alone leaves a step and two blended ones do not: the floor shows the ceiling above the probe,
/// which has one color above each.
#[test]
fn blended_probes_have_no_seam() {
    let mut text = room([[0.0; 3]; 5]).replace("[probe.middle]\nposition = [0, 2, 0]\n", "");
    for (name, x, color) in [
        ("left", -2.0, [0.8, 0.1, 0.1]),
        ("right", 2.0, [0.1, 0.1, 0.8]),
    ] {
        let (low, high) = (x - 3.0, x + 3.0);
        text.push_str(&format!(
            "[probe.{name}]\nposition = [{x}, 1, 0]\nbox_min = [{low}, 0, -4]\nbox_max = [{high}, 4, 4]\n\
             [material.{name}]\nbase_color = [0, 0, 0]\nreflectivity = 0\nemission = {color:?}\n\
             [model.{name}]\nshape = {{ kind = \"plane\", size = [4, 8] }}\nmaterial = \"{name}\"\n\
             [[instance]]\nmodel = \"{name}\"\ntranslation = [{x}, 3.9, 0]\nrotation_deg = [180, 0, 0]\n"
        ));
    }
    let view = [
        "reflection.method=probe",
        "probes.lookup=infinity",
        "camera.main.eye=[0, 2, 0.5]",
        "camera.main.target=[0, 0, 0.4]",
        "camera.main.fov_deg=30",
    ];
    let step = |nearest: u32| {
        let nearest = format!("probes.nearest={nearest}");
        let set: Vec<&str> = view.iter().copied().chain([nearest.as_str()]).collect();
        let picture = by(&text, &set, &[])?;
        let reds = (0..63).map(|x| color(&picture, x, 18)[0] - color(&picture, x + 1, 18)[0]);
        Some(reds.fold(0.0, |most: f32, step| most.max(step.abs())))
    };
    let (one, two) = (or_skip!(step(1)), or_skip!(step(2)));
    assert!(one > 0.6 && two < 0.1, "steps of {one} and {two}");
}

/// The march and its rule are the same as in `ssr`; only pixels without a hit are looked up, and as `probe` does.
#[test]
fn probes_answer_where_the_march_does_not() {
    let text = room(WALLS);
    let of = |method: &str| {
        by(
            &text,
            &[&format!("reflection.method=\"{method}\"")],
            &[Aov::Cause],
        )
    };
    let (ssr, both) = (or_skip!(of("ssr")), or_skip!(of("ssr+probe")));
    let probe = or_skip!(of("probe"));
    let causes = integers(&both, Aov::Cause);
    assert_eq!(causes, integers(&ssr, Aov::Cause));
    let mut counts = [0; 2];
    for (i, &cause) in causes.iter().enumerate() {
        let of = |picture: &Picture| [0, 1, 2].map(|c| picture.color[4 * i + c]);
        match Cause::from_number(cause) {
            Some(Cause::NotReflective | Cause::Rough) => {}
            Some(Cause::Hit | Cause::None) => {
                assert_eq!(of(&both), of(&ssr), "pixel {i}");
                counts[0] += 1;
            }
            _ => {
                assert_eq!(of(&both), of(&probe), "pixel {i}");
                counts[1] += 1;
            }
        }
    }
    assert!(counts.iter().all(|count| *count > 50), "{counts:?}");
}

fn shot(renderer: &mut Renderer, world: &World, eye: Vec3) -> Picture {
    let gpu = gpu().expect("a GPU");
    let mut camera = world.cameras[0].value.clone();
    camera.eye = eye;
    or_panic!(renderer.update(gpu, world));
    or_panic!(renderer.picture(gpu, &camera, &[]))
}

/// Maps depend on the light and on static things, not on earlier frames, the camera, or moving things.
#[test]
fn frames_with_probes_do_not_depend_on_those_before() {
    let Some(gpu) = gpu() else { return };
    let more = include_str!("probes/frames_with_probes_do_not_depend_on_those_before.toml");
    let text = format!("{}{more}", room(WALLS)).replace("segments = 16", "segments = 12");
    let (mut desc, world): (SceneDesc, World) = scene(&text, &[]);
    desc.reflection.method = Method::Probe;
    let mut later = world.clone();
    later.lights[0].desc.color = Vec3::new(0.2, 1.0, 0.4);
    let ball = later.instances.last_mut().expect("the ball");
    ball.world_from_object.translation.x += 0.7;
    let eyes = [Vec3::new(2.2, 1.6, 2.6), Vec3::new(-2.0, 2.5, 3.0)];
    let make = || renderer(gpu, &desc, &world, false);
    let mut forwards = make();
    let first = shot(&mut forwards, &world, eyes[0]);
    let second = shot(&mut forwards, &later, eyes[1]);
    let mut backwards = make();
    assert!(shot(&mut backwards, &later, eyes[1]).color == second.color);
    assert!(shot(&mut backwards, &world, eyes[0]).color == first.color);
    // The ball moves before the lamp and the probe: neither it nor its shadow is in the maps.
    let mut moved = world.clone();
    let ball = moved.instances.last_mut().expect("the ball");
    ball.world_from_object.translation.x += 0.7;
    let camera = &world.cameras[0].value;
    let mut update_ms = |world: &World| {
        or_panic!(forwards.update(gpu, world));
        let stats = or_panic!(forwards.render(gpu, camera));
        stats.maps.expect("probes").update_ms
    };
    assert!(update_ms(&world) > 0.0, "the lamp has another color");
    assert!(update_ms(&moved) <= 0.0, "captured again");
}

/// Under the open sky a probe sees nothing, and the environment, with lamps in it, is what `rt` shows: no part of the
/// specular light is counted twice, whatever the roughness.
#[test]
fn light_beyond_the_probes_is_that_of_traced_rays() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("probes/light_beyond_the_probes_is_that_of_traced_rays.toml");
    for roughness in ["0", "0.15", "0.6", "1"] {
        let of = |method: &str| {
            let set = [
                &format!("material.metal.roughness={roughness}"),
                &format!("reflection.method={method}"),
            ];
            render(gpu, text, &set.map(String::as_str), &[])
        };
        let (rt, probe) = (of("rt"), of("probe"));
        let pairs = rt.color.iter().zip(&probe.color);
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 2e-3, "roughness {roughness}: {worst}");
    }
}

/// A rough mirror in a room of one color shows that color times its albedo, as traced rays do in the mean.
#[test]
fn levels_of_the_maps_keep_the_light_of_a_lobe() {
    let Some(gpu) = gpu() else { return };
    let text = room([[0.2, 0.5, 0.8]; 5]).replace("reflection = \"mirror\"", "");
    for roughness in ["0.12", "0.5"] {
        let of = |method: &str| {
            let set = [
                &format!("material.mirror.roughness={roughness}"),
                &format!("reflection.method={method}"),
                &"image.samples=32".to_owned(),
                &"image.size=[16, 9]".to_owned(),
            ];
            render(gpu, &text, &set.map(String::as_str), &[])
        };
        let (rt, probe) = (crate::kit::mean(&of("rt")), crate::kit::mean(&of("probe")));
        for (a, b) in rt.iter().zip(probe) {
            assert!(
                (a - b).abs() < 0.02 * a,
                "roughness {roughness}: {rt:?} against {probe:?}"
            );
        }
    }
}

#[test]
fn more_probes_than_there_is_room_for_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (mut desc, world) = scene(&room(WALLS), &["probes.spacing_m=0.4"]);
    desc.reflection.method = Method::Probe;
    let made = Renderer::new(
        gpu,
        &crate::common::shaders(),
        &world,
        &RenderOptions::for_scene(&desc),
    );
    let error = made.expect_err("too many").to_string();
    assert!(error.contains("probes; there is room for 41"), "{error}");
    assert_eq!(desc.reflection.probes.lookup, Lookup::Box);
}
