//! Projects: `reflet.toml`, the border that it gives to scenes, and its settings for commands.

use super::*;
use crate::common::{assert_says, cases};

/// A base that shots are laid over, with a light of its own.
const BASE: &str = include_str!("project/base.toml");

/// A shot in a subfolder, which reaches upward by its base, an included file, a placed scene and a script.
const SHOT: &str = "version = 1\nbase = \"../base.toml\"\ninclude = \"../lib/red.toml\"\nscript = \"turn.rhai\"\n\
                    [[instance]]\nmodel = \"ball\"\nmaterial = \"red\"\n[[instance]]\n\
                    model = { scene = \"../props/lamp.toml\" }\n";

fn write(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(path, text).expect("written");
    }
}

/// A project in `show`, with a shot that needs it.
pub fn show(name: &str, project: &str) -> std::path::PathBuf {
    let folder = folder(name);
    let prop = "version = 1\ninclude = \"../lib/red.toml\"\n[model.foot]\nshape = { kind = \"box\", size = [0.1, 0.1, 0.1] }\n\
                [[instance]]\nmodel = \"foot\"\nmaterial = \"red\"\ntranslation = [1, 0, 0]\n";
    write(
        &folder,
        &[
            ("show/reflet.toml", project),
            ("show/base.toml", BASE),
            (
                "show/lib/red.toml",
                "[material.red]\nbase_color = [0.8, 0.1, 0.1]\n",
            ),
            ("show/props/lamp.toml", prop),
            (
                "show/scripts/turn.rhai",
                "import \"common\" as c;\nfn setup(ctx) { #{} }\n",
            ),
            ("show/scripts/common.rhai", "fn one() { 1 }\n"),
            ("show/shots/a.toml", SHOT),
            ("outside.toml", "version = 1\n"),
        ],
    );
    folder
}

#[test]
fn mistakes_of_a_project_have_their_places() {
    let folder = show("project-mistakes", "");
    let file = folder.join("show/reflet.toml");
    for (text, says) in cases(include_str!(
        "project/mistakes_of_a_project_have_their_places.txt"
    )) {
        let says: Vec<&str> = says.split(" | ").collect();
        fs::write(&file, format!("{text}\n")).expect("written");
        let [_, error] = exits(&folder, "check show/base.toml", 3);
        assert!(
            says.iter().all(|say| error.contains(say)),
            "{text}: {error}"
        );
        // An output that is not used does no harm.
        let with = ["render", "show/base.toml", "-o", "a.png"];
        let render = if says[1] == ".png" { &with[..2] } else { &with };
        let [_, error] = exits(&folder, render, 3);
        assert!(error.contains(says[0]), "{text}: {error}");
    }
    for (bytes, says) in [
        (vec![b'#'; (1 << 20) + 1], "at most 1 MiB"),
        (vec![0xff], "UTF-8"),
    ] {
        fs::write(&file, bytes).expect("written");
        let [_, error] = exits(&folder, "check show/base.toml", 3);
        assert_says(&error, &[says, "reflet.toml"]);
    }
    // A folder that does not exist is a warning, as for `--assets`.
    fs::write(&file, "assets = [\"gone\"]\n").expect("written");
    let [text, error] = exits(&folder, "check show/base.toml", 0);
    assert!(
        text.contains("1 warning") && error.contains("reflet.toml:1:11"),
        "{text}{error}"
    );
    assert_eq!(names(&folder), ["outside.toml", "scene.toml", "show"]);
}

#[test]
fn jobs_name_the_project() {
    let folder = show("project-job", "scripts = \"scripts\"\n");
    let film = format!("{SHOT}[timeline]\nend = 3\n");
    fs::write(folder.join("show/shots/a.toml"), film).expect("written");
    let slurm = words("job slurm show/shots/a.toml --pictures o/a.##.png -o a.sh");
    exits(&folder, &slurm, 0);
    let script = fs::read_to_string(folder.join("a.sh")).expect("written");
    let file = folder
        .join("show/reflet.toml")
        .canonicalize()
        .expect("there");
    assert!(
        script.contains(&format!("--project {}", file.display())),
        "{script}"
    );
    let openjd = words("job openjd show/shots/a.toml --pictures o/a.##.png -o job");
    exits(&folder, &openjd, 0);
    let template = fs::read_to_string(folder.join("job/template.json")).expect("written");
    assert!(template.contains("{{Param.Project}}"), "{template}");
    let inputs = fs::read_to_string(folder.join("job/asset_references.json")).expect("written");
    assert!(inputs.contains("show/reflet.toml"), "{inputs}");
}

#[test]
fn a_new_project_checks_and_renders() {
    let folder = folder("project-new");
    let [_, said] = exits(&folder, ["new", "my show"], 0);
    assert_says(
        &said,
        &["`reflet render 'my show/scenes/main.toml' --size draft`"],
    );
    let [text, warnings] = exits(&folder, ["check", "my show/scenes/main.toml"], 0);
    assert_says(&text, &["ok, 1 variant, in the project \"my show\""]);
    assert_eq!(warnings, "");
    // Nothing is replaced, nor left where it cannot be made.
    fs::write(folder.join("my show/reflet.toml"), "name = \"mine\"\n").expect("written");
    exits(&folder, ["new", "my show"], 2);
    exits(&folder, "new scene.toml", 2);
    exits(&folder, "new gone/show", 2);
    exits(&folder, "new ..", 2);
    exits(&folder, ["new", "a\nb"], 2);
    exits(&folder, ["check", "my show/reflet.toml"], 3);
    let own = fs::read_to_string(folder.join("my show/reflet.toml")).expect("there");
    assert_eq!(own, "name = \"mine\"\n");
    assert_eq!(names(&folder), ["my show", "scene.toml"]);
    assert!(SCENE.contains("version"));
}

#[test]
fn a_new_project_renders_a_scene_without_further_arguments() {
    or_skip!(gpu_or_skip());
    let folder = folder("project-new-render");
    exits(&folder, "new show", 0);
    let [_, error] = exits(&folder.join("show"), "render", 2);
    assert!(error.contains("without SCENE"), "{error}");
    let quick = ["--size", "64x36", "--samples", "1"];
    exits(
        &folder,
        [&["render", "show/scenes/main.toml"], &quick[..]].concat(),
        0,
    );
    assert_eq!(names(&folder.join("show/renders")), ["main.main.png"]);
    let picture = image::open(folder.join("show/renders/main.main.png")).expect("a PNG");
    let picture = picture.to_rgb8();
    let red = picture
        .pixels()
        .filter(|p| p.0[0] > 80 && p.0[1] < p.0[0] / 2);
    assert!(red.count() > 20, "the ball is seen");
}
