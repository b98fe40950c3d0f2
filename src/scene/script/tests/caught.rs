//! Tests of the value that `catch (e)` gives.

use super::frame;

/// Errors at any depth of calls; values that a script throws stay as they are.
#[test]
fn caught_errors_have_message_and_place() {
    let bounds = "array index 5 out of bounds: only 2 elements in array";
    for (body, caught) in [
        ("[1, 2][5]", format!("3:22: {bounds}")),
        ("deep()", format!("1:20: {bounds}")),
        ("[1].map(|x| [1, 2][5]);", format!("3:34: {bounds}")),
        (
            "placed(1)",
            "3:15: there is no function `placed`".to_owned(),
        ),
        ("#{ a: 1 }.b", "3:25: there is no property `b`".to_owned()),
    ] {
        let script = format!(
            "fn deep() {{ [1, 2][5] }}\nfn frame(ctx) {{\n        try {{ {body} }} catch (e) {{\n\
             if e.keys() != [\"column\", \"line\", \"message\"] {{ throw `has ${{e.keys()}}`; }}\n\
             throw `${{e.line}}:${{e.column}}: ${{e.message}}`; }} }}"
        );
        let error = frame(&script).expect_err(body);
        assert!(
            error.contains(&caught),
            "{body} should say {caught}:\n{error}"
        );
    }
    let thrown = "fn frame(ctx) { try { throw #{ error: \"ours\", message: 3 }; } \
                  catch (e) { e.more = 1; throw `${e}`; } }";
    for like in ["error: \"Error: mine\"", "error: \"ErrorRuntime\", code: 5"] {
        let thrown = format!(
            "fn frame(ctx) {{ let e = #{{ {like}, message: \"m (line 3)\" }}; try {{ throw e; }} \
             catch (e) {{ throw `${{e}}`; }} }}"
        );
        let error = frame(&thrown).expect_err("it throws");
        assert!(error.contains("m (line 3)"), "{error}");
        assert!(!error.contains("column"), "{error}");
    }
    let error = frame(thrown).expect_err("it throws");
    assert!(
        error.contains("\"error\": \"ours\", \"message\": 3, \"more\": 1"),
        "{error}"
    );
}
