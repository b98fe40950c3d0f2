//! Trial additions of docs/extending.md: patches that apply to this tree, with the files and lines that the document
//! says they touch.

use std::{ffi::OsStr, fs, path::PathBuf, process::Command};

use super::{files_below, root};

/// The document that shows the patches, each in a block of text after a comment with its path.
const GUIDE: &str = "docs/extending.md";

fn patches() -> Vec<PathBuf> {
    files_below(&root().join("tests/extending"), &["patch"])
}

/// Output of `git apply` with an option, or its error messages.
fn git_apply(option: &str, patch: &OsStr) -> Result<String, String> {
    let mut git = Command::new("git");
    // A repository around this folder would change how `git apply` reads paths.
    if let Some(parent) = root().parent() {
        git.env("GIT_CEILING_DIRECTORIES", parent);
    }
    git.args(["apply", option]).arg(patch).current_dir(root());
    let run = git.output().map_err(|error| format!("git: {error}"))?;
    let text = |bytes| String::from_utf8_lossy(bytes).into_owned();
    match run.status.success() {
        true => Ok(text(&run.stdout)),
        false => Err(text(&run.stderr)),
    }
}

/// The guide with the block after `marker` replaced by `block`; `None` where it has no such block.
fn with_block(guide: &str, marker: &str, block: &str) -> Option<String> {
    let (before, rest) = guide.split_once(&format!("{marker}\n```text\n"))?;
    let (_, after) = rest.split_once("```\n")?;
    Some(format!("{before}{marker}\n```text\n{block}```\n{after}"))
}

#[test]
fn trial_additions_apply_and_touch_what_the_guide_says() {
    let path = root().join(GUIDE);
    let written = fs::read_to_string(&path).expect("readable");
    let mut guide = written.clone();
    let mut wrong = Vec::new();
    for patch in patches() {
        let name = patch
            .file_name()
            .expect("a name")
            .to_string_lossy()
            .into_owned();
        if let Err(error) = git_apply("--check", patch.as_os_str()) {
            wrong.push(format!("{name}: {error}"));
        }
        let stat = git_apply("--stat", patch.as_os_str()).unwrap_or_else(|error| panic!("{error}"));
        let marker = format!("<!-- tests/extending/{name} -->");
        match with_block(&guide, &marker, &stat) {
            Some(text) => guide = text,
            None => wrong.push(format!("{GUIDE} has no block of text after `{marker}`")),
        }
    }
    let shown = written.matches("<!-- tests/extending/").count();
    assert_eq!(
        shown,
        patches().len(),
        "{GUIDE} shows other patches than there are"
    );
    let refresh = "the code around a trial changed: run `tools/extending.sh --refresh`";
    assert!(wrong.is_empty(), "{}\n{refresh}", wrong.join("\n"));
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &guide).expect("the guide can be written");
        return;
    }
    let stale = "is stale: UPDATE_DOCS=1 cargo test --test layers";
    assert!(guide == written, "{GUIDE} {stale}");
}

#[test]
fn a_block_is_replaced_after_its_marker() {
    let guide = "a\n<!-- x -->\n```text\nold\n```\nb\n<!-- y -->\n```text\nkept\n```\n";
    let changed = guide.replace("old", "new");
    assert_eq!(with_block(guide, "<!-- x -->", "new\n"), Some(changed));
    assert_eq!(with_block(guide, "<!-- z -->", ""), None);
}
