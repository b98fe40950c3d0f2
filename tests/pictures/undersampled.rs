//! Undersampled rays: pixels that reuse hits of the rays around them.

use crate::kit::*;

/// A mirror that shows one wall, and with a height, a ball before it.
const SCENE: &str = include_str!("undersampled/scene.toml");

const BALL: &str = "instance.ball.translation=[0.3, 0.9, -1]";
/// The wall leaves the sky in the mirror.
const SKY: &str = "model.wall.shape={ kind = \"box\", size = [60, 1, 0.1] }";
const AOVS: [Aov; 3] = [Aov::HitDistance, Aov::HitIds, Aov::Source];

fn shown(rate: u32, set: &[&str]) -> Option<Picture> {
    shown_by("rt", rate, set)
}

fn shown_by(method: &str, rate: u32, set: &[&str]) -> Option<Picture> {
    let settings = [
        format!("reflection.method={method}"),
        format!("reflection.rate={rate}"),
    ];
    let set = [set, &[&settings[0], &settings[1]]].concat();
    Some(render(gpu()?, SCENE, &set, &AOVS))
}

/// The hit's geometry is taken over and shaded anew, so that the checker is as sharp as with all rays.
#[test]
fn a_mirror_that_shows_one_plane_is_that_of_all_rays() {
    for (set, rate, most) in [
        (&[][..], 2, 0.56),
        (&[][..], 4, 0.32),
        (&[SKY][..], 4, 0.32),
    ] {
        let Some(all) = shown(1, set) else { return };
        let some = shown(rate, set).expect("a GPU");
        let share = f64::from(some.stats.rays) / f64::from(all.stats.rays);
        assert!(share < most, "{set:?}, rate {rate}: {share} of the rays");
        assert_eq!(share_differing(&some, &all, 1), 0.0, "{set:?}, rate {rate}");
        assert_eq!(integers(&some, Aov::HitIds), integers(&all, Aov::HitIds));
        let distances = floats(&some, Aov::HitDistance).iter();
        let apart = distances
            .zip(floats(&all, Aov::HitDistance))
            .map(|(a, b)| match a == b {
                true => 0.0,
                false => (a - b).abs() / b,
            });
        assert!(apart.fold(0.0, f32::max) < 1e-4);
    }
}

/// Hits that neighbors share are listed beside hits of the march, in every sub-frame.
#[test]
fn the_march_and_shared_hits_show_what_all_rays_do() {
    let set = [BALL, "image.samples=2"];
    let Some(all) = shown_by("hybrid", 1, &set) else {
        return;
    };
    let some = shown_by("hybrid", 2, &set).expect("a GPU");
    assert!(
        some.stats.rays + 100 < all.stats.rays,
        "{} rays",
        some.stats.rays
    );
    assert_eq!(integers(&some, Aov::Source), integers(&all, Aov::Source));
    let share = share_differing(&some, &all, 4);
    assert!(share < 0.01, "{share}");
}

#[test]
fn edges_are_traced_and_only_similar_pixels_share() {
    let Some(all) = shown(1, &[BALL]) else { return };
    let some = shown(2, &[BALL]).expect("a GPU");
    let of_ball = |p: &Picture| {
        integers(p, Aov::HitIds)
            .chunks(2)
            .filter(|id| id[0] == 2)
            .count()
    };
    assert!(of_ball(&all) > 60, "{}", of_ball(&all));
    assert_eq!(of_ball(&some), of_ball(&all));
    // The ball's small triangles are taken over from a pixel away.
    let share = share_differing(&some, &all, 4);
    assert!(share < 0.01, "{share}");
    let plane = shown(2, &[]).expect("a GPU");
    assert!(some.stats.rays > plane.stats.rays + 20, "edges are traced");
    // Less tolerance never traces fewer rays, nor errs more.
    let none = shown(2, &[BALL, "reflection.similarity=0"]).expect("a GPU");
    assert!(none.stats.rays >= some.stats.rays);
    assert!(share_differing(&none, &all, 2) <= share_differing(&some, &all, 2));
}

/// Rays that are traced first end in maps as all do: their causes, and the counts of these, say so.
#[test]
fn rays_that_are_traced_first_keep_how_they_ended_in_maps() {
    let Some(gpu) = gpu() else { return };
    let cases = [
        (
            Method::NearFar,
            Cause::Far,
            2,
            (|x, y| x % 2 == y % 2) as fn(usize, usize) -> bool,
        ),
        (Method::SsrBox, Cause::Box, 4, |x, y| {
            x % 2 == 0 && y % 2 == 0
        }),
    ];
    for &(method, found, rate, is_first) in first_or_all(&cases, 1) {
        let [some, all] = [rate, 1].map(|rate| {
            let method = format!("reflection.method=\"{}\"", method.name());
            let rate = format!("reflection.rate={rate}");
            let set = [&method, &rate, "near_far.half_size_m=1", BALL];
            render(gpu, SCENE, &set, &[Aov::Cause])
        });
        let causes = integers(&some, Aov::Cause);
        let pairs = causes.iter().zip(integers(&all, Aov::Cause)).enumerate();
        let mut in_maps = 0;
        for (index, (cause, expected)) in pairs.filter(|(i, _)| is_first(i % 96, i / 96)) {
            assert_eq!(cause, expected, "{method:?}, pixel {index}");
            in_maps += usize::from(*cause == found as u32);
        }
        assert!(in_maps > 60, "{method:?}: {in_maps}");
        for share in &some.stats.shares.causes {
            let is_it = |cause: &&u32| Cause::ALL[**cause as usize].name() == share.name;
            let shown = causes.iter().filter(is_it).count();
            assert_eq!(shown as u64, share.pixels, "{method:?}: {}", share.name);
        }
    }
}
