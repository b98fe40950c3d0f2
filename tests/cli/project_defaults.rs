//! Camera, variant, size and output that `render` and `check` take from a project.

use super::project::show;
use super::*;

#[test]
fn render_takes_camera_variant_size_and_output_from_the_project() {
    or_skip!(gpu_or_skip());
    let project = "camera = \"side\"\nvariant = [\"night\", \"other\"]\n\
                   output = \"out/{scene}.{camera}.{variant}.####.png\"\n[sizes]\ntiny = [16, 9]\n";
    let folder = show("project-render", project);
    let render = ["render", "show/base.toml", "--size", "tiny"];
    let [_, error] = exits(&folder, render, 0);
    let out = folder.join("show/out");
    assert_eq!(names(&out), ["base.side.night.png"], "{error}");
    let size = image::image_dimensions(out.join("base.side.night.png")).expect("a PNG");
    assert_eq!(size, (16, 9));
    let same = words("-o same.png --camera side --variant night --no-project");
    let size = ["render", "show/base.toml", "--size", "16x9"];
    exits(&folder, [&size[..], &same].concat(), 0);
    let read = |path: &Path| fs::read(path).expect("written");
    let default = read(&out.join("base.side.night.png"));
    assert!(default == read(&folder.join("same.png")));
    // Arguments win; an empty variant is none.
    exits(
        &folder,
        [&render[..], &["--camera", "main", "--variant", ""]].concat(),
        0,
    );
    assert_eq!(names(&out), ["base.main.png", "base.side.night.png"]);
    assert!(default != read(&out.join("base.main.png")));
    let [_, error] = exits(&folder, "render show/base.toml --size tinny", 2);
    assert!(error.contains("did you mean \"tiny\"?"), "{error}");
    let [_, error] = exits(&folder, "render scene.toml --size tiny", 2);
    assert!(error.contains("the scene is of no project"), "{error}");
    let [_, error] = exits(&folder, "render scene.toml", 2);
    assert!(error.contains("--output FILE is missing"), "{error}");
}

#[test]
fn names_of_a_project_that_are_nearly_those_of_the_scene_are_warned_of() {
    let project =
        "camera = \"sid\"\nvariant = [\"nigth\", \"winter\"]\noutput = \"{scene}.%04d.png\"\n";
    let folder = show("project-misspelt", project);
    let [text, error] = exits(&folder, "check show/base.toml", 0);
    assert!(text.contains("2 warnings"), "{text}");
    for part in [
        "reflet.toml:1:10",
        "has no camera \"sid\"",
        "did you mean \"side\"?",
        "reflet.toml:2:12",
        "has no variant \"nigth\"",
        "did you mean \"night\"?",
    ] {
        assert!(error.contains(part), "{part}: {error}");
    }
    assert!(!error.contains("no variant \"winter\""), "{error}");
    if gpu_or_skip().is_some() {
        // A scene without a timeline has no number.
        let tiny = ["render", "show/base.toml", "--size", "16x9"];
        exits(&folder, tiny, 0);
        assert!(folder.join("show/base.png").is_file());
    }
}
