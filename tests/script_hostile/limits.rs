//! Locations of limit errors, and capacity below the limits.

use std::fs;

use reflet::scene::{script::Bounds, stages::Animator};

use super::{first_or_all, folder, load};

const FAR: &str = include_str!("limits/far.rhai");

/// Location of a message, `file:line:column`.
fn first_place(error: &str) -> &str {
    let place = error.lines().find(|line| line.contains("-->"));
    place.unwrap_or_default()
}

/// Limits for calls that would not end by themselves.
fn endless() -> Bounds {
    Bounds::CALL.at_most(100_000)
}

#[test]
fn limits_are_reported_where_they_are_met() {
    let folder = folder("limits");
    fs::write(folder.join("parts/far.rhai"), FAR).expect("temporary file");
    let cases: &[(&str, &[&str], &str)] = &[
        ("loop {}", &["s.rhai:7:"], "was stopped"),
        (
            "far::spin();",
            &["far.rhai:3:", "far.rhai:4:"],
            "was stopped",
        ),
        ("helper();", &["far.rhai:3:", "far.rhai:4:"], "s.rhai:4"),
        ("far::grow();", &["far.rhai:10:"], "too large"),
        ("far::fill();", &["far.rhai:15:"], "too large"),
        ("far::down(0);", &["far.rhai:18:"], "more than 32 deep"),
        (
            "let s = far::text(); s += far::text();",
            &["s.rhai:7:"],
            "too large",
        ),
        ("far::each([1]);", &["far.rhai:27:"], "a closure"),
    ];
    for (body, places, says) in cases {
        let script = format!(
            "import \"parts/far\" as far;\nfn helper() {{\n    // calls\n    far::spin()\n}}\n\
             fn frame(ctx) {{\n{body}\n}}"
        );
        let desc = load(&folder, &script).expect(body);
        let bounds = match *says {
            "too large" | "more than 32 deep" => Bounds::CALL,
            _ => endless(),
        };
        let posed = bounds.over(|| Animator::new(&desc).pose(0));
        let error = posed.expect_err(body)[0].to_string();
        let is_there = places
            .iter()
            .any(|place| first_place(&error).contains(place));
        assert!(is_there && error.contains(says), "{body}:\n{error}");
    }
    for (script, place) in [
        (
            "fn setup(ctx) {\n    let n = 0;\n    loop { n += 1; }\n}",
            "s.rhai:3:",
        ),
        ("fn frame(ctx) { }\nlet x = 1;\nloop {}", "s.rhai:3:"),
        (
            "import \"parts/spins\" as s;\nfn frame(ctx) { }",
            "spins.rhai:2:",
        ),
    ] {
        fs::write(folder.join("parts/spins.rhai"), "let x = 1;\nloop {}").expect("file");
        let loaded = endless().over(|| load(&folder, script));
        let error = loaded.expect_err(script);
        assert!(first_place(&error).contains(place), "{script}:\n{error}");
    }
}

/// Largest allowed array of elements, all with names, built one by one or from parts.
#[test]
fn setup_may_name_fifty_thousand_elements() {
    let folder = folder("many");
    let part = include_str!("limits/setup_may_name_fifty_thousand_elements.rhai");
    let cases = [
        // With a size check at each push, these would exceed the time limit of a call.
        ("#{ instances: part(0, 50000) }", 50_000),
        (
            "let all = []; for i in 0..200 { all += part(250 * i, 250 * i + 250); } \
             #{ instances: all }",
            50_000,
        ),
    ];
    for (setup, count) in first_or_all(&cases, 1) {
        let script = format!("{part}\nfn setup(ctx) {{ {setup} }}");
        let desc = load(&folder, &script).expect("it is within the limits");
        assert_eq!(desc.instances.len(), count + 2);
    }
}
