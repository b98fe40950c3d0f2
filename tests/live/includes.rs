//! Included scene text is watched like the scene's own.

use crate::kit::*;

const RED: &str = "[material.red]\nbase_color = [0.9, 0.1, 0.1]\n";

#[test]
fn an_included_file_is_watched_and_taken_over() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = format!("include = \"parts/red.toml\"\n{}", SCENE.replace(RED, ""));
    let scene = folder.write("scene.toml", text);
    let part = folder.write("parts/red.toml", RED);
    let mut live = open(&gpu, &scene, None);
    let (list, _) = live.watch_list();
    assert!(
        list.files.contains(&(part.clone(), Change::Scene)),
        "{list:?}"
    );
    let first = picture(&gpu, &mut live);

    folder.write("parts/red.toml", RED.replace("0.9, 0.1", "0.1, 0.9"));
    let reload = live.reload(&[Change::Scene].into());
    assert!(
        reload.ok && !reload.files,
        "materials read no file: {reload:?}"
    );
    let second = picture(&gpu, &mut live);
    assert!(first != second, "the box has another color");

    // After an error in the included file, or its removal, the last good picture stays, and it is still watched.
    folder.write("parts/red.toml", RED.replace("base_color", "base_colour"));
    assert!(!live.reload(&[Change::Scene].into()).ok);
    let problem = live.problems.scene[0].to_string();
    assert!(problem.contains("parts/red.toml:2:1"), "{problem}");
    std::fs::remove_file(&part).expect("it is there");
    assert!(!live.reload(&[Change::Scene].into()).ok);
    assert!(picture(&gpu, &mut live) == second);
    let (list, _) = live.watch_list();
    assert!(list.files.contains(&(part, Change::Scene)), "{list:?}");

    folder.write("parts/red.toml", RED);
    assert!(live.reload(&[Change::Scene].into()).ok);
    assert!(picture(&gpu, &mut live) == first);
}
