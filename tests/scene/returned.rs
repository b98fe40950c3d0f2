//! Errors in the result of `setup`: named by entry, and located in the script.

use reflet::world::load;

use crate::kit::*;

const SCENE: &str = "script = \"walk.rhai\"\nversion = 1\nparams = { speed = 1.5 }\n\
                     timeline = { end = 10 }\n";

/// All messages about a scene with this script.
fn messages(name: &str, script: &str) -> Vec<String> {
    let folder = kept_folder(&format!("returned-{name}"), &[("walk.rhai", script)]);
    let read = Scene::from_text(SCENE, &folder.join("scene.toml"), &[]);
    let errors = read.expect_err("it is wrong");
    errors.iter().map(|e| e.to_string()).collect()
}

/// Values that a script returns, with parts of the only message about each.
#[test]
fn wrong_values_are_named_and_placed() {
    let cases = cases(include_str!("returned/wrong_values.txt"));
    for (number, (script, says)) in cases.into_iter().enumerate() {
        let messages = messages(&format!("wrong-{number}"), script);
        let text = messages.join("\n");
        assert_eq!(messages.len(), 1, "{text}");
        assert_says(&text, &says.split(" | ").collect::<Vec<_>>());
        let is_hidden = !text.contains("| [material.");
        assert!(is_hidden, "the generated text shows:\n{text}");
    }
}

#[test]
fn many_mistakes_of_a_long_script_take_no_long_time() {
    let names: String = (0..500).map(|i| format!("// filler: {i}\n")).collect();
    let script = format!(
        "{names}fn part(a) {{ let l = []; for i in a..a + 250 {{ l.push(#{{ model: `m${{i}}` }}); }} l }}\n\
         fn setup(ctx) {{ let all = []; for i in 0..80 {{ all += part(250 * i); }} #{{ instances: all }} }}\n"
    );
    let messages = messages("many", &script);
    // Further messages are counted.
    assert_eq!(messages.len(), 2, "{}", messages.join("\n"));
    let first = [
        "(and 99 more like it)",
        "setup() returned instances[0].model = \"m0\"",
    ];
    assert_says(&messages[0], &first);
    assert_says(&messages[1], &["19900 more messages"]);
}

#[test]
fn parameters_cannot_be_set_by_a_script() {
    let folder = kept_folder("returned-params", &[]);
    let pose = |line: &str| {
        let script = format!("fn frame(ctx) {{\n    {line}\n}}\n");
        fs::write(folder.join("walk.rhai"), script).expect("written");
        let (desc, _) = Scene::from_text(SCENE, &folder.join("scene.toml"), &[]).expect("is right");
        Animator::new(&desc).pose(0)
    };
    for line in [
        "ctx.params.speed = 3.0;",
        "ctx.params.more = 1;",
        "ctx.params = #{};",
    ] {
        let errors = pose(line).expect_err(line);
        let error = errors[0].to_string();
        let says = error.contains("`ctx.params` is read-only") && error.contains("rhai:2:");
        assert!(says, "{line}: {error}");
    }
    for line in [
        "for name in ctx.params.keys() { print(name); }",
        "if !(\"speed\" in ctx.params) || ctx.params.len() != 1 { throw \"no\"; }",
        "let p = ctx.params; p.speed = 3.0;",
    ] {
        pose(line).unwrap_or_else(|errors| panic!("{line}: {}", errors[0]));
    }
}

#[test]
fn printed_lines_say_where_they_come_from() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("returned-print");
    fs::create_dir_all(folder.join("parts")).expect("temporary folder");
    fs::write(
        folder.join("parts/say.rhai"),
        "\nfn it(x) { print(x); x }\n",
    )
    .expect("written");
    let script = include_str!("returned/printed_lines_say_where_they_come_from.rhai");
    fs::write(folder.join("walk.rhai"), script).expect("written");
    let (desc, _) = Scene::from_text(SCENE, &folder.join("scene.toml"), &[]).expect("is right");
    let log = Animator::new(&desc).pose(4).expect("it runs").log;
    let lines: Vec<_> = (log.iter())
        .map(|line| {
            line.rsplit_once('/')
                .map_or(line.as_str(), |(_, line)| line)
        })
        .collect();
    let expected = [
        "walk.rhai:3: frame 4",
        "walk.rhai:4: 3",
        "walk.rhai:4: 2.5",
        "walk.rhai:4: true",
        "walk.rhai:4: c",
        "walk.rhai:4: ",
        "walk.rhai:5: [1, \"a\"]",
        "walk.rhai:5: #{\"a\": 1}",
        "walk.rhai:5: vec3(1, 2, 3)",
        "walk.rhai:6: \"a\"",
        "say.rhai:2: 7",
    ];
    assert_eq!(lines, expected);
}

/// Elements that a broken `setup` would have added are unknown: references to them are not reported.
#[test]
fn names_that_a_broken_script_would_add_are_not_reported() {
    const GOOD: &str = include_str!("returned/good.rhai");
    const SCENE: &str = include_str!("returned/scene.toml");
    let folder = kept_folder("returned-names", &[]);
    let read = |script: &str, set: &[&str]| {
        fs::write(folder.join("hop.rhai"), script).expect("the script can be written");
        let set: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
        Scene::from_text(SCENE, &folder.join("scene.toml"), &set)
    };
    let good = read(GOOD, &[]);
    assert!(good.is_ok(), "{good:?}");
    let deep = format!("{GOOD}fn f(n) {{ f(n + 1) }}\n").replace("let hop", "f(0); let hop");
    for (script, set, says) in [
        (GOOD.replace("let hop", "let let"), None, "script-syntax"),
        (
            GOOD.replace("let hop", "throw \"stop\"; let hop"),
            None,
            "stop",
        ),
        (deep, None, "hop.rhai"),
        (GOOD.replace("model:", "modle:"), None, "modle"),
        (GOOD.to_owned(), Some("params.height=nan"), "height"),
        (GOOD.to_owned(), Some("timeline.end=-1"), "end"),
    ] {
        let errors = read(&script, set.as_slice()).expect_err("it is wrong");
        let text: String = errors.iter().map(ToString::to_string).collect();
        assert!(text.contains(says), "no {says:?} in {text}");
        assert!(
            errors.iter().all(|e| e.name != "dangling-name"),
            "a false mistake in {text}"
        );
    }
    // References that need no script are still checked.
    let wrong = SCENE.replace("\"hop1\"", "\"hop2\"");
    fs::write(folder.join("hop.rhai"), GOOD).expect("the script can be written");
    let errors = Scene::from_text(&wrong, &folder.join("scene.toml"), &[]).expect_err("no hop2");
    assert_eq!(errors[0].name, "dangling-name");
}

#[test]
fn setup_gives_the_environment() {
    let script =
        "fn setup(ctx) {\n    #{ environment: #{ color: [0.1, 0.2, ctx.params.speed] } }\n}\n";
    let folder = kept_folder("returned-environment", &[("walk.rhai", script)]);
    let read = |scene: &str| Scene::from_text(scene, &folder.join("scene.toml"), &[]);
    let (scene, _) = read(SCENE).expect("valid");
    let zenith = scene.environment.zenith.to_array();
    assert_eq!(zenith, [0.1, 0.2, 1.5]);
    let errors = read(&format!("{SCENE}[environment]\nintensity = 2\n")).expect_err("two of them");
    let text = errors[0].to_string();
    let parts = [
        "the scene has an `[environment]` of its own",
        "walk.rhai:2:8",
    ];
    assert_says(&text, &parts);
}

/// A font whose letter A is composed of empty glyphs.
const NESTED: &[u8] = include_bytes!("../../src/world/shape/tests/nested_3_5.ttf");

/// Texts that a script measures stand as the shapes themselves do: aligned by their width, and put together of letters.
/// The letters of the font file have no width.
#[test]
fn scripts_measure_texts_as_shapes_have_them() {
    let files = [
        ("measure.rhai", &include_bytes!("returned/measure.rhai")[..]),
        ("scene.toml", b"version = 1\nscript = \"measure.rhai\"\n"),
        ("thin.ttf", NESTED),
    ];
    let folder = Folder::new();
    for (name, bytes) in files {
        folder.write(name, bytes);
    }
    let scene = Scene::from_file(&folder.path("scene.toml"), &[]);
    let (scene, _) = scene.unwrap_or_else(|errors| panic!("{}", errors[0]));
    let world = load::load(&scene, &load::LoadOptions::default()).expect("valid");
    let bounds = |of: &str| {
        let named = world.instances.iter().filter(|i| i.name.starts_with(of));
        let all = named.map(|i| {
            world.meshes[i.mesh]
                .bounds
                .transformed(&i.world_from_object)
        });
        all.reduce(|a, b| a.union(b)).expect(of)
    };
    let want = bounds("right");
    for of in ["moved", "letter"] {
        let found = bounds(of);
        let off = (found.min - want.min).abs() + (found.max - want.max).abs();
        assert!(off.max_element() < 1e-4, "{of}: {found:?}, not {want:?}");
    }
    assert!(
        scene
            .text_files()
            .iter()
            .any(|file| file.ends_with("thin.ttf"))
    );
}
