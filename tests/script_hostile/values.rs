//! Deeply nested, inconsistent and overflowing values: none may overflow the stack or trigger
//! assertions inside Rhai.

use std::fs;

use reflet::scene::stages::Animator;

use crate::common::sampled;

use super::{folder, load, wrong_ends};

/// Statements that make `a` thousands of arrays or maps deep, in steps that copy and in steps that move.
const DEEP: [&str; 4] = [
    "let a = []; for i in 0..1500 { a = [a]; }",
    "let a = #{}; for i in 0..1500 { a = #{ a: a }; }",
    "let a = [1]; for i in 0..1500 { a = [#{ b: [a.pop()] }]; }",
    "let a = #{ a: 1 }; for i in 0..1500 { a = #{ a: [#{ a: a.remove(\"a\") }] }; }",
];

/// Operations on `a`, and their messages; an empty message where the operation succeeds.
const DONE: [(&str, &str); 16] = [
    ("", ""),
    ("a == a", "nested more than 64 deep"),
    ("a = 1;", ""),
    ("let b = a; b = [a, b]; let c = b;", ""),
    ("same(a); same(same(a));", ""),
    ("switch a { 1 => throw \"1\", _ => () }", ""),
    ("let t = `${a}`; if t.len() < 1500 { throw t; }", ""),
    ("return a;", ""),
    ("[1, 2].map(|x| x).contains(a);", ""),
    ("[a] != [a]", "nested more than 64 deep"),
    ("[[a]].contains([a])", "nested more than 64 deep"),
    ("a.to_string()", "nested more than 64 deep"),
    ("print(a)", "nested more than 64 deep"),
    ("debug([a])", "nested more than 64 deep"),
    ("#{ a: a }.to_json()", "nested more than 64 deep"),
    ("throw a", "nested more than 64 deep"),
];

/// Bodies of `frame`, and text that the message must contain.
const BODIES: &str = include_str!("values/bodies.txt");

/// Bodies whose second run, which looks for the place of the limit, takes its whole time; each is like one of
/// [`super::FRAMES`], with another built-in function.
const SLOW_FRAMES: &str = include_str!("values/slow_frames.txt");

#[test]
fn values_of_any_depth_are_made_used_and_freed() {
    let folder = folder("deep");
    for (index, made) in DEEP.into_iter().enumerate() {
        // Steps that copy take a time quadratic in the depth; the values are the same as after steps that move.
        // Daily the two other values take the operations in turn.
        let done = match index {
            0 | 1 => DONE[..2].iter().collect(),
            _ => sampled(DONE.iter().skip(index % 2).collect(), 2),
        };
        for (done, says) in done {
            let script = format!("fn same(x) {{ x }}\nfn frame(ctx) {{\n{made}\n{done}\n}}");
            let desc = load(&folder, &script).expect("it compiles");
            let posed = Animator::new(&desc).pose(0);
            match (posed, says) {
                (Ok(_), &"") => {}
                (Err(errors), &says) if !says.is_empty() => {
                    let error = errors[0].to_string();
                    assert!(error.contains(says), "{made} {done}:\n{error}");
                    assert!(error.contains("s.rhai:4:"), "{made} {done}:\n{error}");
                }
                (posed, _) => panic!("{made} {done}: {posed:?}"),
            }
        }
    }
}

#[test]
fn values_beyond_their_limits_are_ended_with_a_message() {
    let wrong = wrong_ends(BODIES);
    assert!(wrong.is_empty(), "{}", wrong.join("\n---\n"));
}

/// Deep values would be freed with the script, on another thread.
#[test]
fn deep_values_are_not_exported() {
    let folder = folder("export");
    let part = "let a = []; for i in 0..1500 { a = [a]; }\nexport a;";
    fs::write(folder.join("parts/deep.rhai"), part).expect("temporary file");
    let script = "import \"parts/deep\" as deep;\nfn frame(ctx) { }";
    let error = load(&folder, script).expect_err("it is too deep");
    assert!(error.contains("nested more than 64 deep"), "{error}");
    assert!(error.contains("s.rhai:1:"), "{error}");
}

/// Inconsistent comparisons sort in any order; NaN comes last.
#[test]
fn sorting_takes_any_comparison() {
    let folder = folder("sort");
    let pose = |body: &str| {
        let desc = load(&folder, &format!("fn frame(ctx) {{\n{body}\n}}")).expect("it compiles");
        Animator::new(&desc).pose(0)
    };
    let many = "let a = []; for i in 0..2000 { a.push(i * 7919 % 2003); }";
    for body in [
        "a.sort(|x, y| if hash01(x, y) < 0.5 { 1 } else { -1 }); if a.len() != 2000 { throw a; }",
        "a.sort(|x, y| true); a.sort(|x, y| 1); if a.len() != 2000 { throw a; }",
        "a.sort(); for i in 1..2000 { if a[i] < a[i - 1] { throw i; } }",
        "a.sort(|x, y| y < x); for i in 1..2000 { if a[i] > a[i - 1] { throw i; } }",
        "a[5] = 0.0 / 0.0; a[900] = 0.0 / 0.0; a.sort(); \
         for i in 1..1998 { if a[i] < a[i - 1] { throw i; } } if a[1999] == a[1999] { throw a; }",
        "let b = a.order_desc(); if b[0] < b[1] || a.order() == b { throw b; }",
        "let b = a.map(|x| [x / 100, x]); b.sort(|x, y| x[0] - y[0]); let c = b; \
         c.sort(|x, y| x[0] < y[0]); if b != c { throw b; }",
    ] {
        let posed = pose(&format!("{many}\n{body}"));
        assert!(posed.is_ok(), "{body}: {posed:?}");
    }
    for body in [
        "if [3, 1.5, 2].order() != [1.5, 2, 3] { throw 1; }",
        "if [\"b\", \"a\"].order() != [\"a\", \"b\"] || ['b', 'a'].order_desc() != ['b', 'a'] { throw 2; }",
        "if [true, false].order() != [false, true] || [].order() != [] { throw 3; }",
        // Equal elements keep their order.
        "if [#{ k: 1, n: 0 }, #{ k: 0, n: 1 }, #{ k: 1, n: 2 }].order_by(|a, b| a.k - b.k)\
         .map(|x| x.n) != [1, 0, 2] { throw 4; }",
        "let a = [3, 1, 2]; try { a.sort(|x, y| x.size); } catch { } if a != [3, 1, 2] { throw 5; }",
    ] {
        let posed = pose(body);
        assert!(posed.is_ok(), "{body}: {posed:?}");
    }
}

#[test]
#[ignore = "long: each takes seconds"]
fn slow_hostile_frames_are_ended_with_a_message() {
    let wrong = wrong_ends(SLOW_FRAMES);
    assert!(wrong.is_empty(), "{}", wrong.join("\n---\n"));
}
