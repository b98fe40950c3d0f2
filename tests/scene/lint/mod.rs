//! Warnings of `check` about allowed text that is hardly intended, and intended text that looks like it.

mod lamps;
mod meant;
mod probes;

use crate::common::{
    assert_says,
    folder::kept_folder,
    program::{reflet, texts},
};
use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::Stdio,
};

use reflet::{
    app::{args::SceneArgs, check},
    scene::{dependencies::Dependencies, diagnostic::Source},
};

/// Name, place and sentence of a message, the advice after a semicolon.
type Found = [String; 3];

fn folder(name: &str) -> PathBuf {
    kept_folder(&format!("lint-{name}"), &[])
}

/// Messages of `check` about the text of a scene at this path.
fn found_at(path: &Path, text: &str) -> Vec<Found> {
    let source = Source::new(path, text).into();
    let args = SceneArgs::default();
    let messages = check::messages(&source, &args, Default::default(), &Dependencies::default());
    let rows = messages.into_iter().map(|d| {
        let at = d.span.source.as_ref().map(|s| s.place(d.span.range.start));
        let at = at.map(|at| format!("{}:{}", at.line, at.column));
        let sentence = d
            .help
            .map_or(d.message.clone(), |help| format!("{}; {help}", d.message));
        [d.name.to_owned(), at.unwrap_or_default(), sentence]
    });
    rows.collect()
}

/// Messages of `check` about the text of a scene without files.
fn found(text: &str) -> Vec<Found> {
    found_at(Path::new("scene.toml"), text)
}

/// The only message about the text of a scene.
#[track_caller]
fn only(text: &str) -> Found {
    let found = found(text);
    <[Found; 1]>::try_from(found).map_or_else(|found| panic!("{found:#?}"), |[one]| one)
}

/// Number of messages of this name about the text of a scene.
fn count(name: &str, text: &str) -> usize {
    let named = |found: &Found| found[0] == name;
    found(text).into_iter().filter(named).count()
}

/// Scene cameras that share a name with a placed scene's camera are told apart from it.
#[test]
fn cameras_of_placed_scenes_are_told_from_those_of_the_scene() {
    let folder = folder("placed");
    fs::write(folder.join("wall.toml"), include_str!("placed_wall.toml")).expect("writable");
    let mut found = found_at(&folder.join("scene.toml"), include_str!("placed.toml"));
    found.retain(|[name, ..]| name == "camera-inside");
    assert!(
        matches!(&found[..], [[_, at, _]] if at == "7:9"),
        "{found:#?}"
    );
}

#[test]
fn mistakes_of_a_scene_do_not_hide_those_of_its_variants() {
    let found = found(
        "version = 1\n[camera.main]\nfov_deg = 900\n[variant.a.camera.main]\nlens = 3\n\
         [variant.b]\nremove = \"camera.mian\"\n",
    );
    let places: Vec<&str> = found.iter().map(|[_, at, _]| at.as_str()).collect();
    assert_eq!(places, ["3:11", "5:1", "7:10"], "{found:#?}");
}

#[test]
fn all_scenes_are_checked_and_one_may_come_from_standard_input() {
    let folder = folder("several");
    let good = "version = 1\nenvironment.color = [1, 1, 1]\n[model.a]\nshape.kind = \"box\"\n";
    fs::write(folder.join("good.toml"), good).expect("writable");
    fs::write(folder.join("bad.toml"), "version = 2\n").expect("writable");
    let check = |arguments: &[&str], input: &str| {
        let mut child = reflet(&folder, "check")
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut stdin = child.stdin.take().expect("piped");
        stdin.write_all(input.as_bytes()).expect("it reads");
        drop(stdin);
        let output = child.wait_with_output().expect("it ends");
        let [out, errors] = texts(&output);
        assert!(!errors.contains("panicked"), "{errors}");
        (output.status.code(), out, errors)
    };
    let (code, out, errors) = check(&["bad.toml", "good.toml", "none.toml"], "");
    assert_eq!(
        (code, out.as_str()),
        (Some(3), "good.toml: ok\n"),
        "{errors}"
    );
    assert_says(&errors, &["version 2", "none.toml"]);
    let (code, out, errors) = check(&["-"], good);
    assert_eq!((code, out.as_str()), (Some(0), "<stdin>: ok\n"), "{errors}");
    let (code, _, errors) = check(&["-"], "version = 1\n[material.a]\nroughness = 5\n");
    assert_eq!(code, Some(3));
    assert!(errors.contains("<stdin>:3:13"), "{errors}");
    let (code, out, _) = check(&["-", "--json"], "version = 1\nx = 1\n");
    assert_eq!(code, Some(3));
    let log: serde_json::Value = serde_json::from_str(&out).expect("it is JSON");
    assert_eq!(log["version"], "2.1.0");
    let result = &log["runs"][0]["results"][0];
    assert_eq!(
        (&result["level"], &result["ruleId"]),
        (&"error".into(), &"unknown-key".into())
    );
    let place = &result["locations"][0]["physicalLocation"];
    assert_eq!(place["artifactLocation"]["uri"], "%3Cstdin%3E");
    let region = &place["region"];
    assert_eq!(
        (&region["startLine"], &region["startColumn"]),
        (&2.into(), &1.into())
    );
}
