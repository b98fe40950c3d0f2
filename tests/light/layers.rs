//! Transmission, blended alpha and clear coats, against closed forms.

use crate::common::cases;

use super::environment::directional_albedo;
use super::kit::*;

/// The camera looks along -Z at an emissive wall, through an object that a test adds at the origin.
const WALL: &str = include_str!("layers/wall.toml");

/// Scene text of an object at the origin with these keys of its material.
fn thing(shape: &str, material: &str) -> String {
    format!(
        "[material.thing]\nroughness = 0\n{material}\n[model.thing]\nshape = {shape}\n\
         material = \"thing\"\n[[instance]]\nname = \"thing\"\nmodel = \"thing\"\n\
         rotation_deg = [90, 0, 0]\n"
    )
}

fn wall_and(thing: &str) -> String {
    [WALL, thing].concat()
}

const PANE: &str = "{ kind = \"plane\", size = [2, 2] }";
const BALL: &str = "{ kind = \"sphere\", radius = 1 }";

fn fresnel_at_normal(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

#[test]
fn a_pane_lets_through_what_it_does_not_reflect() {
    let Some(gpu) = gpu() else { return };
    for ior in [1.1_f32, 1.5, 2.4] {
        let pane = format!("transmission = 1\nior = {ior}\nbase_color = [0.5, 1, 1]");
        let text = wall_and(&thing(PANE, &pane));
        let passed = 1.0 - fresnel_at_normal(ior);
        for method in ["rt", "hybrid", "ssr"] {
            let set = [format!("reflection.method={method}")];
            let picture = render(gpu, &text, &[&set[0]], &[]);
            let expected = [0.5 * passed, 0.5 * passed, 0.25 * passed];
            assert_color(&picture, 4, 4, expected, 2e-3);
        }
    }
}

#[test]
fn mirrors_at_60_degrees_follow_fresnel() {
    let Some(gpu) = gpu() else { return };
    // A ball out of sight, so that all materials with an index of refraction share their pipelines.
    let unseen = thing(BALL, "specular = 0.5\nior = 2") + "translation = [90, 0, 0]\n";
    let unseen = unseen.replace("thing", "unseen");
    for (material, expected) in cases(include_str!("layers/fresnel.txt")) {
        let mut text = wall_and(&thing(PANE, material));
        if material.contains("ior") {
            text += &unseen;
        }
        for method in first_or_all(&["rt", "path"], 1) {
            let set = [
                &format!("reflection.method={method}"),
                "environment.color=[1, 1, 1]",
                "model.wall.shape.size=[1, 1]",
                "instance.thing.rotation_deg=[150, 0, 0]",
            ];
            let found = mean(&render(gpu, &text, &set, &[]));
            for (found, share) in found.iter().zip(expected.split(' ')) {
                let share: f32 = share.parse().expect("a number");
                assert!(
                    (found - share).abs() < 5e-4,
                    "{material}, {method}: {found}, not {share}"
                );
            }
        }
    }
}

/// F82 is below zero for dark metals with a dark tint, where they reflect nothing.
#[test]
fn dark_edges_of_dark_metals_reflect_no_less_than_nothing() {
    let Some(gpu) = gpu() else { return };
    let dark = "metallic = 1\nedge_tint = true\nbase_color = [0.05, 0.1, 0.3]\nspecular_color = [0, 0.2, 0.1]";
    for more in ["", "ior = 1.5", "reflection = \"none\"\nior = 1.5"] {
        let ball = thing(BALL, &format!("{dark}\n{more}"));
        let text = wall_and(&ball.replace("roughness = 0", "roughness = 0.3"));
        let white = [
            "environment.color=[1, 1, 1]",
            "camera.main.fov_deg=60",
            "image.size=[32, 32]",
            "reflection.filter=false",
        ];
        let picture = render(gpu, &text, &white, &[]);
        let range = 0.0..1.001;
        assert!(picture.color.iter().all(|v| range.contains(v)), "{more}");
    }
}

#[test]
fn a_slab_absorbs_along_the_way_and_reflects_inside() {
    let Some(gpu) = gpu() else { return };
    let slab = "transmission = 1\nior = 2\nthickness_m = 1\nattenuation_color = [0.5, 0.8, 1]\n\
                attenuation_distance_m = 2";
    let text = wall_and(&thing("{ kind = \"box\", size = [3, 2, 3] }", slab));
    let picture = render(
        gpu,
        &text,
        &["image.size=[32, 32]", "image.samples=16"],
        &[],
    );
    let f = fresnel_at_normal(2.0);
    let found = mean(&picture);
    for (channel, (a, wall)) in [(0.5_f32, 1.0), (0.8, 0.5), (1.0, 0.25)].iter().enumerate() {
        // Sum over all pairs of internal reflections; the thickness of the slab equals the attenuation distance.
        let expected = (1.0 - f).powi(2) * a / (1.0 - (f * a).powi(2)) * wall;
        assert_close(found[channel], expected, 0.01);
    }
}

/// A ball out of sight has the features of all kinds of glass, so that they share their pipelines.
#[test]
fn glass_in_a_white_world_cannot_be_seen() {
    let all = "transmission = 1\nthickness_m = 1\ndispersion = 1\nclearcoat = 0.5\nior = 2";
    let unseen = thing(BALL, all) + "translation = [0, 90, 0]\n";
    check_glass(&(unseen.replace("roughness = 0", "roughness = 0.4")).replace("thing", "unseen"));
    if is_long() {
        check_glass(""); // each kind by pipelines of its own
    }
}

fn check_glass(unseen: &str) {
    let Some(gpu) = gpu() else { return };
    for (shape, roughness, material) in [
        (BALL, 0.0, "thickness_m = 1"),
        (BALL, 0.0, "thickness_m = 1\nior = 2.4"),
        // Both ways at its inner side together have all light: the wall is a lamp.
        (BALL, 0.4, "thickness_m = 1"),
        (BALL, 0.4, "thickness_m = 1\ndispersion = 1"),
        (BALL, 0.0, "thickness_m = 0"),
        (PANE, 0.0, "clearcoat = 0.5"),
    ] {
        let glass = thing(shape, &format!("transmission = 1\n{material}"));
        let glass = glass.replace("roughness = 0", &format!("roughness = {roughness}"));
        let text = wall_and(&(glass + unseen));
        // Rough glass chooses otherwise from 33 samples on (`FEW_SAMPLES`), and dispersive glass from eight on.
        let pictures: &[(u32, u32)] = match material {
            "thickness_m = 1\ndispersion = 1" => &[(16, 28)],
            _ if roughness > 0.0 => &[(1, 32), (33, 12)],
            _ => &[(1, 20)],
        };
        for (samples, side) in pictures {
            let set = [
                "environment.color=[1, 1, 1]",
                "material.wall.emission=[1, 1, 1]",
                "material.wall.light=true",
                "reflection.roughness_cutoff=1",
                "reflection.method=rt",
                "camera.main.fov_deg=20",
                "reflection.bounces=8",
                "reflection.filter=false",
                &format!("image.size=[{side}, {side}]"),
                &format!("image.samples={samples}"),
            ];
            let found = mean(&render(gpu, &text, &set, &[]));
            assert_close(found[0], 1.0, 0.01);
        }
    }
}

/// Light that enters the edge of a thin sheet leaves it after up to 40 total reflections.
#[test]
fn sheets_of_glass_guide_light_to_their_edges() {
    let Some(gpu) = gpu() else { return };
    let glass = "transmission = 1\nthickness_m = 1";
    let sheet = thing("{ kind = \"box\", size = [1, 0.03, 1] }", glass);
    let text = [
        "version = 1\n[camera.main]\neye = [3.2, 0.1, 2]\ntarget = [0, 0, 0]\nfov_deg = 20\n\
         [environment]\ncolor = [1, 1, 1]\n[image]\nsize = [32, 32]\ntone_map = \"none\"\n",
        &sheet.replace("rotation_deg = [90, 0, 0]", "rotation_deg = [0, 0, 30]"),
    ]
    .concat();
    for samples in ["image.samples=1", "image.samples=4"] {
        let picture = render(gpu, &text, &[samples], &[]);
        for i in 0..32 * 32 {
            assert_color(&picture, i % 32, i / 32, [1.0; 3], 0.02);
        }
    }
}

/// Lamps beyond a rough solid are found by refracted rays and by rays that are aimed at them from within, which share
/// their light: one ray gives the brightness of four, and less than half the grain of refracted rays alone, .18.
#[test]
fn rough_glass_shows_lamps_as_bright_by_any_number_of_rays() {
    let Some(gpu) = gpu() else { return };
    let panel = "[light.panel]\nkind = \"rect\"\nposition = [0, 0, -3]\ndirection = [0, 0, 1]\n\
                 size = [0.5, 0.5]\nintensity_cd = 36\n";
    let ball = thing(BALL, "transmission = 1\nthickness_m = 1");
    let ball = ball.replace("roughness = 0\n", "roughness = 0.5\n");
    let text = wall_and(&format!("{panel}{ball}"));
    let [few, many] = [(1, 64), (4, 33)].map(|(rays, samples)| {
        let set = [
            &format!("image.samples={samples}"),
            "image.size=[12, 12]",
            "environment.color=[0, 0, 0]",
            "material.wall.emission=[0, 0, 0]",
            "reflection.roughness_cutoff=1",
            "reflection.glint_limit=0",
            &format!("image.light_rays={rays}"),
        ];
        render(gpu, &text, &set, &[])
    });
    assert_close(mean(&many)[0] / mean(&few)[0], 1.0, 0.01);
    let red = |p: &Picture, i: u32| color(p, i % 12, i / 12)[0];
    let squares = (0..144).map(|i| (red(&few, i) - red(&many, i)).powi(2));
    let grain = (squares.sum::<f32>() / 144.0).sqrt() / mean(&many)[0];
    assert!(grain < 0.12, "{grain}");
}

#[test]
fn a_ball_of_glass_turns_around_what_is_behind_it() {
    let Some(gpu) = gpu() else { return };
    // Red on the left, green on the right.
    let half = |name: &str, x: f32, emission: &str| {
        format!(
            "[material.{name}]\nbase_color = [0, 0, 0]\nreflectivity = 0\nemission = {emission}\n\
             [model.{name}]\nshape = {{ kind = \"plane\", size = [20, 40] }}\nmaterial = \"{name}\"\n\
             [[instance]]\nmodel = \"{name}\"\ntranslation = [{x}, 0, -4.9]\nrotation_deg = [90, 0, 0]\n"
        )
    };
    let ball = thing(
        BALL,
        "transmission = 1\nthickness_m = 2\nreflectivity = 0.04",
    );
    let text = [
        WALL,
        &half("left", -10.0, "[1, 0, 0]"),
        &half("right", 10.0, "[0, 1, 0]"),
        &ball,
    ]
    .concat();
    for method in ["rt", "hybrid"] {
        let method = format!("reflection.method={method}");
        let set = ["image.size=[64, 64]", "camera.main.fov_deg=40", &method];
        let picture = render(gpu, &text, &set, &[]);
        let is_red = |x, y| {
            let [r, g, _] = color(&picture, x, y);
            assert!(r.max(g) > 0.5, "{r} {g} at ({x}, {y})");
            r > g
        };
        assert!(is_red(2, 32) && !is_red(61, 32), "beside the ball");
        assert!(!is_red(24, 32) && is_red(40, 32), "through the ball");
    }
}

#[test]
fn mirrors_show_what_is_behind_a_pane() {
    let Some(gpu) = gpu() else { return };
    let pane = thing(PANE, "transmission = 1\nior = 2\nbase_color = [0.5, 1, 1]");
    let mirror = "[material.mirror]\nbase_color = [1, 1, 1]\nmetallic = 1\nroughness = 0\n\
                  [model.mirror]\nshape = { kind = \"plane\", size = [2, 2] }\nmaterial = \"mirror\"\n\
                  [[instance]]\nmodel = \"mirror\"\ntranslation = [0, 0, 6]\nrotation_deg = [-90, 0, 0]\n";
    let text = [WALL, &pane, mirror].concat();
    let set = [
        "camera.main.target=[0, 0, 6]",
        "reflection.bounces=1",
        "image.size=[16, 16]",
        "image.samples=16",
    ];
    let passed = 1.0 - fresnel_at_normal(2.0);
    let found = mean(&render(gpu, &text, &set, &[]));
    for (found, expected) in found.iter().zip([0.5, 0.5, 0.25]) {
        assert_close(*found, expected * passed, 0.02);
    }
}

#[test]
fn blended_alpha_shows_both_the_surface_and_what_is_behind() {
    let Some(gpu) = gpu() else { return };
    let pane = "base_color = [0, 0, 0]\nreflectivity = 0\nemission = [0, 0, 1]";
    let text = wall_and(&thing(PANE, pane));
    let (desc, mut world) = scene(&text, &[]);
    let pane = world.materials.iter_mut().find(|m| m.name == "thing");
    let pane = pane.expect("it is used");
    pane.blended = true;
    pane.base_color.w = 0.25;
    let picture = renderer(gpu, &desc, &world, false).first_view(&world, &[]);
    assert_color(&picture, 4, 4, [0.75, 0.375, 0.75 * 0.25 + 0.25], 5e-3);
}

#[test]
fn a_clear_coat_reflects_like_glass_and_takes_that_from_below() {
    let Some(gpu) = gpu() else { return };
    let coat = "base_color = [0, 0, 0]\nreflectivity = 0\nemission = [0, 0.5, 0]\nclearcoat = 1";
    let text = wall_and(&thing(PANE, coat));
    for (roughness, samples, ior) in [(0.0, 1, 1.5), (0.5, 64, 1.5), (0.0, 1, 2.0)] {
        let share = ((ior - 1.0_f32) / (ior + 1.0)).powi(2);
        let set = [
            &*format!("material.thing.clearcoat_roughness={roughness}"),
            &format!("image.samples={samples}"),
            &format!("material.thing.clearcoat_ior={ior}"),
            "environment.color=[1, 1, 1]",
            "reflection.roughness_cutoff=1",
        ];
        let found = mean(&render(gpu, &text, &set, &[]));
        let lobe = directional_albedo(1.0, roughness) as f32;
        assert_close(found[0], share * lobe, 0.05);
        assert_close(found[1], share * lobe + (1.0 - share) * 0.5, 0.01);
    }
}

#[test]
#[ignore = "long: each material needs pipelines of its own"]
fn rough_metals_see_a_lamp_behind_a_pane_once() {
    let Some(gpu) = gpu() else { return };
    let metal = WALL
        .replace("emission = [1, 0.5, 0.25]", "roughness = 0.4")
        .replace(
            "base_color = [0, 0, 0]\nreflectivity = 0",
            "base_color = [1, 1, 1]\nmetallic = 1",
        );
    let lamp =
        "[light.lamp]\nkind = \"point\"\nposition = [0, 0, 2]\nintensity_cd = 10\nradius_m = 0.3\n";
    let pane = thing(PANE, "transmission = 1\nior = 1.5");
    // A light behind the pane, so that it reaches the camera only through the pane.
    let set = [
        "camera.main.eye=[0, 0, -1]",
        "camera.main.target=[0, 0, -5]",
        "reflection.roughness_cutoff=1",
        "reflection.method=rt",
        // A single bounce, so that the metal does not see itself in the pane.
        "reflection.bounces=1",
        "image.size=[32, 32]",
        "image.samples=16",
    ];
    let open = mean(&render(gpu, &[&metal, lamp].concat(), &set, &[]))[0];
    let behind = mean(&render(gpu, &[&metal, lamp, &pane].concat(), &set, &[]))[0];
    assert_close(behind, open * (1.0 - fresnel_at_normal(1.5)), 0.01);
}

#[test]
fn alpha_of_scene_text_blends_as_that_of_a_file() {
    let Some(gpu) = gpu() else { return };
    let pane = "base_color = [0, 0, 0]\nreflectivity = 0\nemission = [0, 0, 1]\nalpha = 0.25";
    let text = wall_and(&thing(PANE, pane));
    let found = mean(&render(gpu, &text, &["image.samples=16"], &[]));
    for (found, expected) in found.iter().zip([0.75, 0.375, 0.25 * 0.75 + 0.25]) {
        assert_close(*found, expected, 0.01); // 7 bits of alpha
    }
    // With alpha 1 the material is opaque and costs nothing; with a cut-off it is fully visible or invisible.
    let (desc, world) = scene(&text, &["material.thing.alpha=1"]);
    assert!(
        !renderer(gpu, &desc, &world, false)
            .plan()
            .features
            .transmission
    );
    let cut = ["material.thing.alpha_cutoff=0.5"];
    let found = mean(&render(gpu, &text, &cut, &[]));
    assert_close(found[0], 1.0, 1e-3);
}

#[test]
fn glass_of_no_strength_mirrors_inside() {
    let Some(gpu) = gpu() else { return };
    let ball = |strength: &str| {
        let keys = format!("transmission = 1\nthickness_m = 2\nspecular = {strength}");
        wall_and(&thing("{ kind = \"box\", size = [2, 2, 2] }", &keys))
    };
    // Seen from above, the far side is beyond the angle of total internal reflection.
    let set = [
        "camera.main.eye=[1, 3, 4]",
        "camera.main.fov_deg=30",
        "image.size=[32, 32]",
        "environment.color=[0.2, 0.3, 0.4]",
    ];
    let [none, almost] = ["0", "0.002"].map(|s| render(gpu, &ball(s), &set, &[]));
    for (x, y) in (0..32).flat_map(|y| (0..32).map(move |x| (x, y))) {
        assert_color(&none, x, y, color(&almost, x, y), 5e-3);
    }
    let without = "material.thing.reflection=none";
    let picture = render(gpu, &ball("0"), &[set.as_slice(), &[without]].concat(), &[]);
    let differs = |&i: &usize| (picture.color[i] - none.color[i]).abs() > 0.05;
    assert!(
        (0..picture.color.len()).filter(differs).count() > 50,
        "what is inside shows"
    );
}
