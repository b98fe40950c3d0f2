//! Work and size of large scenes, counted: twice as long a text takes twice as many allocations, and a scene placed
//! many times is limited.

use std::{collections::BTreeSet, fmt::Write as _, sync::Arc};

use allocation_counter::measure;
use reflet::{
    app::{args::SceneArgs, check::messages},
    runtime::scene_text::{SceneOptions, SceneText},
    scene::{
        dependencies::Dependencies,
        diagnostic::{Diagnostic, Source},
        reach::UnsavedTexts,
        script::Bounds,
    },
};

use crate::{common::folder::Folder, kit::*};

const START: &str = "version = 1\ncamera.main.eye = [0, 0, 9]\ntimeline.end = 3\n\
    [model.ball]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"ball\"\nname = \"b\"\n";

/// Scenes with a number of things of one kind: lines once, lines for each of them, lines once more.
const KINDS: &str = include_str!("scale/kinds.txt");

/// The scene of a kind with `n` things.
fn scene_of(kind: &str, n: usize) -> String {
    let mut pieces = kind.splitn(3, "---\n");
    let [head, part, tail] = [(); 3].map(|()| pieces.next().unwrap_or_default());
    let names: String = (0..n).map(|i| format!("\"instance.i{i}\", ")).collect();
    let count = n.max(1).to_string();
    let whole = |lines: &str| {
        format!("{lines}\n")
            .replace("{n}", &count)
            .replace("{names}", &names)
    };
    let part = |i: usize| format!("{part}\n").replace("{i}", &i.to_string());
    text(n, &whole(head), part) + whole(tail).as_str()
}

/// A scene with `n` parts after `head`.
fn text(n: usize, head: &str, part: impl Fn(usize) -> String) -> String {
    let mut text = format!("{START}{head}");
    (0..n).for_each(|i| text += &part(i));
    text
}

/// Reads, loads and poses a scene and each of its variants, as `check` does.
fn read_all(text: &str) {
    let scene = SceneText::new(text, Path::new("scene.toml"), &SceneOptions::default());
    let variants = scene.variants();
    let chosen = variants.iter().map(|name| scene.with_variant(name));
    for one in [scene.clone()].into_iter().chain(chosen) {
        let opened = one
            .open(&[], &Dependencies::default())
            .expect("it is valid");
        let mut world = load(&opened.scene, &LoadOptions::default()).expect("no files are missing");
        let state = Animator::new(&opened.scene).pose(1).expect("it poses");
        world.apply(&state).expect("it is finite");
    }
}

#[test]
fn twice_as_many_parts_take_twice_the_work() {
    for kind in KINDS.split("\n\n") {
        let work = |n: usize| {
            let text = scene_of(kind, n);
            let work = measure(|| read_all(&text));
            [work.count_total, work.bytes_total]
        };
        // The difference leaves out what does not depend on the number.
        let [none, one, two] = [0, 150, 300].map(work);
        for (none, (one, two)) in none.into_iter().zip(one.into_iter().zip(two)) {
            let ratio = (two - none) as f64 / (one - none) as f64;
            assert!(
                ratio < 2.3,
                "{kind}: {one} and {two}: {ratio:.2} times the work"
            );
        }
    }
}

/// Messages about a text without unsaved texts beside it.
fn messages_of(text: &Arc<Source>, from: &SceneArgs) -> Vec<Diagnostic> {
    messages(
        text,
        from,
        UnsavedTexts::default(),
        &Dependencies::default(),
    )
}

/// Variants that leave geometry alone share meshes and trees; variants that move it have their own trees.
#[test]
fn variants_share_meshes_and_trees() {
    let ball = "[model.globe]\nshape = { kind = \"sphere\", segments = 256 }\n\
        [[instance]]\nmodel = \"globe\"\nname = \"g\"\n[material.paint]\n";
    let work = |n: usize| {
        let part = |i: usize| format!("[variant.v{i}.material.paint]\nroughness = 0.{}\n", i + 1);
        let text = text(n, ball, part);
        let source = Arc::new(Source::new(Path::new("scene.toml"), &text));
        let work = measure(|| drop(messages_of(&source, &SceneArgs::default())));
        work.bytes_total
    };
    let [none, two, eight] = [0, 2, 8].map(work);
    let each = (eight - two) / 6;
    assert!(
        each * 10 < none,
        "{each} bytes for each variant, {none} for the scene"
    );
    // A variant that moves something with the lamp inside of it, between two with the lamp outside.
    let text = format!(
        "{START}[environment]\ncolor = [1, 1, 1]\n[light.lamp]\nkind = \"point\"\nposition = [0, 0, 5]\n\
         intensity_cd = 1\n[variant.a.image]\nexposure_ev = 1\n\
         [variant.b.instance.b]\ntranslation = [0, 0, 5]\n[variant.c.image]\nexposure_ev = 2\n"
    );
    let source = Arc::new(Source::new(Path::new("scene.toml"), &text));
    let all = messages_of(&source, &SceneArgs::default());
    let alone = |name: &str| {
        let args = SceneArgs {
            variant: vec![name.to_owned()],
            ..SceneArgs::default()
        };
        messages_of(&source, &args)
    };
    let names = |found: &[Diagnostic]| found.iter().map(|d| d.name).collect::<BTreeSet<_>>();
    assert_eq!(names(&alone("a")), names(&alone("c")));
    assert!(
        names(&alone("b")).len() > names(&alone("a")).len(),
        "{all:?}"
    );
    let each: BTreeSet<_> = ["a", "b", "c"]
        .iter()
        .flat_map(|v| names(&alone(v)))
        .collect();
    assert_eq!(names(&all), each);
}

fn refused(folder: &Folder, file: &str) -> Vec<Diagnostic> {
    match Scene::from_file(&folder.0.join(file), &[]) {
        Err(errors) => errors,
        Ok(_) => panic!("{file} is not too large"),
    }
}

/// Scene that places a scene a number of times under these names.
fn placing(names: impl Iterator<Item = String>, params: impl Fn(usize) -> String) -> String {
    let mut text = "version = 1\n".to_owned();
    for (i, name) in names.enumerate() {
        let _ = writeln!(
            text,
            "[[instance]]\nname = \"{name}\"\nmodel = {{ scene = \"part.toml\"{} }}",
            params(i)
        );
    }
    text
}

#[test]
fn what_placed_scenes_become_is_limited() {
    let numbers = format!("version = 1\n[params]\nx = [{}]\n", "0, ".repeat(50_000));
    let materials: String = (0..200).map(|i| format!("[material.m{i}]\n")).collect();
    let materials = format!("version = 1\n{materials}");
    let many = placing((0..100).map(|i| format!("p{i}")), |_| String::new());
    let long = placing(
        (0..3).map(|i| format!("p{i}{}", "a".repeat(100_000))),
        |_| String::new(),
    );
    for (part, scene, says) in [
        (&numbers, &many, "4000000 values"),
        (&materials, &long, "32 MiB of names"),
    ] {
        let folder = Folder::with(&[("part.toml", part), ("scene.toml", scene)]);
        let mut errors = Vec::new();
        let work = measure(|| errors = refused(&folder, "scene.toml"));
        assert_eq!(errors.len(), 1, "{errors:?}");
        assert_eq!(errors[0].name, "scene-too-large");
        assert!(errors[0].message.contains(says), "{}", errors[0].message);
        assert!(work.bytes_max < 1 << 30, "{} bytes", work.bytes_max);
    }
}

/// Three scenes that each place the next nine times, and the last has materials: 729,000 tables in 36 KB.
#[test]
#[ignore = "long: it reads 650,000 tables"]
fn scenes_that_place_scenes_multiply_no_further_than_the_limit() {
    let placing = |file: &str| {
        let part = |i| format!("[[instance]]\nname = \"c{i}\"\nmodel = {{ scene = \"{file}\" }}\n");
        (0..9)
            .map(part)
            .fold("version = 1\n".to_owned(), |text, part| {
                text + part.as_str()
            })
    };
    let materials: String = (0..1000)
        .map(|i| format!("[material.m{i}]\nroughness = 0.1\n"))
        .collect();
    let files = [
        ("p0.toml", placing("p1.toml")),
        ("p1.toml", placing("p2.toml")),
        ("p2.toml", placing("p3.toml")),
        ("p3.toml", format!("version = 1\n{materials}")),
    ];
    let files: Vec<_> = files
        .iter()
        .map(|(name, text)| (*name, text.as_str()))
        .collect();
    let folder = Folder::with(&files);
    let mut errors = Vec::new();
    let work = measure(|| errors = refused(&folder, "p0.toml"));
    assert_eq!(
        (errors.len(), errors[0].name),
        (1, "scene-too-large"),
        "{errors:?}"
    );
    assert_says(&errors[0].message, &["650000 tables"]);
    assert!(work.bytes_max < 2 << 30, "{} bytes", work.bytes_max);
}

#[test]
fn texts_of_a_scene_are_limited_together() {
    let filler = format!("version = 1\n# {}\n", "filler ".repeat((15 << 20) / 7));
    let files = [
        ("a.toml", filler.as_str()),
        ("b.toml", &filler),
        ("c.toml", &filler),
    ];
    let scene = "version = 1\ninclude = [\"a.toml\", \"b.toml\", \"c.toml\"]\n";
    let folder = Folder::with(&[&files[..], &[("scene.toml", scene)]].concat());
    let errors = refused(&folder, "scene.toml");
    assert_eq!((errors.len(), errors[0].name), (1, "scene-too-large"));
    let text = errors[0].to_string();
    assert!(text.contains("scene.toml:2:32"), "{text}");
}

#[test]
fn inherited_texts_are_limited() {
    let heirs = (0..400).map(|i| format!("[material.m{i}]\nextends = \"a\"\n"));
    let long = "a".repeat(100_000);
    let text = format!(
        "version = 1\n[material.a]\nbase_color_texture = \"{long}\"\n{}",
        heirs.collect::<String>()
    );
    let errors = Scene::from_text(&text, Path::new("scene.toml"), &[]).expect_err("too large");
    assert_eq!((errors.len(), errors[0].name), (1, "scene-too-large"));
}

/// A script that exceeds a limit keeps the scripts that are placed after it from running.
#[test]
fn one_placed_script_that_exceeds_a_limit_is_enough() {
    let part = "version = 1\nscript = \"s.rhai\"\nparams = { n = 0 }\n";
    let script = "fn setup(ctx) { if ctx.params.n > 0 { loop { } } }";
    let scene = placing((0..50).map(|i| format!("p{i}")), |i| {
        format!(", params = {{ n = {i} }}")
    });
    let files = [
        ("part.toml", part),
        ("s.rhai", script),
        ("scene.toml", &scene),
    ];
    let folder = Folder::with(&files);
    let errors = Bounds::CALL
        .at_most(10_000)
        .over(|| refused(&folder, "scene.toml"));
    let names: Vec<_> = errors.iter().map(|e| e.name).collect();
    assert_eq!(names, ["script-limit"], "{errors:?}");
}
