//! A scene's project is watched and taken over like its text.

use reflet::{
    runtime::{SceneSource, ViewOverrides, scene_text::SceneOptions},
    scene::project::ProjectChoice,
};

use crate::kit::*;

const RED: &str = "[material.red]\nbase_color = [0.9, 0.1, 0.1]\n";

#[test]
fn a_changed_project_is_taken_over_and_its_mistakes_are_shown() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let text = format!("include = \"red.toml\"\n{}", SCENE.replace(RED, ""));
    let scene = folder.write("scene.toml", text);
    folder.write("one/red.toml", RED);
    folder.write("two/red.toml", RED.replace("0.9, 0.1", "0.1, 0.9"));
    let project = folder.write("reflet.toml", "assets = \"one\"\n");
    let source = SceneSource {
        options: SceneOptions {
            project: ProjectChoice::Search,
            ..SceneOptions::default()
        },
        ..source(&scene)
    };
    let opened = Live::open(
        gpu.clone(),
        source,
        ViewOverrides::default(),
        InitialBuild::Whole,
    );
    let mut live = opened.expect("the scene opens");
    let project = project.canonicalize().expect("there");
    let is_watched = |live: &Live| {
        let (list, _) = live.watch_list();
        list.files.iter().any(|(path, _)| *path == project)
    };
    assert!(is_watched(&live));
    let first = picture(&gpu, &mut live);
    folder.write("reflet.toml", "assets = \"two\"\n");
    assert!(live.reload(&[Change::Scene].into()).ok);
    let second = picture(&gpu, &mut live);
    assert!(first != second, "the box has the color of the other folder");
    // A mistake keeps the last good picture, and the file is still watched.
    folder.write("reflet.toml", "asets = \"two\"\n");
    assert!(!live.reload(&[Change::Scene].into()).ok);
    let problem = live.problems.scene[0].to_string();
    assert!(problem.contains("reflet.toml:1:1"), "{problem}");
    assert!(picture(&gpu, &mut live) == second && is_watched(&live));
    folder.write("reflet.toml", "assets = \"one\"\n");
    assert!(live.reload(&[Change::Scene].into()).ok);
    assert!(picture(&gpu, &mut live) == first);
}
