//! Reloads of a scene with an animated file: edits of the played animation read no file, and
//! rebuild trees only if other instances move.

use crate::{common::animated::write_arm, kit::*};

const SCENE: &str = include_str!("animation/scene.toml");

#[test]
fn what_is_played_changes_without_reading_a_file() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    write_arm(folder.path("arm.gltf").parent().expect("a folder"));
    let scene = folder.write("scene.toml", SCENE);
    let mut live = open(&gpu, &scene, None);
    let playing = |what: &str| format!("{SCENE}animation = {what}\n");
    for (text, builds) in [
        (playing("\"swing\""), true), // static things may move
        (playing("\"*\""), false),    // the same things move
        (
            playing("{ name = \"swing\", start_s = 1, repeat = \"once\" }"),
            false,
        ),
        (playing("\"*\""), false),
        (SCENE.to_owned(), true),
    ] {
        fs::write(&scene, &text).expect("written");
        let reload = live.reload(&[Change::Scene].into());
        assert!(reload.ok && !reload.files, "{text}: {:?}", live.problems);
        assert_eq!(reload.rebuilt.trees, builds, "{text}");
        assert!(!reload.rebuilt.upload, "{text}");
        assert!(picture(&gpu, &mut live) == picture(&gpu, &mut open(&gpu, &scene, None)));
    }
    fs::write(&scene, playing("\"swimg\"")).expect("written");
    let reload = live.reload(&[Change::Scene].into());
    assert!(!reload.ok && !reload.files);
    let error = &live.problems.scene[0];
    assert_eq!(error.name, "unknown-animation");
    assert!(error.to_string().contains("scene.toml:12:13"), "{error}");
    fs::write(&scene, playing("\"swing\"")).expect("written");
    assert!(live.reload(&[Change::Scene].into()).ok);
}
