//! Captured maps over changes of a renderer and frames of a film: kept where they fit, captured anew where they do not.

use reflet::scene::desc::EnvironmentShadow;

use crate::{
    kit::*,
    probes::{WALLS, room},
};

/// Changes a renderer to a scene and renders it; returns whether it captured maps for that, `None` where it has none.
fn shown(renderer: &mut Renderer, desc: &SceneDesc, world: &World) -> (Option<bool>, Picture) {
    let gpu = gpu().expect("a GPU");
    let camera = &world.cameras[0].value;
    or_panic!(renderer.change(gpu, &shaders(), world, &RenderOptions::for_scene(desc)));
    let maps = or_panic!(renderer.render(gpu, camera)).maps;
    let picture = renderer.picture(gpu, camera, &[]);
    (maps.map(|maps| maps.update_ms > 0.0), or_panic!(picture))
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
    // So is light that is found in another way.
    world.environment.desc.zenith = Vec3::ONE;
    for shadow in [EnvironmentShadow::Ray, EnvironmentShadow::None] {
        world.environment.desc.shadow = shadow;
        assert_eq!(shown(one, &wide, &world).0, Some(true), "{shadow:?}");
    }
    // So are maps of another size.
    wide.reflection.probes.face_px = 32;
    assert_eq!(shown(one, &wide, &world).0, Some(true));
}

/// A mirror across from a wall behind the camera, with a board that becomes a hole and a decal that moves and fades.
const FILM: &str = include_str!("probe_upkeep/film.toml");

/// Picture of the last of these frames, by a renderer that has rendered the others before.
fn last_of(frames: &[u32], text: &str, method: &str) -> Option<Picture> {
    let gpu = gpu()?;
    let set = format!("reflection.method=\"{method}\"");
    let (scene, mut world) = film_of(Path::new("test.toml"), text, &[&set]);
    let mut renderer = renderer(gpu, &scene, &world, false);
    let shown = frames.iter().map(|frame| {
        pose(&scene, &mut world, *frame);
        renderer.moved_view(&world, &[])
    });
    shown.last()
}

/// Maps show cut-outs and decals as they are in a frame, whatever frame came before.
#[test]
fn maps_follow_cut_outs_and_decals() {
    let still =
        "[motion.decal.paint]\ntranslation = { keys = [{ at_s = 0, value = [1.5, 1.5, 6] }] }\n";
    let cut_out = format!(
        "{still}[motion.material.board]\nalpha_cutoff = {{ keys = [{{ at_s = 0, value = 0 }}, {{ at_s = 2, value = 1 }}] }}\n"
    );
    let moved = "[motion.decal.paint]\ntranslation = { keys = [{ at_s = 0, value = [-1.5, 1.5, 6] }, \
                 { at_s = 2, value = [1.5, 1.5, 6] }] }\n";
    let painted = format!(
        "{still}[motion.material.paint]\nbase_color = {{ keys = [{{ at_s = 0, value = [0.9, 0.8, 0.1] }}, \
         {{ at_s = 2, value = [0.1, 0.8, 0.9] }}] }}\n"
    );
    for (change, method) in [
        (cut_out.as_str(), "near-far"),
        (&cut_out, "ssr+box"),
        (&cut_out, "probe"),
        (moved, "probe"),
        (&painted, "probe"),
    ] {
        let text = format!("{FILM}{change}");
        let of = |frames: &[u32]| last_of(frames, &text, method);
        let Some(first) = of(&[0]) else { return };
        let (alone, later) = (of(&[3]).expect("a GPU"), of(&[0, 3]).expect("a GPU"));
        assert!(first.color != alone.color, "{method}: {change}");
        assert!(alone.color == later.color, "{method}: {change}");
    }
}
