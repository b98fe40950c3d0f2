//! `marched = "cheaper"`: surfaces whose rays take less time to trace are never marched; the others are.

use reflet::{
    render::{
        decide::{Decided, decide},
        pipeline::cause::Source,
        settings::unit_costs::UnitCosts,
    },
    world::bvh::Trees,
};

use crate::kit::*;

/// A mirror floor that shows a wall which the picture shows too, and a mirror ball that shows what it does not.
const SCENE: &str = include_str!("marched/scene.toml");

/// Costs at which a march takes less time than a trace, and passes take none.
const COSTS: UnitCosts = UnitCosts {
    march_ray: 10.0,
    march_node: 0.0,
    hit: 10.0,
    pyramid_pixel: 0.0,
    pass: 0.0,
    ..UnitCosts::PROCESSOR
};

fn decided(set: &[&str], costs: UnitCosts) -> Decided {
    let (desc, world) = scene(SCENE, set);
    let mut options = RenderOptions::for_scene(&desc);
    options.costs = Some(costs);
    let trees = Trees::build(&world, u64::MAX).expect("small");
    decide(&world, &trees, &options, true)
}

const HYBRID: &str = "reflection.method=hybrid";
const CHEAPER: &str = "reflection.marched=cheaper";

#[test]
fn surfaces_are_marched_where_that_is_cheaper() {
    let (floor, globe) = (0, 2);
    for set in [&[HYBRID, CHEAPER][..], &["reflection.method=auto"]] {
        let found = decided(set, COSTS);
        assert_eq!(
            found.options.reflection.method,
            Method::Hybrid,
            "{:?}",
            found.decisions
        );
        assert_eq!(
            (found.traced[floor], found.traced[globe]),
            (false, true),
            "{:?}",
            found.decisions
        );
        let marched = found
            .decisions
            .iter()
            .find(|d| d.what == "reflection.marched");
        assert_eq!(marched.map(|d| d.chosen.as_str()), Some("1 of 2 surfaces"));
    }
    // All surfaces are marched where the scene says so, or no method is `auto`.
    let all = ["reflection.method=auto", "reflection.marched=all"];
    for set in [&[HYBRID][..], &all] {
        assert!(!decided(set, COSTS).traced.contains(&true));
    }
    // With nothing cheaper to march, rays are traced at once.
    let dear = UnitCosts {
        march_ray: 1e6,
        ..COSTS
    };
    let found = decided(&[HYBRID, CHEAPER], dear);
    assert_eq!(found.options.reflection.method, Method::Rt);
    assert!(found.traced.is_empty());
}

#[test]
fn traced_surfaces_are_not_marched_and_look_as_before() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(SCENE, &[HYBRID, CHEAPER]);
    let mut options = RenderOptions::for_scene(&desc);
    options.costs = Some(COSTS);
    let mut renderer = Renderer::new(gpu, &shaders(), &world, &options).expect("built");
    let aovs = [Aov::Cause, Aov::Ids];
    let split = renderer.first_view(&world, &aovs);
    let traced = renderer.ray_list(gpu).expect("read").expect("a list");
    let all = render(gpu, SCENE, &[HYBRID], &aovs);
    let rt = render(gpu, SCENE, &["reflection.method=rt"], &[]);

    let causes = [&split, &all].map(|picture| integers(picture, Aov::Cause));
    let unmarched = |causes: &[u32]| {
        let is_unmarched = |cause: &&u32| **cause == Cause::Unmarched as u32;
        causes.iter().filter(is_unmarched).count()
    };
    assert_eq!(unmarched(causes[1]), 0);
    let mut listed = vec![false; 96 * 54];
    for [x, y] in traced {
        let place = (y * 96 + x) as usize;
        assert!(!listed[place], "{x}, {y} is traced twice");
        listed[place] = true;
    }
    let mut on_globe = 0;
    for (pixel, (now, before)) in causes[0].iter().zip(causes[1]).enumerate() {
        let cause = Cause::from_number(*now).expect("a cause");
        let is_traced = cause.source(Method::Hybrid) == Source::Traced;
        assert_eq!(listed[pixel], is_traced, "pixel {pixel}: {cause:?}");
        if cause == Cause::Unmarched {
            on_globe += 1;
        } else {
            assert_eq!(now, before, "pixel {pixel}");
        }
    }
    assert!(on_globe > 100, "{on_globe}");
    assert!(causes[0].contains(&(Cause::Hit as u32)));
    let [to_all, to_rt] = [&all, &rt].map(|other| share_differing(&split, other, 2));
    assert!(to_all < 0.01 && to_rt < 0.03, "{to_all} {to_rt}");
}
