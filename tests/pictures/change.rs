//! A renderer that switches to another world renders it like a new renderer.

use glam::Vec3A;
use reflet::render::RebuildSummary;

use crate::{culled::CULLED, kit::*};

const SIZE: &str = "image.size=[64, 36]";

/// Pictures of a new renderer for the second world, and of a renderer changed to it.
fn shown(first: &(SceneDesc, World), second: &(SceneDesc, World)) -> Option<RebuildSummary> {
    let gpu = gpu()?;
    let (desc, world) = second;
    let picture = |renderer: &mut Renderer| renderer.first_view(world, &[]).display;
    let mut fresh = renderer(gpu, desc, world, false);
    let mut changed = renderer(gpu, &first.0, &first.1, false);
    let options = *fresh.options();
    let rebuilt = or_panic!(changed.change(gpu, &shaders(), world, &options));
    assert!(picture(&mut changed) == picture(&mut fresh));
    Some(rebuilt)
}

#[test]
fn other_meshes_and_textures_are_uploaded() {
    let cornell = scene(include_str!("../../scenes/cornell.toml"), &[SIZE]);
    let mirrors = scene(include_str!("../../scenes/mirrors.toml"), &[SIZE]);
    for (first, second) in first_or_all(&[(&cornell, &mirrors), (&mirrors, &cornell)], 1) {
        let rebuilt = shown(first, second);
        assert!(rebuilt.is_none_or(|rebuilt| rebuilt.upload));
    }
}

#[test]
fn a_mesh_that_was_edited_in_place_is_uploaded() {
    let first = scene(include_str!("../../scenes/cornell.toml"), &[SIZE]);
    let mut second = first.clone();
    for position in &mut second.1.meshes[0].positions {
        *position *= Vec3::new(0.9, 0.8, 0.9);
    }
    let rebuilt = shown(&first, &second);
    assert!(rebuilt.is_none_or(|rebuilt| rebuilt.upload));
}

#[test]
fn a_copy_of_a_world_is_not_uploaded_again() {
    let first = scene(include_str!("../../scenes/cornell.toml"), &[SIZE]);
    let rebuilt = shown(&first, &first.clone());
    assert!(rebuilt.is_none_or(|rebuilt| rebuilt == RebuildSummary::default()));
}

#[test]
fn a_march_that_comes_later_knows_what_the_camera_culls() {
    let gpu = or_skip!(gpu());
    let [rt, hybrid] =
        ["rt", "hybrid"].map(|m| scene(CULLED, &[SIZE, &format!("reflection.method=\"{m}\"")]));
    assert!(
        renderer(gpu, &hybrid.0, &hybrid.1, false)
            .plan()
            .features
            .culled_surfaces
    );
    let rebuilt = shown(&rt, &(hybrid.0, rt.1.clone()));
    assert!(rebuilt.is_some_and(|rebuilt| !rebuilt.upload));
}

/// The origin of the renderer's coordinates follows the camera.
#[test]
fn a_scene_that_moved_far_away_is_not_uploaded_again() {
    let text = include_str!("far/contact.toml").replace('X', "");
    let first = scene(&text, &[SIZE]);
    let (desc, mut second) = first.clone();
    let away = Vec3::splat(4096.0);
    for instance in &mut second.instances {
        instance.world_from_object.translation += Vec3A::from(away);
    }
    for light in &mut second.lights {
        *light.desc.kind.position_mut().expect("a lamp") += away;
    }
    let camera = &mut second.cameras[0].value;
    (camera.eye, camera.target) = (camera.eye + away, camera.target + away);
    let rebuilt = shown(&first, &(desc, second));
    assert!(rebuilt.is_none_or(|rebuilt| !rebuilt.upload));
}
