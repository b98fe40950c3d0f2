//! Every scene in `tests/bad_scenes/` gives exactly the messages of its expectation file.
//!
//! A file that begins with `# --set …` is read with those overrides. `UPDATE_EXPECTED=1` rewrites
//! the expectations; read the difference before committing it.

use crate::kit::*;

/// The folder of bad scenes, above the folder of people's mistakes.
pub fn bad_scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes")
}

/// Files of a folder with any of these extensions, in the order of their names.
pub fn files_of(folder: &Path, extensions: &[&str]) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder)
        .expect("the folder exists")
        .map(|entry| entry.expect("it can be listed").path())
        .filter(|path| {
            let is_of = |extension: &&str| path.extension().is_some_and(|e| e == *extension);
            extensions.iter().any(is_of)
        })
        .collect();
    files.sort();
    files
}

/// Compares `got` with the expectation of a file, or writes it; returns the difference.
pub fn unexpected(file: &Path, got: &str) -> Option<String> {
    let expectation = file.with_extension("txt");
    if std::env::var_os("UPDATE_EXPECTED").is_some() {
        fs::write(&expectation, got).expect("the expectation can be written");
    }
    let name = file.display();
    match fs::read_to_string(&expectation) {
        Ok(want) if want == got => None,
        Ok(want) => Some(format!("{name}:\n{got}\n--- expected ---\n{want}")),
        Err(_) => Some(format!("{name} has no expectation; it gives\n{got}")),
    }
}

fn overrides(text: &str) -> Vec<String> {
    text.lines()
        .map_while(|line| line.strip_prefix("# --set "))
        .map(str::to_owned)
        .collect()
}

#[test]
fn each_bad_scene_gives_its_exact_messages() {
    let files = files_of(&bad_scenes(), &["toml"]);
    assert!(
        files.len() >= 45,
        "only {} bad scenes are there",
        files.len()
    );
    let mut wrong = Vec::new();
    for file in &files {
        let text = fs::read_to_string(file).expect("a bad scene is still text");
        let name = Path::new(file.file_name().expect("files have names"));
        let messages = match Scene::from_text(&text, name, &overrides(&text)) {
            Ok((_, warnings)) => warnings, // a few files show warnings
            Err(messages) => messages,
        };
        assert!(!messages.is_empty(), "{} is not bad at all", name.display());
        wrong.extend(unexpected(file, &render_all(&messages, false)));
    }
    assert_eq!(
        files_of(&bad_scenes(), &["txt"]).len(),
        files.len(),
        "an expectation has lost its scene"
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n======\n"));
}

#[test]
fn case_files_are_read_line_by_line() {
    let text = "// A comment.\n// Another one.\na\nb // c\n=> d\ne => f\n=> g\n";
    let expected = [("a\nb // c", "d"), ("e => f", "g")];
    assert_eq!(crate::common::cases(text), expected);
    let cut_off = std::panic::catch_unwind(|| crate::common::cases("a\n=> b\nc\n"));
    assert!(cut_off.is_err(), "a case without what follows");
}
