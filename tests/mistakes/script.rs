//! Mistakes of scripts.

use super::{Mistake, check_group, script};

pub const SCRIPTS: &[Mistake] = &[
    script(
        "function",
        "// moves\nfunction frame(ctx) { }\n",
        [
            "script-syntax",
            "2:1",
            "no `function` in Rhai",
            "write `fn name(ctx) { … }`",
        ],
    ),
    script(
        "def",
        "def frame(ctx):\n  pass\n",
        [
            "script-syntax",
            "1:1",
            "no `def` in Rhai",
            "write `fn name(ctx)",
        ],
    ),
    script(
        "var",
        "fn frame(ctx) {\n    var x = 3;\n}\n",
        [
            "script-syntax",
            "2:5",
            "no `var` in Rhai",
            "write `let x = 1;`",
        ],
    ),
    script(
        "null",
        "fn frame(ctx) {\n    let x = null;\n}\n",
        [
            "script-syntax",
            "2:13",
            "no `null` in Rhai",
            "nothing is written `()`",
        ],
    ),
    script(
        "and",
        "fn frame(ctx) {\n    let a = true;\n    if a and a { }\n}\n",
        [
            "script-syntax",
            "3:10",
            "no `and` in Rhai",
            "write `a && b`",
        ],
    ),
    script(
        "a ternary",
        "fn frame(ctx) {\n    let a = true;\n    let b = a ? 1 : 2;\n}\n",
        [
            "script-syntax",
            "3:15",
            "no `? :` in Rhai",
            "write `if a { 1 } else { 2 }`",
        ],
    ),
    script(
        "a map of JavaScript",
        "fn frame(ctx) {\n    let b = {a: 1};\n}\n",
        [
            "script-syntax",
            "2:14",
            "a map begins with `#{`",
            "write `#{ a: 1 }`",
        ],
    ),
    script(
        "a text in single quotes",
        "fn frame(ctx) {\n    let b = 'abc';\n}\n",
        ["script-syntax", "2:13", "double quotes", "write \"abc\""],
    ),
    script(
        "a loop of C",
        "fn frame(ctx) {\n    for (let i = 0; i < 3; i++) { }\n}\n",
        [
            "script-syntax",
            "2:10",
            "goes over a range",
            "write `for i in 0..3 { … }`",
        ],
    ),
    script(
        "a type",
        "fn frame(ctx) {\n    let x: int = 3;\n}\n",
        [
            "script-syntax",
            "2:10",
            "variables have no types",
            "write `let x = …`",
        ],
    ),
    script(
        "Math",
        "fn frame(ctx) {\n    let x = Math.sin(2);\n}\n",
        ["script-syntax", "2:13", "no `Math` in Rhai", "`sin(x)`"],
    ),
    script(
        "a missing brace",
        "fn frame(ctx) {\n    if ctx.frame > 1 {\n        print(1);\n}\n\nfn other() { }\n",
        [
            "script-syntax",
            "2:22",
            "`{` is not closed",
            "add `}`, such as after line 3",
        ],
    ),
    script(
        "a missing brace of a map",
        "fn setup(ctx) {\n    #{\n        instances: [],\n}\n",
        [
            "script-syntax",
            "2:6",
            "`{` is not closed",
            "add `}`, such as after line 3",
        ],
    ),
    script(
        "a typing error in a name",
        "fn frame(ctx) {\n    let angle = 1;\n    ctx.place(\"b\", [angel, 0, 0]);\n}\n",
        [
            "script-syntax",
            "3:21",
            "no variable `angel`",
            "did you mean `angle`?",
        ],
    ),
    script(
        "an unknown parameter",
        "fn frame(ctx) {\n    let x = ctx.params.cuont;\n}\n",
        [
            "script-error",
            "2:24",
            "no property `cuont`",
            "did you mean `count`?",
        ],
    ),
    script(
        "an unknown instance",
        "fn frame(ctx) {\n    ctx.place(\"c\", [0, 1, 0]);\n}\n",
        [
            "script-error",
            "2:9",
            "no instance is named \"c\"",
            "the instances are \"b\"",
        ],
    ),
    script(
        "no parameter",
        "fn frame() { }\n",
        [
            "script-function",
            "1:1",
            "`frame` has one parameter",
            "write `fn frame(ctx)`",
        ],
    ),
    script(
        "another name",
        "fn Frame(ctx) { }\n",
        [
            "script-function",
            "1:1",
            "`Frame` is never called",
            "did you mean `frame`?",
        ],
    ),
    script(
        "neither function",
        "fn walk(ctx) { }\n",
        [
            "script-empty",
            "1:1",
            "neither `fn setup(ctx)` nor `fn frame(ctx)`",
            "`frame` moves",
        ],
    ),
    script(
        "a list from setup",
        "fn setup(ctx) {\n    let list = [];\n    list\n}\n",
        [
            "script-result",
            "3:5",
            "setup must return a map",
            "return `#{ instances: list }`",
        ],
    ),
    script(
        "a wrong key from setup",
        "fn setup(ctx) {\n    #{ instances: [#{ model: \"ball\", translatoin: [0, 1, 0] }] }\n}\n",
        [
            "unknown-key",
            "2:38",
            "`translatoin` is not a key",
            "did you mean `translation`?",
        ],
    ),
    script(
        "the third of three names",
        "fn setup(ctx) {\n    #{ instances: [\n        #{ name: \"a\", model: \"ball\" },\n        \
         #{ name: \"c\", model: \"ball\" },\n        #{ name: \"d\", model: \"bal\" },\n    ] }\n}\n",
        [
            "dangling-name",
            "5:23",
            "no model is named \"bal\"",
            "did you mean \"ball\"?",
        ],
    ),
    script(
        "a name that is taken",
        "fn setup(ctx) {\n    #{ instances: [\n        #{ name: \"a\", model: \"ball\" },\n        \
         #{ name: \"a\", model: \"ball\" },\n    ] }\n}\n",
        [
            "duplicate-name",
            "4:12",
            "two instances are named \"a\"",
            "must be unique",
        ],
    ),
    script(
        "a missing semicolon",
        "fn frame(ctx) {\n    let a = 1\n    let b = 2;\n}\n",
        ["script-syntax", "2:13", "a `;` is missing", "add `;` here"],
    ),
    script(
        "a function of another program",
        "fn frame(ctx) {\n    ctx.move(\"b\", [0, 1, 0]);\n}\n",
        [
            "script-error",
            "2:9",
            "no function `move`",
            "did you mean `place`?",
        ],
    ),
    script(
        "a constant",
        "fn frame(ctx) {\n    let a = sin(PI * ctx.t);\n}\n",
        ["script-syntax", "2:17", "no variable `PI`", "write `PI()`"],
    ),
    script(
        "a loop over a number",
        "fn frame(ctx) {\n    for i in 10 { }\n}\n",
        [
            "script-syntax",
            "2:14",
            "over a range or a list, not a number",
            "write `for i in 0..10",
        ],
    ),
    script(
        "a number appended as to a list",
        "fn setup(ctx) {\n    let p = floats();\n    p.push(1.0);\n    #{}\n}\n",
        [
            "script-error",
            "3:7",
            "there is no function `push`",
            "did you mean `add`?",
        ],
    ),
    script(
        "a mesh whose triangle has no such vertex",
        "fn setup(ctx) {\n    let p = floats(9);\n    p[0] = 1;\n    p[4] = 1;\n    let t = floats(3);\n    t[0] = 7;\n    t[1] = 1;\n    \
         #{ models: #{ flag: #{ shape: #{ kind: \"mesh\", positions: p, indices: t } } } }\n}\n",
        [
            "out-of-range",
            "8:66",
            "indices with 3 numbers: `indices[0]` must be the number of a vertex, 0 to 2, not 7",
            "numbered from 0",
        ],
    ),
];

#[test]
fn mistakes_of_scripts_are_explained() {
    check_group("scripts");
}
