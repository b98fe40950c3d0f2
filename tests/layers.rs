//! The house rules that a machine can hold: imports point down, files are short and say what
//! they own.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Lower comes first. A file may name modules of its own layer and of those it lists.
const LAYERS: [(&str, &[&str]); 8] = [
    ("math", &[]),
    ("files", &[]),
    ("scene", &["math", "files"]),
    ("world", &["scene", "math", "files"]),
    ("gpu", &["math", "files"]),
    ("render", &["gpu", "world", "scene", "math"]),
    (
        "bench",
        &["render", "gpu", "world", "scene", "math", "files"],
    ),
    (
        "app",
        &["bench", "render", "gpu", "world", "scene", "math", "files"],
    ),
];

/// Longest a source file may be.
const MAX_LINES: usize = 400;

/// Files that may be longer, and how long.
const LONGER: [(&str, usize); 1] = [
    // Its doc comments are the scene manual.
    ("src/scene/desc.rs", 500),
];

fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("entry").path()) {
        if path.is_dir() {
            files.extend(files_below(&path, extensions));
        } else if path
            .extension()
            .is_some_and(|e| extensions.iter().any(|wanted| e == *wanted))
        {
            files.push(path);
        }
    }
    files.sort();
    files
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// `src/gpu/bind.rs` and `src/gpu.rs` belong to `gpu`.
fn layer_of(file: &Path) -> String {
    let below = file.strip_prefix(root().join("src")).expect("below src");
    let first = below.iter().next().expect("a name").to_string_lossy();
    first.trim_end_matches(".rs").to_owned()
}

/// Module names right after `crate::`, also those of `crate::{a, b::{c, d}, e}`.
fn named_modules(text: &str) -> Vec<String> {
    let code: String = text
        .lines()
        .map(|line| line.split("//").next().unwrap_or(""))
        .collect::<Vec<_>>()
        .join("\n");
    let mut modules = Vec::new();
    for after in code.split("crate::").skip(1) {
        if let Some(list) = after.strip_prefix('{') {
            let mut depth = 0;
            let mut word = String::new();
            for c in list.chars() {
                match c {
                    '{' => depth += 1,
                    '}' if depth == 0 => break,
                    '}' => depth -= 1,
                    ',' if depth == 0 => modules.push(std::mem::take(&mut word)),
                    c if depth == 0 => word.push(c),
                    _ => {}
                }
            }
            modules.push(word);
        } else {
            modules.push(after.to_owned());
        }
    }
    let first_word = |path: String| {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let path = path.trim_start();
        path.split(|c| !is_part(c)).next().unwrap_or("").to_owned()
    };
    let names = modules.into_iter().map(first_word);
    names.filter(|name| !name.is_empty()).collect()
}

#[test]
fn the_parser_of_imports_sees_nested_lists() {
    let text = "use crate::{gpu::{Gpu, GpuError}, math,\n scene::desc};\nlet x = crate::world::World;\n// crate::app";
    assert_eq!(named_modules(text), ["gpu", "math", "scene", "world"]);
}

#[test]
fn imports_only_point_down() {
    let mut wrong = Vec::new();
    for file in files_below(&root().join("src"), &["rs"]) {
        let layer = layer_of(&file);
        if layer == "lib" || layer == "main" {
            continue;
        }
        let Some((_, allowed)) = LAYERS.iter().find(|(name, _)| *name == layer) else {
            wrong.push(format!("{}: not in the list of layers", file.display()));
            continue;
        };
        let text = fs::read_to_string(&file).expect("readable");
        for named in named_modules(&text) {
            let is_layer = LAYERS.iter().any(|(name, _)| *name == named);
            if is_layer && named != layer && !allowed.contains(&named.as_str()) {
                wrong.push(format!("{}: {layer} imports {named}", file.display()));
            }
        }
        for (package, only) in [
            ("wgpu", &["gpu", "render", "app"][..]),
            ("clap", &["bench", "app"]),
        ] {
            let uses = text.contains(&format!("{package}::"));
            if uses && !only.contains(&layer.as_str()) {
                wrong.push(format!("{}: {layer} uses {package}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_are_short_and_say_what_they_own() {
    let mut wrong = Vec::new();
    let mut check = |file: &Path, opening: &str, max_lines: usize| {
        let text = fs::read_to_string(file).expect("readable");
        if !text.starts_with(opening) {
            wrong.push(format!("{}: must open with `{opening}`", file.display()));
        }
        let num_lines = text.lines().count();
        if num_lines > max_lines {
            wrong.push(format!(
                "{}: {num_lines} lines, at most {max_lines}",
                file.display()
            ));
        }
    };
    for folder in ["src", "tests"] {
        for file in files_below(&root().join(folder), &["rs"]) {
            let longer = LONGER.iter().find(|(name, _)| file.ends_with(name));
            check(&file, "//! ", longer.map_or(MAX_LINES, |(_, lines)| *lines));
        }
    }
    for file in files_below(&root().join("shaders"), &["wgsl"]) {
        check(&file, "// ", MAX_LINES);
    }
    check(&root().join("src/main.rs"), "//! ", 99);
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
