//! Mistakes of TOML itself.

use super::{Mistake, check_group, text};

pub const SYNTAX: &[Mistake] = &[
    text(
        "a tuple",
        "[camera.main]\neye = (0, 1.6, 5)\n",
        [
            "toml-syntax",
            "3:7",
            "square brackets `[ ]`, not in parentheses",
            "write [0, 1.6, 5]",
        ],
    ),
    text(
        "a constructor",
        "[camera.main]\neye = vec3(0, 1.6, 5)\n",
        ["toml-syntax", "3:7", "square brackets", "write [0, 1.6, 5]"],
    ),
    text(
        "arithmetic",
        "[camera.main]\nfov_deg = 30*2\n",
        ["toml-syntax", "3:11", "TOML does not compute", "write 60"],
    ),
    text(
        "arithmetic in a list",
        "[camera.main]\neye = [0, 1.6*2, 5]\n",
        ["toml-syntax", "3:14", "TOML does not compute", "write 3.2"],
    ),
    text(
        "a colon",
        "[material.a]\nmetallic: 1\n",
        [
            "toml-syntax",
            "3:9",
            "stands `=`, not `:`",
            "write `metallic = 1`",
        ],
    ),
    text(
        "a Windows path",
        "[model.a]\nfile = \"C:\\assets\\a.glb\"\n",
        [
            "toml-syntax",
            "3:12",
            "`\\` has a special meaning",
            "write \"C:/assets/a.glb\"",
        ],
    ),
    text(
        "a Windows home",
        "[model.a]\nfile = \"C:\\Users\\me\\a.glb\"\n",
        [
            "toml-syntax",
            "3:13",
            "`\\` has a special meaning",
            "write \"C:/Users/me/a.glb\"",
        ],
    ),
    text(
        "no quotes",
        "[model.a]\nfile = chair.glb\n",
        [
            "toml-syntax",
            "3:8",
            "`chair.glb` must be in quotes",
            "write \"chair.glb\"",
        ],
    ),
    text(
        "a capital",
        "[[instance]]\nmodel = \"a\"\ndynamic = True\n",
        ["toml-syntax", "4:11", "`True` is not a value", "write true"],
    ),
    text(
        "null",
        "[model.a]\nfile = null\n",
        [
            "toml-syntax",
            "3:8",
            "no `null` in TOML",
            "leave the key out",
        ],
    ),
    text(
        "a unit",
        "[camera.main]\nfov_deg = 60deg\n",
        [
            "toml-syntax",
            "3:13",
            "a number has no unit, here `deg`",
            "write 60",
        ],
    ),
    text(
        "no digit before the point",
        "[material.a]\nroughness = .5\n",
        ["toml-syntax", "3:13", "digits on both sides", "write 0.5"],
    ),
    text(
        "a leading zero",
        "[image]\nsamples = 04\n",
        ["toml-syntax", "3:11", "no leading zeros", "write 4"],
    ),
    text(
        "a decimal comma",
        "[material.a]\nroughness = 0,5\n",
        [
            "toml-syntax",
            "3:14",
            "a decimal point `.`, not a comma",
            "write 0.5",
        ],
    ),
    text(
        "a list without brackets",
        "[camera.main]\neye = 0, 1, 5\n",
        [
            "toml-syntax",
            "3:8",
            "a list stands in square brackets",
            "write [0, 1, 5]",
        ],
    ),
    text(
        "a list without commas",
        "[camera.main]\neye = [0 1 5]\n",
        ["toml-syntax", "3:8", "a comma is missing", "write"],
    ),
    text(
        "a semicolon",
        "[material.a]\nroughness = 0.5;\n",
        [
            "toml-syntax",
            "3:16",
            "`;` does not belong",
            "write `roughness = 0.5`",
        ],
    ),
    text(
        "a comma at the end",
        "[material.a]\nroughness = 0.5,\n",
        [
            "toml-syntax",
            "3:16",
            "`,` does not belong",
            "write `roughness = 0.5`",
        ],
    ),
    text(
        "a comment of C",
        "// the floor\n[material.a]\n",
        [
            "toml-syntax",
            "2:1",
            "comments begin with `#`",
            "write `# the floor`",
        ],
    ),
    text(
        "a color without quotes",
        "[material.a]\nbase_color = #ff8800\n",
        [
            "toml-syntax",
            "3:14",
            "`#` begins a comment",
            "write \"#ff8800\"",
        ],
    ),
    text(
        "typographic quotes",
        "[model.a]\nfile = “a.glb”\n",
        [
            "toml-syntax",
            "3:8",
            "is a typographic quote",
            "write \"a.glb\"",
        ],
    ),
    text(
        "no equals sign",
        "[material.a]\nroughness 0.5\n",
        [
            "toml-syntax",
            "3:11",
            "`=` is missing",
            "write `roughness = 0.5`",
        ],
    ),
    text(
        "no value",
        "[material.a]\nroughness =\nmetallic = 1\n",
        ["toml-syntax", "3:12", "a value is missing", "write"],
    ),
    text(
        "a space in a header",
        "[material red]\nroughness = 0.5\n",
        [
            "toml-syntax",
            "2:10",
            "not a valid table header",
            "write `[material.red]`",
        ],
    ),
    text(
        "a bracket too few",
        "[[instance]\nmodel = \"a\"\n",
        [
            "toml-syntax",
            "2:12",
            "not a valid table header",
            "write `[[instance]]`",
        ],
    ),
    text(
        "text over the end of a line",
        "[model.a]\nfile = \"a.glb\n",
        [
            "toml-syntax",
            "3:14",
            "does not end on its line",
            "add a `\"`",
        ],
    ),
    text(
        "a missing brace",
        "[model.a]\nshape = { kind = \"box\", size = [1,1,1]\nmaterial = \"red\"\n[material.red]\n\
         base_color = [1,0,0]\n[[instance]]\nmodel = \"a\"\n[light.l]\nkind = \"point\"\n",
        [
            "toml-syntax",
            "3:9",
            "`{` is not closed",
            "add `}`, such as at the end of line 3",
        ],
    ),
    text(
        "a missing bracket",
        "[camera.main]\neye = [0, 1, 5\ntarget = [0, 0, 0]\n[[instance]]\nmodel = \"a\"\n",
        [
            "toml-syntax",
            "3:7",
            "`[` is not closed",
            "add `]`, such as at the end of line 3",
        ],
    ),
    text(
        "a missing bracket before a brace",
        "[model.a]\nshape = { kind = \"box\", size = [1, 1, 1 }\n[[instance]]\nmodel = \"a\"\n",
        [
            "toml-syntax",
            "3:32",
            "`[` is not closed",
            "add `]`, before the `}` of line 3",
        ],
    ),
    text(
        "two instances with one bracket",
        "[model.b]\nshape = { kind = \"box\" }\n[instance]\nmodel = \"b\"\n[instance]\nmodel = \"b\"\n",
        [
            "duplicate-key",
            "6:2",
            "`instance` is defined twice",
            "write `[[instance]]`",
        ],
    ),
    text(
        "backticks",
        "[model.a]\nfile = `a.glb`\n",
        [
            "toml-syntax",
            "3:8",
            "\"`a.glb`\" must be in quotes",
            "write \"a.glb\"",
        ],
    ),
    text(
        "a unit of length",
        "[model.a]\nshape = { kind = \"sphere\", radius = 50cm }\n",
        [
            "toml-syntax",
            "3:37",
            "no unit, here `cm`",
            "write 0.5, in meters",
        ],
    ),
    text(
        "a constant for an angle",
        "[camera.main]\nfov_deg = PI / 4\n",
        [
            "toml-syntax",
            "3:11",
            "no constant `PI / 4`",
            "write 45, in degrees",
        ],
    ),
    text(
        "a constant for an angle out of range",
        "[camera.main]\nfov_deg = PI\n",
        [
            "toml-syntax",
            "3:11",
            "no constant `PI`",
            "it is 180 in degrees, and `fov_deg` must be 1 to 170",
        ],
    ),
    text(
        "a constant in a list",
        "[[instance]]\nrotation_deg = [0, -PI, 0]\n",
        [
            "toml-syntax",
            "3:20",
            "no constant `-PI`",
            "write -180, in degrees",
        ],
    ),
    text(
        "a colon in braces",
        "[model.a]\nshape = { kind: \"sphere\", radius = 1 }\n",
        [
            "toml-syntax",
            "3:15",
            "stands `=`, not `:`",
            "write `kind = \"sphere\"`",
        ],
    ),
    text(
        "a comment with slashes",
        "// a room\n",
        [
            "toml-syntax",
            "2:1",
            "comments begin with `#`",
            "write `# a room`",
        ],
    ),
];

#[test]
fn mistakes_of_toml_are_explained() {
    check_group("syntax");
}
