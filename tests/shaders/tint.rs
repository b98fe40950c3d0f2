//! Shaders in a second compiler of WGSL.

use std::{collections::HashMap, fs, path::Path, process::Command};

use reflet::{
    gpu::{ShaderError, ShaderLibrary, ShaderSource},
    render::{passes, pipeline::shader_variant::ShaderVariant, plan::Features},
};

use xxhash_rust::xxh3::xxh3_128;

use crate::common::folder::kept_folder;

/// Name and text of a shader, and the features of the variants that have it.
pub type Source = (String, Result<ShaderSource, ShaderError>, Vec<Features>);

/// Every shader of every variant; shared ones appear once.
pub fn sources() -> Vec<Source> {
    let embedded = ShaderLibrary::embedded();
    let mut all: Vec<Source> = Vec::new();
    let mut places = HashMap::new();
    for variant in ShaderVariant::all() {
        let library = or_panic!(variant.library(&embedded, &passes::ALL));
        for name in library.names() {
            let source = library.source(name);
            let text = source.as_ref().map(|source| source.text.clone());
            let text = text.map_err(ToString::to_string);
            // Texts are long, and the hash of a map is slow without optimization.
            let text = text.map(|text| xxh3_128(text.as_bytes()));
            let place = *places.entry((name.to_owned(), text)).or_insert(all.len());
            if place == all.len() {
                all.push((name.to_owned(), source, Vec::new()));
            }
            all[place].2.push(variant.features);
        }
    }
    all
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
    sources.retain(|(_, source, _)| {
        let source = source.as_ref().expect("it assembles");
        !source.text.contains("enable wgpu_ray_query;")
    });
    for (index, (name, source, _)) in sources.iter().enumerate() {
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
