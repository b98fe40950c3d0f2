//! Output paths of frames, and locations in messages about a frame.

use super::*;

#[test]
fn the_folder_of_frames_is_created() {
    let folder = folder("created");
    let text = render(&folder, "-o out/f.#.png --shard 7/7", 2);
    assert!(text.contains("no frames in this part"), "{text}");
    assert!(!folder.join("out").exists());
    or_skip!(gpu_or_skip());
    let text = render(&folder, "-o out/f.#.png --frames 1", 0);
    assert!(text.contains("created the folder out"), "{text}");
    assert!(folder.join("out/f.1.png").is_file());
    let text = render(&folder, "-o out/f.#.png --frames 1", 0);
    assert!(!text.contains("created"), "{text}");
}

#[test]
fn a_bad_pose_is_reported_at_what_places_the_instance() {
    let folder = folder("bad-pose");
    let lines = |text: &str, table: &str| text[..text.find(table).expect("there")].lines().count();
    let motion = "[motion.instance.ball]\nscale = { keys = [{ at_s = 0, value = [1, 1, 1] }] }\n";
    for (text, table) in [
        (SCENE.to_owned(), "[[instance]]\nname = \"ball\""),
        (format!("{SCENE}{motion}"), "[motion.instance.ball]"),
    ] {
        let path = folder.join("scene.toml");
        let (desc, _) = Scene::from_text(&text, &path, &[]).expect("it is right");
        let mut world = load::load(&desc, &LoadOptions::default()).expect("it loads");
        let mut state = Animator::new(&desc).pose(0).expect("it moves");
        state.instances[1] = glam::Affine3A::from_scale(glam::Vec3::ZERO);
        let errors = world.apply(&state).expect_err("it is flat");
        let source = errors[0].span.source.as_ref().expect("a place");
        let line = source.place(errors[0].span.range.start).line;
        assert_eq!(line, lines(&text, table) + 1, "{}", errors[0]);
    }
}
