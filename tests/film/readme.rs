//! The example files of the README and the guide render as a film.

use super::*;
use crate::common::readme::Story;

#[test]
fn the_scene_of_the_readme_is_checked_and_rendered_step_by_step() {
    let has_gpu = gpu_or_skip().is_some();
    let story = Story::read();
    let folder = kept_folder("film-readme", &[]);
    for (scene, moves) in story.scenes().iter().zip([false, true, true]) {
        if scene.contains(&story.script_lines) {
            fs::write(folder.join(&story.script_name), &story.script).expect("written");
        }
        fs::write(folder.join("my.toml"), scene).expect("written");
        let [out, err] = exits(&folder, "check my.toml", 0);
        assert!(out.starts_with("my.toml: ok"), "{err}");
        assert!(
            out.contains("96 frames") == moves && err.is_empty(),
            "{out}{err}"
        );
    }
    if has_gpu {
        let output = ["-o", "out/my.####.png", "--frames", "0,40"];
        let small = ["--set", "image.size=[32, 18]"];
        let arguments = [&["render", "my.toml"], &output[..], &small[..]].concat();
        exits(&folder, arguments, 0);
        let pictures = pictures(&folder.join("out"));
        assert_eq!(pictures.len(), 2);
        assert_ne!(pictures["my.0000.png"], pictures["my.0040.png"]);
    }
}
