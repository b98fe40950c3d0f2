//! Counters of passes: closed forms, and invariants of any scene.

use reflet::render::{
    PlaneData,
    pipeline::instrument::{Counts, PassCounts},
};

use crate::kit::*;

const ATRIUM: &str = include_str!("../../scenes/atrium.toml");

/// A renderer of the scene and its counts.
fn counted(text: &str, set: &[&str]) -> Option<(Renderer, World, Vec<PassCounts>)> {
    let gpu = gpu()?;
    let (desc, world) = scene(text, set);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let counts = or_panic!(renderer.counts(gpu, &world.cameras[0].value));
    Some((renderer, world, counts))
}

fn counts_of(counts: &[PassCounts], pass: &str) -> Counts {
    let found = counts.iter().find(|c| c.pass == pass);
    found
        .unwrap_or_else(|| panic!("{pass} did not count"))
        .counts
}

/// A mirror that faces the camera sends the ray of a pixel outward along its row, ever closer to
/// the camera, so that it crosses nothing: every step leaves a cell of the depth pyramid, and the
/// next cell is twice as wide, until the border is reached or no step is left.
#[test]
fn a_march_to_the_border_takes_the_steps_that_its_length_says() {
    for steps in [8u32, 64] {
        let set = [
            "image.size=[65, 1]",
            "camera.main.fov_deg=1",
            "reflection.method=ssr",
            &format!("reflection.steps={steps}"),
        ];
        let (_, _, counts) = or_skip!(counted(FACING, &set));
        let steps_of = |start: i32| -> u64 {
            if start == 32 {
                return 0; // straight back: no pixel is left
            }
            let outward = (start - 32).signum();
            let (mut x, mut level, mut taken) = (start + outward, 0, 0);
            while (0..65).contains(&x) && taken < steps {
                let cell = x >> level;
                x = if outward > 0 {
                    (cell + 1) << level
                } else {
                    (cell << level) - 1
                };
                level = (level + 1).min(6);
                taken += 1;
            }
            taken.into()
        };
        let expected: u64 = (0..65).map(steps_of).sum();
        let ssr = counts_of(&counts, "ssr");
        assert_eq!(ssr.march_steps, expected, "{steps} steps at most");
        assert_eq!((ssr.traversals, ssr.visited_nodes), (0, 0));
    }
}

/// All four triangles of the facing mirrors fit one BVH node, so that every bounce of every ray visits
/// that one. It tests the two triangles ahead, and at most the two that it leaves: boxes are rounded
/// outward.
#[test]
fn facing_mirrors_visit_one_node_a_bounce() {
    for bounces in [1u64, 5] {
        let set = [
            "reflection.method=rt",
            &format!("reflection.bounces={bounces}"),
            "image.samples=2",
        ];
        let (_, _, counts) = or_skip!(counted(FACING, &set));
        let trace = counts_of(&counts, "trace");
        let rays = 2 * 81 * bounces; // sub-frames × pixels × bounces
        assert_eq!((trace.traversals, trace.visited_nodes), (rays, rays));
        let tested = trace.tested_triangles;
        assert!((2 * rays..=4 * rays).contains(&tested), "{tested}");
        assert_eq!(counts.len(), 2, "rt does not march: {counts:?}");
    }
}

/// With a reflectance of 0.075 the throughput is 1.4 / 255 after two reflections and 0.1 / 255 after three: a third
/// bounce is traced, a fourth is not.
#[test]
fn bounces_end_where_the_throughput_falls_below_a_level_of_255() {
    let set = [
        "reflection.method=rt",
        "reflection.bounces=16",
        "material.mirror.reflectivity=0.075",
    ];
    let (_, _, counts) = or_skip!(counted(FACING, &set));
    assert_eq!(counts_of(&counts, "trace").traversals, 3 * 81);
}

/// With a strength of 0 nothing is reflected, so that no ray is sent, and the picture is the same; but glass
/// reflects inside.
#[test]
fn surfaces_without_a_specular_lobe_send_no_rays() {
    let mirror = "material.mirror.specular=0";
    for method in first_or_all(&["hybrid", "rt"], 1) {
        let method = format!("reflection.method={method}");
        let other = "instance.1.material={ specular = 1 }";
        let (renderer, _, counts) = or_skip!(counted(FACING, &[mirror, &method]));
        let sent = |counts: &[PassCounts]| counts.iter().map(|c| c.counts.traversals).sum::<u64>();
        assert!(
            !renderer.plan().features.reflections && sent(&counts) == 0,
            "{counts:?}"
        );
        // The camera sees only one of the two facing mirrors, which does not reflect.
        let (_, _, counts) = counted(FACING, &[mirror, other, &method]).expect("there is a GPU");
        assert_eq!(sent(&counts), 0, "{method}: {counts:?}");
        let gpu = gpu().expect("as before");
        let almost = "material.mirror.specular=0.000001";
        let [none, almost] = [mirror, almost].map(|s| render(gpu, FACING, &[s, &method], &[]));
        let pairs = none.color.iter().zip(&almost.color);
        assert!(
            pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-4),
            "{method}"
        );
    }
}

#[test]
fn every_pixel_sends_one_ray_to_each_light_behind_glass_and_to_other_surfaces() {
    let text = include_str!("counts/every_lit_pixel_sends_one_shadow_ray_to_each_light.toml");
    let (_, _, counts) = or_skip!(counted(text, &[]));
    let light = counts_of(&counts, "light");
    assert_eq!((light.traversals, light.visited_nodes), (288, 288));
    assert_eq!(light.march_steps, 0);
    assert_eq!(counts.len(), 1, "nothing reflects: {counts:?}");
    for (set, pass) in [
        ("material.gray.transmission=1", "transmit"),
        ("reflection.diffuse_bounces=1", "indirect"),
    ] {
        let (_, _, counts) = or_skip!(counted(text, &["material.gray.roughness=0", set]));
        let counts = counts_of(&counts, pass);
        assert_eq!(
            (counts.traversals, counts.visited_nodes),
            (144, 144),
            "{pass}"
        );
    }
}

#[test]
fn counts_repeat_and_hybrid_visits_no_more_than_rt() {
    let Some(gpu) = gpu() else { return };
    let of_method = |method: &str| {
        let set = [
            "image.size=[160, 90]",
            "reflection.accept=threshold",
            &format!("reflection.method={method}"),
        ];
        let (mut renderer, world, first) = counted(ATRIUM, &set).expect("a GPU");
        let camera = &world.cameras[0].value;
        assert_eq!(or_panic!(renderer.counts(gpu, camera)), first);
        first
    };
    let [ssr, hybrid, rt] = ["ssr", "hybrid", "rt"].map(of_method);
    let names = |counts: &[PassCounts]| counts.iter().map(|c| c.pass).collect::<Vec<_>>();
    assert_eq!(names(&ssr), ["light", "ssr", "trace"]);
    assert_eq!(names(&rt), ["light", "trace"]);
    assert_eq!(
        counts_of(&ssr, "ssr"),
        counts_of(&hybrid, "ssr"),
        "the same march"
    );
    let [some, all] = [&hybrid, &rt].map(|counts| counts_of(counts, "trace"));
    for ((what, some), (_, all)) in some.named().into_iter().zip(all.named()).skip(1) {
        assert!(0 < some && some < all, "{what}: {some} of {all}");
    }
}

/// Probes do not affect the frame: a picture is the same before and after them.
#[test]
fn probes_leave_pictures_alone() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(ATRIUM, &["image.size=[160, 90]"]);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let camera = &world.cameras[0].value;
    let hits = [Aov::Cause, Aov::HitDistance, Aov::HitIds];
    let mut picture = || or_panic!(renderer.picture(gpu, camera, &hits));
    let before = picture();
    or_panic!(renderer.counts(gpu, camera));
    let ms = or_panic!(renderer.traversal_ms(gpu, camera));
    assert!(ms.is_none_or(|ms| ms > 0.0));
    // The rays without shading have the same hits.
    for (aov, plane) in hits.iter().zip(&before.planes) {
        assert_eq!(or_panic!(aov.plane(gpu, &renderer, camera)), *plane);
    }
    let crossings = or_panic!(renderer.crossings(gpu, camera, &hits));
    let [PlaneData::U32(cause), PlaneData::F32(distance_m)] = [0, 1].map(|i| &crossings[i].data)
    else {
        panic!("other planes were asked for");
    };
    let mut refused = 0;
    for (i, marched) in integers(&before, Aov::Cause).iter().enumerate() {
        match Cause::from_number(*marched) {
            Some(Cause::Hit) => {
                assert_eq!(distance_m[i], floats(&before, Aov::HitDistance)[i]);
                assert_eq!(cause[i], *marched);
            }
            Some(Cause::Hidden | Cause::Unconfirmed | Cause::BackFace | Cause::Reflector) => {
                assert_eq!(cause[i], Cause::Hit as u32, "pixel {i} crossed something");
                refused += 1;
            }
            _ => assert_eq!(cause[i], *marched),
        }
    }
    assert!(refused > 100, "only {refused} crossings were refused");
    let after = or_panic!(renderer.picture(gpu, camera, &hits));
    assert_eq!(
        (&after.display, &after.planes),
        (&before.display, &before.planes)
    );
}
