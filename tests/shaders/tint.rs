//! Shaders in a second compiler of WGSL.

use std::{collections::HashSet, fs, path::Path, process::Command};

use reflet::gpu::{ShaderError, ShaderSource};

use super::libraries;
use crate::common::folder::kept_folder;

/// Names and texts of every shader of every variant; shared shaders appear once.
pub fn sources() -> Vec<(String, Result<ShaderSource, ShaderError>)> {
    let libraries = libraries();
    let all = libraries.iter().flat_map(|library| {
        let names = library.names();
        names.map(move |name| (name.to_owned(), library.source(name)))
    });
    let mut seen = HashSet::new();
    let mut is_new = |name: &String, text: &str| seen.insert((name.clone(), text.to_owned()));
    all.filter(|(name, s)| s.as_ref().map_or(true, |s| is_new(name, &s.text)))
        .collect()
}

/// Tint, the compiler of WGSL in Chromium, reads every shader that naga reads.
#[test]
#[ignore = "takes long; needs a package of npm"]
fn a_second_compiler_accepts_every_shader() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let has_node = Command::new("node").arg("--version").output().is_ok();
    let dawn = root.join("target/tools/node_modules/webgpu");
    if !has_node || !dawn.is_dir() {
        eprintln!("SKIPPED: node or its package webgpu in target/tools is not installed");
        return;
    }
    let folder = kept_folder("tint", &[]);
    let mut sources = sources();
    // Ray queries are an extension of wgpu, which Chromium does not have.
    sources.retain(|(_, source)| {
        let source = source.as_ref().expect("it assembles");
        !source.text.contains("enable wgpu_ray_query;")
    });
    for (index, (name, source)) in sources.iter().enumerate() {
        let text = &source.as_ref().expect("it assembles").text;
        let file = format!("{index:04}-{}.wgsl", name.replace('/', "-"));
        fs::write(folder.join(file), text.as_bytes()).expect("writable");
    }
    let mut tint = Command::new("node");
    tint.arg(root.join("tools/tint.mjs"))
        .arg(&dawn)
        .arg(&folder);
    let output = tint.output().expect("node starts");
    let [said, errors] =
        [output.stdout, output.stderr].map(|b| String::from_utf8_lossy(&b).into_owned());
    assert!(output.status.success(), "{said}{errors}");
    assert_eq!(said, format!("{} shaders compile\n", sources.len()));
}
