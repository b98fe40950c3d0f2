//! The example files of the README and the guide render as a film.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use super::pictures;
use crate::common::{gpu_or_skip, readme::Story};

fn reflet(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_reflet"))
        .current_dir(folder)
        .args(arguments)
        .env("NODEVICE_SELECT", "1")
        .output()
        .expect("the program starts")
}

#[test]
fn the_scene_of_the_readme_is_checked_and_rendered_step_by_step() {
    let has_gpu = gpu_or_skip().is_some();
    let story = Story::read();
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("film-readme");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("temporary folder");
    for (scene, moves) in story.scenes().iter().zip([false, true, true]) {
        if scene.contains(&story.script_lines) {
            fs::write(folder.join(&story.script_name), &story.script).expect("written");
        }
        fs::write(folder.join("my.toml"), scene).expect("written");
        let checked = reflet(&folder, &["check", "my.toml"]);
        let [out, err] = [checked.stdout, checked.stderr]
            .map(|text| String::from_utf8(text).expect("its output is text"));
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
        let rendered = reflet(&folder, &arguments);
        assert!(rendered.status.success(), "{rendered:?}");
        let pictures = pictures(&folder.join("out"));
        assert_eq!(pictures.len(), 2);
        assert_ne!(pictures["my.0000.png"], pictures["my.0040.png"]);
    }
}
