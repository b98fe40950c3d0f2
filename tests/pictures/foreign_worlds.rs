//! Invalid worlds passed by library callers are refused with the reason.

use reflet::{
    render::RenderError,
    scene::desc::ShadowMode,
    world::{DecalMask, TextureRef},
};

use crate::{common::assert_says, kit::*};

const SIZE: &str = "image.size=[32, 18]";

fn reason<T>(result: Result<T, RenderError>) -> String {
    match result {
        Err(RenderError::Scene(diagnostic)) => diagnostic.message.clone(),
        Err(RenderError::Gpu(error)) => panic!("refused by the GPU: {error}"),
        Ok(_) => panic!("a foreign world was taken"),
    }
}

type Damage = fn(&mut World);

/// Invalid worlds, and a part of the expected reason.
const BROKEN: [(Damage, &str); 7] = [
    (
        |w| w.instances[0].mesh = w.meshes.len(),
        "its mesh or material does not exist",
    ),
    (
        |w| w.instances[0].material = 1000,
        "its mesh or material does not exist",
    ),
    (
        |w| w.meshes[0].triangles[0][1] = u32::MAX,
        "points past its",
    ),
    (|w| w.meshes[0].normals.truncate(1), "differ in length"),
    (
        |w| {
            w.materials[0].base_color_texture = Some(TextureRef {
                texture: w.textures.len(),
                ..FIRST_IMAGE
            })
        },
        "its texture does not exist",
    ),
    (
        |w| {
            while w.lights.len() < 65 {
                w.lights.push(w.lights[0].clone())
            }
        },
        "65 lights",
    ),
    (
        |w| w.textures.push(linear_image(2, 2, vec![0; 3])),
        "texture \"made\": 3 bytes for 2 x 2 pixels",
    ),
];

#[test]
fn worlds_with_foreign_indices_or_too_many_lights_are_refused() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(include_str!("../../scenes/cornell.toml"), &[SIZE]);
    let mut good = renderer(gpu, &desc, &world, false);
    let options = *good.options();
    let before = good.first_view(&world, &[]);
    for (damage, what) in BROKEN {
        let mut broken = world.clone();
        damage(&mut broken);
        let refused = reason(Renderer::new(gpu, &shaders(), &broken, &options));
        assert!(refused.contains(what), "new: {refused}");
        let refused = reason(good.change(gpu, &shaders(), &broken, &options));
        assert!(refused.contains(what), "change: {refused}");
    }
    let after = good.first_view(&world, &[]);
    assert!(before.display == after.display, "an error changes nothing");
}

/// Worlds that differ from the uploaded one by more than a pose, behind a part of the expected reason.
const NOT_POSED: [(&str, &[Damage]); 4] = [
    (
        "other meshes, textures, instances",
        &[
            |w| drop(w.instances.pop()),
            |w| w.instances.push(w.instances[0].clone()),
            |w| w.instances[0].mesh = 1,
            |w| w.materials.truncate(1),
            |w| w.meshes[0].positions[0].x += 1.0,
            |w| w.instances[0].world_from_object.translation.x += 1.0,
            |w| w.instances[0].material = 1,
            |w| w.decals.sets.push(DecalMask::default()),
            |w| w.decals.set_of.push(0),
        ],
    ),
    ("numbers of lamps", &[|w| w.lamps.push(w.lights[0].clone())]),
    ("other shadow maps", &[|w| w.lights.clear()]),
    (
        "shadow maps, rays or numbers of lights",
        &[
            |w| w.lights.push(w.lights[0].clone()),
            |w| w.lights[0].desc.shadow = ShadowMode::Ray,
        ],
    ),
];

#[test]
fn another_world_is_not_taken_as_a_pose() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(include_str!("../../scenes/cornell.toml"), &[SIZE]);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let before = renderer.first_view(&world, &[]);
    let all = NOT_POSED.iter();
    for (damage, what) in all.flat_map(|(what, all)| all.iter().map(move |damage| (damage, what))) {
        let mut other = world.clone();
        damage(&mut other);
        let refused = reason(renderer.update(gpu, &other));
        assert_says(&refused, &[what, "change"]);
    }
    let after = renderer.first_view(&world, &[]);
    assert!(before.display == after.display, "an error changes nothing");
}
