//! File lists of docs/extending.md: where real additions stand in the code, found by words that only they have.

use std::{ffi::OsStr, fs};

use super::{files_below, root};

/// The document that shows each list in a block of text after a comment with its words.
const GUIDE: &str = "docs/extending.md";

/// For each kind of addition, the words that one of that kind has to itself, in the order of the document.
const ADDITIONS: [&[&str]; 10] = [
    &["denoise_indirect"],                             // a pass
    &["EdgeOn", "edge_on", "CAUSE_EDGE_ON"],           // a cause
    &["clearcoat_roughness"],                          // a material number
    &["Rect | Disk", "LightKind::Disk", "LIGHT_DISK"], // a light kind
    &["Torus", "torus"],                               // a shape
    &["SsrBox", "ssr+box", "box_faces", "BoxHidden"],  // a method
    &["CacheArgs", "Command::Cache"],                  // a subcommand
    &["checkers", "HAS_CHECKERS"],                     // a shader feature
    &["threshold_u"],                                  // a reflection key
    &["rel_mse"],                                      // a metric
];

/// Whether a line of code has a word, which no letter, digit or underscore continues.
fn has_word(line: &str, word: &str) -> bool {
    let continues = |c: char| c.is_alphanumeric() || c == '_';
    !line.trim_start().starts_with("//")
        && line.match_indices(word).any(|(at, _)| {
            !line[..at].ends_with(continues) && !line[at + word.len()..].starts_with(continues)
        })
}

/// Whether a file's code has one of the words, outside of comments and of the tests at its end.
fn says(text: &str, words: &[&str]) -> bool {
    let code = text.split(")]\nmod tests {").next().unwrap_or_default();
    code.lines()
        .any(|line| words.iter().any(|word| has_word(line, word)))
}

/// Paths of the code that has one of the words, or whose name is one, a line each, and their number.
fn places(words: &[&str]) -> String {
    let folders =
        ["shaders", "src"].map(|folder| files_below(&root().join(folder), &["rs", "wgsl"]));
    let mut list = String::new();
    for file in folders.concat() {
        let path = file.strip_prefix(root()).expect("below the root");
        let stem = path.with_extension("");
        let mut parts = stem.iter().map(OsStr::to_string_lossy);
        if parts.any(|part| part == "tests" || part.ends_with("_tests")) {
            continue;
        }
        let is_named = words.iter().any(|word| stem.ends_with(word));
        if is_named || says(&fs::read_to_string(&file).expect("readable"), words) {
            list += &format!("{}\n", path.display());
        }
    }
    let count = list.lines().count();
    assert!(count > 0, "no file has {words:?}: name another addition");
    format!("{list}{count} files\n")
}

/// The guide with the block after `marker` replaced by `block`; `None` where it has no such block.
fn with_block(guide: &str, marker: &str, block: &str) -> Option<String> {
    let (before, rest) = guide.split_once(&format!("{marker}\n```text\n"))?;
    let (_, after) = rest.split_once("```\n")?;
    Some(format!("{before}{marker}\n```text\n{block}```\n{after}"))
}

#[test]
fn the_guide_lists_the_files_of_each_addition() {
    let path = root().join(GUIDE);
    let written = fs::read_to_string(&path).expect("readable");
    let mut guide = written.clone();
    for words in ADDITIONS {
        let marker = format!("<!-- files with {} -->", words.join(", "));
        guide = with_block(&guide, &marker, &places(words))
            .unwrap_or_else(|| panic!("{GUIDE} has no block of text after `{marker}`"));
    }
    assert_eq!(written.matches("<!-- files with ").count(), ADDITIONS.len());
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &guide).expect("the guide can be written");
        return;
    }
    let stale = "is stale: UPDATE_DOCS=1 cargo test --test layers";
    assert!(guide == written, "{GUIDE} {stale}");
}

#[test]
fn words_are_found_in_code_alone() {
    let code = "fn a() {\n    let b = Kind::Disk; // said\n}\n#[cfg(test)]\nmod tests {\n    use Torus;\n}\n";
    assert!(says(code, &["c", "Kind::Disk"]));
    for absent in ["Kind::Dis", "ind::Disk", "Torus"] {
        assert!(!says(code, &[absent]), "{absent}");
    }
    assert!(!says("    // Kind::Disk\n", &["Kind::Disk"]));
}

#[test]
fn a_block_is_replaced_after_its_marker() {
    let guide = "a\n<!-- x -->\n```text\nold\n```\nb\n<!-- y -->\n```text\nkept\n```\n";
    let changed = guide.replace("old", "new");
    assert_eq!(with_block(guide, "<!-- x -->", "new\n"), Some(changed));
    assert_eq!(with_block(guide, "<!-- z -->", ""), None);
}
