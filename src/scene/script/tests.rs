//! Tests of scripts: every example of the reference, purity and speed of calls, errors.

use std::{
    hash::{DefaultHasher, Hash as _},
    path::Path,
    sync::mpsc,
    thread,
    time::Duration,
};

use glam::Vec3;
use rhai::{Dynamic, Map};

use super::{
    Halt, Script, api,
    bounds::Bounds,
    call_limits::run_limited,
    limits::{ARRAY, MAP},
};
use crate::{
    desc::SceneDesc,
    motion::FrameState,
    stages::{Animator, Scene},
};

const SCENE: &str = include_str!("tests/scene.toml");

fn scene() -> SceneDesc {
    let read = Scene::from_text(SCENE, Path::new("scene.toml"), &[]);
    read.expect("the scene is right").0.desc
}

fn frame(script: &str) -> Result<FrameState, String> {
    let script = Script::from_text("test.rhai", script).map_err(|e| e.to_string())?;
    let scene = Scene::new(scene(), script);
    Animator::new(&scene).pose(12).map_err(|e| e[0].to_string())
}

#[test]
fn every_example_of_the_reference_evaluates_as_documented() {
    for entry in api::API.iter().flat_map(|group| &group.entries) {
        let example = entry.example.as_str();
        let (statements, last) = example.rsplit_once("; ").unwrap_or(("", example));
        let script =
            format!("fn frame(ctx) {{ {statements};\nif !({last}) {{ throw \"false\"; }} }}");
        if let Err(error) = frame(&script) {
            panic!("{example}: {error}");
        }
    }
}

#[test]
fn every_registered_name_is_in_the_reference() {
    let sources = [
        include_str!("api/floats.rs"),
        include_str!("api/math.rs"),
        include_str!("api/random.rs"),
        include_str!("api/scene.rs"),
        include_str!("api/text.rs"),
    ];
    let calls = sources
        .iter()
        .flat_map(|text| text.split(".register_").skip(1));
    let named = calls.filter_map(|call| {
        call.split_once('(')?
            .1
            .trim_start()
            .strip_prefix('"')?
            .split('"')
            .next()
    });
    let is_word = |name: &&str| name.chars().all(|c| c.is_alphanumeric() || c == '_');
    let names: Vec<_> = named.filter(is_word).collect();
    assert!(names.len() > 60, "{names:?}");
    let known = api::names();
    let missing: Vec<_> = names.iter().filter(|name| !known.contains(name)).collect();
    assert!(missing.is_empty(), "not in api/reference.toml: {missing:?}");
}

#[test]
fn the_example_of_the_introduction_runs() {
    let manual = api::manual();
    let script = manual.split("```rust\n").nth(1).expect("an example");
    let script = script.split("```").next().expect("its end");
    let script = Script::from_text("hop.rhai", script).expect("it compiles");
    let desc = scene();
    let (text, _) = script
        .setup(&desc.params, desc.timeline.as_ref())
        .expect("it runs");
    let text = text.expect("it returns a map");
    assert_eq!(text.matches("[[instance]]").count(), 31);
    let all = format!("{SCENE}{text}");
    let (read, _) = Scene::from_text(&all, Path::new("scene.toml"), &[]).expect("it is a scene");
    let scene = Scene::new(read.desc, script);
    let moved = Animator::new(&scene).pose(12).expect("it moves").instances;
    assert_ne!(moved[3], moved[4]);
}

#[test]
fn calls_share_no_state() {
    let script = "
        const HEIGHT = 2;
        fn frame(ctx) {
            let p = ctx.params;
            p.count += 1;
            ctx.place(\"ball\", ctx.position(\"ball\") + vec3(0, global::HEIGHT + p.count, 0));
        }";
    let script = Script::from_text("s.rhai", script).expect("it compiles");
    let scene = Scene::new(scene(), script);
    let motion = Animator::new(&scene);
    let first = motion.pose(3).expect("it runs");
    let _ = motion.pose(9);
    let again = motion.pose(3).expect("it runs");
    assert_eq!(first, again);
    assert_eq!(again.instances[0].translation.y, 1.0 + 2.0 + 32.0);
}

/// A beam with a hard edge at 60° has a solid angle of π, whatever key comes first.
#[test]
fn a_flux_fills_the_new_angles_of_its_beam() {
    let set = "ctx.light(\"beam\", #{ flux_lm: 314.159265, inner_deg: 60, outer_deg: 60 });";
    let lights = frame(&format!("fn frame(ctx) {{ {set} }}"))
        .expect("it is set")
        .lights;
    let [_, beam] = &lights[..] else {
        panic!("{lights:?}")
    };
    assert!(
        (beam.kind.intensity() - 100.0).abs() < 0.2,
        "{:?}",
        beam.kind
    );
}

/// Text before and behind a statement that is tried: the caught error has a message and a place, which are thrown.
const CAUGHT: &str = "fn deep() { [1, 2][5] }\nfn frame(ctx) {\n        try { ";
const CATCH: &str = "catch (e) {
if e.keys() != [\"column\", \"line\", \"message\"] { throw `has ${e.keys()}`; }
throw `${e.line}:${e.column}: ${e.message}`; } }";

/// Lines of `refused.txt`: the place of the error, the statement in `frame` that makes it, behind `!` the whole script, or
/// behind `?` a statement whose error is caught; and parts of the message, with ` … ` between them. A place that ends with a colon is any column.
#[test]
fn errors_have_place_and_suggestion() {
    for case in include_str!("tests/refused.txt").lines() {
        let (place, rest) = case.split_once(' ').expect("a place");
        let (body, says) = rest.split_once(" => ").expect("a message");
        let body = body.replace("\\n", "\n");
        let script = match body.split_at(1) {
            ("!", whole) => whole.to_owned(),
            ("?", tried) => format!("{CAUGHT}{tried} }} {CATCH}"),
            _ => format!(
                "fn frame(ctx) {{\n  {body};\n}}\nfn same(key) {{ let m = #{{}}; m[key] = 1; m }}"
            ),
        };
        let error = frame(&script).expect_err(case);
        let end = if place.ends_with(':') { "" } else { "\n" };
        let is_there = error.contains(&format!("test.rhai:{place}{end}"));
        let is_said = says.split(" … ").all(|part| error.contains(part));
        assert!(is_there && is_said, "{case}:\n{error}");
    }
}

/// Rhai's recursive functions of a value (clone, hash, size, format, drop) on the stack of a call.
#[test]
fn the_stack_of_a_call_holds_the_deepest_values() {
    let ran = run_limited(Bounds::CALL, || {
        let mut value = Dynamic::from(1_i64);
        for _ in 0..MAP {
            value = Map::from([("a".into(), value)]).into();
        }
        for _ in 0..ARRAY {
            value = vec![value].into();
        }
        let copy = value.clone();
        copy.hash(&mut DefaultHasher::new());
        let sizes = rhai::Engine::new_raw().ensure_data_size_within_limits(&copy);
        drop(copy);
        sizes.map(|()| format!("{value:?}").len())
    });
    assert!(ran.result.expect("it has no limits") > MAP + ARRAY);
}

#[test]
fn calls_have_a_maximum_of_arguments_and_blocks_of_variables() {
    let call = |count: usize| format!("f({})", vec!["[1, 2]"; count].join(", "));
    let block = |count: usize| "let a = 1; ".repeat(count);
    let said = |body: String| {
        let text = format!("fn setup(ctx) {{\n  {body}\n}}");
        let read = Script::from_text("long.rhai", &text);
        read.map_or_else(|wrong| wrong.to_string(), |_| String::new())
    };
    assert_eq!([said(call(64)), said(block(64))], ["", ""]);
    for (error, what) in [
        (said(call(65)), "more than 64 arguments"),
        (said(block(65)), "more than 64 variables"),
    ] {
        assert!(
            error.contains(what) && error.contains("long.rhai:2:"),
            "{error}"
        );
    }
}

#[test]
fn a_halted_call_ends_before_any_limit_and_so_does_what_begins_under_it() {
    // Each operation reads a long text, so the limit of operations is not met.
    let slow = "let text = \"abcdefgh\";
        for i in 0..12 { text += text; }
        loop { text.contains(\"no\"); }";
    for script in [
        format!("fn frame(ctx) {{ {slow} }}"),
        format!("fn setup(ctx) {{ {slow} }}"),
        format!("fn frame(ctx) {{ [3, 2, 1].sort(|a, b| {{ {slow} }}); }}"),
    ] {
        let script = Script::from_text("slow.rhai", &script).expect("compiles");
        let scene = Scene::new(scene(), script.clone());
        let halt = Halt::default();
        let call = || match script.has_frame() {
            true => Animator::new(&scene).pose(3).map(drop),
            false => script.setup(&[], None).map(drop).map_err(|e| vec![*e]),
        };
        let ended = thread::scope(|scope| {
            let (sender, begins) = mpsc::channel();
            let (halt, call) = (&halt, &call);
            let called = scope.spawn(move || {
                sender.send(()).expect("is waited for");
                halt.over(call)
            });
            begins.recv().expect("begins");
            thread::sleep(Duration::from_millis(50));
            halt.halt();
            called.join().expect("ends")
        });
        for ended in [ended, halt.over(call)] {
            let message = &ended.expect_err("is halted")[0].message;
            assert!(message.contains("it was halted"), "{message}");
        }
    }
    // Other calls are not halted.
    assert!(frame("fn frame(ctx) { }").is_ok());
}

#[test]
fn joints_and_morphs_are_those_that_the_scene_lists() {
    let script = "fn frame(ctx) {
        ctx.joint(\"walker\", \"hip\", #{ turn: [0, 90, 0], translation: [1, 2, 3] });
        ctx.joint(\"walker\", \"hip\", #{ scale: 2 });
        ctx.morph(\"walker\", \"smile\", 0.25);
    }";
    let state = frame(script).expect("it runs");
    let pose = state.joints[&(1, 1)];
    assert_eq!(pose.translation, Some(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!((pose.scale, pose.rotation), (Some(Vec3::splat(2.0)), None));
    assert_eq!(state.morphs, [((1, 0), 0.25)].into());
}

#[test]
fn the_last_vertices_of_a_frame_are_those_at_the_call() {
    let script = "fn frame(ctx) {
        let p = floats(9);
        ctx.mesh(\"flag\", p);
        p[1] = 2.5;
        ctx.mesh(\"flag\", p, p);
        p[1] = 7.0;
    }";
    let state = frame(script).expect("it runs");
    let (_, pose) = state.meshes.first_key_value().expect("one mesh");
    assert_eq!(pose.positions[..3], [0.0, 2.5, 0.0]);
    assert_eq!(pose.normals.as_ref().map(|n| n.len()), Some(9));
}
