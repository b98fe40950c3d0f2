//! Tests of the warnings about scripts, and of code that gives none.

use super::*;

fn lint(text: &str) -> Vec<String> {
    let param = |name: &str, value| Entry {
        name: name.to_owned(),
        at: Span::default(),
        value,
    };
    let params = [
        param("count", ParamValue::Integer(3)),
        param("size", ParamValue::Number(3.0)),
    ];
    let found = lint_scripts(&[("s.rhai".to_owned(), text.to_owned())], &params);
    let show = |d: &Diagnostic| format!("{} {}", d.name, &text[d.span.range.clone()]);
    found.iter().map(show).collect()
}

#[test]
fn quotients_of_whole_numbers_are_found() {
    for (text, at) in [
        ("let x = 1/2;", "1/2"),
        (
            "fn frame(ctx) { let t = ctx.frame / 24; }",
            "ctx.frame / 24",
        ),
        ("for i in 0..3 { a(i / 3) }", "i / 3"),
        ("for i in 0..3 { a(2 * i / 3) }", "2 * i / 3"),
        ("fn f(ctx) { ctx.params.count / 2 }", "ctx.params.count / 2"),
        (
            "for i in 0..n { a(i / ctx.params.count) }",
            "i / ctx.params.count",
        ),
        ("for i in 0..9 { a(i / list.len()) }", "i / list.len()"),
        ("let n = 5; let x = 1 / n;", "1 / n"),
    ] {
        assert_eq!(lint(text), [format!("integer-division {at}")], "{text}");
    }
}

#[test]
fn other_quotients_are_left_alone() {
    for text in [
        "let x = 1/2.0; let y = 4 / 2; let z = 1.0 / 2;",
        "fn frame(ctx) { let t = ctx.t / 24; let u = ctx.params.size / 2; }",
        "for i in 0..9 { a(i / 3, i % 3) }",
        "for i in 0..3 { a(2.0 * i / 3); b(i.to_float() / 3); }",
        "fn f(n) { n / 2 }",
        "// 1 / 2\nlet s = \"1 / 2\";",
    ] {
        assert_eq!(lint(text), [""; 0], "{text}");
    }
}

#[test]
fn names_that_hide_others_are_found() {
    for (text, want) in [
        (
            "fn f(a) { let b = 0; for i in a { let b = i; } b }",
            "shadowed-variable b",
        ),
        ("fn f(i) { for i in 0..3 { } }", "shadowed-variable i"),
        (
            "fn smoothstep(a, b, x) { x }",
            "shadowed-function smoothstep",
        ),
    ] {
        assert_eq!(lint(text), [want], "{text}");
    }
    for text in [
        "fn f(a) { let a = 1; let a = 2; }",
        "fn f(a) { if a { let b = 1; } else { let b = 2; } }",
        "let a = 1; fn f() { let a = 2; }",
        "fn smoothstep(x) { x }",
    ] {
        assert_eq!(lint(text), [""; 0], "{text}");
    }
}

#[test]
fn parameters_are_used_by_name() {
    let used = |text| used_params([text].into_iter());
    let named = |names: &[&'static str]| Params::Named(names.iter().copied().collect());
    let text = "ctx.params.a + ctx.params[\"b\"]; if \"c\" in ctx.params { }";
    assert_eq!(used(text), named(&["a", "b", "c"]));
    assert_eq!(used("// params.a"), named(&[]));
    for text in ["f(ctx.params)", "ctx.params[name]"] {
        assert_eq!(used(text), Params::Unknown, "{text}");
    }
}
