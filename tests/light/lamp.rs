//! Lamps: cones, ranges, and floors that must not shade themselves.

use super::kit::*;

/// A white floor seen from 4 m above.
const FLOOR: &str = include_str!("lamp/floor.toml");

/// Distance of a pixel of the middle row from the middle of the floor, meters.
fn offset_m(x: u32) -> f32 {
    ((x as f32 + 0.5) / 33.0 * 2.0 - 1.0) * 4.0 * 20f32.to_radians().tan()
}

/// Cone of KHR_lights_punctual: the square of a ramp in the cosine, from the outer to the inner angle.
#[test]
fn the_edge_of_a_cone_is_the_squared_ramp_of_its_cosine() {
    let Some(gpu) = gpu() else { return };
    let [inner, outer] = [10f32, 35.0].map(|angle| angle.to_radians().cos());
    // 10 candela within the inner angle, and a third of them on average over the ramp.
    let lumens = 10.0 * 2.0 * PI * (1.0 - inner + (inner - outer) / 3.0);
    let text = format!(
        "{FLOOR}\n[light.spot]\nkind = \"spot\"\nposition = [0, 2, 0]\ndirection = [0, -1, 0]\n\
         inner_deg = 10\nouter_deg = 35\nflux_lm = {lumens}\nshadow = \"none\"\n"
    );
    let picture = render(gpu, &text, &[], &[]);
    let mut partly = 0;
    for x in 0..33 {
        let d2 = offset_m(x).powi(2) + 4.0;
        let cosine = 2.0 / d2.sqrt();
        let ramp = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0);
        partly += u32::from(ramp > 0.0 && ramp < 1.0);
        let expected = ramp * ramp * 10.0 / d2 * cosine / PI;
        assert_color(&picture, x, 16, [expected; 3], 2e-3);
    }
    assert!(partly > 8, "{partly}");
    // All of the flux arrives on the floor, whose radiance is 1/π of its illuminance.
    let pixel_m2 = (offset_m(1) - offset_m(0)).powi(2);
    let arrived = picture.color.chunks_exact(4).map(|c| c[0] * PI * pixel_m2);
    assert_close(arrived.sum(), lumens, 0.01);
}

/// Range of KHR_lights_punctual: 1 minus the fourth power of the distance over the range.
#[test]
fn a_range_ends_light_by_the_fourth_power() {
    let Some(gpu) = gpu() else { return };
    let text = format!(
        "{FLOOR}\n[light.lamp]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 10\n\
         shadow = \"none\"\n"
    );
    let (desc, mut world) = scene(&text, &[]);
    world.lights[0].range_m = Some(1.5);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let picture = renderer.first_view(&world, &[]);
    for x in 0..33 {
        let d2 = offset_m(x).powi(2) + 1.0;
        let rest = (1.0 - (d2 / (1.5 * 1.5)).powi(2)).max(0.0);
        let expected = rest * 10.0 / d2 / d2.sqrt() / PI;
        assert_color(&picture, x, 16, [expected; 3], 4e-3);
    }
    assert_eq!(color(&picture, 0, 16), [0.0; 3], "past the range");
}

#[test]
fn an_empty_floor_casts_no_shadow_on_itself() {
    let Some(gpu) = gpu() else { return };
    for light in [
        "kind = \"directional\"\ndirection = [1, -0.25, 0.3]\nintensity_lux = 3",
        "kind = \"point\"\nposition = [-3, 0.8, 0.4]\nintensity_cd = 20",
        "kind = \"spot\"\nposition = [-3, 0.8, 0.4]\ndirection = [3, -0.8, -0.4]\nouter_deg = 60\n\
         intensity_cd = 20",
    ] {
        let of = |shadow: &str| {
            let text = format!("{FLOOR}\n[light.l]\n{light}\nshadow = \"{shadow}\"\n");
            render(gpu, &text, &["environment.color=[0, 0, 0]"], &[])
        };
        let open = of("none");
        for shadow in ["map", "ray"] {
            let shaded = of(shadow);
            for (i, pixel) in open.color.chunks_exact(4).enumerate() {
                let (x, y) = (i as u32 % 33, i as u32 / 33);
                let light_left = color(&shaded, x, y)[0] / pixel[0].max(1e-9);
                assert!(
                    pixel[0] < 1e-4 || light_left > 0.99,
                    "{light}, {shadow}: {light_left} of the light at ({x}, {y})"
                );
            }
        }
    }
}

/// A ball of few triangles: where the smooth normal faces away from the lamp, the flat triangle may still face
/// it, and light there would be negative.
#[test]
fn no_light_falls_from_behind_the_smooth_normal() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("lamp/no_light_falls_from_behind_the_smooth_normal.toml");
    let picture = render(gpu, text, &[], &[Aov::Normal]);
    let normals = floats(&picture, Aov::Normal).chunks_exact(3);
    let (mut lit, mut turned_away) = (0, 0);
    for (pixel, normal) in picture.color.chunks_exact(4).zip(normals) {
        // A normal that faces away from a lamp at +X.
        if normal[0] <= -1e-3 {
            assert_eq!(pixel[0], 0.0, "normal {normal:?}");
            turned_away += 1;
        } else if pixel[0] > 0.0 {
            let expected = 3.0 * normal[0] / PI;
            assert!((pixel[0] - expected).abs() < 2e-3, "normal {normal:?}");
            lit += 1;
        }
    }
    assert!(lit > 400 && turned_away > 400, "{lit} {turned_away}");
}

#[test]
fn reflections_show_lights_with_a_size_unless_they_hide() {
    let Some(gpu) = gpu() else { return };
    let [point, rect, surface, opposite] = include_str!("lamp/reflected.txt")
        .split("---\n")
        .collect::<Vec<_>>()
        .try_into()
        .expect("four parts");
    // Columns and rows of a picture.
    let brightest = |picture: &Picture, x: u32, y: u32| {
        let part = (0..5 * 16).map(|i| color(picture, x + i % 5, y + i / 5)[1]);
        part.fold(0.0, f32::max)
    };
    // A mirror and rough metal beside each other below the lights, and the matte floor on their left.
    let strips = include_str!("lamp/strips.toml");
    let of = |floor: &str, lights: &str, method: &str| {
        let floor = FLOOR.replace("reflectivity = 0", floor);
        let text = [&floor, strips, lights].concat();
        let picture = render(gpu, &text, &[&format!("reflection.method={method}")], &[]);
        let matte = (0..33 * 8).map(|i| color(&picture, i / 33, i % 33)[1]);
        let strips = [11, 17].map(|x| [0, 17].map(|y| brightest(&picture, x, y)));
        (strips, matte.sum::<f32>() / (33.0 * 8.0))
    };
    for another in ["", opposite] {
        let mirrors = "metallic = 1\nroughness = 0";
        let ([mirror, satin], _) = of(mirrors, &[point, another].concat(), "auto");
        assert!(mirror == [0.0; 2] && satin[0] > 1.0, "{mirror:?} {satin:?}");
    }
    // More lights than the array holds, all hidden.
    let hide = |lights: &str| lights.replace("# hidden: ", "");
    let point = hide(point)
        .replace("= 10\n", "= 0.01\n")
        .replace("none", "ray");
    let numbered = |n| point.replace("light.lamp", &format!("light.p{n}"));
    let two = [rect, surface].concat();
    // Both once more below the floor, turned away and hidden, so that shown and hidden lights share their pipelines.
    let unseen = (hide(&two).replace("[0, 5,", "[0, -5,"))
        .replace("light.rect", "light.unseen")
        .replace("glow", "unseen");
    let many: String = (0..70).map(numbered).chain([two.clone()]).collect();
    let cases = [(&many, "rt"), (&two, "hybrid"), (&two, "path")];
    for &(lights, method) in first_or_all(&cases, 2) {
        let [shown, hidden] = [lights.clone(), hide(lights)]
            .map(|lights| lights + &*unseen)
            .map(|lights| of("reflectivity = 0", &lights, method));
        let is_lit = shown.0.as_flattened().iter().all(|&b| b > 1.0) && shown.1 > 0.01;
        assert!(is_lit, "{method} {lights}: {shown:?}");
        assert_eq!(hidden.0, [[0.0; 2]; 2], "{method} {lights}");
        assert_close(hidden.1, shown.1, 0.02);
    }
}
