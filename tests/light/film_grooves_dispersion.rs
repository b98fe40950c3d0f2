//! Thin films, anisotropic lobes and dispersion (KHR_materials_iridescence, _anisotropy and _dispersion), against
//! integrals of the physical models.

use std::f64::consts::PI;

use glam::DVec3;

use super::kit::*;

/// A floor of metal seen from 3 m at an angle that a test sets, in even light.
const FLOOR: &str = include_str!("film_grooves_dispersion/floor.toml");

/// Mean color of the floor seen from this direction.
fn seen(view: DVec3, material: &str, set: &[&str]) -> Option<[f32; 3]> {
    let [x, y, z] = (3.0 * view).to_array();
    let eye = format!("camera.main.eye=[{x}, {y}, {z}]");
    let text = FLOOR.replace("[material.floor]", &format!("[material.floor]\n{material}"));
    let set: Vec<&str> = set.iter().copied().chain([eye.as_str()]).collect();
    Some(mean(&render(gpu()?, &text, &set, &[])))
}

/// Color matching functions at a wavelength in nanometers (Wyman, Sloan & Shirley 2013).
fn color_matching(nm: f64) -> [f64; 3] {
    let peak = |height: f64, mean: f64, below: f64, above: f64| {
        let width = if nm < mean { below } else { above };
        height * (-0.5 * ((nm - mean) / width).powi(2)).exp()
    };
    [
        peak(1.056, 599.8, 37.9, 31.0) + peak(0.362, 442.0, 16.0, 26.7)
            - peak(0.065, 501.1, 20.4, 26.2),
        peak(0.821, 568.8, 46.9, 40.5) + peak(0.286, 530.9, 16.3, 31.1),
        peak(1.217, 437.0, 11.8, 36.0) + peak(0.681, 459.0, 26.0, 13.8),
    ]
}

/// Linear Rec. 709 reflectance of a film at normal incidence: Airy's sum of all reflections between its sides,
/// integrated over the spectrum.
fn film_color(film: f64, below: f64, thickness_nm: f64) -> [f64; 3] {
    let outer = (1.0 - film) / (1.0 + film);
    let inner = (film - below) / (film + below);
    let (squares, product) = (outer.powi(2) + inner.powi(2), 2.0 * outer * inner);
    let reflectance = |nm: f64| {
        let wave = product * (4.0 * PI * film * thickness_nm / nm).cos();
        (squares + wave) / (1.0 + (outer * inner).powi(2) + wave)
    };
    // White point, for values that do not depend on the wavelength.
    let white = (0..1000)
        .map(|i| {
            let wave = product * (2.0 * PI * f64::from(i) / 1000.0).cos();
            (squares + wave) / (1.0 + (outer * inner).powi(2) + wave)
        })
        .sum::<f64>()
        / 1000.0;
    let (mut xyz, mut sum) = ([0.0; 3], 0.0);
    for nm in (360..830).map(f64::from) {
        let matching = color_matching(nm);
        sum += matching[1];
        for (channel, weight) in xyz.iter_mut().zip(matching) {
            *channel += (reflectance(nm) - white) * weight;
        }
    }
    let [x, y, z] = xyz.map(|channel| channel / sum);
    [
        white + 3.240_454_2 * x - 1.537_138_5 * y - 0.498_531_4 * z,
        white - 0.969_266 * x + 1.876_010_8 * y + 0.041_556 * z,
        white + 0.055_643_4 * x - 0.204_025_9 * y + 1.057_225_2 * z,
    ]
}

#[test]
fn a_film_has_the_colors_of_its_interference() {
    let up = DVec3::new(0.001, 1.0, 0.0).normalize();
    for (ior, thickness_nm) in [(1.3, 300.0), (1.8, 200.0), (1.8, 400.0)] {
        let film = format!(
            "base_color = [0, 0, 0]\niridescence = 1\niridescence_ior = {ior}\n\
             iridescence_thickness_nm = {thickness_nm}"
        );
        for below in [1.5_f64, 2.5] {
            let reflectivity = ((below - 1.0) / (below + 1.0)).powi(2);
            let dielectric = format!("{film}\nreflectivity = {reflectivity}");
            let metal = format!("{film}\nmetallic = 1")
                .replace("[0, 0, 0]", &format!("{:?}", [reflectivity; 3]));
            for material in [dielectric, metal] {
                let found = or_skip!(seen(up, &material, &[]));
                let expected = film_color(ior, below, thickness_nm);
                let errors = found.iter().zip(expected);
                let error = errors.map(|(f, e)| (f64::from(*f) - e).abs());
                assert!(
                    error.fold(0.0, f64::max) < 0.015, // error of the model
                    "{found:?}, expected {expected:?} of {material}"
                );
            }
        }
    }
}

#[test]
fn a_film_of_no_strength_or_no_thickness_is_not_seen() {
    let view = DVec3::new(0.5, 0.7, 0.0).normalize();
    for base in [
        "base_color = [0, 0, 0]",
        "metallic = 1\nbase_color = [0.9, 0.6, 0.3]",
    ] {
        let plain = or_skip!(seen(view, base, &[]));
        for film in [
            "iridescence = 0",
            "iridescence = 1\niridescence_thickness_nm = 0",
        ] {
            let found = seen(view, &format!("{base}\n{film}"), &[]).unwrap_or_default();
            for (found, plain) in found.into_iter().zip(plain) {
                assert!(
                    (found - plain).abs() < 2e-3,
                    "{found}, {plain}: {base} {film}"
                );
            }
        }
        let film = format!("{base}\niridescence = 1");
        let [red, _, blue] = seen(view, &film, &[]).unwrap_or_default();
        assert!((red - plain[0]).abs() + (blue - plain[2]).abs() > 0.02);
    }
}

/// The lobe of KHR_materials_anisotropy for a reflectance of 1, times the cosine of the light: x along the tangent,
/// z along the normal.
fn lobe(view: DVec3, light: DVec3, [along, across]: [f64; 2]) -> f64 {
    let half = (view + light).normalize();
    let stretched = half / DVec3::new(along, across, 1.0);
    let density = 1.0 / (PI * along * across * stretched.length_squared().powi(2));
    let masked = |d: DVec3| DVec3::new(along * d.x, across * d.y, d.z).length();
    density * 0.5 * light.z / (light.z * masked(view) + view.z * masked(light))
}

fn alphas(roughness: f64, anisotropy: f64) -> [f64; 2] {
    let across = roughness * roughness;
    [across + (1.0 - across) * anisotropy * anisotropy, across]
}

/// Albedo of the lobe: the share of even light that it reflects.
fn albedo(view: DVec3, alphas: [f64; 2]) -> f64 {
    let steps = 800;
    let sum: f64 = (0..steps * steps)
        .map(|i| {
            let up = (f64::from(i / steps) + 0.5) / f64::from(steps);
            let turn = 2.0 * PI * (f64::from(i % steps) + 0.5) / f64::from(steps);
            let flat = (1.0 - up * up).sqrt();
            lobe(
                view,
                DVec3::new(flat * turn.cos(), flat * turn.sin(), up),
                alphas,
            )
        })
        .sum();
    sum * 2.0 * PI / f64::from(steps * steps)
}

/// Rotates a direction from the axes of [`lobe`] to the world's; u of a plane grows along x.
fn on_floor(d: DVec3) -> DVec3 {
    DVec3::new(d.x, d.z, -d.y)
}

#[test]
fn grooves_reflect_their_directional_albedo() {
    for (roughness, anisotropy, turn) in [(0.4, 0.7, 0.2), (0.5, 1.0, 1.2), (0.6, 0.4, 0.0)] {
        let tilt = 50.0_f64.to_radians();
        let view = DVec3::new(
            tilt.sin() * f64::cos(turn),
            tilt.sin() * f64::sin(turn),
            tilt.cos(),
        );
        let metal = format!("metallic = 1\nbase_color = [1, 1, 1]\nanisotropy = {anisotropy}");
        let expected = albedo(view, alphas(roughness, anisotropy)) as f32;
        let own = format!("material.floor.roughness={roughness}");
        let found = or_skip!(seen(on_floor(view), &metal, &[&own]));
        assert_close(found[0], expected, 0.015);
        // Above the cut-off an isotropic lobe replaces the anisotropic one.
        let far = [own.as_str(), "reflection.roughness_cutoff=0"];
        let found = seen(on_floor(view), &metal, &far).unwrap_or_default();
        assert_close(found[0], expected, 0.12);
        // Multiple scattering restores about all energy that is lost between facets.
        let whole = [own.as_str(), "reflection.multiple_scattering=true"];
        let found = seen(on_floor(view), &metal, &whole).unwrap_or_default();
        assert_close(found[0], 1.0, 0.1);
    }
}

#[test]
fn a_lamp_on_grooves_shows_the_formula_in_their_direction() {
    let lamp = "[light.lamp]\nkind = \"directional\"\nintensity_lux = 2\ndirection = ";
    let view = DVec3::new(0.5, 0.2, 0.8).normalize();
    let light = DVec3::new(-0.1, -0.5, 0.8).normalize();
    let to = on_floor(-light);
    for rotation_deg in [0.0_f64, 90.0, 30.0] {
        let material = format!(
            "metallic = 1\nbase_color = [1, 1, 1]\nanisotropy = 0.6\nreflection = \"none\"\n\
             anisotropy_rotation_deg = {rotation_deg}\n{lamp}{:?}\n[material.floor]",
            to.to_array()
        );
        // Counter-clockwise rotation on the texture, whose upper side is at the y of the lobe.
        let turn = |d: DVec3| {
            let (sine, cosine) = rotation_deg.to_radians().sin_cos();
            DVec3::new(d.x * cosine + d.y * sine, d.y * cosine - d.x * sine, d.z)
        };
        let expected = 2.0 * lobe(turn(view), turn(light), alphas(0.4, 0.6));
        let text = material.replace("\n[material.floor]", "");
        let (material, lamp) = text.split_once("[light").expect("both");
        let own = format!("{material}roughness = 0.4\n[light{lamp}");
        let eye = (3.0 * on_floor(view)).to_array();
        let eye = format!("camera.main.eye={eye:?}");
        let text = FLOOR
            .replace(
                "[material.floor]\nroughness = 0\n",
                &format!("[material.floor]\n{own}\n"),
            )
            .replace("color = [1, 1, 1]\n[mat", "color = [0, 0, 0]\n[mat");
        let Some(gpu) = gpu() else { return };
        let found = mean(&render(gpu, &text, &[&eye], &[]))[0];
        assert_close(found, expected as f32, 0.02);
    }
}

/// A ball of glass before a checkerboard.
const BALL: &str = include_str!("film_grooves_dispersion/ball.toml");

#[test]
fn a_solid_bends_each_color_by_its_own_index() {
    let Some(gpu) = gpu() else { return };
    let of = |ior: &str, dispersion: u32| {
        let ior = format!("material.glass.ior={ior}");
        let dispersion = format!("material.glass.dispersion={dispersion}");
        render(gpu, BALL, &[&ior, &dispersion], &[])
    };
    let spread = of("1.5", 12);
    // Offsets of the channels' indices of refraction: 0.5 x 0.025 x 12.
    let plain = ["1.35", "1.5", "1.65"].map(|ior| of(ior, 0));
    for channel in 0..3 {
        let apart = |index: usize| {
            let plain = &plain[index];
            let all = (0..24).flat_map(|y| (0..24).map(move |x| (x, y)));
            let apart = all
                .map(|(x, y)| (color(&spread, x, y)[channel] - color(plain, x, y)[channel]).abs());
            apart.sum::<f32>() / (24.0 * 24.0)
        };
        let (own, other) = (apart(channel), apart(usize::from(channel != 1)));
        assert!(own < 0.03 && other > 2.0 * own, "{channel}: {own}, {other}");
    }
    // The sum over the channels is as bright as without dispersion.
    let sum = |c: [f32; 3]| Vec3::from(c).element_sum() / 3.0;
    assert_close(sum(mean(&spread)), sum(mean(&plain[1])), 0.05);
}
