//! Pairs of renders that must agree: traced pixels of both methods, static and dynamic, moved and
//! rebuilt.

use glam::{Affine3A, Quat};
use reflet::{render::pipeline::cause::Source, scene::desc::LightKind, world::Instance};

use crate::kit::*;

const ATRIUM: &str = include_str!("../../scenes/atrium.toml");
const SMALL: &str = "image.size=[160, 90]";

#[test]
fn traced_pixels_of_hybrid_equal_rt_bit_for_bit() {
    let Some(gpu) = gpu() else { return };
    let of = |method: &str| {
        let aovs = [Aov::Reflection, Aov::Source, Aov::HitDistance, Aov::HitIds];
        render(
            gpu,
            ATRIUM,
            &[SMALL, &format!("reflection.method={method}")],
            &aovs,
        )
    };
    let (hybrid, rt) = (of("hybrid"), of("rt"));
    let mut traced = 0;
    for (i, source) in integers(&hybrid, Aov::Source).iter().enumerate() {
        if *source != Source::Traced as u32 {
            continue;
        }
        traced += 1;
        let pixel = |p: &Picture| {
            let bits = floats(p, Aov::Reflection)[3 * i..3 * i + 3]
                .iter()
                .map(|v| v.to_bits())
                .collect::<Vec<_>>();
            (
                bits,
                floats(p, Aov::HitDistance)[i].to_bits(),
                integers(p, Aov::HitIds)[2 * i..2 * i + 2].to_vec(),
            )
        };
        assert_eq!(pixel(&hybrid), pixel(&rt), "pixel {i}");
    }
    assert!(traced > 200, "only {traced} pixels were traced");
}

#[test]
fn causes_and_sources_account_for_every_reflective_pixel() {
    let Some(gpu) = gpu() else { return };
    for method in ["ssr", "hybrid", "rt"] {
        let picture = render(
            gpu,
            ATRIUM,
            &[SMALL, &format!("reflection.method={method}")],
            &[Aov::Cause],
        );
        let shares = &picture.stats.shares;
        let total = |list: &[reflet::render::renderer::stats::Share]| -> (u64, f64) {
            (
                list.iter().map(|s| s.pixels).sum(),
                list.iter().map(|s| s.percent).sum(),
            )
        };
        for list in [&shares.causes, &shares.sources] {
            let (pixels, percent) = total(list);
            assert_eq!(pixels, shares.reflective);
            assert!((percent - 100.0).abs() < 1e-9, "{method}: {percent} %");
        }
        let causes = integers(&picture, Aov::Cause);
        for cause in Cause::ALL.into_iter().skip(1) {
            let counted = causes.iter().filter(|c| **c == cause as u32).count() as u64;
            let reported = shares
                .causes
                .iter()
                .find(|s| s.name == cause.name())
                .map(|s| s.pixels);
            assert_eq!(reported, Some(counted), "{method}: {}", cause.name());
        }
        let rays = causes.iter().filter(|c| {
            Cause::from_number(**c)
                .is_some_and(|c| c.source(picture.stats.method) == Source::Traced)
        });
        assert_eq!(u64::from(picture.stats.rays), rays.count() as u64);
    }
}

#[test]
fn the_same_frame_gives_the_same_bytes() {
    let Some(gpu) = gpu() else { return };
    let of = || {
        render(
            gpu,
            ATRIUM,
            &["image.size=[97, 55]", "image.samples=2"],
            &[],
        )
    };
    let (first, second) = (of(), of());
    assert_eq!(first.display, second.display);
    let bits = |p: &Picture| p.color.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&first), bits(&second));
}

/// A shiny floor with objects of all shapes; `dynamic` is filled in.
const OBJECTS: &str = include_str!("agreement/objects.toml");

#[test]
fn a_dynamic_instance_looks_like_a_static_one() {
    let Some(gpu) = gpu() else { return };
    for method in ["rt", "hybrid"] {
        let of = |dynamic| {
            let text = OBJECTS.replace("DYNAMIC", dynamic);
            // U is the diagonal of the static bounds, which differ here.
            render(
                gpu,
                &text,
                &[
                    "reflection.unit_m=1",
                    &format!("reflection.method={method}"),
                ],
                &[],
            )
        };
        let differing = share_differing(&of("true"), &of("false"), 2);
        assert!(
            differing <= 0.001,
            "{method}: {:.3} % of the pixels differ",
            100.0 * differing
        );
    }
}

#[test]
fn primary_rays_find_what_rasterization_shows() {
    let Some(gpu) = gpu() else { return };
    let inside = OBJECTS.replace("eye = [0, 2.2, 6]", "eye = [-1.4, 1, 0.1]\nnear_m = 0.4");
    let single_sided = inside.replace("metallic = 1", "metallic = 1\ndouble_sided = false");
    let mut differing = 0;
    for text in [OBJECTS, &inside, &single_sided] {
        for dynamic in ["false", "true"] {
            let text = text.replace("DYNAMIC", dynamic);
            let of = |visibility: &str| {
                let set = format!("image.visibility={visibility}");
                let set = [set.as_str(), "image.size=[96, 54]"];
                let picture = render(gpu, &text, &set, &[Aov::Ids]);
                integers(&picture, Aov::Ids).to_vec()
            };
            let (raster, rays) = (of("raster"), of("rays"));
            let at = |ids: &[u32], x: i32, y: i32| {
                let (x, y) = (x.clamp(0, 95), y.clamp(0, 53));
                ids[2 * (y * 96 + x) as usize..][..2].to_vec()
            };
            for (x, y) in (0..54).flat_map(|y| (0..96).map(move |x| (x, y))) {
                let found = at(&rays, x, y);
                if found == at(&raster, x, y) {
                    continue;
                }
                differing += 1;
                // Differences by rounding only: a neighboring pixel shows the same.
                let mut around = (-1..2).flat_map(|v| (-1..2).map(move |u| (x + u, y + v)));
                assert!(
                    around.any(|(x, y)| at(&raster, x, y)[0] == found[0]),
                    "dynamic {dynamic}: pixel ({x}, {y}) shows {found:?}"
                );
            }
        }
    }
    assert!(differing <= 6 * 96 * 54 / 1000, "{differing} pixels differ");
}

#[test]
fn moved_instances_and_lights_look_as_if_built_there() {
    let Some(gpu) = gpu() else { return };
    let (desc, mut world) = scene(
        &OBJECTS.replace("DYNAMIC", "true"),
        &["reflection.unit_m=1"],
    );
    let mut moving = renderer(gpu, &desc, &world, false);
    let camera = world.cameras[0].value.clone();
    or_panic!(moving.picture(gpu, &camera, &[]));

    let turn =
        Affine3A::from_rotation_translation(Quat::from_rotation_y(0.7), Vec3::new(0.4, 0.2, 0.5));
    for instance in world.instances.iter_mut().filter(|i| i.dynamic) {
        instance.world_from_object = turn * instance.world_from_object;
    }
    if let LightKind::Point { position, .. } = &mut world.lights[0].desc.kind {
        *position = Vec3::new(-2.0, 3.0, 1.0);
    }
    moving.update(gpu, &world).expect("posed");
    let moved = or_panic!(moving.picture(gpu, &camera, &[]));
    let mut fresh = renderer(gpu, &desc, &world, false);
    let built = or_panic!(fresh.picture(gpu, &camera, &[]));
    assert_eq!(moved.display, built.display);
}

#[test]
fn shadow_maps_at_rest_are_drawn_once() {
    let Some(gpu) = gpu() else { return };
    let (desc, mut world) = scene(
        &OBJECTS.replace("DYNAMIC", "true"),
        &["reflection.unit_m=1"],
    );
    let mut kept = renderer(gpu, &desc, &world, false);
    let camera = world.cameras[0].value.clone();
    let mut shows = |world: &World, what: &str, is_drawn: bool| {
        kept.update(gpu, world).expect("posed");
        let picture = kept.picture(gpu, &camera, &[]).expect("drawn");
        let mut passes = picture.stats.passes_ms.iter();
        assert_eq!(passes.any(|(name, _)| name == "shadow"), is_drawn, "{what}");
        let mut fresh = renderer(gpu, &desc, world, false);
        let built = fresh.picture(gpu, &camera, &[]).expect("drawn");
        assert!(picture.display == built.display, "{what}");
    };
    shows(&world, "the first", true);
    shows(&world, "the same", false);
    let place = world.instances[1].world_from_object;
    world.instances[1].world_from_object.translation.x += 0.5;
    shows(&world, "a caster moved", true);
    world.instances[1].world_from_object = Instance::HIDDEN;
    shows(&world, "it is hidden", true);
    shows(&world, "and stays so", false);
    world.instances[1].world_from_object = place;
    shows(&world, "it is back", true);
    if let LightKind::Point { position, .. } = &mut world.lights[0].desc.kind {
        position.y -= 0.5;
    }
    shows(&world, "the light moved", true);
    world.lights[0].desc.color = Vec3::X;
    shows(&world, "it has another color", false);
}

/// A lamp between posts and balls in the corner of a room: its shadows cross all faces of the cube map.
const ROOM: &str = include_str!("agreement/room.toml");

#[test]
fn cube_maps_agree_with_shadow_rays() {
    let Some(gpu) = gpu() else { return };
    let of = |shadow| render(gpu, &ROOM.replace("SHADOW", shadow), &[], &[]);
    let (map, ray) = (of("map"), of("ray"));
    // Edges of shadows are filtered in one picture and hard in the other; everything else is the same.
    let differing = share_differing(&map, &ray, 12);
    assert!(
        differing < 0.02,
        "{:.2} % of the pixels differ",
        100.0 * differing
    );
    // No specks: a pixel is never much darker than all of its eight neighbors.
    for picture in [&map, &ray] {
        let [width, height] = picture.size;
        let light = |x: u32, y: u32| picture.display[4 * (y * width + x) as usize];
        for y in 1..height - 1 {
            for x in 1..width - 1 {
                let around = (0..9)
                    .filter(|k| *k != 4)
                    .map(|k| light(x + k % 3 - 1, y + k / 3 - 1));
                let darkest = around.min().unwrap_or(0);
                assert!(
                    light(x, y).saturating_add(24) >= darkest,
                    "a dark speck at ({x}, {y})"
                );
            }
        }
    }
}
