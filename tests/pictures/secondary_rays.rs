//! Rays that mirror rays bring, onward and towards lights, as the cost model counts them on the CPU.

use reflet::{
    render::{
        decide::{cost::Pair, decide, secondary_rays::SecondaryRays, workload},
        settings::unit_costs::UnitCosts,
    },
    world::bvh::Trees,
};

use crate::kit::*;

/// A mirror floor before a bright wall, in a room without gaps.
const ROOM: &str = include_str!("secondary_rays/room.toml");

#[test]
fn the_cpu_counts_the_rays_that_mirror_rays_bring() {
    let lamp = |shadow: &str| {
        format!(
            "{ROOM}[light.lamp]\nkind = \"point\"\nposition = [1, 6, 0]\nintensity_cd = 5\nshadow = \"{shadow}\"\n"
        )
    };
    let lit = ROOM.replace("emission = [4, 4, 4]", "emission = [4, 4, 4]\nlight = true");
    let matte = ["reflection.diffuse_bounces=2", "reflection.bounces=1"];
    for (text, set) in [
        (ROOM.to_owned(), &[][..]),
        (lamp("ray"), &[]),
        (lit, &[]),
        (ROOM.to_owned(), &matte),
    ] {
        let (desc, world) = scene(&text, set);
        let trees = Trees::build(&world, u64::MAX).expect("small");
        let work = workload(&world, &trees, &RenderOptions::for_scene(&desc));
        let secondary = work.view.secondary;
        let rays = secondary.onward.rays + secondary.shadow.rays + secondary.light.rays;
        let is_plain = text == ROOM && set.is_empty();
        assert_eq!(rays == 0, is_plain, "{secondary:?}");
        // Both methods take the same time for them.
        let mut plain = work.clone();
        plain.view.secondary = SecondaryRays::default();
        let [with, without] =
            [&work, &plain].map(|w| w.reflections(&UnitCosts::PROCESSOR, |_| false));
        let difference = |pair: &Pair| pair.ms()[0] - pair.ms()[1];
        assert!((difference(&with) - difference(&without)).abs() < 1e-9);
        assert_eq!(with.ms()[1] > without.ms()[1], !is_plain);

        let Some(gpu) = gpu() else { continue };
        let camera = &world.cameras[0].value;
        let mut renderer = renderer(gpu, &desc, &world, false);
        let counts = renderer.counts(gpu, camera).expect("counted");
        let on_gpu = counts.iter().find(|pass| pass.pass == "trace");
        let on_gpu = on_gpu.expect("mirror rays").counts.traversals as f64;
        let on_cpu = work.weight() * f64::from(work.view.all_mirror().rays + rays);
        let ratio = on_cpu / on_gpu;
        assert!(
            (0.8..1.25).contains(&ratio),
            "{on_cpu} against {on_gpu}: {secondary:?}"
        );
    }
}

#[test]
fn costs_of_other_adapters_are_shown_where_they_choose_otherwise() {
    let text = ROOM.replace("method = \"rt\"", "method = \"auto\"");
    let why = |software: bool| {
        let (desc, world) = scene(&text, &[]);
        let trees = Trees::build(&world, u64::MAX).expect("small");
        let found = decide(&world, &trees, &RenderOptions::for_scene(&desc), software);
        let method = found
            .decisions
            .iter()
            .find(|d| d.what == "reflection.method");
        method
            .map(|d| (d.chosen.clone(), d.why.clone()))
            .expect("decided")
    };
    let (chosen, on_gpus) = why(false);
    assert_eq!(chosen, "rt");
    assert!(on_gpus.contains("of 2013, hybrid takes 0."), "{on_gpus}");
    assert!(!why(true).1.contains("2013"));
}
