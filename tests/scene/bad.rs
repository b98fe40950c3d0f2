//! Every scene in `tests/bad_scenes/` gives exactly the messages of its expectation file.
//!
//! A file that begins with `# --set …` is read with those overrides. `UPDATE_EXPECTED=1` rewrites
//! the expectations; read the difference before committing it.

use std::{fs, path::Path};

use reflet::scene::{diagnostic::render_all, stages::Scene};

fn overrides(text: &str) -> Vec<String> {
    text.lines()
        .map_while(|line| line.strip_prefix("# --set "))
        .map(str::to_owned)
        .collect()
}

#[test]
fn each_bad_scene_gives_its_exact_messages() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_scenes");
    let update = std::env::var_os("UPDATE_EXPECTED").is_some();
    let mut files: Vec<_> = fs::read_dir(&folder)
        .expect("the folder exists")
        .map(|entry| entry.expect("it can be listed").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
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
        let got = render_all(&messages, false);
        let expectation = file.with_extension("txt");
        if update {
            fs::write(&expectation, &got).expect("the expectation can be written");
        }
        match fs::read_to_string(&expectation) {
            Ok(want) if want == got => {}
            Ok(want) => wrong.push(format!(
                "{}:\n{got}\n--- expected ---\n{want}",
                name.display()
            )),
            Err(_) => wrong.push(format!(
                "{} has no expectation; it gives\n{got}",
                name.display()
            )),
        }
    }
    let expectations = fs::read_dir(&folder).expect("the folder exists").count() - files.len();
    assert_eq!(
        expectations,
        files.len(),
        "an expectation has lost its scene"
    );
    assert!(wrong.is_empty(), "{}", wrong.join("\n======\n"));
}
