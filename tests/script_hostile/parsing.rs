//! Scripts that are slow to parse, and limits of messages and output.

use crate::common::assert_says;
use std::{fmt::Write as _, fs, time::Duration};

use reflet::scene::{
    script::{Bounds, Halt, Script},
    stages::Animator,
};

use super::{folder, load, wrong_ends};

/// Texts whose parsing time is quadratic in their length.
fn slow() -> Vec<(&'static str, String)> {
    let list = |n: usize, one: &dyn Fn(usize) -> String| (0..n).map(one).collect::<String>();
    vec![
        (
            "entries of a map",
            format!("let m = #{{{}}};", list(80_000, &|i| format!("k{i}:1,"))),
        ),
        (
            "parameters",
            format!("fn f({}) {{}}", list(100_000, &|i| format!("a{i},"))),
        ),
        ("let", list(50_000, &|i| format!("let a{i}=1;"))),
        (
            "cases",
            format!(
                "switch 1 {{ {} }}",
                list(60_000, &|i| format!("{i}..{}=>1,", i + 1))
            ),
        ),
        ("blocks", list(200_000, &|_| "{}".to_owned())),
        ("terms", format!("let x = {}1;", "1+".repeat(300_000))),
    ]
}

#[test]
fn reading_a_script_is_ended_by_the_limits_of_a_call() {
    let folder = folder("slow");
    let bounds = [
        Bounds::CALL.at_most(10_000),
        Bounds::CALL.within(Duration::from_millis(1)),
    ];
    for (what, text) in slow() {
        let script = format!("fn frame(ctx) {{ }}\n{text}\n");
        for bounds in bounds {
            let read = bounds.over(|| Script::from_text("slow.rhai", &script));
            let error = read.expect_err(what).to_string();
            // Rhai refuses this text itself, unless the time ends before.
            let is_refused = what == "terms" && error.contains("exceeds maximum complexity");
            let is_told = is_refused || error.contains("parsing of the script was stopped");
            assert!(is_told && error.contains("slow.rhai:"), "{what}: {error}");
        }
    }
    // An imported slow text: halted by the caller, and stopped by the time limit.
    let (_, entries) = slow().swap_remove(0);
    fs::write(folder.join("parts/slow.rhai"), &entries).expect("temporary file");
    let script = "import \"parts/slow\" as s;\nfn frame(ctx) { }";
    let halt = Halt::default();
    halt.halt();
    let error = halt.over(|| load(&folder, script)).expect_err("halted");
    assert!(error.contains("it was halted"), "{error}");
    assert!(error.contains("s.rhai:1:"), "{error}");
    let error = (bounds[0].over(|| load(&folder, script))).expect_err("it is long");
    assert!(error.contains("slow.rhai:1:"), "{error}");
    assert_says(&error, &["parsing of the script was stopped"]);
}

#[test]
fn literals_marks_and_directions() {
    let error = Script::from_text("a.rhai", "let x = 99999999999999999999;").expect_err("large");
    let error = error.to_string();
    assert!(error.contains("too large for an integer"), "{error}");
    assert!(error.contains("a.rhai:1:9"), "{error}");
    let least = "fn frame(ctx) { let x = -9223372036854775808; let y = 1e20; }";
    Script::from_text("a.rhai", least).expect("it is the least integer");

    let folder = folder("mark");
    let marked = "\u{feff}import \"parts/m\" as m;\nfn frame(ctx) { if m::f() != 7 { throw 1; } }";
    fs::write(folder.join("parts/m.rhai"), "\u{feff}fn f() { 7 }").expect("temporary file");
    let desc = load(&folder, marked).expect("the mark is accepted");
    Animator::new(&desc).pose(0).expect("it runs");
    let error = load(&folder, "\u{feff}let = 1;").expect_err("no name");
    assert!(error.contains("s.rhai:1:5"), "{error}");

    let turned = Script::from_text("a.rhai", "fn setup(ctx) { throw \"a\\u202e\\x00b\"; }");
    let error = turned.expect("it compiles").setup(&[], None);
    let error = error.expect_err("it throws").to_string();
    assert!(error.contains("a\u{fffd}\u{fffd}b"), "{error}");
    assert!(!error.contains(['\u{202e}', '\0']), "{error}");
}

/// Bodies of `frame`, and text that the message must contain.
const BODIES: &str = include_str!("parsing/bodies.txt");

#[test]
fn closures_fail_and_values_have_names() {
    let wrong = wrong_ends(BODIES);
    assert!(wrong.is_empty(), "{}", wrong.join("\n---\n"));
    for thrown in ["ctx", "0..3", "[ctx]", "#{ a: 0..=3 }"] {
        let script = format!("fn setup(ctx) {{ throw {thrown}; }}");
        let script = Script::from_text("a.rhai", &script).expect("it compiles");
        let error = script.setup(&[], None).expect_err(thrown).to_string();
        let message = error.lines().next().expect("one line");
        assert!(!message.contains("::"), "{message}");
    }
    let script = Script::from_text("a.rhai", "fn setup(ctx) { ctx }").expect("it compiles");
    let error = script.setup(&[], None).expect_err("no map").to_string();
    assert!(error.contains("not `ctx`"), "{error}");
    let long = "fn setup(ctx) { let s = \"\"; s.pad(500000, 'x'); throw s; }";
    let script = Script::from_text("a.rhai", long).expect("it compiles");
    let error = script.setup(&[], None).expect_err("it throws").to_string();
    assert!(error.len() < 2000, "{} bytes", error.len());
}

#[test]
fn lines_are_bounded_in_bytes_and_show_numbers() {
    let folder = folder("printed");
    let posed = |body: &str| {
        let desc = load(&folder, &format!("fn frame(ctx) {{\n{body}\n}}")).expect("it compiles");
        Animator::new(&desc).pose(0).expect("it runs").log
    };
    let log = posed("let s = \"\"; s.pad(500000, 'é'); for i in 0..50 { print(s); }");
    let bytes: usize = log.iter().map(String::len).sum();
    assert!(bytes < 70_000, "{bytes}");
    assert!(log.last().is_some_and(|l| l.contains("65,536 bytes")));
    let log = posed("for i in 0..2000 { print(i); }");
    assert_eq!(log.len(), 1001);
    let log = posed(
        "print(rotation_deg(0, 0, 0)); print(mat4([1, 2, 3], [0, 0, 0], 1)); print(ctx); \
         print([vec3(1, 2, 3), ctx]);",
    );
    let mut all = String::new();
    for line in &log {
        let _ = writeln!(all, "{line}");
    }
    for part in [
        "quat(0, 0, 0, 1)",
        "mat4(1, 0, 0, 1; 0, 1, 0, 2; 0, 0, 1, 3; 0, 0, 0, 1)",
        ": ctx",
        "[vec3(1, 2, 3), ctx]",
    ] {
        assert!(all.contains(part), "{all}");
    }
}

#[test]
fn each_file_is_one_module() {
    let folder = folder("once");
    fs::write(folder.join("parts/a.rhai"), "fn f() { 1 }").expect("temporary file");
    let mut names = vec!["parts/a", "./parts/a", "parts/./a.rhai"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(folder.join("parts"), folder.join("again")).expect("a link");
        names.push("again/a");
    }
    let mut script = String::new();
    for (i, name) in names.iter().enumerate() {
        let _ = writeln!(script, "import \"{name}\" as m{i};");
    }
    script += "fn frame(ctx) { m0::f() + m1::f() + m2::f() }";
    let desc = load(&folder, &script).expect("it compiles");
    Animator::new(&desc).pose(0).expect("frames know all names");
    assert_eq!(desc.script.as_ref().map(|s| s.files.len()), Some(2));
    let error = load(&folder, "import \"./s\" as s;\nfn frame(ctx) { }").expect_err("itself");
    assert!(error.contains("imports itself"), "{error}");
    // A module that is refused is no longer being loaded.
    let deep = "let a = []; for i in 0..1500 { a = [a]; }\nexport a;";
    fs::write(folder.join("parts/deep.rhai"), deep).expect("temporary file");
    let twice = "try { import \"parts/deep\" as d; } catch { }\nimport \"parts/deep\" as e;\n\
                 fn frame(ctx) { }";
    let error = load(&folder, twice).expect_err("it is too deep");
    assert!(error.contains("nested more than 64 deep"), "{error}");
}

#[test]
fn a_refused_import_is_an_error_whoever_catches_it() {
    let folder = folder("caught");
    let asks = "fn x() { }\ntry { import \"../../out\" as o; } catch { }";
    fs::write(folder.join("parts/asks.rhai"), asks).expect("temporary file");
    for (script, place) in [
        (
            "try {\n  import \"../out\" as o;\n} catch { }\nfn frame(ctx) { }",
            "s.rhai:2:",
        ),
        (
            "import \"parts/asks\" as a;\nfn frame(ctx) { }",
            "asks.rhai:2:",
        ),
        (
            "fn f() {\n  import \"parts/none\" as n;\n}\ntry { f(); } catch (e) { }\nfn frame(ctx) { }",
            "s.rhai:2:",
        ),
    ] {
        let error = load(&folder, script).expect_err(script);
        assert!(error.contains(place), "{script}:\n{error}");
    }
    let late = "fn frame(ctx) {\n  try { import \"parts/none\" as n; } catch { }\n}";
    let desc = load(&folder, late).expect("nothing runs yet");
    let error = Animator::new(&desc).pose(0).expect_err("it is refused")[0].to_string();
    assert_says(&error, &["s.rhai:2:", "at the top"]);
}
