//! Audit of screen hits: its counts equal the comparison of two whole pictures.

use reflet::render::{
    passes::audit::{TOLERANCE_RELATIVE, TOLERANCE_U},
    renderer::stats::Audit,
};

use crate::kit::*;

const ATRIUM: &str = include_str!("../../scenes/atrium.toml");

/// A picture with an audit, and the audit computed by comparing all of its screen hits with `rt`.
fn audited(size: &str, method: Method) -> Option<(Picture, Audit)> {
    audited_of(ATRIUM, size, method)
}

/// The same of a scene.
fn audited_of(text: &str, size: &str, method: Method) -> Option<(Picture, Audit)> {
    let gpu = gpu()?;
    // The paper's rule errs often.
    let set = [
        size,
        "reflection.accept=threshold",
        "reflection.threshold_u=0.1",
    ];
    let (desc, world) = scene(text, &set);
    let of = |method, audit| {
        let mut options = RenderOptions {
            audit,
            ..RenderOptions::for_scene(&desc)
        };
        options.reflection.method = method;
        let mut renderer = or_panic!(Renderer::new(gpu, &shaders(), &world, &options));
        let aovs = [Aov::Cause, Aov::HitDistance, Aov::HitIds];
        renderer.first_view(&world, &aovs)
    };
    let (picture, truth) = (of(method, true), of(Method::Rt, false));
    let mut all = Audit::default();
    for (i, cause) in integers(&picture, Aov::Cause).iter().enumerate() {
        if *cause != Cause::Hit as u32 {
            continue;
        }
        let met = |p: &Picture| {
            (
                floats(p, Aov::HitDistance)[i],
                integers(p, Aov::HitIds)[2 * i],
            )
        };
        let ((found_m, found), (true_m, meant)) = (met(&picture), met(&truth));
        let tolerance_m = (TOLERANCE_U * picture.stats.unit_m).max(TOLERANCE_RELATIVE * true_m);
        let is_same = found == meant && (found_m - true_m).abs() <= tolerance_m;
        all.hits += 1;
        all.of += 1;
        all.wrong += u32::from(!is_same);
    }
    Some((picture, all))
}

#[test]
fn few_hits_are_all_traced_and_many_are_sampled() {
    let (small, all) = or_skip!(audited("image.size=[64, 36]", Method::Hybrid));
    assert!(all.hits < 1024 && all.wrong > 5, "{all}");
    assert_eq!(small.stats.audit, Some(all));

    let (large, all) = audited("image.size=[160, 90]", Method::Hybrid).expect("a GPU");
    let sampled = large.stats.audit.expect("an audit");
    assert!(all.hits > 1500, "{all}");
    assert_eq!((sampled.hits, sampled.of), (1024, all.hits));
    assert!(sampled.wrong_share().1.is_some() && all.wrong_share().1.is_none());
    let (share, _) = all.wrong_share();
    let (found, _) = sampled.wrong_share();
    let deviation = (share * (1.0 - share) / 1024.0).sqrt();
    assert!(
        (found - share).abs() < 5.0 * deviation,
        "{sampled}, all: {all}"
    );
}

/// Rays past all surfaces are listed for their fog, and are no hits.
#[test]
fn rays_into_fog_are_not_counted_as_hits() {
    let fog = "fog = { density = 0.01 }\nzenith = [0.13, 0.24, 0.52]";
    let text = ATRIUM.replace("zenith = [0.13, 0.24, 0.52]", fog);
    let small = audited_of(&text, "image.size=[64, 36]", Method::Hybrid);
    let (small, all) = or_skip!(small);
    let past = |p: &Picture| {
        let causes = integers(p, Aov::Cause);
        causes.iter().filter(|c| **c == Cause::None as u32).count()
    };
    assert!(past(&small) > 50 && all.hits > 100, "{all}");
    assert_eq!(small.stats.audit, Some(all));

    let (large, all) = audited_of(&text, "image.size=[160, 90]", Method::Hybrid).expect("a GPU");
    let sampled = large.stats.audit.expect("an audit");
    assert_eq!(sampled.of, all.of);
    // About as many of the checked entries are hits as of all.
    let listed = all.of as usize + past(&large);
    let expected = 1024.0 * f64::from(all.of) / listed as f64;
    assert!(listed > 1500, "{listed}");
    assert!(
        (f64::from(sampled.hits) - expected).abs() < 100.0,
        "{sampled}, all: {all}"
    );
}

#[test]
fn nothing_is_audited_where_no_hit_is_taken_from_the_screen() {
    for method in [Method::Rt, Method::Ssr] {
        let (picture, _) = or_skip!(audited("image.size=[32, 18]", method));
        assert_eq!(picture.stats.audit, None);
    }
}

#[test]
fn a_renderer_that_changes_its_method_audits_too() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(ATRIUM, &["image.size=[64, 36]"]);
    let mut options = RenderOptions {
        audit: true,
        ..RenderOptions::for_scene(&desc)
    };
    options.reflection.method = Method::Rt;
    let library = shaders();
    let mut renderer = or_panic!(Renderer::new(gpu, &library, &world, &options));
    for (method, size) in [
        (Method::Rt, [64, 36]),
        (Method::Hybrid, [64, 36]),
        (Method::Hybrid, [24, 16]),
    ] {
        options.reflection.method = method;
        options.image.size = size;
        or_panic!(renderer.change(gpu, &library, &world, &options));
        for _ in 0..3 {
            let picture = renderer.first_view(&world, &[]);
            assert_eq!(picture.stats.audit.is_some(), method == Method::Hybrid);
        }
    }
}
