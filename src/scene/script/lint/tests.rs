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

/// Lines of `cases.txt`: code, and its only warning with the text at which it stands, if there is one.
#[test]
fn quotients_and_hidden_names_are_found_and_others_left_alone() {
    for case in include_str!("cases.txt").lines() {
        let (text, want) = case.split_once(" =>").expect("code and warning");
        let found = lint(&text.replace("\\n", "\n")).join("; ");
        assert_eq!(found, want.trim_start(), "{text}");
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
