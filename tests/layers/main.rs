//! Source structure that crates cannot hold: modules without import cycles, module headers, named parameters, and
//! plain comments.

mod circles;
mod comments;
mod extending;
mod imports;
mod structure;

use std::{
    fs,
    path::{Path, PathBuf},
};

use comments::Syntax;

fn files_below(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files = Vec::new();
    for path in entries.map(|entry| entry.expect("entry").path()) {
        if path.is_dir() && !path.is_symlink() {
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

/// Folders of the workspace's crates below the root, with their modules; the program's own is `src`.
fn crates() -> Vec<(String, imports::Crate)> {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).expect("readable");
    let (_, members) = manifest.split_once("members = [").expect("a workspace");
    let (members, _) = members.split_once(']').expect("a list");
    let mut folders: Vec<&str> = members.split('"').skip(1).step_by(2).collect();
    folders.push("src");
    let is_of = |file: &Path, folder: &str| {
        let others = folders.iter().filter(|other| **other != folder);
        let mut inner = others.filter(|other| other.starts_with(folder));
        !inner.any(|other| file.starts_with(root().join(other)))
    };
    let modules = |folder: &str| {
        let files = files_below(&root().join(folder), &["rs"]).into_iter();
        let files = files.filter(|file| is_of(file, folder) && !file.ends_with("build.rs"));
        let read = files.map(|path| {
            let text = fs::read_to_string(&path).expect("readable");
            (path, text)
        });
        imports::Crate::new(&root().join(folder), read.collect())
    };
    let all = folders.iter();
    all.map(|folder| ((*folder).to_owned(), modules(folder)))
        .collect()
}

/// Import cycles of a crate of these files.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    let files = files
        .iter()
        .map(|(path, text)| (PathBuf::from(path), (*text).to_owned()));
    circles::circles(
        "src",
        &imports::Crate::new(Path::new(""), files.collect()).edges(),
    )
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
    let crates = crates();
    assert!(crates.len() > 5, "{} crates", crates.len());
    for (folder, modules) in crates {
        let edges = modules.edges();
        assert!(!edges.is_empty(), "{folder} has no imports");
        let found = circles::circles(&folder, &edges);
        assert!(
            found.is_empty(),
            "{} circles\n{}",
            found.len(),
            found.join("\n")
        );
    }
}

#[test]
fn files_state_what_they_own() {
    let mut wrong = Vec::new();
    let folders = [
        ("src", "rs", "//! "),
        ("tests", "rs", "//! "),
        ("shaders", "wgsl", "// "),
    ];
    for (folder, extension, opening) in folders {
        for file in files_below(&root().join(folder), &[extension]) {
            let text = fs::read_to_string(&file).expect("readable");
            if !text.starts_with(opening) {
                wrong.push(format!("{}: must open with `{opening}`", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn planted_tuples_of_unlike_things_are_found() {
    let text = "fn plain(a: f32, (x, y): (i32, i32), list: &[(u8, f32)]) {}\nimpl A {\n    pub fn \
                drawn<F: Fn(u8) -> u8>(\n        &self,\n        (name, size): &mut (&str, Vec<(u8, u8)>),\n    ) {\n    \
                }\n}\n// fn hidden(a: (u8, f32))\nconst T: &str = \"fn text(a: (u8, f32))\";\n";
    let found = structure::functions(text);
    let names: Vec<&str> = found.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(names, ["plain", "drawn"]);
    let tuples: Vec<usize> = found.iter().map(|f| f.unlike_tuples().count()).collect();
    assert_eq!(
        (tuples, found[1].line, found[1].num_lines),
        (vec![0, 1], 3, 5)
    );
    let types = "pub struct A {\n    b: B,\n}\n\npub struct B(u8);\n\npub enum C {\n    D,\n}\n";
    assert_eq!(structure::unrelated_types(types), ["A", "C"]);
}

/// A tuple of a name, a size and a flag as a parameter is a struct without names.
#[test]
fn parameters_of_several_kinds_have_a_struct() {
    let (mut found, mut functions) = (Vec::new(), 0);
    for file in files_below(&root().join("src"), &["rs"]) {
        let text = fs::read_to_string(&file).expect("readable");
        for function in structure::functions(&text) {
            functions += 1;
            let place = format!("{}:{} {}", file.display(), function.line, function.name);
            let tuples = function.unlike_tuples();
            found.extend(tuples.map(|tuple| format!("{place}: {tuple}")));
        }
    }
    assert!(functions > 5000, "{functions} functions");
    assert!(
        found.is_empty(),
        "{} parameters are tuples of unlike things; write plain parameters, or a struct for three and more:\n{}",
        found.len(),
        found.join("\n")
    );
}

/// Prints files and functions that a person should look at; nothing of it is a rule.
///
/// `cargo test --test layers report -- --ignored --nocapture` shows the list.
#[test]
#[ignore = "a report: it cannot fail"]
fn report_of_places_to_look_at() {
    for folder in ["src", "tests"] {
        for file in files_below(&root().join(folder), &["rs"]) {
            let text = fs::read_to_string(&file).expect("readable");
            let name = file.strip_prefix(root()).expect("below the root").display();
            let types = structure::unrelated_types(&text);
            if types.len() > 3 {
                println!(
                    "{name}: does it do one thing? unrelated types {}",
                    types.join(", ")
                );
            }
            for function in structure::functions(&text) {
                let (line, called) = (function.line, &function.name);
                let num_parameters = function.parameters.len();
                if num_parameters > 6 {
                    println!("{name}:{line}: {called} has {num_parameters} parameters");
                }
                if function.num_lines > 80 {
                    println!("{name}:{line}: {called} has {} lines", function.num_lines);
                }
            }
        }
    }
}

#[test]
fn planted_comment_fragments_are_found() {
    // The escape keeps this file's own check from finding the example of a comment behind code.
    let slashes = "/// Of a pixel.\nlet x = 1;\n//! As above.\n/// Which one\n/// Of these.\n///\
                   \n/// Those begin a paragraph.\nlet y = 2; \u{2f}/ What it is.\n// As it goes on.\
                   \nlet url = \"http://What\";\n// Whatever, Often and Asset are other words.\
                   \n/// # Errors\n/// As above.\n";
    let python = "# What it does.\n# As it goes on.\ndef f():\n    \"\"\"Of a film.\"\"\"\n\
                  def g():\n    \"\"\"\n    Those that are left.\n    \"\"\"\nx = 1  # Which one.\n\
                  y = \"# Of\"\n";
    for (text, syntax, expected) in [
        (slashes, Syntax::Slashes, &[1, 3, 4, 7, 8, 13][..]),
        (python, Syntax::Python, &[1, 4, 7, 9][..]),
    ] {
        let found = comments::fragments(text, syntax).into_iter();
        let lines: Vec<usize> = found.map(|(line, _)| line).collect();
        assert_eq!(lines, expected, "{text}");
    }
}

/// Findings in the comments of all files, each with its file and line.
fn in_comments(find: fn(&str, Syntax) -> Vec<(usize, String)>) -> Vec<String> {
    let mut all = Vec::new();
    for (folder, extension, syntax) in [
        ("src", "rs", Syntax::Slashes),
        ("tests", "rs", Syntax::Slashes),
        ("docs/examples", "rs", Syntax::Slashes),
        ("shaders", "wgsl", Syntax::Slashes),
        ("tools", "py", Syntax::Python),
        ("tests/tools", "py", Syntax::Python),
        ("src/python", "py", Syntax::Python),
    ] {
        let mut files = files_below(&root().join(folder), &[extension]);
        if folder == "src" {
            files.push(root().join("build.rs"));
        }
        for file in files {
            let name = file.strip_prefix(root()).expect("below the root");
            // Installed packages are not the project's.
            let is_installed = |part: &str| part == "node_modules" || part.starts_with('.');
            if !name
                .iter()
                .any(|part| is_installed(&part.to_string_lossy()))
            {
                let text = fs::read_to_string(&file).expect("readable");
                let place = |(line, words)| format!("{}:{line}: {words}", name.display());
                all.extend(find(&text, syntax).into_iter().map(place));
            }
        }
    }
    all
}

#[test]
fn comments_name_their_thing() {
    let wrong = in_comments(comments::fragments);
    assert!(
        wrong.is_empty(),
        "{} comments begin with Of, As, Those, Which or What; name the thing with a noun: \
         \"Offset of the sub-frame in pixels\", not \"Of a sub-frame\"; \"Material of the nearest \
         hit\", not \"What it hit\"; \"Same errors as\", not \"As\":\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn planted_pronouns_without_noun_are_found() {
    let slashes = "/// Texels of the map and\n/// those of its mips.\nlet x = 1;\
                   \n//! Times of a frame: what it drew.\n// Depth behind what is seen.\
                   \n// Keeps the one that is nearer, or the other one.\n/// One of them.\
                   \nlet y = 2; \u{2f}/ Like that of a film.\n/// Larger ones in front.\n///\
                   \n/// - Ray lists\n/// - those with hits\n/// These of the bench.\n";
    let python = "def f():\n    \"\"\"Name the files.\n\n    Skip those\n    that exist.\n    \"\"\"\n\
                  # Paths, and what they hold.\nx = 1  # Like that of a film.\n";
    let plain = "/// Says what to do, and knows what it drew; those, not `those of` code.\
                 \n// Larger ones first, one of each kind.\nlet text = \"those of\";\n";
    for (text, syntax, expected) in [
        (
            slashes,
            Syntax::Slashes,
            &[2, 4, 5, 6, 6, 7, 8, 9, 12, 13][..],
        ),
        (python, Syntax::Python, &[4, 7, 8]),
        (plain, Syntax::Slashes, &[]),
    ] {
        let found = comments::pronouns(text, syntax);
        let lines: Vec<usize> = found.iter().map(|(line, _)| *line).collect();
        assert_eq!(lines, expected, "{text}: {found:?}");
    }
}

#[test]
fn comments_have_nouns_instead_of_pronouns() {
    let found = in_comments(comments::pronouns);
    assert!(
        found.is_empty(),
        "{} pronouns stand in comments where a noun belongs; write \"shading normals of the capsule\", not \"those of \
         the capsule\"; \"visible surfaces\", not \"what the camera sees\":\n{}",
        found.len(),
        found.join("\n")
    );
}

/// Files with `unsafe`, as the map of the crate and the security policy count them.
#[test]
fn every_use_of_unsafe_is_listed() {
    const NUMBERS: [&str; 10] = [
        "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine",
    ];
    let read = |path: &Path| fs::read_to_string(path).expect("readable");
    let map = read(&root().join("src/lib.rs"));
    let policy = read(&root().join("SECURITY.md"));
    let start = map.find("`unsafe` is used in").expect("the map lists it");
    let end = map[start..].find("//! - ").expect("a rule follows");
    let rule = &map[start..start + end];
    let files = files_below(&root().join("src"), &["rs"]);
    let using = files
        .iter()
        .filter(|path| read(path).contains("unsafe_code,"));
    let using: Vec<_> = using
        .map(|path| {
            path.strip_prefix(root())
                .expect("below")
                .display()
                .to_string()
        })
        .collect();
    for path in &using {
        assert!(
            rule.contains(&format!("`{path}`")),
            "{path} is not in {rule}"
        );
    }
    assert_eq!(rule.matches("`src/").count(), using.len());
    let says = format!("`unsafe` is used in {} places", NUMBERS[using.len()]);
    assert!(rule.contains(&says) && policy.contains(&says), "{says}");
}

/// Files that the security policy names as the test of a limit exist and have tests.
#[test]
fn limits_of_the_security_policy_have_tests() {
    let policy = fs::read_to_string(root().join("SECURITY.md")).expect("readable");
    let words = policy.split('`').skip(1).step_by(2);
    let paths: Vec<_> = words
        .filter(|word| word.starts_with("tests/") || word.starts_with("src/"))
        .collect();
    assert!(paths.len() > 40, "{paths:?}");
    for path in paths {
        let path = root().join(path);
        assert!(path.exists(), "{} is not there", path.display());
        let is_rust = path.extension().is_some_and(|e| e == "rs");
        if is_rust && !path.ends_with("src/lib.rs") {
            let text = fs::read_to_string(&path).expect("readable");
            let tests = ["#[test]", "mod tests;"]
                .iter()
                .any(|word| text.contains(word));
            assert!(tests, "{} has no test", path.display());
        }
    }
}
