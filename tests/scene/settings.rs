//! Settings of the whole scene: environment, reflection, image.

use reflet::scene::desc::*;

use crate::{kit::*, text::read};

#[test]
fn environment_reflection_and_image_arrive() {
    let scene = read(include_str!(
        "settings/environment_reflection_and_image_arrive.toml"
    ));
    let color = Vec3::new(1.0, 2.0, 3.0);
    let flat = EnvironmentDesc {
        zenith: color,
        horizon: color,
        ground: color,
        shadow: EnvironmentShadow::None,
        is_written: true,
        ..EnvironmentDesc::default()
    };
    assert_eq!(scene.environment, flat);
    let probes = ProbesDesc {
        spacing_m: Some(2.5),
        face_px: 2048,
        samples: 1024,
        nearest: 4,
        lookup: Lookup::Distance,
        select: SelectBy::Instance,
    };
    assert_eq!(
        scene.reflection,
        ReflectionDesc {
            method: Method::Ssr,
            trace: Trace::Query,
            ray_length_u: 2.0,
            accept: Accept::Threshold,
            edge_px: 0.5,
            threshold_u: 0.0,
            bounces: Bounces::AtMost(16),
            diffuse_bounces: 8,
            glint_limit: Some(3.0),
            steps: 8,
            layers: 2,
            separation_m: Some(0.2),
            rate: 4,
            similarity: 0.5,
            skip_px: 2.5,
            roughness_cutoff: 1.0,
            unit_m: Some(0.5),
            reuse_light: false,
            fade: true,
            filter: false,
            multiple_scattering: true,
            blur_px: 1.5,
            probes,
            box_faces: reflection::BoxFacesDesc {
                box_min: Some(Vec3::new(-1.0, -2.0, -3.0)),
                box_max: Some(Vec3::new(1.0, 2.0, 3.0)),
                face_px: 16384,
            },
            near_far: reflection::NearFarDesc {
                half_size_m: Some(3.5),
                face_px: 8,
            },
        }
    );
    let (samples, exposure_ev, tone_map) = (4096, Exposure::Ev(-20.0), ToneMap::Aces);
    assert_eq!(
        scene.image,
        ImageDesc {
            size: [1, 16384],
            samples: Samples::Count(samples),
            light_rays: Some(256),
            exposure_ev,
            tone_map,
            visibility: Visibility::Rays,
            radiance: Radiance::Full,
            alpha: true,
            shutter: 0.5,
        }
    );
}

#[test]
fn light_rays_and_gradients_have_defaults() {
    let color = Vec3::new(1.0, 2.0, 3.0);
    let image = |text: &str| read(text).image.light_rays();
    let rays = [
        "",
        "image.samples = 3",
        "image.samples = 4",
        "image.samples = 7",
        "image.light_rays = 9",
    ]
    .map(image);
    assert_eq!(rays, [4, 2, 2, 1, 9]);
    let gradient = read("environment.zenith = [1, 2, 3]").environment;
    assert_eq!(
        gradient,
        EnvironmentDesc {
            zenith: color,
            shadow: EnvironmentShadow::None,
            is_written: true,
            ..EnvironmentDesc::default()
        }
    );
}

#[test]
fn exposure_and_bounces_are_numbers_or_auto() {
    let ev = |text: &str| {
        read(&format!("image.exposure_ev = {text}"))
            .image
            .exposure_ev
    };
    assert_eq!(
        [ev("2"), ev("\"auto\"")],
        [Exposure::Ev(2.0), Exposure::Auto]
    );
    let bounces = |text: &str| {
        read(&format!("reflection.bounces = {text}"))
            .reflection
            .bounces
    };
    assert_eq!(
        [bounces("3"), bounces("\"auto\"")],
        [Bounces::AtMost(3), Bounces::Auto]
    );
    for (setting, message) in cases(include_str!("settings/exposure_and_bounces.txt")) {
        let text = format!("version = 1\n{setting}\n");
        let errors = Scene::from_text(&text, Path::new("scene.toml"), &[]).expect_err("is wrong");
        let error = errors[0].to_string();
        assert!(error.contains(message), "{error}");
    }
}
