//! Rays near the camera, and maps of the distance beyond.

use crate::kit::*;

/// A courtyard without a roof: two walls that glow, a floor that mirrors, and a ball that glows.
const COURT: &str = include_str!("near_far/court.toml");

fn by(text: &str, set: &[&str]) -> Option<Picture> {
    Some(render(gpu()?, text, set, &[Aov::Cause, Aov::HitDistance]))
}

fn near_far(text: &str, further: &[&str]) -> Option<Picture> {
    let set = ["reflection.method=near-far", "near_far.face_px=256"];
    by(text, &[&set, further].concat())
}

fn count(picture: &Picture, cause: Cause) -> usize {
    let causes = integers(picture, Aov::Cause).iter();
    causes.filter(|&&found| found == cause as u32).count()
}

/// In a box that holds the scene every ray is traced to its end.
#[test]
fn a_box_around_everything_shows_exactly_what_rt_shows() {
    let rt = or_skip!(by(COURT, &["reflection.method=rt"]));
    let picture = near_far(COURT, &["near_far.half_size_m=20"]).expect("a GPU");
    assert!(picture.color == rt.color);
    let bits = |picture: &Picture| -> Vec<u32> {
        let distances = floats(picture, Aov::HitDistance).iter();
        distances.map(|m| m.to_bits()).collect()
    };
    assert!(bits(&picture) == bits(&rt));
    assert!(count(&picture, Cause::Unmarched) > 500);
    for far in [Cause::Far, Cause::FarHidden] {
        assert_eq!(count(&picture, far), 0);
    }
}

/// Where the camera sees all that reflections show, hits in the map equal hits of rays, to the rounding of the
/// intersection with the triangle that a pixel names. A second layer and shared rays change nothing.
#[test]
fn the_map_answers_as_rays_do_where_the_camera_sees_everything() {
    let text = COURT.replace("translation = [-1.5, 1, -1]", "translation = [0, 50, 0]");
    let rt = or_skip!(by(&text, &["reflection.method=rt"]));
    for set in [
        &["near_far.half_size_m=0.3"][..],
        &["near_far.half_size_m=2"],
        &["near_far.half_size_m=0.3", "reflection.layers=2"],
        &["near_far.half_size_m=0.3", "reflection.rate=4"],
    ] {
        let picture = near_far(&text, set).expect("a GPU");
        let wrong = share_differing(&picture, &rt, 1);
        assert!(wrong < 0.02, "{set:?}: {wrong}");
        let found = count(&picture, Cause::Far);
        assert!(found > 100, "{set:?}: {found} in the map");
        let pairs = floats(&picture, Aov::HitDistance)
            .iter()
            .zip(floats(&rt, Aov::HitDistance));
        let far = pairs.filter(|(a, b)| a.is_finite() && b.is_finite() && (*a - *b).abs() > 1e-3);
        let far = far.count();
        assert!(far < 20, "{set:?}: {far} hits are elsewhere");
    }
}

/// The typical failure: the floor mirrors the underside of the ball, which the camera does not see. The environment
/// stands for it, and the cause says so. A box that holds the ball shows it.
#[test]
fn what_the_camera_does_not_see_is_replaced_by_the_environment() {
    or_skip!(gpu());
    let view = [
        "camera.main.eye=[-1.5, 3.5, 1.5]",
        "camera.main.target=[-1.5, 0, -0.6]",
    ];
    let above = |further: &str| near_far(COURT, &[&view[..], &[further]].concat()).expect("a GPU");
    let [small, large] = ["near_far.half_size_m=0.5", "near_far.half_size_m=6"].map(above);
    let [of_small, of_large] = [&small, &large].map(|p| count(p, Cause::FarHidden));
    assert!(
        of_small > 20 && of_large == 0,
        "{of_small} and {of_large} hidden"
    );
    assert!(share_differing(&small, &large, 10) > 0.01);
    let mut causes = integers(&small, Aov::Cause).iter();
    let at = causes.position(|&cause| cause == Cause::FarHidden as u32);
    let at = at.expect("a hidden pixel") as u32;
    assert_color(&small, at % 64, at / 64, [0.1, 0.2, 0.9], 1e-3);
}

/// Things behind a screen, as the camera sees them, are in the second layer.
#[test]
fn a_second_layer_shows_what_the_first_hides() {
    let screen = "[model.screen]\nshape = { kind = \"box\", size = [1.6, 1.2, 0.1] }\nmaterial = \"red\"\n\
                  [[instance]]\nmodel = \"screen\"\ntranslation = [0, 1.4, -2]\n";
    let text = format!("{COURT}{screen}");
    let of = |layers: u32| {
        let layers = format!("reflection.layers={layers}");
        let set = [
            "near_far.half_size_m=0.3",
            "reflection.separation_m=0.5",
            "camera.main.eye=[0, 1.6, 2.6]",
            "camera.main.target=[0, 0.2, -1]",
            layers.as_str(),
        ];
        near_far(&text, &set)
    };
    let (one, two) = (or_skip!(of(1)), or_skip!(of(2)));
    let [of_one, of_two] = [&one, &two].map(|p| count(p, Cause::FarHidden));
    assert!(
        of_one > 20 && 2 * of_two < of_one,
        "{of_one} and {of_two} hidden"
    );
}

fn shot(renderer: &mut Renderer, world: &World, eye: Vec3) -> (Picture, f64) {
    let gpu = gpu().expect("a GPU");
    let mut camera = world.cameras[0].value.clone();
    camera.eye = eye;
    or_panic!(renderer.update(gpu, world));
    let stats = or_panic!(renderer.render(gpu, &camera));
    let picture = or_panic!(renderer.picture(gpu, &camera, &[]));
    (picture, stats.maps.expect("a far map").update_ms)
}

/// The map shows what moves where it is, and depends on no frame before.
#[test]
fn maps_follow_the_camera_and_what_moves() {
    let Some(gpu) = gpu() else { return };
    let (mut desc, world) = scene(COURT, &["near_far.half_size_m=0.5"]);
    desc.reflection.method = Method::NearFar;
    let mut later = world.clone();
    let ball = later.instances.last_mut().expect("the ball");
    ball.world_from_object.translation.x += 1.5;
    let eyes = [Vec3::new(2.2, 1.6, 2.6), Vec3::new(1.0, 2.0, 3.0)];
    let make = || renderer(gpu, &desc, &world, false);
    let mut forwards = make();
    let (first, ms) = shot(&mut forwards, &world, eyes[0]);
    assert!(ms > 0.0, "captured for the first picture");
    let (again, ms) = shot(&mut forwards, &world, eyes[0]);
    assert!(ms <= 0.0 && again.color == first.color, "nothing has moved");
    let (moved, ms) = shot(&mut forwards, &later, eyes[0]);
    assert!(ms > 0.0 && moved.color != first.color, "the ball has moved");
    let (elsewhere, ms) = shot(&mut forwards, &later, eyes[1]);
    assert!(ms > 0.0, "the camera has moved");
    let mut backwards = make();
    assert!(shot(&mut backwards, &later, eyes[1]).0.color == elsewhere.color);
    assert!(shot(&mut backwards, &later, eyes[0]).0.color == moved.color);
    assert!(shot(&mut backwards, &world, eyes[0]).0.color == first.color);
}
