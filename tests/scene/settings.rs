//! Settings of the whole scene: environment, reflection, image.

use std::path::Path;

use glam::Vec3;
use reflet::scene::{desc::*, stages::Scene};

use crate::text::read;

#[test]
fn environment_reflection_and_image_arrive() {
    let scene = read(
        "environment.color = [1, 2, 3]\n[reflection]\nmethod = \"ssr\"\nmarched = \"all\"\ntrace = \"query\"\nray_length_u = 2\n\
         accept = \"threshold\"\nedge_px = 0.5\nthreshold_u = 0\nbounces = 16\ndiffuse_bounces = 8\nglint_limit = 3\nsteps = 8\nroughness_cutoff = 1\nunit_m = 0.5\nreuse_light = false\nfade = true\nfilter = false\nmultiple_scattering = true\n\
         layers = 2\nseparation_m = 0.2\nrate = 4\nsimilarity = 0.5\nskip_px = 2.5\nblur_px = 1.5\n[probes]\nspacing_m = 2.5\nface_px = 2048\nsamples = 1024\nnearest = 4\n\
         lookup = \"distance\"\nselect = \"instance\"\n[near_far]\nhalf_size_m = 3.5\nface_px = 8\n[box_faces]\nbox_min = [-1, -2, -3]\nbox_max = [1, 2, 3]\nface_px = 16384\n[image]\nsize = [1, 16384]\nsamples = 4096\nlight_rays = 256\nexposure_ev = -20\n\
         tone_map = \"aces\"\nvisibility = \"rays\"\nradiance = \"full\"\nalpha = true\nshutter = 0.5",
    );
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
            marched: Marched::All,
            trace: Trace::Query,
            ray_length_u: 2.0,
            accept: Accept::Threshold,
            edge_px: 0.5,
            threshold_u: 0.0,
            bounces: Bounces::AtMost(16),
            diffuse_bounces: 8,
            glint_limit: 3.0,
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
            box_faces: BoxFacesDesc {
                box_min: Some(Vec3::new(-1.0, -2.0, -3.0)),
                box_max: Some(Vec3::new(1.0, 2.0, 3.0)),
                face_px: 16384,
            },
            near_far: NearFarDesc {
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
    let (exposure, bounces) = ("image.exposure_ev", "reflection.bounces");
    for (key, value, message) in [
        (
            exposure,
            "\"automatic\"",
            "must be a number or \"auto\", not",
        ),
        (exposure, "30", "`exposure_ev` must be"),
        (exposure, "true", "must be a number or \"auto\", not true"),
        (
            bounces,
            "\"autos\"",
            "must be a whole number or \"auto\", not",
        ),
        (
            bounces,
            "\"Auto\"",
            "must be a whole number or \"auto\", not",
        ),
        (bounces, "0", "must be 1 to 16, not 0"),
        (bounces, "-1", "must be 1 to 16, not -1"),
        (bounces, "1e9", "must be 1 to 16, not"),
        (bounces, "inf", "must be a finite number, not"),
        (bounces, "2.5", "must be a whole number, not"),
        (bounces, "[3]", "must be a whole number or \"auto\", not"),
    ] {
        let text = format!("version = 1\n{key} = {value}\n");
        let errors = Scene::from_text(&text, Path::new("scene.toml"), &[]).expect_err("is wrong");
        let error = errors[0].to_string();
        assert!(error.contains(message), "{error}");
    }
}
