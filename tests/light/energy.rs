//! Light of rough surfaces on both sides of `roughness_cutoff`.

use super::kit::*;

/// A floor seen from 3 m at an angle that a test sets.
const FLOOR: &str = include_str!("energy/floor.toml");
const METAL: &str = "[material.floor]\nmetallic = 1\n";
const DIELECTRIC: &str = "[material.floor]\n";

/// Mean brightness of the floor.
fn brightness(text: &str, cosine: f32, roughness: f32, set: &[&str]) -> Option<f32> {
    let sine = (1.0 - cosine * cosine).sqrt();
    let own = [
        format!("camera.main.eye=[{}, {}, 0]", 3.0 * sine, 3.0 * cosine),
        format!("material.floor.roughness={roughness}"),
    ];
    let own = own.iter().map(String::as_str);
    let set: Vec<&str> = own.chain(set.iter().copied()).collect();
    Some(mean(&render(gpu()?, text, &set, &[]))[0])
}

#[test]
fn both_sides_of_the_cutoff_are_alike_bright() {
    let even = "[environment]\ncolor = [1, 1, 1]\n";
    let gradient =
        "[environment]\nzenith = [1, 1, 1]\nhorizon = [0.5, 0.5, 0.5]\nground = [0, 0, 0]\n";
    for (sky, tolerance) in [(even, 0.01), (gradient, 0.02)] {
        for material in [METAL, DIELECTRIC] {
            let text = [FLOOR, material, sky].concat();
            let cases = [(0.24, 0.45), (0.7, 0.6), (0.4, 0.45), (0.4, 0.9)];
            for &(roughness, cosine) in first_or_all(&cases, 2) {
                let side = |set: &str| brightness(&text, cosine, roughness, &[set]);
                let near = side("reflection.roughness_cutoff=1");
                let far = side("reflection.roughness_cutoff=0");
                let (near, far) = (or_skip!(near), or_skip!(far));
                assert_close(far, near, tolerance);
            }
        }
    }
}

#[test]
fn no_pixel_is_black_where_its_one_facet_turns_light_to_the_wrong_side() {
    let grooves = "[material.floor]\nmetallic = 1\nanisotropy = 1\nroughness = 0.2\n";
    let pane = "[material.floor]\ntransmission = 1\nreflectivity = 0\nroughness = 0.8\n";
    for (material, cosine) in [(grooves, 0.5), (pane, 0.4)] {
        let text = [FLOOR, material, "[environment]\ncolor = [1, 1, 1]\n"].concat();
        let sine = (1.0_f32 - cosine * cosine).sqrt();
        let eye = format!("camera.main.eye=[{}, {}, 0]", 3.0 * sine, 3.0 * cosine);
        let picture = |samples: &str| {
            let set = [
                eye.as_str(),
                samples,
                "image.size=[48, 48]",
                "reflection.roughness_cutoff=1",
            ];
            gpu().map(|gpu| render(gpu, &text, &set, &[]))
        };
        let one = or_skip!(picture("image.samples=1"));
        let many = or_skip!(picture("image.samples=64"));
        let expected = mean(&many)[0];
        // A single facet left a quarter of the pixels of the grooves black, and a sixth of the pane's.
        let pixels = one.color.chunks_exact(4);
        let dark = pixels.filter(|pixel| pixel[0] < 0.3 * expected).count();
        assert!(dark <= 4, "{dark} of 2304 pixels");
        assert_close(mean(&one)[0], expected, 0.01);
    }
}

/// A rough metal floor below a red ceiling, under a black sky, with a small bright lamp.
const ROOM: &str = include_str!("energy/room.toml");

#[test]
fn metals_show_what_is_around_past_the_cutoff_of_dielectrics() {
    let of = |set: &[&str]| Some(mean(&render(gpu()?, ROOM, set, &[])));
    for roughness in [0.19, 0.21, 0.5, 0.95] {
        let own = format!("material.floor.roughness={roughness}");
        let Some(found) = of(&[&own]) else { return };
        let whole = of(&[&own, "reflection.roughness_cutoff=1"]).unwrap_or_default();
        assert!(found[0] > 0.2 && found[1] == 0.0, "{found:?}");
        assert_close(found[0], whole[0], 1e-5);
    }
    // A roughness above the cut-off disables them too.
    let none = of(&[
        "material.floor.roughness=0.5",
        "reflection.roughness_cutoff=0",
    ]);
    assert_eq!(none.unwrap_or_default()[0], 0.0);
}

#[test]
fn the_filter_keeps_the_light_of_a_lamp_that_facets_mirror_below_the_surface() {
    let lamp = "[light.lamp]\nkind = \"point\"\nposition = [0, 1, -3]\nintensity_cd = 60\nradius_m = 0.2\n";
    let text = format!("{ROOM}{lamp}").replace("emission = [1, 0, 0]\n", "");
    for roughness in first_or_all(&[0.98, 0.6], 1) {
        let own = format!("material.floor.roughness={roughness}");
        let of = |set: &[&str]| {
            let set: Vec<&str> = [own.as_str()].iter().chain(set).copied().collect();
            let picture = render(gpu()?, &text, &set, &[]);
            let brightest = picture.color.iter().copied().fold(0.0, f32::max);
            Some((mean(&picture)[0], brightest))
        };
        let (truth, brightest) = or_skip!(of(&["image.samples=64"]));
        for samples in ["image.samples=1", "image.samples=8"] {
            let (found, most) = of(&[samples]).unwrap_or_default();
            assert_close(found, truth, 0.03);
            assert!(most < 1.5 * brightest, "{most}, expected {brightest}");
        }
    }
}
