//! Light that is scattered inside of solids, against closed forms and a walk on the processor.

use super::kit::*;

/// White solids beside each other: of wax, of smooth and of rough glass.
const WHITE: &str = include_str!("scattering/white.toml");

/// Asserts that each of three numbers is the expected one within `tolerance`.
fn assert_color(found: [f32; 3], expected: [f32; 3], tolerance: f32) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert_close(found, expected, tolerance);
    }
}

/// Brightness of each of the white solids.
fn whites(gpu: &Gpu, set: &[&str]) -> [f32; 3] {
    let picture = render(gpu, WHITE, set, &[]);
    let mean = |x: u32| {
        (0..64)
            .flat_map(|i| color(&picture, x + i % 8, i / 8))
            .sum::<f32>()
    };
    [0, 8, 16].map(|x| mean(x) / 192.0)
}

#[test]
fn white_solids_return_all_light_that_enters() {
    let Some(gpu) = gpu() else { return };
    assert_color(whites(gpu, &[]), [1.0; 3], 0.02);
    // Maps of probes, whose rays walk through no solid, show wax as without paths.
    let mirror = [
        "model.milk.material=wax",
        "model.jade.material=mirror",
        "reflection.method=probe",
        "reflection.diffuse_bounces=1",
        "image.samples=1",
    ];
    let picture = render(gpu, WHITE, &mirror, &[]);
    for i in 0..64 {
        assert_color(color(&picture, 16 + i % 8, i / 8), [1.0; 3], 0.05);
    }
}

/// Light samples of points within go straight through surfaces that refract, and are as bright as refracted rays.
#[test]
fn lamps_light_solids_within_alike_by_samples_and_by_rays() {
    let Some(gpu) = gpu() else { return };
    let lit = [
        "environment.color=[0, 0, 0]",
        "light.lamp.position=[0, 4, 3]",
        "light.lamp.intensity_cd=40",
    ];
    let sampled = [
        "reflection.method=rt",
        "reflection.diffuse_bounces=2",
        "reflection.glint_limit=0",
    ];
    let samples = |n| format!("image.samples={n}");
    let [by_rays, by_samples] = [(&[][..], 128), (&sampled[..], 32)]
        .map(|(set, n)| whites(gpu, &[&lit, set, &[samples(n).as_str()]].concat()));
    assert_color(by_samples, by_rays, 0.08);
}

const COLOR: [f32; 3] = [0.8, 0.6, 0.3];

/// Color of a slab: `thick` or `thin`.
fn slab(gpu: &Gpu, seen: &str, set: &[&str]) -> [f32; 3] {
    let other = if seen == "thin" { "thick" } else { "thin" };
    let text = include_str!("scattering/slabs.toml");
    let text = text.replace("SEEN", seen).replace("OTHER", other);
    mean(&render(gpu, &text, set, &[]))
}

#[test]
fn a_thick_solid_returns_its_color_and_a_thin_one_what_a_walk_says() {
    let Some(gpu) = gpu() else { return };
    // Light that is scattered onward goes deeper, but in the same color.
    for anisotropy in ["0", "0.6"] {
        let set = format!("material.thick.scattering_anisotropy={anisotropy}");
        assert_color(slab(gpu, "thick", &[&set]), COLOR, 0.03);
    }
    let walked = COLOR.map(|color| seen_through_sheet(color.into()) as f32);
    assert_color(slab(gpu, "thin", &[]), walked, 0.03);
}

#[test]
fn light_leaves_a_solid_where_it_entered_if_no_path_is_followed() {
    let Some(gpu) = gpu() else { return };
    let plain = ["reflection.method=rt", "image.samples=1"];
    assert_color(slab(gpu, "thick", &plain), COLOR, 2e-3);
    // A clear coat over a white solid takes from it what it returns itself.
    let coat = [
        "material.thick.clearcoat=1",
        "material.thick.scattering_color=[1, 1, 1]",
    ];
    let coated = slab(gpu, "thick", &[plain, coat].concat());
    assert_color(coated, [1.0; 3], 2e-3);
}

/// Light that arrives straight from above out of a sheet one mean free path thick with this multiple-scattering color, in the
/// scene's environment: the mean over walks of a photon backwards.
fn seen_through_sheet(color: f64) -> f64 {
    // The inverse of van de Hulst's albedo by bisection, not by the fit that the renderer takes.
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..60 {
        let lack: f64 = 0.5 * (low + high);
        let back = (1.0 - lack) * (1.0 - 0.139 * lack) / (1.0 + 1.17 * lack);
        let end = if back > color { &mut low } else { &mut high };
        *end = lack;
    }
    let albedo = 1.0 - low * low;
    let mut numbers = crate::common::Random(0x5eed_0003);
    let mut random = || (numbers.below(1 << 31) as f64 + 0.5) / f64::from(1_u32 << 31);
    let walks = 40_000;
    let mut sum = 0.0;
    for _ in 0..walks {
        let (mut depth, mut down, mut weight) = (0.0, 1.0, 1.0);
        loop {
            depth -= random().ln() * down;
            if !(0.0..=1.0).contains(&depth) {
                // Radiance of the environment in this direction.
                sum += weight * (1.0 - f64::max(down, 0.0));
                break;
            }
            weight *= albedo;
            down = 2.0 * random() - 1.0;
        }
    }
    sum / f64::from(walks)
}
