//! Tests of shader assembly.

use super::*;

#[test]
fn imports_are_included_once_and_lines_map_back() {
    let library = ShaderLibrary::from_texts(&[
        (
            "pass.wgsl",
            "// pass\n#import b // shared\n#import a\nfn main() {}\n",
        ),
        ("lib/a.wgsl", "const A = 1;\n"),
        ("lib/b.wgsl", "#import a\nconst B = A;\n"),
    ]);
    let source = library.source("pass").expect("assembles");
    assert_eq!(
        &*source.text,
        "// pass\nconst A = 1;\nconst B = A;\nfn main() {}\n"
    );
    for (word, file, line) in [
        ("A = 1", "shaders/lib/a.wgsl", 1),
        ("B =", "shaders/lib/b.wgsl", 2),
        ("main", "shaders/pass.wgsl", 4),
    ] {
        let start = source.text.find(word).expect("present");
        let place = source.locate(start..start + 1).expect("inside");
        assert_eq!((&*place.file, place.line), (file, line), "{word}");
    }
}

#[test]
fn import_errors_state_place_and_reason() {
    let library = ShaderLibrary::from_texts(&[
        ("cycle.wgsl", "#import a\n"),
        ("missing.wgsl", "\n#import ssr\n"),
        ("path.wgsl", "#import ../secret\n"),
        ("ssr.wgsl", ""),
        ("lib/a.wgsl", "#import b\n"),
        ("lib/b.wgsl", "#import a\n"),
    ]);
    let says = |name: &str| library.source(name).expect_err("refused").to_string();
    assert_eq!(
        says("cycle"),
        "shaders/lib/b.wgsl:1: import cycle: lib/a.wgsl -> lib/b.wgsl -> lib/a.wgsl\n1 | #import a"
    );
    assert_eq!(
        says("missing"),
        "shaders/missing.wgsl:2: no lib/ssr.wgsl; lib/ has: a, b\n2 | #import ssr"
    );
    assert!(says("path").contains("expected `#import NAME`"));
    assert_eq!(says("nowhere"), "shaders/nowhere.wgsl: no such shader");
}

#[test]
fn a_folder_without_shaders_is_refused() {
    let temporary = tempfile::tempdir().expect("a folder");
    let dir = temporary.path().join("shaders");
    let error = ShaderLibrary::from_dir(&dir).expect_err("missing");
    assert!(error.to_string().contains("cannot read"));
    fs::create_dir_all(&dir).expect("temporary folder");
    let error = ShaderLibrary::from_dir(&dir).expect_err("empty");
    assert!(error.to_string().contains("no .wgsl files"));
    fs::write(dir.join("x.wgsl"), "const X = 1;").expect("temporary file");
    let library = ShaderLibrary::from_dir(&dir).expect("one shader");
    assert_eq!(library.names().collect::<Vec<_>>(), ["x"]);
    assert!(!library.source("x").expect("assembles").embedded);
    let (lib, room) = (dir.join("lib"), dir.join("methods/a/lib"));
    for folder in [&lib, &room] {
        fs::create_dir_all(folder).expect("temporary folder");
    }
    fs::write(room.join("x.wgsl"), "const Y = 1;").expect("temporary file");
    let library = ShaderLibrary::from_dir(&dir).expect("a method's library");
    assert_eq!(library.lib_names().collect::<Vec<_>>(), ["x"]);
    let y = library.lib_source("x").expect("assembles");
    assert!(y.text.contains('Y') && y.file.ends_with("methods/a/lib/x.wgsl"));
    fs::write(lib.join("x.wgsl"), "").expect("temporary file");
    let error = ShaderLibrary::from_dir(&dir).expect_err("two of one name");
    assert!(error.to_string().contains("has the name of"), "{error}");
}
