//! Outputs never replace an input of their command, nor anything but a regular file.

use super::check_and_info::without_gpu;
use super::*;

/// Runs a command that is refused; returns its message.
#[track_caller]
fn refused(folder: &Path, arguments: impl Arguments) -> String {
    let [_, error] = without_gpu(folder, arguments, 2);
    error
}

/// Names, kinds and contents of all files.
fn state(folder: &Path) -> Vec<(String, bool, Option<Vec<u8>>)> {
    let entries = fs::read_dir(folder).expect("readable").flatten();
    let mut all: Vec<_> = entries
        .map(|entry| {
            let path = entry.path();
            let content = path.is_file().then(|| fs::read(&path).expect("readable"));
            let name = entry.file_name().to_string_lossy().into_owned();
            (name, path.is_symlink(), content)
        })
        .collect();
    all.sort();
    all
}

/// A scene with a texture and an included file, and other names of these.
fn scene(name: &str) -> std::path::PathBuf {
    let folder = folder(name);
    let text = super::SCENE.replace(
        "base_color = [0.8, 0.1, 0.1]",
        "base_color_texture = \"f.03.png\"",
    );
    assert!(text.contains("f.03.png"));
    fs::write(folder.join("scene.toml"), text).expect("written");
    let texture = image::RgbImage::from_pixel(4, 4, image::Rgb([200, 30, 30]));
    texture.save(folder.join("f.03.png")).expect("written");
    folder
}

#[test]
fn no_command_replaces_its_input() {
    let folder = scene("inputs");
    fs::create_dir(folder.join("inside")).expect("a folder");
    fs::hard_link(folder.join("scene.toml"), folder.join("hard.zip")).expect("a hard link");
    #[cfg(unix)]
    for (to, name) in [("f.03.png", "soft.png"), ("light.toml", "soft.zip")] {
        std::os::unix::fs::symlink(to, folder.join(name)).expect("a link");
    }
    let before = state(&folder);
    let mut cases = vec![
        "pack scene.toml -o scene.toml",
        "pack scene.toml -o inside/../light.toml",
        "pack scene.toml -o hard.zip",
        "job slurm scene.toml --pictures p.#.png -o scene.toml",
        "job slurm scene.toml --pictures p.#.png -o s.rhai",
        "render scene.toml -o f.03.png",
        "render scene.toml -o inside/../f.03.png",
        // The third of its frames is the texture.
        "render scene.toml -o f.##.png",
    ];
    if cfg!(unix) {
        cases.extend([
            "render scene.toml -o soft.png",
            "pack scene.toml -o soft.zip",
        ]);
    }
    for arguments in cases {
        let text = refused(&folder, arguments);
        assert!(
            text.contains("an input of this command"),
            "{arguments:?}: {text}"
        );
        assert_eq!(state(&folder), before, "{arguments:?}");
    }
    // The files of a bundle have names of their own.
    fs::rename(folder.join("scene.toml"), folder.join("template.json")).expect("renamed");
    let before = state(&folder);
    let text = refused(&folder, "job openjd template.json --pictures p.#.png -o .");
    assert!(text.contains("an input of this command"), "{text}");
    assert_eq!(state(&folder), before);
}

/// Reports of `bench` that a scene reads, by names that only hostile scenes give their files.
#[test]
fn no_report_replaces_an_input() {
    let folder = scene("reports");
    let text = fs::read_to_string(folder.join("scene.toml")).expect("there");
    for name in [
        "samples.csv",
        "bench.json",
        "report.html",
        "reload.json",
        "stability.csv",
        "stability.html",
        "systems.csv",
    ] {
        let part = format!("version = 1\n[material.\"{name}\"]\n");
        fs::write(folder.join(name), part).expect("written");
        let scene = format!(
            "include = [\"light.toml\", \"{name}\"]\n{}",
            text.replace("include", "# include")
        );
        fs::write(folder.join(format!("{name}.toml")), scene).expect("written");
    }
    let before = state(&folder);
    for (command, report) in [
        ("bench", "samples.csv"),
        ("bench", "bench.json"),
        ("bench", "report.html"),
        ("bench reload", "reload.json"),
        ("bench stability", "samples.csv"),
        ("bench stability", "stability.csv"),
        ("bench stability", "stability.html"),
        ("bench comparators", "systems.csv"),
    ] {
        let text = refused(&folder, format!("{command} {report}.toml -o ."));
        assert!(
            text.contains("an input of this command"),
            "{command:?} {report}: {text}"
        );
        assert_eq!(state(&folder), before, "{command:?}");
    }
}

#[cfg(unix)]
#[test]
fn outputs_are_regular_files() {
    let folder = scene("regular");
    let path = |name: &str| folder.join(name);
    let made = Command::new("mkfifo").arg(path("pipe.png")).status();
    assert!(made.is_ok_and(|status| status.success()));
    fs::create_dir(path("folder.png")).expect("a folder");
    std::os::unix::fs::symlink("/dev/null", path("null.png")).expect("a link");
    fs::write(path("locked.png"), "old").expect("written");
    let mut locked = fs::metadata(path("locked.png"))
        .expect("there")
        .permissions();
    locked.set_readonly(true);
    fs::set_permissions(path("locked.png"), locked).expect("settable");
    let before = state(&folder);
    for command in [
        "render scene.toml -o",
        "pack scene.toml -o",
        "job slurm scene.toml --pictures p.#.png -o",
    ] {
        for (name, says) in [
            ("pipe.png", "it is a pipe"),
            ("folder.png", "it is a folder"),
            ("null.png", "it is a device"),
            ("locked.png", "it is read-only"),
        ] {
            let text = refused(&folder, format!("{command} {name}"));
            assert!(text.contains(says), "{command:?} {name}: {text}");
        }
        assert_eq!(state(&folder), before, "{command:?}");
    }
}
