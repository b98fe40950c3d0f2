//! The syntax tree of a text has every byte of it, and its nodes lie where their values are written.

use reflet::scene::{
    diagnostic::Source,
    syntax::{Content, Entries, Node, parse_value},
};

use crate::kit::*;

/// All files below a folder that are scene text.
fn texts(folder: &str) -> Vec<(PathBuf, String)> {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    let mut found = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("it can be listed") {
            let path = entry.expect("it can be listed").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "toml") {
                let text = fs::read_to_string(&path).expect("it is text");
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty());
    found
}

/// Asserts that the tokens follow each other without gaps, to the end of the text.
fn assert_whole(source: &Source) {
    let mut end = 0;
    for token in source.tokens() {
        assert_eq!(token.at.start, end, "{}: {token:?}", source.path.display());
        end = token.at.end;
        assert!(source.text.is_char_boundary(end));
    }
    assert_eq!(end, source.text.len(), "{}", source.path.display());
}

/// Asserts that the text at the place of each value is that value; returns the number of values.
fn assert_placed(source: &Source, entries: &Entries) -> usize {
    let all = entries.iter().map(|(key, node)| {
        let written = &source.text[key.span()];
        let name = written.trim_matches(['"', '\'']);
        assert!(name == key.get_ref() || written.contains('\\'), "{written}");
        assert_value_placed(source, node)
    });
    all.sum()
}

fn assert_value_placed(source: &Source, node: &Node) -> usize {
    let written = &source.text[node.span()];
    match node.get_ref() {
        Content::Table(entries) => assert_placed(source, entries),
        Content::Array(items) => items.iter().map(|i| assert_value_placed(source, i)).sum(),
        plain => {
            let again = parse_value(written).unwrap_or_else(|e| panic!("{written}: {e:?}"));
            assert_eq!(format!("{:?}", again.get_ref()), format!("{plain:?}"));
            1
        }
    }
}

#[test]
fn each_byte_of_a_text_is_in_a_token_and_each_value_at_its_place() {
    let mut values = 0;
    for (path, text) in texts("scenes").into_iter().chain(texts("tests/bad_scenes")) {
        let source = Source::new(path, text);
        assert_whole(&source);
        if let Ok(root) = source.syntax().correct() {
            values += assert_placed(&source, root);
        }
    }
    assert!(values > 1000, "only {values} values were found");
}

#[test]
fn a_broken_text_has_a_tree_of_what_is_right_in_it() {
    let text = "version = 1\n[camera.main]\neye =\n[light.sun]\nkind = \"point\"\n";
    let source = Source::new("a.toml", text);
    let lines = source.syntax().errors().iter();
    let lines: Vec<_> = lines.map(|e| source.place(e.at.start).line).collect();
    assert_eq!(lines, [3]);
    let sun = source.syntax().root().get("light").and_then(|lights| {
        let sun = lights.get_ref().as_table()?.get("sun")?;
        sun.get_ref().as_table()?.get("kind")?.get_ref().as_str()
    });
    assert_eq!(sun, Some("point"));
}

#[test]
fn no_mutation_of_a_text_loses_a_byte() {
    let texts = texts("scenes");
    let mut random = Random(11);
    let mut broken = 0;
    for _ in 0..400 {
        let (path, text) = &texts[random.below(texts.len())];
        let mut bytes = text.clone().into_bytes();
        bytes.truncate(4000);
        for _ in 0..1 + random.below(6) {
            let at = random.below(bytes.len());
            match random.below(3) {
                1 if bytes.len() == 1 => {}
                0 => bytes[at] = b"[]{}=\"'.,#\\\r\n\t0a"[random.below(16)],
                1 => drop(bytes.remove(at)),
                _ => bytes.truncate(at.max(1)),
            }
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let source = Source::new(path, text);
        assert_whole(&source);
        broken += usize::from(source.syntax().correct().is_err());
    }
    assert!(broken > 100, "only {broken} texts are broken");
    assert_whole(&Source::new("mark.toml", "\u{feff}version = 1\n"));
}
