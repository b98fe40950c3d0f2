//! Source structure: layered imports without cycles, short files, and module headers.

mod circles;
mod imports;

use std::{
    fs,
    path::{Path, PathBuf},
};

/// Lower comes first. A file may name modules of its own layer and of those it lists.
const LAYERS: [(&str, &[&str]); 11] = [
    ("math", &[]),
    ("files", &[]),
    ("memory", &[]),
    ("processor_time", &[]),
    ("scene", &["math", "files", "processor_time"]),
    ("world", &["scene", "math", "files", "memory"]),
    ("gpu", &["math", "files"]),
    (
        "render",
        &["gpu", "world", "scene", "math", "processor_time"],
    ),
    (
        "session",
        &["render", "gpu", "world", "scene", "math", "files"],
    ),
    (
        "bench",
        &["render", "gpu", "world", "scene", "math", "files"],
    ),
    (
        "app",
        &[
            "session", "bench", "render", "gpu", "world", "scene", "math", "files", "memory",
        ],
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

/// The modules of `src`.
fn sources() -> imports::Crate {
    let src = root().join("src");
    let read = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("readable");
        (path, text)
    };
    let files = files_below(&src, &["rs"]);
    imports::Crate::new(&src, files.into_iter().map(read).collect())
}

/// A crate of these files, its circles.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let files = files
        .iter()
        .map(|(path, text)| (PathBuf::from(path), (*text).to_owned()));
    circles::circles(&imports::Crate::new(Path::new(""), files.collect()).edges())
}

#[test]
fn planted_circles_are_found() {
    let parent = ("a.rs", "mod b;\nmod c;\nuse b::X;\npub use c::Y;");
    for (circle, what) in [
        (
            [
                ("a/b.rs", "use super::c::Z;"),
                ("a/c.rs", "use super::b::{Q, X};"),
            ],
            "by super",
        ),
        (
            [
                ("a/b.rs", "use crate::a::{c::{self, Z}};"),
                ("a/c.rs", "fn f() { super::b::g() }"),
            ],
            "by list and code",
        ),
        (
            [("a/b.rs", "use super::Y;"), ("a/c.rs", "use super::X;")],
            "by what the parent passes on",
        ),
        (
            [
                ("a/b.rs", "use super::c::d::Z;"),
                ("a/c/d.rs", "use crate::a::b;"),
            ],
            "between folders",
        ),
    ] {
        let mut files = vec![parent, circle[0], circle[1]];
        if circle[1].0 == "a/c/d.rs" {
            files.push(("a/c.rs", "mod d;"));
        }
        let found = circles_of(&files);
        assert!(
            found.len() == 1 && found[0].starts_with("src/a: b, c"),
            "{what}: {found:?}"
        );
    }
    let none = [
        parent,
        ("a/b.rs", "use super::c::Z; // super::b"),
        (
            "a/c.rs",
            "use super::Own;\n#[cfg(test)]\nmod tests { use crate::a::b; }",
        ),
    ];
    assert!(circles_of(&none).is_empty());
}

#[test]
fn modules_have_no_circular_imports() {
    let found = circles::circles(&sources().edges());
    assert!(
        found.is_empty(),
        "{} circles\n{}",
        found.len(),
        found.join("\n")
    );
}

#[test]
fn imports_only_point_down() {
    let mut wrong = Vec::new();
    let is_layer = |name: &str| LAYERS.iter().any(|(layer, _)| *layer == name);
    for (from, to) in sources().edges() {
        let (Some(from), Some(to)) = (from.first(), to.first()) else {
            continue;
        };
        let known = LAYERS.iter().find(|(layer, _)| layer == from);
        let allowed = known.is_none_or(|(_, allowed)| from == to || allowed.contains(&to.as_str()));
        if !allowed {
            wrong.push(format!("{from} imports {to}"));
        }
    }
    for file in files_below(&root().join("src"), &["rs"]) {
        let below = file.strip_prefix(root().join("src")).expect("below src");
        let first = below.iter().next().expect("a name").to_string_lossy();
        let layer = first.trim_end_matches(".rs");
        if ["lib", "main"].contains(&layer) {
            continue;
        }
        if !is_layer(layer) {
            wrong.push(format!("{}: not in the list of layers", file.display()));
        }
        let text = fs::read_to_string(&file).expect("readable");
        for (package, only) in [
            ("wgpu", &["gpu", "render", "app"][..]),
            ("clap", &["bench", "app"]),
        ] {
            if text.contains(&format!("{package}::")) && !only.contains(&layer) {
                wrong.push(format!("{}: {layer} uses {package}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_are_short_and_state_what_they_own() {
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
