//! Buffers on the faces of a box, marched where the screen has nothing.

use crate::{common::assert_says, kit::*};

/// A closed room with glowing walls, a floor that mirrors, a block, and a ball that moves.
const ROOM: &str = include_str!("box_faces/room.toml");

const PLANES: [Aov; 3] = [Aov::Cause, Aov::HitDistance, Aov::HitIds];

fn by(set: &[&str]) -> Option<Picture> {
    Some(render(gpu()?, ROOM, set, &PLANES))
}

/// Indices of the pixels with this cause.
fn of_cause(picture: &Picture, cause: Cause) -> Vec<usize> {
    let causes = integers(picture, Aov::Cause).iter().enumerate();
    let found = causes.filter(|(_, found)| **found == cause as u32);
    found.map(|(i, _)| i).collect()
}

/// Share of the pixels whose rays end on a face that have other distances than `other`, by more than a millimeter.
fn share_elsewhere(picture: &Picture, other: &Picture) -> f64 {
    let found = of_cause(picture, Cause::Box);
    let [a, b] = [picture, other].map(|p| floats(p, Aov::HitDistance));
    let far = found.iter().filter(|&&i| (a[i] - b[i]).abs() > 1e-3);
    far.count() as f64 / found.len().max(1) as f64
}

/// Hits are points on the triangles that pixels of the faces name, so that they equal hits of rays but at outlines.
/// Rays that others follow keep the cause of the screen's march.
#[test]
fn the_faces_of_a_closed_room_answer_as_rays_do() {
    let rt = or_skip!(by(&["reflection.method=rt"]));
    for (set, least) in [(&[][..], 500), (&["reflection.rate=4"], 300)] {
        let picture = by(set).expect("a GPU");
        let [found, hidden, unmarched] =
            [Cause::Box, Cause::BoxHidden, Cause::Unmarched].map(|c| of_cause(&picture, c).len());
        assert!(
            found > least && hidden < found / 20 && unmarched == 0,
            "{set:?}: {found} on faces, {hidden} hidden, {unmarched} without a cause"
        );
        let elsewhere = share_elsewhere(&picture, &rt);
        assert!(elsewhere < 0.02, "{set:?}: {elsewhere}");
    }
}

/// The typical failure: a surface that is hidden from the face across is on no face, and the environment stands for it.
#[test]
fn what_is_hidden_from_all_faces_is_replaced_by_the_environment() {
    let plates = |text: &mut String| {
        for (x, z, turn) in [
            (-0.9, -1.2, 0),
            (-2.1, -1.2, 0),
            (-1.5, -0.6, 90),
            (-1.5, -1.8, 90),
        ] {
            *text += &format!(
                "[[instance]]\nmodel = \"plate\"\ntranslation = [{x}, 0.9, {z}]\nrotation_deg = [0, {turn}, 0]\n"
            );
        }
    };
    let mut text = format!(
        "{}[model.plate]\nshape = {{ kind = \"box\", size = [0.1, 1.2, 1.6] }}\nmaterial = \"red\"\n\
         [[instance]]\nmodel = \"block\"\ntranslation = [-1.5, 1.9, -1.2]\nscale = 1.6\n",
        ROOM.replace(
            "translation = [-1.2, 1.4, -1.2]",
            "translation = [-1.5, 0.9, -1.2]\nscale = 0.5"
        )
    );
    plates(&mut text);
    let Some(gpu) = gpu() else { return };
    let picture = render(gpu, &text, &[], &PLANES);
    let hidden = of_cause(&picture, Cause::BoxHidden);
    assert!(hidden.len() > 10, "{} hidden", hidden.len());
    let at = hidden[hidden.len() / 2] as u32;
    assert_color(&picture, at % 64, at / 64, [0.1, 0.2, 0.9], 1e-3);
}

/// Faces of one pixel answer something, and those past the limits are refused.
#[test]
fn faces_of_one_pixel_are_rendered_and_the_largest_refused() {
    let one = or_skip!(by(&["box_faces.face_px=1"]));
    let gpu = gpu().expect("a GPU");
    assert!(one.color.iter().all(|v| v.is_finite()));
    let (desc, world) = scene(ROOM, &["box_faces.face_px=16384"]);
    let options = reflet::render::RenderOptions::for_scene(&desc);
    let refused = Renderer::new(gpu, &shaders(), &world, &options).expect_err("too large");
    let text = refused.to_string();
    assert_says(
        &text,
        &["faces of 16384 pixels takes 24576 MiB; there is room for 2048 MiB"],
    );
}

/// Without anything static the box is a point, on whose faces there is nothing.
#[test]
fn a_scene_without_static_things_reflects_the_environment() {
    let Some(gpu) = gpu() else { return };
    let text = ROOM
        .replace("[[instance]]", "[[instance]]\ndynamic = true")
        .replace("name = \"ball\"\ndynamic = true", "name = \"ball\"");
    let picture = render(gpu, &text, &[], &PLANES);
    for cause in [Cause::Box, Cause::BoxHidden] {
        assert_eq!(of_cause(&picture, cause).len(), 0, "{cause:?}");
    }
}

fn shot(renderer: &mut Renderer, world: &World) -> (Picture, f64) {
    let gpu = gpu().expect("a GPU");
    let camera = &world.cameras[0].value;
    or_panic!(renderer.update(gpu, world));
    let stats = or_panic!(renderer.render(gpu, camera));
    let picture = renderer.picture(gpu, camera, &PLANES);
    let faces = stats.maps.expect("a box");
    assert_eq!(faces.facts.bytes, 96 * 256 * 256);
    (or_panic!(picture), faces.update_ms)
}

/// Moving things are on no face: faces are captured once, and no frame depends on another.
#[test]
fn faces_are_captured_once_without_what_moves() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(ROOM, &[]);
    let mut later = world.clone();
    let ball = later.instances.last_mut().expect("the ball");
    ball.world_from_object.translation = glam::Vec3A::new(-0.2, 0.9, 0.2);
    let make = || renderer(gpu, &desc, &world, false);
    let mut forwards = make();
    let (first, ms) = shot(&mut forwards, &world);
    assert!(ms > 0.0, "captured for the first picture");
    let (moved, ms) = shot(&mut forwards, &later);
    assert!(ms <= 0.0, "nothing static has moved");
    let mut backwards = make();
    assert!(shot(&mut backwards, &later).0.color == moved.color);
    assert!(shot(&mut backwards, &world).0.color == first.color);
    let ball = world.instances.len() as u32 - 1;
    let ids = integers(&moved, Aov::HitIds);
    let on_faces = of_cause(&moved, Cause::Box);
    assert!(on_faces.iter().all(|&i| ids[2 * i] != ball));
    let rt = SceneDesc {
        reflection: reflet::scene::desc::ReflectionDesc {
            method: Method::Rt,
            ..desc.reflection
        },
        ..desc
    };
    let mut traced = renderer(gpu, &rt, &later, false);
    let traced = traced.first_view(&later, &PLANES);
    let by_rays = integers(&traced, Aov::HitIds);
    let missed = on_faces.iter().filter(|&&i| by_rays[2 * i] == ball);
    assert!(missed.count() > 10, "rays hit the ball where faces do not");
}
