//! Hostile and runaway scripts: each is ended by a limit or refused with a message, and memory
//! stays bounded.

mod limits;
mod meshes;
mod parsing;
mod values;

use std::{fs, path::Path, time::Duration};

use reflet::scene::{
    script::{Bounds, Script},
    stages::{Animator, Scene},
};

const SCENE: &str = "
version = 1
timeline = { end = 9 }
material.paint = {}
model.ball = { shape = { kind = \"sphere\" }, material = \"paint\" }
light.lamp = { kind = \"point\", position = [0, 3, 0], intensity_cd = 10 }
camera.main = {}
[[instance]]
name = \"ball\"
model = \"ball\"
dynamic = true
[[instance]]
name = \"wall\"
model = \"ball\"
";

/// Body of `frame`, and text that the message must contain.
const FRAMES: &[(&str, &str)] = &[
    // Endless loops.
    ("loop {}", "was stopped"),
    ("while true { let x = 1; }", "was stopped"),
    ("let i = 0; do { i += 1; } while i >= 0;", "was stopped"),
    ("for i in 0..1000000000 { let x = i; }", "was stopped"),
    (
        "for i in 0..1000000 { for j in 0..1000000 { let x = j; } }",
        "was stopped",
    ),
    ("fn_loop(ctx)", "was stopped"),
    ("loop { try { loop {} } catch { } }", "was stopped"),
    ("let a = [1]; a.map(|x| { loop {} });", "was stopped"),
    ("let a = [3, 1, 2]; loop { a.sort(); }", "was stopped"),
    (
        "let s = 0; for i in range(0, 10000000000) { s += i % 7; }",
        "was stopped",
    ),
    ("let f = || { loop {} }; f.call();", "was stopped"),
    // Nesting that is too deep.
    ("down(ctx)", "more than 32 deep"),
    ("ping(ctx)", "more than 32 deep"),
    (
        "let f = |g, n| g.call(g, n + 1); f.call(f, 0);",
        "more than 32 deep",
    ),
    ("fib(ctx, 60)", "more than 32 deep"),
    // Values that are too large.
    ("let s = \"x\"; loop { s += s; }", "too large"),
    ("let a = [1]; loop { a += a; }", "too large"),
    ("let a = []; loop { a.push(a); }", "too large"),
    ("let a = []; loop { a.push([1, [2]]); }", "50,000 elements"),
    ("let a = [[], 1]; loop { a[0].push(1); }", "50,000 elements"),
    (
        "let a = []; loop { a.push(#{ b: #{ c: 1 } }); }",
        "too large",
    ),
    ("const A = []; A.push(1);", "constant"),
    ("let a = 5; a.push(1);", "no function `push`"),
    ("let a = []; a.pad(2000000000, 0);", "too large"),
    ("let s = \"\"; s.pad(2000000000, 'x');", "too large"),
    (
        "let m = #{}; for i in 0..1000000000 { m[`k${i}`] = i; }",
        "was stopped",
    ),
    ("let m = #{}; loop { m.a = m; }", "was stopped"),
    ("let a = [[0; 1]];", "syntax"),
    (
        "let a = []; loop { a.push(\"0123456789012345678901234567890123456789\"); }",
        "bytes",
    ),
    ("let a = []; a.pad(49000, 0); let b = [a, a];", "too large"),
    (
        "let s = \"\"; for i in 0..100000000 { s += \"more text\"; }",
        "too large",
    ),
    (
        "let b = []; for i in 0..100 { let c = b; c.push(c); b = [c, c, c]; }",
        "too large",
    ),
    ("loop { print(\"a lot of text\"); }", "was stopped"),
    // Much work or memory in one built-in function of Rhai.
    (
        "let s = \"x\"; s.pad(1000000, \"x\"); let t = s; s.replace(\"x\", t);",
        "too large",
    ),
    (
        "let s = \"x\"; s.pad(1000000, 'x'); let t = s; s.replace('x', t);",
        "too large",
    ),
    (
        "let s = \"x\"; s.pad(1000000, 'x'); let t = s; s.replace(\"\", t);",
        "too large",
    ),
    (
        "let s = \"x\"; s.pad(1000000, 'x'); s.replace('x', 'é');",
        "too large",
    ),
    ("let s = \"x\"; s.pad(10, \"\");", "must not be empty"),
    ("let s = \"x\"; s.pad(1000000, \"é\");", "too large"),
    (
        "let a = []; a.pad(49000, 1); loop { a.index_of(2); }",
        "more than 100,000 operations",
    ),
    // Calls through closures, in which Rhai restarts its counters.
    (
        "let a = []; a.pad(4000, 1); a.map(|x| { let b = []; b.pad(3000, 1); b.map(|y| y + 1).len() })",
        "was stopped",
    ),
    (
        "let a = []; a.pad(4000, 1); a.sort(|x, y| { a_lot().sort(|p, q| p - q); x - y });",
        "was stopped",
    ),
    (
        "let a = []; a.pad(40000, 1); a.map(|x| { let b = [1]; b.pad(40000, 1); b })",
        "script-limit",
    ),
    // Missing names.
    ("eval(\"loop {}\")", "eval"),
    ("sleep(1000)", "no function `sleep`"),
    ("timestamp()", "no function `timestamp`"),
    ("open(\"/etc/passwd\")", "no function `open`"),
    ("import \"other\" as o;", "imports must stand at the top"),
    ("undefined_variable", "no variable `undefined_variable`"),
    ("ctx.state", "no property `state`"),
    ("exit(7)", "no function `exit`"),
    // Invalid values.
    ("ctx.place(\"ball\", [0.0 / 0.0, 0, 0])", "finite"),
    ("ctx.place(\"ball\", [1.0 / 0.0, 0, 0])", "finite"),
    ("ctx.place(\"ball\", [1e300, 0, 0])", "finite"),
    (
        "ctx.place(\"ball\", [0, 0, 0], [0, 0, 0], 0)",
        "scale must not be 0",
    ),
    (
        "ctx.place(\"ball\", [0, 0, 0], [0, 0, 0], [1, 0, 1])",
        "scale must not be 0",
    ),
    (
        "ctx.place(\"ball\", mat4([0, 0, 0], [0, 0, 0], 1) * mat4([0, 0, 0], [0, 0, 0], 1e-30))",
        "flat",
    ),
    (
        "ctx.place(\"nobody\", [0, 0, 0])",
        "no instance is named \"nobody\"",
    ),
    ("ctx.place(\"wall\", [0, 0, 0])", "stands still"),
    ("ctx.place(1, 2)", "does not take"),
    (
        "ctx.material(\"paint\", #{ roughness: \"smooth\" })",
        "must be a number",
    ),
    ("ctx.light(\"lamp\", #{ intensity_cd: -1 })", "0 or more"),
    (
        "ctx.camera(\"main\", #{ eye: [0, 0, 0], target: [0, 0, 0] })",
        "same place",
    ),
    ("1 / 0", "division by zero"),
    ("9223372036854775807 + 1", "overflow"),
    ("[1, 2][5]", "5"),
    ("throw #{ a: 1 }", "a"),
];

const HELPERS: &str = "
fn fn_loop(ctx) { loop {} }
fn down(ctx) { down(ctx) }
fn ping(ctx) { pong(ctx) }
fn pong(ctx) { ping(ctx) }
fn a_lot() { let a = []; a.pad(4000, 1); a }
fn fib(ctx, n) { fib(ctx, n - 1) + fib(ctx, n - 2) }
";

fn desc() -> Scene {
    let read = Scene::from_text(SCENE, Path::new("scene.toml"), &[]);
    read.expect("the scene is right").0
}

/// Largest memory of this process so far, MiB.
#[cfg(target_os = "linux")]
fn peak_mib() -> u64 {
    let status = fs::read_to_string("/proc/self/status").expect("Linux has it");
    let line = status
        .lines()
        .find(|l| l.starts_with("VmHWM"))
        .expect("it has the peak");
    let kib = line.split_whitespace().nth(1).expect("a number");
    kib.parse::<u64>().expect("a number") / 1024
}

/// Runs a body; returns the deviation from the expected end. Bodies that only the limit of time or operations ends
/// get less of both, since they would not end by themselves.
fn run((body, says): &(&str, &str)) -> Option<String> {
    let text = format!("{HELPERS}\nfn frame(ctx) {{\n{body}\n}}");
    let end = || match Script::from_text("hostile.rhai", &text) {
        Err(error) => error.to_string(),
        Ok(script) => {
            let scene = Scene::new(desc().desc, script);
            match Animator::new(&scene).pose(3) {
                Err(errors) => errors[0].to_string(),
                Ok(_) => "nothing was wrong".to_owned(),
            }
        }
    };
    let bounds = match *says {
        "was stopped" => (Bounds::CALL.at_most(100_000)).within(Duration::from_millis(100)),
        says if says.contains("100,000 operations") => Bounds::CALL.at_most(100_000),
        // A body that fills memory or exceeds another limit gets the full bounds, to reach that limit.
        _ => Bounds::CALL,
    };
    let message = bounds.over(end);
    let told = message.to_lowercase().contains(&says.to_lowercase());
    let right = told && message.contains("hostile.rhai:");
    (!right).then(|| format!("{body} should say {says:?}:\n{message}"))
}

#[test]
fn every_hostile_frame_is_ended_with_a_message() {
    assert!(FRAMES.len() >= 50);
    let (some, others) = FRAMES.split_at(FRAMES.len() / 3);
    let wrong = std::thread::scope(|scope| {
        let other = scope.spawn(|| others.iter().filter_map(run).collect::<Vec<_>>());
        let mut wrong: Vec<_> = some.iter().filter_map(run).collect();
        wrong.extend(other.join().expect("no panic"));
        wrong
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n---\n"));
    #[cfg(target_os = "linux")]
    // Two at a time, each within 1,024 MiB when last checked; one step can double that.
    assert!(peak_mib() < 4608, "{} MiB", peak_mib());
}

fn folder(name: &str) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("script-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(folder.join("scene/parts")).expect("temporary folder");
    folder.join("scene")
}

fn load(folder: &Path, script: &str) -> Result<Scene, String> {
    fs::write(folder.join("s.rhai"), script).expect("temporary file");
    let text = SCENE.replacen("version = 1", "version = 1\nscript = \"s.rhai\"", 1);
    let read = Scene::from_text(&text, &folder.join("scene.toml"), &[]);
    read.map(|(desc, _)| desc).map_err(|errors| {
        let texts: Vec<_> = errors.iter().map(ToString::to_string).collect();
        texts.join("\n")
    })
}

#[test]
fn imports_stay_below_the_folder_of_the_scene() {
    let folder = folder("imports");
    fs::write(folder.join("parts/legs.rhai"), "fn twice(x) { x * 2 }").expect("temporary file");
    fs::write(folder.join("../out.rhai"), "fn f() { }").expect("temporary file");
    fs::write(
        folder.join("parts/loop.rhai"),
        "import \"parts/loop\" as l;",
    )
    .expect("file");
    fs::write(folder.join("parts/bad.rhai"), "fn f( {").expect("temporary file");
    let good = "import \"parts/legs\" as legs;\nfn frame(ctx) { ctx.place(\"ball\", [legs::twice(2), 0, 0]) }";
    let desc = load(&folder, good).expect("it is below");
    let state = Animator::new(&desc).pose(0).expect("it runs");
    assert_eq!(state.instances[0].translation.x, 4.0);
    assert_eq!(desc.script.as_ref().map(|s| s.files.len()), Some(2));
    for (import, says) in [
        ("../out", "not below the scene's folder"),
        ("/etc/passwd", "not below the scene's folder"),
        ("parts/../../out", "not below the scene's folder"),
        ("parts/none", "does not exist"),
        ("parts/loop", "imports itself"),
        ("parts/bad", "bad.rhai:1:"),
    ] {
        let script = format!("import \"{import}\" as m;\nfn frame(ctx) {{ }}");
        let error = load(&folder, &script).expect_err(import);
        assert!(error.contains(says), "{import}: {error}");
    }
    #[cfg(unix)]
    {
        let link = folder.join("parts/link.rhai");
        std::os::unix::fs::symlink(folder.join("../out.rhai"), link).expect("a link");
        let script = "import \"parts/link\" as m;\nfn frame(ctx) { }";
        let error = load(&folder, script).expect_err("it leads out");
        assert!(error.contains("outside the scene's folder"), "{error}");
    }
}

#[test]
fn what_setup_returns_is_checked_as_scene_text() {
    let folder = folder("setup");
    for (returned, says) in [
        ("5", "must return a map"),
        ("#{ lamps: #{} }", "cannot return `lamps`"),
        ("#{ lamps: #{} }", "it may return `cameras`, `materials`"),
        ("#{ light: #{} }", "did you mean `lights`?"),
        ("#{ lamps: #{} }", "s.rhai:2:4"),
        ("let r = #{}; r.lamps = 1; r", "s.rhai:2:16"),
        ("let r = #{}; r[\"la\" + \"mps\"] = 1; r", "s.rhai:1:1"),
        ("#{ instances: 5 }", "an array of maps"),
        (
            "#{ instances: [#{ model: \"bal\" }] }",
            "did you mean \"ball\"?",
        ),
        (
            "#{ instances: [#{ model: \"ball\", name: \"wall\" }] }",
            "two instances are named",
        ),
        ("#{ materials: #{ paint: #{} } }", "but not replace"),
        (
            "#{ materials: #{ gold: #{ roughnes: 1 } } }",
            "did you mean `roughness`?",
        ),
        (
            "#{ materials: #{ gold: #{ roughness: 0.0 / 0.0 } } }",
            "finite",
        ),
        (
            "#{ materials: #{ gold: #{ roughness: || 1 } } }",
            "not a valid value in a scene",
        ),
        (
            "#{\nmaterials: #{ gold: #{ roughness: || 1 } } }",
            "s.rhai:3:24",
        ),
        (
            "let a = 1; for i in 0..500 { a = [a]; } #{ materials: #{ gold: #{ roughness: a } } }",
            "nested more than 64 deep",
        ),
        (
            "let a = 1; for i in 0..500 { a = #{ a: a }; } #{ models: #{ m: a } }",
            "nested more than 64 deep",
        ),
        ("ctx.place(\"ball\", [0, 0, 0])", "only frame can pose it"),
    ] {
        let script = format!("fn setup(ctx) {{\n{returned}\n}}");
        let error = load(&folder, &script).expect_err(returned);
        assert!(error.contains(says), "{returned}: {error}");
    }
    let script = "fn setup(ctx) { #{
        materials: #{ gold: #{ base_color: vec3(1, 0.8, 0.2), metallic: 1 } },
        lights: #{ \"a b\": #{ kind: \"point\", position: [0, 1, 0], intensity_cd: 3 } },
        instances: [#{ model: \"ball\", material: \"gold\", rotation_quat: rotation_deg(0, 90, 0) }]
    } }";
    let desc = load(&folder, script).expect("it is right");
    assert_eq!(
        (
            desc.materials.len(),
            desc.lights.len(),
            desc.instances.len()
        ),
        (2, 2, 3)
    );
}

#[test]
fn script_without_functions_is_an_error() {
    let folder = folder("empty");
    for (script, says) in [
        ("", "neither `fn setup(ctx)` nor"),
        ("fn frame() { }", "`frame` has one parameter, `ctx`"),
        ("fn setup(ctx) { #{} }\nfn frame(ctx, t) { }", "s.rhai:2:1"),
        (
            "// fn Frame\nfn setup(ctx) { #{} }\nfn Frame(ctx) { }",
            "did you mean `frame`?",
        ),
        ("fn frame(ctx) { }\nfn setup() { }", "`setup` has one"),
        ("fn frame(ctx) {", "s.rhai:1:"),
        ("let x = y;\nfn frame(ctx) { }", "no variable `y`"),
    ] {
        let error = load(&folder, script).expect_err(script);
        assert!(error.contains(says), "{script}: {error}");
    }
}
