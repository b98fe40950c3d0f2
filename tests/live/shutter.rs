//! Motion blur of a live scene: a still view equals the picture of `render`.

use reflet::{render::pipeline::targets::Target, scene::desc::MATERIAL, world::World};

use crate::kit::*;

/// The box and the camera move while the shutter is open.
fn moving() -> String {
    let text = SCENE
        .replace(
            "[image]",
            "[reflection]\nmethod = \"rt\"\n[image]\nsamples = 8\nshutter = 1",
        )
        .replace(
            "model = \"box\"",
            "model = \"box\"\nname = \"box\"\ndynamic = true",
        );
    [
        text.as_str(),
        "[timeline]\nfps = 2\nend = 4\n[motion.instance.box]\ntranslation = { rate = [2, 0, 0] }\n\
         [motion.camera.main]\neye = { rate = [0, 0.5, 0] }\n",
    ]
    .concat()
}

/// Picture of the first camera, which may move.
fn seen(gpu: &Gpu, live: &mut Live) -> Vec<u8> {
    let first = |world: &World| world.cameras[0].value.clone();
    live.render(&first).expect("renders");
    live.renderer().read(gpu, Target::Display).expect("is read")
}

#[test]
fn a_view_at_rest_is_blurred_as_a_render_is() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let scene = folder.write("scene.toml", moving());
    let mut live = open(&gpu, &scene, None);
    let mut sharp = open_with(&gpu, &scene, None, &["image.shutter=0"]);
    let mut session = Session::open(&scene, &SessionOptions::default()).expect("opens");
    for frame in [1, 3] {
        assert!(live.pose_now(frame) && sharp.pose_now(frame));
        session.pose(frame).expect("poses");
        let expected = session.render(&[]).expect("renders").display;
        let before = live.world().instances[1].world_from_object;
        assert!(seen(&gpu, &mut live) == expected, "frame {frame}");
        assert!(seen(&gpu, &mut sharp) != expected, "the shutter shows");
        let after = live.world().instances[1].world_from_object;
        assert_eq!(before, after, "what is picked is that of the frame");
    }
}

/// Unsaved edits apply at every moment of the shutter.
#[test]
fn moments_keep_edited_materials() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let moved = "[motion.material.red]\nroughness = { rate = 0.01 }\n";
    let scene = folder.write("scene.toml", moving() + moved);
    let mut live = open(&gpu, &scene, None);
    assert!(live.pose_now(2));
    let red = (live.world().materials.iter()).position(|m| m.name == "red");
    let red = red.expect("it is used");
    let before = seen(&gpu, &mut live);
    let mut edit = live.edit_of(red);
    let place = MATERIAL.iter().position(|field| field.key == "base_color");
    edit.values[place.expect("a field")] = Some(Vec3::new(0.1, 0.1, 0.9));
    live.edit(edit).expect("builds");
    let blue = seen(&gpu, &mut live);
    assert!(blue != before);
    assert!(seen(&gpu, &mut live) == blue);
    assert_eq!(live.world().materials[red].base_color.z, 0.9);
}

/// A script that fails while the shutter is open does not change the shown frame.
#[test]
fn a_moment_that_fails_leaves_the_frame() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    folder.write(
        "s.rhai",
        "fn frame(ctx) {
            if ctx.frame == 1 && ctx.t != 0.5 { throw \"while it is open\"; }
            ctx.place(\"box\", [2 * ctx.t, 0.5, 0]);
        }",
    );
    let text = moving().replacen("version = 1", "version = 1\nscript = \"s.rhai\"", 1);
    let text = text.replace(
        "[motion.instance.box]\ntranslation = { rate = [2, 0, 0] }\n",
        "",
    );
    let scene = folder.write("scene.toml", text);
    let mut live = open(&gpu, &scene, None);
    let first = |world: &World| world.cameras[0].value.clone();
    assert!(live.pose_now(1));
    let before = live.world().instances[1].world_from_object;
    let error = live.render(&first).expect_err("a moment fails");
    assert!(error.to_string().contains("while it is open"), "{error}");
    assert_eq!(live.world().instances[1].world_from_object, before);
    assert!(live.pose_now(2));
    let shown = seen(&gpu, &mut live);
    let mut other = open(&gpu, &scene, None);
    assert!(other.pose_now(2) && seen(&gpu, &mut other) == shown);
}
