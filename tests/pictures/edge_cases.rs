//! Edge cases: one pixel, very wide pictures, empty and unlit scenes.

use crate::kit::*;

const BALL: &str = include_str!("edge_cases/ball.toml");

#[test]
fn odd_tiny_and_wide_pictures_render() {
    let Some(gpu) = gpu() else { return };
    let sizes = ["[1, 1]", "[1, 7]", "[33, 17]", "[16384, 1]"];
    let ways = [
        ("hybrid", "raster"),
        ("hybrid", "rays"),
        ("rt", "rays"),
        ("ssr", "raster"),
    ];
    for (size, (method, visibility)) in sizes.iter().flat_map(|size| ways.map(|way| (size, way))) {
        let set = [
            &*format!("image.size={size}"),
            &format!("reflection.method={method}"),
            &format!("image.visibility={visibility}"),
        ];
        let picture = render(gpu, BALL, &set, &[Aov::Cause, Aov::Reflectance]);
        assert_eq!(
            picture.color.len(),
            4 * (picture.size[0] * picture.size[1]) as usize
        );
        assert!(picture.color.iter().all(|v| v.is_finite()));
    }
}

#[test]
fn a_mirror_that_fills_the_picture_is_listed_whole() {
    let Some(gpu) = gpu() else { return };
    for (method, edge_px) in [("hybrid", "0"), ("hybrid", "4"), ("rt", "0.25")] {
        let set = [
            "camera.main.eye=[0, 0, 1.05]",
            "camera.main.near_m=0.001",
            "image.size=[65, 33]",
            &format!("reflection.method={method}"),
            &format!("reflection.edge_px={edge_px}"),
        ];
        let picture = render(gpu, BALL, &set, &[Aov::Cause]);
        let shares = &picture.stats.shares;
        assert_eq!(shares.reflective, shares.pixels, "{method}");
        assert!(integers(&picture, Aov::Cause).iter().all(|c| *c != 0));
    }
}

#[test]
fn an_empty_scene_is_its_environment() {
    let Some(gpu) = gpu() else { return };
    let text = "version = 1\n[image]\nsize = [8, 4]\ntone_map = \"none\"\n[environment]\ncolor = [0.25, 0.5, 0.75]\n";
    let picture = render(gpu, text, &[], &Aov::ALL);
    assert_color(&picture, 3, 2, [0.25, 0.5, 0.75], 1e-3);
    assert_eq!(picture.stats.shares.reflective, 0);
    assert_eq!(picture.planes.len(), Aov::ALL.len());
}

#[test]
fn a_scene_without_lights_or_reflectors_is_lit_by_its_environment() {
    let Some(gpu) = gpu() else { return };
    let set = [
        "material.chrome.metallic=0",
        "material.chrome.roughness=1",
        "material.chrome.reflectivity=0",
    ];
    let picture = render(gpu, BALL, &set, &[]);
    assert_color(&picture, 8, 4, [0.25, 0.5, 0.75], 2e-3);
}

#[test]
fn a_camera_inside_or_on_a_mirror_gives_finite_pixels() {
    let Some(gpu) = gpu() else { return };
    for eye in ["[0, 0, 0]", "[0, 0, 1.001]", "[0, 0, 0.999]"] {
        for method in ["ssr", "rt", "hybrid"] {
            let set = [
                &*format!("camera.main.eye={eye}"),
                "camera.main.target=[0.1, 0.2, -5]",
                &format!("reflection.method={method}"),
            ];
            let picture = render(gpu, BALL, &set, &[]);
            assert!(
                picture.color.iter().all(|v| v.is_finite()),
                "{eye} {method}"
            );
        }
    }
}
