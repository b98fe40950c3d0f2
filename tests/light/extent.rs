//! Lights with a size against form factors, and reflections of rough surfaces against integrals.

use super::kit::*;

/// A white, matte floor at y = 0 of which the picture shows a few centimeters around the origin.
pub const FLOOR: &str = include_str!("extent/floor.toml");

/// Irradiance divided by π that a light in the scene text gives the floor.
fn irradiance_over_pi(light: &str) -> Option<f32> {
    let text = format!("{FLOOR}[light.lamp]\n{light}");
    Some(mean(&render(gpu()?, &text, &[], &[]))[0])
}

#[test]
fn a_ball_lights_a_floor_by_its_form_factor() {
    // Form factor of Howell's B-39: (r / d)² cos θ for a ball that is wholly above the floor.
    for (position, radius_m) in [([0.0_f32, 2.0, 0.0], 0.5_f32), ([1.5, 1.5, 0.0], 1.0)] {
        let text = format!(
            "kind = \"point\"\nposition = {position:?}\nintensity_cd = 10\nradius_m = {radius_m}\n"
        );
        let found = or_skip!(irradiance_over_pi(&text));
        let d2: f32 = position.iter().map(|x| x * x).sum();
        let radiance = 10.0 / (PI * radius_m * radius_m);
        let form_factor = radius_m * radius_m / d2 * position[1] / d2.sqrt();
        assert_close(found, radiance * form_factor, 5e-3);
    }
}

#[test]
fn a_ball_too_small_for_its_square_lights_as_a_point() {
    for kind in ["point", "spot"] {
        let aim = match kind {
            "spot" => "direction = [0, -1, 0]\ninner_deg = 40\n",
            _ => "",
        };
        for radius in ["1e-30", "1e-9"] {
            let text = format!(
                "kind = \"{kind}\"\n{aim}position = [0, 2, 0]\nintensity_cd = 10\nradius_m = {radius}\n"
            );
            let found = or_skip!(irradiance_over_pi(&text));
            assert_close(found, 10.0 / 4.0 / PI, 5e-3);
        }
    }
}

#[test]
fn a_rectangle_and_a_disk_light_a_floor_by_their_form_factors() {
    let aim = "position = [0, 2, 0]\ndirection = [0, -1, 0]\nintensity_cd = 10\n";
    let rect = format!("kind = \"rect\"\n{aim}size = [3, 1]\nup = [0, 0, 1]\n");
    let found = or_skip!(irradiance_over_pi(&rect));
    // Form factor of Howell's B-4, four times: the point is below the middle.
    let (a, b) = (1.5_f32 / 2.0, 0.5_f32 / 2.0);
    let term = |a: f32, b: f32| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
    let form_factor = 4.0 / (2.0 * PI) * (term(a, b) + term(b, a));
    assert_close(found, 10.0 / 3.0 * form_factor, 5e-3);

    let disk = format!("kind = \"disk\"\n{aim}radius_m = 1.5\n");
    let found = or_skip!(irradiance_over_pi(&disk));
    let (r2, h2) = (1.5_f32 * 1.5, 4.0);
    assert_close(found, 10.0 / (PI * r2) * r2 / (r2 + h2), 5e-3);

    let behind = rect.replace("[0, -1, 0]", "[0, 1, 0]");
    assert_eq!(irradiance_over_pi(&behind), Some(0.0));
}

/// The default of `light_rays` falls as samples rise, yet the rays of all samples together never do.
#[test]
fn more_samples_are_less_noisy_than_one() {
    let Some(gpu) = gpu() else { return };
    let lamp = "[light.lamp]\nkind = \"rect\"\nposition = [0.6, 0.4, 0]\ndirection = [-1, -1, 0]\n\
                size = [1, 1]\nintensity_cd = 10\n";
    let text = FLOOR.replace("light_rays = 4\n", "") + lamp;
    let grain = |samples: u32| {
        let samples = format!("image.samples={samples}");
        let picture = render(gpu, &text, &[&samples], &[]);
        let mean = mean(&picture)[0];
        let red = picture.color.chunks(4).map(|pixel| pixel[0] - mean);
        (red.map(|off| off * off).sum::<f32>() / 256.0).sqrt() / mean
    };
    let one = grain(1);
    assert!(one > 0.02, "{one}: no grain to compare");
    for (samples, most) in [(2, 1.0), (4, 0.6), (7, 1.0)] {
        let found = grain(samples);
        assert!(
            found < most * one,
            "{found} with {samples} samples, {one} with one"
        );
    }
}

#[test]
fn a_sun_with_a_size_lights_as_much_as_without() {
    let sun = "kind = \"directional\"\ndirection = [1, -1, 0]\nintensity_lux = 3\n";
    for angle in [0, 1, 30] {
        let text = format!("{sun}angle_deg = {angle}\n");
        let found = or_skip!(irradiance_over_pi(&text));
        assert_close(found, 3.0 * 0.5_f32.sqrt() / PI, 5e-3);
    }
}

#[test]
fn half_a_light_behind_an_edge_gives_half_of_its_light() {
    let light = "kind = \"rect\"\nposition = [0, 2, 0]\ntarget = [0, 0, 0]\nsize = [1, 1]\n\
                 intensity_cd = 10\n";
    let shade = "[model.shade]\nshape = { kind = \"plane\", size = [4, 4] }\nmaterial = \"white\"\n\
                 [[instance]]\nmodel = \"shade\"\ntranslation = [2, 1, 0]\n";
    let open = or_skip!(irradiance_over_pi(light));
    let half = or_skip!(irradiance_over_pi(&format!("{light}{shade}")));
    assert_close(half, open / 2.0, 0.02);
    let through = format!("{light}shadow = \"none\"\n{shade}");
    let through = or_skip!(irradiance_over_pi(&through));
    assert_close(through, open, 1e-4);
}

/// Irradiance of the origin from a ball of radiance 1 at (x, 2, 0), past an occluder at height 1 that begins at
/// `edge`: the integral of the cosine over the directions in which the ball is visible.
fn light_past_an_edge(x: f64, radius_m: f64, edge: f64) -> f64 {
    let steps = 1000;
    let distance = (x * x + 4.0).sqrt();
    let (axis, across) = (
        [x / distance, 2.0 / distance],
        [2.0 / distance, -x / distance],
    );
    let least = (1.0 - (radius_m / distance).powi(2)).sqrt();
    let solid_angle = 2.0 * std::f64::consts::PI * (1.0 - least);
    let place = |k: usize| (k as f64 + 0.5) / steps as f64;
    let seen = |i: usize| {
        let along = 1.0 - place(i / steps) * (1.0 - least);
        let side = (1.0 - along * along).sqrt() * (std::f64::consts::TAU * place(i % steps)).cos();
        let [x, up] = [0, 1].map(|k| axis[k] * along + across[k] * side);
        if x / up < edge { up } else { 0.0 }
    };
    (0..steps * steps).map(seen).sum::<f64>() / (steps * steps) as f64 * solid_angle
}

/// A spot with a size is a ball whose light is dimmed as a whole, by the position of its middle in the cone.
#[test]
fn a_spot_with_a_size_lights_past_an_edge_as_a_ball_in_a_cone() {
    let radius_m = 0.4;
    for (x, inner_deg, outer_deg, beyond) in [
        (0.0_f64, 30.0_f64, 40.0_f64, 0.05),
        (0.9, 5.0, 40.0, -0.08),
        (1.3, 0.0, 60.0, 0.1),
        (1.9, 10.0, 40.0, 0.1), // its middle is outside, some of the ball is not
    ] {
        let edge = x / 2.0 + beyond;
        let text = format!(
            "kind = \"spot\"\nposition = [{x}, 2, 0]\ndirection = [0, -1, 0]\nintensity_cd = 10\n\
             radius_m = {radius_m}\ninner_deg = {inner_deg}\nouter_deg = {outer_deg}\n\
             [model.shade]\nshape = {{ kind = \"plane\", size = [4, 4] }}\nmaterial = \"white\"\n\
             [[instance]]\nmodel = \"shade\"\ntranslation = [{}, 1, 0]\n",
            edge + 2.0
        );
        let found = or_skip!(irradiance_over_pi(&text));
        // KHR_lights_punctual, "Inner and Outer Cone Angles".
        let [inner, outer] = [inner_deg, outer_deg].map(|deg| deg.to_radians().cos());
        let cosine = 2.0 / (x * x + 4.0).sqrt();
        let cone = ((cosine - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
        let pi = std::f64::consts::PI;
        let radiance = 10.0 / (pi * radius_m * radius_m) * cone;
        let expected = radiance * light_past_an_edge(x, radius_m, edge) / pi;
        assert_close(found, expected as f32, 0.02);
    }
}

#[test]
fn mirrors_show_lights_with_a_size() {
    let Some(gpu) = gpu() else { return };
    let mirror = FLOOR.replace(
        "base_color = [1, 1, 1]\nreflectivity = 0\nreflection = \"none\"",
        "base_color = [0, 0, 0]\nreflectivity = 1\nreflection = \"mirror\"",
    );
    // The camera at (0, 1, 6) sees the mirrored point (0, 1, -6) in the floor at the origin.
    let flat = "position = [0, 1, -6]\ntarget = [0, 0, 0]\nintensity_cd = 10\n";
    for (light, radiance) in [
        (format!("kind = \"rect\"\n{flat}size = [2, 1]\n"), 5.0),
        (format!("kind = \"disk\"\n{flat}radius_m = 1\n"), 10.0 / PI),
        (
            "kind = \"point\"\nposition = [0, 1, -6]\nradius_m = 0.5\nintensity_cd = 10\n"
                .to_owned(),
            40.0 / PI,
        ),
        (
            "kind = \"directional\"\ndirection = [0, -1, 6]\nangle_deg = 10\nintensity_lux = 3\n"
                .to_owned(),
            3.0 / (PI * 5.0_f32.to_radians().sin().powi(2)),
        ),
    ] {
        let text = format!("{mirror}[light.lamp]\n{light}");
        for method in ["rt", "hybrid"] {
            let method = format!("reflection.method={method}");
            let set = ["image.samples=1", "camera.main.eye=[0, 1, 6]", &method];
            let picture = render(gpu, &text, &set, &[]);
            assert_color(&picture, 4, 4, [radiance; 3], 2e-3 * radiance);
        }
    }
}

/// A metal with reflectance 1 and a rough specular lobe, under an even sky.
pub const METAL: &str = include_str!("extent/metal.toml");

#[test]
fn a_mirror_stays_sharp_whatever_its_roughness() {
    let Some(gpu) = gpu() else { return };
    let ball = include_str!("extent/ball.toml");
    let text = format!("{METAL}{ball}").replace("size = [16, 16]\nsamples = 16", "size = [64, 36]");
    let of = |set: &[&str]| render(gpu, &text, set, &[]);
    let camera = [
        "camera.main.eye=[0, 2, 4]",
        "camera.main.target=[0, 0.5, 0]",
    ];
    let with = |set: [&'static str; 2]| {
        of(&[
            camera[0],
            camera[1],
            set[0],
            set[1],
            "reflection.filter=false",
        ])
    };
    let smooth = with([
        "material.metal.roughness=0",
        "material.metal.reflection=auto",
    ]);
    let mirror = with([
        "material.metal.roughness=0.3",
        "material.metal.reflection=mirror",
    ]);
    let rough = with([
        "material.metal.roughness=0.3",
        "material.metal.reflection=auto",
    ]);
    assert!(share_differing(&smooth, &mirror, 1) == 0.0);
    assert!(share_differing(&smooth, &rough, 8) > 0.01);
}
