//! Values in the forms and units of other programs.

use super::{Mistake, check_group, text};

pub const FORMS: &[Mistake] = &[
    text(
        "a target by its name",
        "[timeline]\nend = 3\n[camera.main]\n[motion.camera.main]\ntarget = { follow = \"ball\" }\n",
        [
            "wrong-type",
            "6:21",
            "must be a table",
            "write `follow = { instance = \"ball\" }`",
        ],
    ),
    text(
        "an angle in radians",
        "[camera.main]\nfov_deg = 0.8\n",
        [
            "out-of-range",
            "3:11",
            "1 to 170, not 0.8",
            "0.8 radians are 45.837",
        ],
    ),
    text(
        "a point with two numbers",
        "[camera.main]\neye = [0, 1]\n",
        [
            "wrong-length",
            "3:7",
            "array of 2 values",
            "such as [0, 1, 0]",
        ],
    ),
    text(
        "a rate about one axis",
        "[timeline]\nend = 3\n[model.ball]\nshape = { kind = \"sphere\" }\n[[instance]]\nname = \"b\"\nmodel = \"ball\"\n[motion.instance.b]\nrotation_deg = { rate = 90 }\n",
        [
            "wrong-type",
            "10:25",
            "not the number 90",
            "write [0, 90, 0] for a turn about Y",
        ],
    ),
    text(
        "a size as text",
        "[image]\nsize = \"1280x720\"\n",
        [
            "wrong-type",
            "3:8",
            "two whole numbers",
            "write [1280, 720]",
        ],
    ),
    text(
        "a gray as one number",
        "[environment]\ncolor = 0.9\n",
        [
            "wrong-type",
            "3:9",
            "not the number 0.9",
            "write [0.9, 0.9, 0.9]",
        ],
    ),
    text(
        "another tone map",
        "[image]\ntone_map = \"filmic\"\n",
        [
            "unknown-word",
            "3:12",
            "not \"filmic\"",
            "\"aces\" and \"agx\" roll bright light off",
        ],
    ),
    text(
        "a key by its frame",
        "[timeline]\nend = 3\n[camera.main]\n[motion.camera.main]\nfov_deg = { keys = [{ frame = 2, value = 50 }] }\n",
        [
            "unknown-key",
            "6:23",
            "`frame` is not a key",
            "write `at_s`, in seconds",
        ],
    ),
    text(
        "a file with a backslash",
        "[model.ball]\nfile = \"models\\ball.glb\"\n[[instance]]\nmodel = \"ball\"\n",
        [
            "file-not-found",
            "3:8",
            "not found",
            "begins a special character: write `/`",
        ],
    ),
    text(
        "a pattern by its name",
        "[material.a]\nroughness = \"noise\"\n",
        [
            "wrong-type",
            "3:13",
            "a number",
            "write { pattern = \"noise\", from = 0.2, to = 0.8, size_m = 0.1 }",
        ],
    ),
    text(
        "a pattern as a color",
        "[material.a]\nbase_color = \"marble\"\n",
        [
            "wrong-color",
            "3:14",
            "not \"marble\"",
            "write { pattern = \"marble\", from = \"#404040\", to = \"#c0c0c0\", size_m = 0.1 }",
        ],
    ),
];

#[test]
fn forms_of_other_programs_are_explained() {
    check_group("forms");
}
