//! A skinned, morphing figure renders like the same figure frozen in each pose, independent of earlier frames,
//! by rasterization, the march, rays and shadow maps.

use std::sync::Arc;

use reflet::scene::desc::ShadowMode;

use crate::{kit, kit::*};

const SCENE: &str = include_str!("deform/scene.toml");

pub fn scene() -> (SceneDesc, World) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts");
    scene_of(&folder.join("test.toml"), SCENE, &[])
}

/// World with the vertices of this pose in the meshes themselves, so that nothing deforms.
fn frozen(world: &World) -> World {
    let mut frozen = world.clone();
    for (mesh, deformed) in std::mem::take(&mut frozen.deformed) {
        frozen.meshes[mesh].set_vertices(deformed.vertices.clone());
        frozen.meshes[mesh].deformation = None;
    }
    frozen.moving.deformers.clear();
    frozen
}

pub fn pose(desc: &SceneDesc, world: &mut World, frame: u32) {
    kit::pose(&Scene::from(desc.clone()), world, frame);
}

#[test]
fn a_skinned_figure_is_its_frozen_poses() {
    let Some(gpu) = gpu() else { return };
    let (mut desc, mut world) = scene();
    assert_eq!(world.deformed.len(), 2, "two figures at different times");
    let aovs = [Aov::Ids, Aov::HitIds, Aov::Cause];
    let ways = [
        (Method::Hybrid, Visibility::Raster, ShadowMode::Map),
        (Method::Rt, Visibility::Rays, ShadowMode::Ray),
    ];
    for (method, visibility, shadow) in ways {
        desc.reflection.method = method;
        desc.image.visibility = visibility;
        for light in &mut desc.lights {
            light.value.shadow = shadow;
        }
        for light in &mut world.lights {
            light.desc.shadow = shadow;
        }
        let mut moving = renderer(gpu, &desc, &world, false);
        let mut before: Option<Picture> = None;
        for frame in [30, 3, 14] {
            pose(&desc, &mut world, frame);
            let picture = moving.moved_view(&world, &aovs);
            let still = frozen(&world);
            let mut fixed = renderer(gpu, &desc, &still, false);
            let expected = fixed.first_view(&world, &aovs);
            let name = format!("{method:?}, frame {frame}");
            for aov in aovs {
                assert_eq!(integers(&picture, aov), integers(&expected, aov), "{name}");
            }
            let far = picture.color.iter().zip(&expected.color);
            let far = far.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(far < 1e-3, "{name}: {far}");
            let moved = before.as_ref().map(|b| b.color != picture.color);
            assert_ne!(moved, Some(false), "{name}: frames differ");
            before = Some(picture);
        }
    }
}

/// A renderer takes only vertices that fit the meshes that it uploaded.
#[test]
fn other_vertices_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (desc, mut world) = scene();
    let mut renderer = renderer(gpu, &desc, &world, false);
    let (mesh, deformed) = world.deformed.pop_first().expect("it is deformed");
    let mut short = (*deformed).clone();
    short.vertices.positions.pop();
    world.deformed.insert(mesh, Arc::new(short));
    let error = renderer
        .update(gpu, &world)
        .expect_err("one vertex is missing");
    assert!(error.to_string().contains("differ in number"), "{error}");
    world.deformed.remove(&mesh);
    assert!(renderer.update(gpu, &world).is_err(), "it is not deformed");
}
