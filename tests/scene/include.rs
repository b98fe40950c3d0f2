//! Scene text from several files.

use reflet::runtime::scene_text::{SceneOptions, SceneText};

use crate::kit::*;

impl Folder {
    fn parse(&self, set: &[&str]) -> Result<(Scene, Vec<Diagnostic>), String> {
        let set: Vec<String> = set.iter().map(|&s| s.to_owned()).collect();
        let read = Scene::from_file(&self.0.join("scene.toml"), &set);
        read.map_err(|errors| {
            let folder = format!("{}/", self.0.display());
            render_all(&errors, false).replace(&folder, "")
        })
    }
}

const SCENE: &str = include_str!("include/scene.toml");

const MATERIALS: &str = include_str!("include/materials.toml");

const COLORS: &str =
    "[material.red]\nbase_color = [1, 0, 0]\n[model.unused]\nshape = { kind = \"box\" }\n";

const LIGHTS: &str = include_str!("include/lights.toml");

fn library(scene: &str) -> Vec<(&'static str, String)> {
    vec![
        ("scene.toml", scene.to_owned()),
        ("library/materials.toml", MATERIALS.to_owned()),
        ("library/colors.toml", COLORS.to_owned()),
        ("lights.toml", LIGHTS.to_owned()),
    ]
}

fn folder(files: &[(&'static str, String)]) -> Folder {
    let files: Vec<_> = files.iter().map(|(f, t)| (*f, t.as_str())).collect();
    Folder::with(&files)
}

#[test]
fn files_stand_beside_the_scene() {
    let folder = folder(&library(SCENE));
    let (scene, warnings) = folder.parse(&[]).expect("it is right");
    assert_eq!(warnings, [], "unused library materials are no mistake");
    let names: Vec<_> = scene.materials.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(names, ["chrome", "red"]);
    let models: Vec<_> = scene.models.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        models,
        ["box"],
        "an unused model of a library stands nowhere"
    );
    assert_eq!(scene.instances.len(), 2);
    assert_eq!(scene.lights[0].name, "lamp");
    assert_eq!(scene.timeline.as_ref().map(|t| t.end), Some(10));
    assert_eq!(scene.motion.lights[0].name, "lamp");
    let included: Vec<_> = scene.includes.iter().map(|i| i.name.as_str()).collect();
    let order = [
        "library/materials.toml",
        "library/colors.toml",
        "lights.toml",
    ];
    assert_eq!(included, order);

    let (scene, _) = folder
        .parse(&["material.chrome.roughness=0.5"])
        .expect("included tables can be set");
    assert_eq!(scene.materials[0].value.roughness, Some(0.5));
}

#[test]
fn a_scene_in_parts_equals_the_scene_in_one_piece() {
    let parts = folder(&library(SCENE));
    let whole = SCENE.replace(
        "include = [\"library/materials.toml\", \"lights.toml\"]\n",
        "",
    ) + MATERIALS.split_once("toml\"]\n").expect("it includes").1
        + COLORS.split_once("[model.unused]").expect("it has one").0
        + LIGHTS;
    let one = Folder::with(&[("scene.toml", whole.as_str())]);
    let read = |folder: &Folder| {
        let (scene, _) = folder.parse(&[]).expect("it is right");
        let mut scene = scene.desc;
        scene.folder = PathBuf::new();
        scene.includes.clear();
        // File positions differ, and nothing else.
        let text = format!("{scene:?}");
        let mut rest = text.as_str();
        let mut out = String::new();
        while let Some((before, after)) = rest.split_once("Span {") {
            out += before;
            rest = after.split_once("range: ").map_or("", |(_, r)| r);
            rest = rest.split_once('}').map_or("", |(_, r)| r);
        }
        out + rest
    };
    assert_eq!(read(&parts), read(&one));
}

#[test]
fn includes_cannot_be_set_and_lists_are_no_tables() {
    let mut files = library(SCENE);
    let said = folder(&files).parse(&["include=[\"gone.toml\"]"]);
    let said = said.expect_err("files are read before settings");
    assert!(said.contains("`include` cannot be set"), "{said}");
    files[3].1 = "[[model]]\nshape = { kind = \"box\" }\n".into();
    let said = folder(&files)
        .parse(&[])
        .expect_err("a list beside a table");
    assert_says(
        &said,
        &["`model` is a table in one place and a list in another"],
    );
}

#[test]
fn each_file_is_read_once_and_circles_end() {
    let folder = Folder::with(&[
        (
            "scene.toml",
            "version = 1\ninclude = \"a.toml\"\n[model.m]\nshape = { kind = \"box\" }\n",
        ),
        (
            "a.toml",
            "include = [\"b.toml\", \"./a.toml\", \"scene.toml\"]\n[material.a]\n",
        ),
        ("b.toml", "include = [\"a.toml\"]\n[material.b]\n"),
    ]);
    let (scene, _) = folder.parse(&[]).expect("circles are no mistake");
    assert_eq!(scene.includes.len(), 2);
    assert_eq!(scene.materials.len(), 2);
}

#[test]
fn mistakes_are_placed_in_the_file_that_has_them() {
    let mut files = library(SCENE);
    files[2].1 = "[material.chrome]\nroughness = 0.3\n[material.blue]\nroughnes = 0.3\n".into();
    files[3].1 = "script = \"a.rhai\"\n[light.lamp]\nkind = \"point\"\nposition = [0 1]\n\
                  [environment]\nzenit = [0, 0, 0]\n"
        .into();
    let said = folder(&files).parse(&[]).expect_err("mistakes");
    for expected in [
        "`material.chrome` is defined twice\n --> library/colors.toml:1:11\n",
        "it is first defined here\n --> library/materials.toml:3:11\n",
        "`roughnes` is not a key of `[material.blue]`\n --> library/colors.toml:4:1\n",
        "did you mean `roughness`?",
        "an included file cannot have a script\n --> lights.toml:1:1\n",
        "a comma is missing between `0` and `1`\n --> lights.toml:4:12\n",
        "`zenit` is not a key of `[environment]`\n --> lights.toml:6:1\n",
    ] {
        assert!(said.contains(expected), "{expected} is not in\n{said}");
    }
    assert_eq!(said.matches("error[").count(), 5, "{said}");
}

#[test]
fn files_that_cannot_be_read_are_told_where_they_are_named() {
    let cases = [
        ("\"gone.toml\"", "gone.toml\" does not exist"),
        ("\"../up.toml\"", "is not below the scene's folder"),
        ("\"/etc/hostname\"", "is not below the scene's folder"),
        ("\"library\"", "cannot be read: it is not a regular file"),
        ("\"latin.toml\"", "must be UTF-8"),
        ("3", "must be text in quotes, or an array of them"),
        ("[3]", "must be text in quotes"),
        ("\"\"", "must not be empty"),
    ];
    for (named, expected) in cases {
        // A material that may be in the missing file is not reported as another mistake.
        let scene = SCENE.replace("[\"library/materials.toml\", \"lights.toml\"]", named);
        let folder = folder(&library(&scene));
        fs::write(folder.0.join("latin.toml"), b"[material.x]\n# caf\xe9\n").expect("written");
        let said = folder.parse(&[]).expect_err("it cannot be read");
        assert!(said.contains(expected), "{named}: {said}");
        let place = if named.contains("latin") {
            "latin.toml:2:6"
        } else {
            "scene.toml:2:"
        };
        assert!(said.contains(place), "{named}: {said}");
        let errors = said.matches("error[").count();
        let alone = !matches!(named, "3" | "[3]" | "\"\"");
        assert!(errors == 1 || !alone, "{named}: {said}");
    }
}

#[test]
#[cfg(unix)]
fn a_link_out_of_the_folder_is_refused() {
    let outside = Folder::with(&[("secret.toml", "[material.secret]\n")]);
    let folder = Folder::with(&[("scene.toml", "version = 1\ninclude = \"l.toml\"\n")]);
    let to = outside.0.join("secret.toml");
    std::os::unix::fs::symlink(to, folder.0.join("l.toml")).expect("a link");
    let said = folder.parse(&[]).expect_err("it leads out");
    assert_says(&said, &["resolves to a file outside the scene's folder"]);
}

#[test]
fn what_was_looked_for_is_known_also_after_a_mistake() {
    let folder = Folder::with(&[
        (
            "scene.toml",
            "version = 1\ninclude = [\"a.toml\", \"gone.toml\"]\n",
        ),
        ("a.toml", "include = \"b.toml\"\n"),
    ]);
    let path = folder.0.join("scene.toml");
    let text = fs::read_to_string(&path).expect("it is there");
    let dependencies = Dependencies::default();
    Scene::from_text_traced(&text, &path, &<_>::default(), &dependencies)
        .expect_err("two are missing");
    let names: Vec<_> = dependencies.paths();
    let expected = ["a.toml", "b.toml", "gone.toml"].map(|n| folder.0.join(n));
    assert_eq!(names, expected);
}

#[test]
fn parameters_of_included_files_are_parameters() {
    let folder = Folder::with(&[
        (
            "scene.toml",
            "version = 1\ninclude = \"p.toml\"\n[params]\na = 1\n",
        ),
        ("p.toml", "[params]\nb = 2\n"),
    ]);
    let path = folder.0.join("scene.toml");
    let options = SceneOptions {
        set: vec!["params.b=3".to_owned()],
        ..SceneOptions::default()
    };
    let text = SceneText::read(Some(&path), &options).expect("it can be read");
    let params = text.declared().expect("they are right");
    let named: Vec<_> = params.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(named, ["a", "b"]);
}

#[test]
fn no_damage_to_an_included_file_panics() {
    let mut random = Random(7);
    let mut failed = 0;
    for _ in 0..300 {
        let mut files = library(SCENE);
        let file = 1 + random.below(3);
        let mut bytes = files[file].1.clone().into_bytes();
        for _ in 0..1 + random.below(4) {
            let at = random.below(bytes.len());
            match random.below(3) {
                0 => bytes[at] = b"[]{}=\".\n0a"[random.below(10)],
                1 => drop(bytes.remove(at)),
                _ => bytes.truncate(at.max(1)),
            }
            if bytes.is_empty() {
                break;
            }
        }
        files[file].1 = String::from_utf8(bytes).expect("ASCII stays ASCII");
        failed += usize::from(folder(&files).parse(&[]).is_err());
    }
    assert!(failed > 100, "only {failed} of 300 damages were noticed");
}
