//! Hostile and damaged scene text: depth, size, non-regular files, mutated bytes.

use reflet::scene::{manual::EXAMPLE, parse};

use crate::kit::*;

fn errors(text: &str) -> Vec<Diagnostic> {
    Scene::from_text(text, Path::new("scene.toml"), &[]).expect_err("the text is wrong")
}

#[test]
fn depth_neither_overflows_the_stack_nor_hangs() {
    let deep = 100_000;
    for text in [
        format!("version = 1\na = {}", "[".repeat(deep)),
        format!("version = 1\na = {}{}", "[".repeat(deep), "]".repeat(deep)),
        format!("version = 1\na = {}", "{a=".repeat(deep)),
        format!("version = 1\n{}a = 1", "a.".repeat(deep)),
        format!("version = 1\n[{}a]", "a.".repeat(deep)),
    ] {
        let names: Vec<_> = errors(&text).iter().map(|e| e.name).collect();
        assert!(names.contains(&"too-deep"), "{names:?}");
    }
}

#[test]
fn size_neither_floods_nor_takes_quadratic_time() {
    let many = 20_000;
    let all = errors(&format!(
        "version = 1\n[camera.main]\neye = [{}]",
        "0,".repeat(many)
    ));
    assert_eq!(
        all[0].message,
        "`eye` must be three numbers, not an array of 20000 values"
    );
    let keys: String = (0..many).map(|i| format!("k{i} = 1\n")).collect();
    assert_eq!(errors(&keys).len(), 101);
    assert_eq!(errors(&"[[[]]\n".repeat(many)).len(), 101);
    let instances = "[[instance]]\nmodel = \"b\"\n".repeat(many / 10);
    assert_eq!(errors(&format!("version = 1\n{instances}")).len(), 101);
    let rendered: String = errors(&"a".repeat(1 << 20))
        .iter()
        .map(Diagnostic::to_string)
        .collect();
    assert!(rendered.len() < 2000);
    let escapes = format!("version = 1\na = \"{}\"", r"\q".repeat(many * 5));
    assert_eq!(errors(&escapes).len(), 1);
    let models: String = (0..many / 10)
        .map(|i| format!("[model.m{i}]\nfile = \"f\"\n"))
        .collect();
    assert_eq!(
        errors(&format!("version = 1\n{models}{instances}")).len(),
        101
    );
    let wide = |name: &str, key: char| {
        let keys = (0..many / 4).map(|i| format!("{key}{i} = 1\n"));
        format!("[material.{name}]\n{}", keys.collect::<String>())
    };
    let heir = format!("{}{}extends = \"a\"\n", wide("a", 'j'), wide("b", 'k'));
    assert_eq!(errors(&format!("version = 1\n{heir}")).len(), 101);
}

#[test]
fn invalid_scene_files_state_the_reason() {
    let folder = std::env::temp_dir().join(format!("reflet-scene-text-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a temporary file");
        path
    };
    let said = |path: &Path| {
        let errors = Scene::from_file(path, &[]).expect_err("it is no scene");
        assert_eq!(errors.len(), 1);
        (
            errors[0].name,
            errors[0]
                .to_string()
                .replace(&folder.display().to_string(), "…"),
        )
    };
    let (name, text) = said(&folder.join("absent.toml"));
    assert_eq!(name, "unreadable-file");
    assert_eq!(
        text,
        "error[unreadable-file]: the scene file does not exist\n--> …/absent.toml\n \
         = help: check the path; it starts from the folder you are in"
    );
    assert!(said(&folder).1.contains("a folder was given"));
    let large = write("large.toml", &vec![b' '; parse::MOST_BYTES as usize + 1]);
    assert_eq!(said(&large).0, "file-too-large");
    let mut just_fits = vec![b' '; parse::MOST_BYTES as usize];
    just_fits[..12].copy_from_slice(b"version = 1\n");
    assert!(Scene::from_file(&write("fits.toml", &just_fits), &[]).is_ok());
    let (name, text) = said(&write("latin1.toml", b"version = 1\n# caf\xe9\n"));
    assert_eq!(name, "not-utf8");
    let marked = "latin1.toml:2:6\n  |\n2 | # caf\u{FFFD}\n  |      ^\n";
    assert!(text.contains(marked), "{text}");
    let good = write("good.toml", b"version = 1\n");
    assert_eq!(
        Scene::from_file(&good, &[]).map(|(scene, _)| scene.desc.folder),
        Ok(folder.clone())
    );
    std::fs::remove_dir_all(&folder).expect("it was made here");
}

/// Errors of scripts that are not UTF-8 are located in the script, also in an imported one; the reference to it,
/// in the scene or an import, is reported as well.
#[test]
fn scripts_that_are_not_utf8_are_placed_in_their_file() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("scene-latin1");
    std::fs::create_dir_all(folder.join("parts")).expect("temporary folder");
    let write = |name: &str, bytes: &[u8]| std::fs::write(folder.join(name), bytes).expect("file");
    write("scene.toml", b"version = 1\nscript = \"s.rhai\"\n");
    let said = || {
        let errors =
            Scene::from_file(&folder.join("scene.toml"), &[]).expect_err("it is not UTF-8");
        assert_eq!(errors.len(), 1, "{errors:?}");
        errors[0].to_string()
    };
    write(
        "s.rhai",
        b"// good\n// \xe9t\xe9 caf\xe9\nfn frame(ctx) { }\n",
    );
    let text = said();
    for says in [
        "error[not-utf8]: a script must be UTF-8 text, and this byte is not",
        "s.rhai:2:4\n",
        "2 | // \u{FFFD}t\u{FFFD} caf\u{FFFD}\n  |    ^\n",
        "scene.toml:2:10",
        "the file is named here",
        "save the file as UTF-8",
    ] {
        assert!(text.contains(says), "no {says:?} in\n{text}");
    }
    write(
        "s.rhai",
        b"import \"parts/legs\" as legs;\nfn frame(ctx) { }\n",
    );
    write("parts/legs.rhai", b"fn f() { }\nlet s = \"\xff\";\n");
    let text = said();
    for says in [
        "a script must be UTF-8 text, and this byte is not",
        "legs.rhai:2:10\n",
        "s.rhai:1:",
        "an import is called here",
    ] {
        assert!(text.contains(says), "no {says:?} in\n{text}");
    }
}

/// A hundred messages are shown; one more is counted, even if it is the only one.
#[test]
fn the_first_message_that_is_left_out_is_counted() {
    let mistakes = |n: usize| -> String { (0..n).map(|i| format!("wrong{i} = 1\n")).collect() };
    let errors = |n: usize| {
        let text = format!("{}version = 1\n", mistakes(n));
        Scene::from_text(&text, Path::new("scene.toml"), &[]).expect_err("it is full of mistakes")
    };
    assert!(errors(100).iter().all(|e| e.name != "too-many-errors"));
    let last = errors(101).pop().expect("a message");
    assert_eq!(last.name, "too-many-errors");
    assert_eq!(last.message, "1 more message is not shown");
    let broken = |n: usize| format!("version = 1\n{}", "a = \n".repeat(n));
    let text = broken(130);
    let errors = Scene::from_text(&text, Path::new("scene.toml"), &[]).expect_err("no value");
    let last = errors.last().expect("a message");
    assert_eq!(
        (errors.len(), last.message.as_str()),
        (101, "30 more messages are not shown")
    );
}

#[test]
fn a_carriage_return_alone_is_named() {
    for text in [
        "version = 1\ra = 2\n",
        "version = 1\n[params]\nx = 'a\rb'\n",
    ] {
        let errors = errors(text);
        assert_says(&errors[0].message, &["carriage return alone"]);
    }
    for text in ["version = 1\r\n\r\n# a\r\n", "\u{feff}version = 1\r\n"] {
        assert!(Scene::from_text(text, Path::new("scene.toml"), &[]).is_ok());
    }
}

/// Most letters of the key differ, but a long prefix suggests the intended one.
#[test]
fn overlong_key_is_suggested_by_its_prefix() {
    let text = "version = 1\n[[instance]]\nmodel = \"a\"\ntranslation_in_meters = [0, 0, 0]\n";
    let errors = Scene::from_text(text, Path::new("scene.toml"), &[]).expect_err("a wrong key");
    let text: String = errors.iter().map(ToString::to_string).collect();
    assert!(text.contains("did you mean `translation`?"), "{text}");
}

/// Scripts do not run on incomplete parameters.
#[test]
fn a_script_waits_until_its_parameters_can_be_read() {
    let folder = std::env::temp_dir().join(format!("reflet-script-waits-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let script = "fn setup(ctx) { throw \"it ran\" }";
    std::fs::write(folder.join("s.rhai"), script).expect("a temporary file");
    let of = |tables: &str| {
        let text = format!("version = 1\nscript = \"s.rhai\"\n{tables}");
        let file = folder.join("scene.toml");
        std::fs::write(&file, text).expect("a temporary file");
        let errors = Scene::from_file(&file, &[]).expect_err("it cannot be read");
        let texts: Vec<String> = errors.iter().map(ToString::to_string).collect();
        (texts.len(), texts.join("\n"))
    };
    let (count, text) = of("[params]\nside = 3\n");
    assert!(count == 1 && text.contains("it ran"), "{text}");
    for tables in [
        "[params]\nside = { wide = 3 }\n",
        "[timeline]\nend = \"never\"\n",
    ] {
        let (count, text) = of(tables);
        assert!(count == 1 && !text.contains("it ran"), "{text}");
    }
    std::fs::remove_dir_all(&folder).expect("it was made here");
}

#[test]
fn mutated_scenes_are_read_or_refused_and_never_panic() {
    const BYTES: &[u8] = b"[]{}=.,\"'#\n\t -_0129aeinv\\\x00\xc3\xa9\xff";
    let mut random = Random(0x5eed_0001);
    let (mut good, mut bad) = (0, 0);
    for round in 0..700 {
        let mut bytes = EXAMPLE.as_bytes().to_vec();
        for _ in 0..1 + round % 4 {
            let at = random.below(bytes.len());
            let byte = BYTES[random.below(BYTES.len())];
            match random.below(4) {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 => drop(bytes.remove(at)),
                _ => bytes.rotate_left(at % 7), // moves a piece from the front to the end
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        match Scene::from_text(&text, Path::new("mutated.toml"), &[]) {
            Ok(_) => good += 1,
            Err(errors) => {
                assert!(!errors.is_empty());
                let _ = errors
                    .iter()
                    .map(|e| (e.render(true), e.span.in_words()))
                    .collect::<Vec<_>>();
                bad += 1;
            }
        }
    }
    assert!(
        good > 50 && bad > 50,
        "{good} read, {bad} refused: the mutations test nothing"
    );
}
