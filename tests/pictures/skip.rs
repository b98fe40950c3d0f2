//! `reflection.skip_px`: no image of a skipped instance is larger, and mirrors that may magnify forbid it.

use std::fmt::Write as _;

use reflet::render::{
    decide::skip::{Kept, Skipping},
    settings::view::View,
};

use crate::kit::*;

/// A mirror floor and a mirror ball before a wall.
const HALL: &str = include_str!("skip/hall.toml");

/// Number of grains.
const GRAINS: usize = 200;

/// The hall with grains spread over it.
fn hall_with_grains() -> String {
    let mut text = HALL.to_owned();
    let spread = |i: usize, step: f64| (0.5 + i as f64 * step).fract();
    for i in 0..GRAINS {
        let [x, y, z] = [0.754_877_7, 0.569_840_3, 0.438_579_0].map(|step| spread(i, step));
        let (x, y, z) = (40.0 * x - 20.0, 0.3 + 9.0 * y, -29.0 + 22.0 * z);
        let _ = write!(
            text,
            "[[instance]]\nname = \"grain{i}\"\nmodel = \"grain\"\ntranslation = [{x:.4}, {y:.4}, {z:.4}]\n"
        );
    }
    text
}

/// Instances that a scene's rays may skip, and instances that they skip in its view.
fn skipped(text: &str, set: &[&str]) -> (Skipping, Vec<usize>, World) {
    let (desc, world) = scene(text, set);
    let options = RenderOptions::for_scene(&desc);
    let skipping = Skipping::for_world(&world, &options);
    let view = view(&desc, &world);
    let indices = skipping.skipped(&world, &view, &desc.reflection);
    (skipping, indices, world)
}

fn view(desc: &SceneDesc, world: &World) -> View {
    View::new(&world.cameras[0].value, desc.image.size, world.unit_m())
}

fn picture(gpu: &Gpu, text: &str, method: &str, skip_px: f32) -> (Picture, u64) {
    let (method, skip) = (
        format!("reflection.method={method}"),
        format!("reflection.skip_px={skip_px}"),
    );
    let (desc, world) = scene(text, &[&method, &skip, "image.visibility=raster"]);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let camera = &world.cameras[0].value;
    let counts = renderer.counts(gpu, camera).expect("counted");
    let trace = counts.iter().find(|c| c.pass == "trace");
    let nodes = trace.map_or(0, |c| c.counts.visited_nodes);
    let aovs = [Aov::Ids, Aov::Radiance, Aov::HitIds];
    (or_panic!(renderer.picture(gpu, camera, &aovs)), nodes)
}

/// Rays skip most grains and spare their nodes; at most the pixels change that the images of the skipped grains cover,
/// one in each of the two mirrors and one in the image of one mirror in the other; what the camera sees does not.
#[test]
fn no_more_pixels_change_than_the_skipped_images_cover() {
    let Some(gpu) = gpu() else { return };
    let text = hall_with_grains();
    const SKIP_PX: f32 = 1.5;
    let (skipping, indices, world) = skipped(&text, &[&format!("reflection.skip_px={SKIP_PX}")]);
    assert_eq!(skipping.refused, None);
    let is_grain = |i: &usize| world.instances[*i].name.starts_with("grain");
    assert!(indices.iter().all(is_grain));
    assert!((100..GRAINS).contains(&indices.len()), "{}", indices.len());
    assert_eq!(
        skipping.kept(&world, &indices),
        [(Kept::Large, GRAINS + 3 - indices.len())]
    );
    for method in ["rt", "hybrid"] {
        let (whole, all_nodes) = picture(gpu, &text, method, 0.0);
        let (less, nodes) = picture(gpu, &text, method, SKIP_PX);
        let disk_px = 0.25 * std::f64::consts::PI * f64::from(SKIP_PX * SKIP_PX);
        let bound = 3.0 * indices.len() as f64 * disk_px / f64::from(160 * 90);
        let changed = share_differing(&whole, &less, 0);
        assert!(changed > 0.0, "{method}: some grain was shown");
        assert!(changed <= bound, "{method}: {changed} of {bound}");
        for aov in [Aov::Ids, Aov::HitIds] {
            let shown = |p: &Picture| {
                let ids = integers(p, aov).chunks(2);
                let is_skipped = |id: &&[u32]| indices.contains(&(id[0] as usize));
                ids.filter(is_skipped).count()
            };
            let (before, after) = (shown(&whole), shown(&less));
            match aov {
                Aov::Ids => assert_eq!(before, after, "{method}: the camera sees them"),
                _ => assert!(before > 0 && after == 0, "{method}: {before} {after}"),
            }
        }
        let light = [&whole, &less].map(|p| floats(p, Aov::Radiance));
        assert_eq!(light[0], light[1], "{method}: light and shadows stay");
        assert!(
            nodes * 5 < all_nodes * 4,
            "{method}: {nodes} of {all_nodes}"
        );
    }
}

/// Everything is skipped below a size that nothing reaches, and nothing below 0 pixels.
#[test]
fn a_huge_size_skips_all_that_rests_and_does_not_shine() {
    let text = HALL.replace("name = \"wall\"", "name = \"wall\"\ndynamic = true");
    let set = [
        "reflection.skip_px=1e12",
        "material.dull.emission=[1, 1, 1]",
        "reflection.method=rt",
    ];
    let (skipping, indices, world) = skipped(&hall_with_grains(), &set);
    assert_eq!(indices.len(), 3, "the grains shine");
    assert_eq!(skipping.kept(&world, &indices), [(Kept::Emits, GRAINS)]);
    let (skipping, indices, world) = skipped(&text, &["reflection.skip_px=1e12"]);
    // The grain that no instance places stands in the middle of the hall.
    assert_eq!(indices, [0, 1, 3]);
    assert_eq!(skipping.kept(&world, &indices), [(Kept::Moves, 1)]);
    let (skipping, indices, _) = skipped(&text, &["reflection.skip_px=0"]);
    assert_eq!((indices, skipping), (Vec::new(), Skipping::default()));
}

#[test]
fn what_may_magnify_forbids_skipping_and_says_so() {
    let skip = "reflection.skip_px=1e6";
    let refused = |text: &str, set: &[&str]| {
        let set: Vec<&str> = set.iter().copied().chain([skip]).collect();
        let (skipping, indices, _) = skipped(text, &set);
        assert!(indices.is_empty() && skipping.apart.is_empty());
        skipping.refused.expect("a reason")
    };
    let ring = HALL.replace(
        "kind = \"sphere\", radius = 1.0, segments = 48",
        "kind = \"torus\"",
    );
    assert!(refused(&ring, &[]).contains("\"ball\" reflects and is not shown to be"));
    let glass = refused(HALL, &["material.wall.transmission=1"]);
    assert!(glass.contains("\"wall\" lets light through"), "{glass}");
    assert!(refused(HALL, &["reflection.diffuse_bounces=1"]).contains("diffuse_bounces"));
    assert!(refused(HALL, &["reflection.method=ssr"]).contains("not \"ssr\""));
    let dull = refused(HALL, &["material.mirror.reflection=none"]);
    assert_eq!(dull, "nothing reflects");
    // From inside of a ball with two sides.
    let inside = [skip, "camera.main.eye=[1.5, 1.2, 0.2]"];
    let one_sided = [inside[0], inside[1], "material.mirror.double_sided=false"];
    let seen = skipped(HALL, &one_sided).1;
    assert!(!seen.is_empty(), "the back is not seen");
    let both = [inside[0], inside[1], "material.mirror.double_sided=true"];
    assert!(skipped(HALL, &both).1.is_empty(), "the back is hollow");
}

/// Facets of a rough mirror may cancel the way from the eye: only what is far from it is skipped.
#[test]
fn rough_mirrors_count_the_way_behind_them_alone() {
    let text = hall_with_grains();
    let sharp = skipped(&text, &["reflection.skip_px=1.5"]).1;
    let set = ["reflection.skip_px=1.5", "material.mirror.roughness=0.15"];
    let rough = skipped(&text, &set).1;
    assert!(rough.len() < sharp.len(), "{} {}", rough.len(), sharp.len());
    assert!(rough.iter().all(|i| sharp.contains(i)));
}

/// A ball that only the mirror shows, before a mirror of some shape.
fn mirror_and_ball(shape: &str) -> String {
    include_str!("skip/mirror_and_ball.toml").replace("SHAPE", shape)
}

/// A patch of a paraboloid over XZ, facing +Y; hollow where `bend` is above 0.
fn paraboloid(bend: f32) -> String {
    const SIDE: usize = 25;
    let at = |i: usize| 6.0 * i as f32 / (SIDE - 1) as f32 - 3.0;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (row, column) in (0..SIDE * SIDE).map(|i| (i / SIDE, i % SIDE)) {
        let (x, z) = (at(column), at(row));
        positions.extend([x, bend * (x * x + z * z), z]);
        if row + 1 < SIDE && column + 1 < SIDE {
            let i = row * SIDE + column;
            triangles.extend([i, i + SIDE, i + 1, i + 1, i + SIDE, i + SIDE + 1]);
        }
    }
    format!("{{ kind = \"mesh\", positions = {positions:?}, indices = {triangles:?} }}")
}

/// Number of pixels that show the thing in the mirror.
fn reflected_px(gpu: &Gpu, text: &str) -> f64 {
    let picture = render(gpu, text, &["reflection.method=rt"], &[Aov::HitIds]);
    let ids = integers(&picture, Aov::HitIds).chunks(2);
    ids.filter(|id| id[0] == 1).count() as f64
}

/// The bound of a thing's size, in pixels: the least `skip_px` with which it is skipped.
fn bound_px(text: &str) -> f64 {
    let (mut desc, world) = scene(text, &[]);
    let mut is_skipped = |px: f64| {
        desc.reflection.skip_px = px as f32;
        let skipping = Skipping::for_world(&world, &RenderOptions::for_scene(&desc));
        let indices = skipping.skipped(&world, &view(&desc, &world), &desc.reflection);
        indices.contains(&1)
    };
    let (mut low, mut high) = (0.1, 400.0);
    assert!(is_skipped(high) && !is_skipped(low));
    while high - low > 0.05 {
        let middle = 0.5 * (low + high);
        *(if is_skipped(middle) {
            &mut high
        } else {
            &mut low
        }) = middle;
    }
    high
}

/// A flat and a convex mirror show a thing no larger than the bound says, the flat one not much smaller; a hollow one
/// shows it larger, and forbids skipping.
#[test]
fn images_in_flat_and_convex_mirrors_are_within_the_bound() {
    let Some(gpu) = gpu() else { return };
    let flat = mirror_and_ball("{ kind = \"plane\", size = [6, 6] }");
    let bound = bound_px(&flat);
    let disk = |px: f64| 0.25 * std::f64::consts::PI * px * px;
    let in_flat = reflected_px(gpu, &flat);
    assert!(in_flat <= disk(bound), "{in_flat} of {}", disk(bound));
    assert!(in_flat >= 0.4 * disk(bound), "{in_flat} of {}", disk(bound));
    for convex in [
        paraboloid(-0.05),
        "{ kind = \"sphere\", radius = 2 }".into(),
    ] {
        let convex = mirror_and_ball(&convex);
        let (found, most) = (reflected_px(gpu, &convex), disk(bound_px(&convex)));
        assert!(found > 5.0 && found <= most, "{found} of {most}");
    }
    let hollow = mirror_and_ball(&paraboloid(0.05));
    assert!(reflected_px(gpu, &hollow) > disk(bound));
    assert!(skipped(&hollow, &["reflection.skip_px=400"]).1.is_empty());
}

/// The choice depends on the picture's own camera and pose, not on earlier pictures.
#[test]
fn each_picture_has_its_own_choice() {
    let Some(gpu) = gpu() else { return };
    let text = hall_with_grains().replace("name = \"wall\"", "name = \"wall\"\ndynamic = true");
    let (desc, world) = scene(&text, &["reflection.skip_px=2", "reflection.method=rt"]);
    let far = &world.cameras[0].value;
    let mut near = far.clone();
    near.eye.z = -10.0;
    near.target.z = -20.0;
    let mut moved = world.clone();
    moved.instances[2].world_from_object.translation.z += 4.0;
    let shown_in = |world: &World, renderer: &mut Renderer, camera| {
        renderer.update(gpu, world).expect("posed");
        or_panic!(renderer.picture(gpu, camera, &[Aov::HitIds]))
    };
    let shown = |renderer: &mut Renderer, camera| shown_in(&world, renderer, camera);
    let mut one = renderer(gpu, &desc, &world, false);
    let first = shown(&mut one, far);
    let (whole, _) = scene(&text, &["reflection.skip_px=0", "reflection.method=rt"]);
    let mut changed = renderer(gpu, &whole, &world, false);
    let options = *one.options();
    let rebuilt = changed.change(gpu, &shaders(), &world, &options);
    assert!(rebuilt.is_ok_and(|rebuilt| rebuilt.trees));
    assert_eq!(shown(&mut changed, far).display, first.display);
    let other = shown(&mut one, &near);
    let again = shown(&mut one, far);
    let other_pose = shown_in(&moved, &mut one, far);
    let pose_alone = shown_in(&moved, &mut renderer(gpu, &desc, &moved, false), far);
    assert_eq!(other_pose.display, pose_alone.display);
    assert_ne!(other_pose.display, first.display, "the wall has moved");
    let alone = shown(&mut renderer(gpu, &desc, &world, false), &near);
    assert_eq!(first.display, again.display);
    assert_eq!(other.display, alone.display);
    assert_eq!(integers(&other, Aov::HitIds), integers(&alone, Aov::HitIds));
}
