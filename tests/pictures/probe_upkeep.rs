//! Maps of probes over changes of a renderer: kept where they fit, captured anew where they do not.

use reflet::{
    render::{Picture, RenderOptions, Renderer},
    scene::desc::{Method, SceneDesc},
    world::World,
};

use crate::{
    common::shaders,
    kit::{gpu, renderer, scene},
    probes::{WALLS, room},
};

/// Changes a renderer to a scene and renders it; returns whether it captured maps for that, `None` where it has none.
fn shown(renderer: &mut Renderer, desc: &SceneDesc, world: &World) -> (Option<bool>, Picture) {
    let gpu = gpu().expect("a GPU");
    let camera = &world.cameras[0].value;
    let changed = renderer.change(gpu, &shaders(), world, &RenderOptions::of(desc));
    changed.unwrap_or_else(|e| panic!("{e}"));
    let stats = renderer.render(gpu, world, camera);
    let probes = stats.unwrap_or_else(|e| panic!("{e}")).probes;
    let picture = renderer.picture(gpu, world, camera, &[]);
    (
        probes.map(|probes| probes.update_ms > 0.0),
        picture.unwrap_or_else(|e| panic!("{e}")),
    )
}

/// A preview changes the size of its pictures, and wipes between methods.
#[test]
fn maps_are_kept_while_other_sizes_and_methods_are_shown() {
    let Some(gpu) = gpu() else { return };
    let set = ["image.size=[32, 18]", "reflection.method=\"probe\""];
    let (desc, mut world) = scene(&room(WALLS), &set);
    let (mut rt, mut wide) = (desc.clone(), desc.clone());
    rt.reflection.method = Method::Rt;
    wide.image.size = [48, 27];
    let fresh = |desc: &SceneDesc, world: &World| {
        shown(&mut renderer(gpu, desc, world, false), desc, world)
            .1
            .color
    };
    let one = &mut renderer(gpu, &desc, &world, false);
    assert_eq!(shown(one, &desc, &world).0, Some(true));
    assert_eq!(shown(one, &rt, &world).0, None);
    assert_eq!(shown(one, &desc, &world).0, Some(false));
    let (captured, picture) = shown(one, &wide, &world);
    assert_eq!(captured, Some(false));
    assert!(picture.color == fresh(&wide, &world));
    // Other materials are captured, also where another method was shown when they changed.
    world.materials.iter_mut().for_each(|m| m.emission *= 0.5);
    assert_eq!(shown(one, &rt, &world).0, None);
    let (captured, picture) = shown(one, &wide, &world);
    assert_eq!(captured, Some(true));
    assert!(picture.color == fresh(&wide, &world));
    // So are maps of another size.
    wide.reflection.probes.face_px = 32;
    assert_eq!(shown(one, &wide, &world).0, Some(true));
}
