//! Wrong keys and values.

use super::{Mistake, check_group, text};

pub const VALUES: &[Mistake] = &[
    text(
        "a number in quotes",
        "[camera.main]\nfov_deg = \"55\"\n",
        [
            "wrong-type",
            "3:11",
            "must be a number, not the text",
            "write 55, without quotes",
        ],
    ),
    text(
        "a number of a list in quotes",
        "[camera.main]\neye = [0, \"1.6\", 5]\n",
        [
            "wrong-type",
            "3:11",
            "must be a number, not the text",
            "write 1.6, without quotes",
        ],
    ),
    text(
        "true in quotes",
        "[reflection]\nfilter = \"true\"\n",
        [
            "wrong-type",
            "3:10",
            "must be true or false",
            "write true, without quotes",
        ],
    ),
    text(
        "bytes for a color",
        "[material.a]\nbase_color = [255, 128, 0]\n",
        [
            "out-of-range",
            "3:14",
            "0 to 1, not [255, 128, 0]",
            "write \"#ff8000\"",
        ],
    ),
    text(
        "the name of a color",
        "[material.a]\nbase_color = \"red\"\n",
        ["wrong-color", "3:14", "not \"red\"", "colors have no names"],
    ),
    text(
        "a color with alpha",
        "[material.a]\nbase_color = \"#ff880080\"\n",
        [
            "wrong-color",
            "3:14",
            "not \"#ff880080\"",
            "such as \"#ff8800\"",
        ],
    ),
    text(
        "an area light",
        "[light.a]\nkind = \"area\"\n",
        [
            "unknown-word",
            "3:8",
            "not \"area\"",
            "flat lights are \"rect\" and \"disk\"",
        ],
    ),
    text(
        "a sun",
        "[light.a]\nkind = \"sun\"\n",
        [
            "unknown-word",
            "3:8",
            "not \"sun\"",
            "did you mean \"directional\"?",
        ],
    ),
    text(
        "an ambient light",
        "[light.a]\nkind = \"ambient\"\n",
        ["unknown-word", "3:8", "not \"ambient\"", "`[environment]`"],
    ),
    text(
        "a cube",
        "[model.a]\nshape = { kind = \"cube\" }\n",
        [
            "unknown-word",
            "3:18",
            "not \"cube\"",
            "did you mean \"box\"?",
        ],
    ),
    text(
        "a path tracer",
        "[reflection]\nmethod = \"raytracing\"\n",
        ["unknown-word", "3:10", "not \"raytracing\"", "write \"rt\""],
    ),
    text(
        "the truth by another name",
        "[reflection]\nmethod = \"pathtraced\"\n",
        [
            "unknown-word",
            "3:10",
            "not \"pathtraced\"",
            "write \"path\"",
        ],
    ),
    text(
        "a shape by its name alone",
        "[model.a]\nshape = \"sphere\"\n",
        [
            "wrong-type",
            "3:9",
            "`shape` must be a table",
            "write `shape = { kind = \"sphere\" }`",
        ],
    ),
    text(
        "something that is always shown",
        "[timeline]\nend = 9\n[model.b]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"b\"\n\
         name = \"b\"\n[motion.instance.b]\nshown = true\n",
        [
            "wrong-type",
            "10:9",
            "`shown` must be a table",
            "leave `shown` out",
        ],
    ),
    text(
        "something that is never shown",
        "[timeline]\nend = 9\n[group.g]\n[motion.group.g]\nshown = false\n",
        [
            "wrong-type",
            "6:9",
            "`shown` must be a table",
            "write `shown = { keys = [{ at_s = 0, value = false }] }`",
        ],
    ),
    text(
        "something hidden in its own table",
        "[model.b]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"b\"\nshown = false\n",
        [
            "unknown-key",
            "6:1",
            "`shown` is not a key",
            "write `visible = false`",
        ],
    ),
    text(
        "a light that is switched",
        "[timeline]\nend = 9\n[light.a]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 1\n\
         [motion.light.a]\nshown = { keys = [{ at_s = 0, value = false }] }\n",
        [
            "unknown-key",
            "9:1",
            "`shown` is not a key",
            "in `[motion.group.GROUP]`",
        ],
    ),
    text(
        "a lamp that is off",
        "[light.a]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 1\nvisible = false\n",
        [
            "unknown-key",
            "6:1",
            "`visible` is not a key",
            "in `[motion.group.GROUP]`",
        ],
    ),
    text(
        "a decal that is hidden",
        "[material.p]\n[decal.a]\nmaterial = \"p\"\nvisible = false\n",
        [
            "unknown-key",
            "5:1",
            "`visible` is not a key",
            "in `[motion.decal.NAME]`",
        ],
    ),
    text(
        "a track of one value",
        "[timeline]\nend = 9\n[light.a]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 1\n\
         [motion.light.a]\nintensity_cd = 5\n",
        [
            "wrong-type",
            "9:16",
            "`intensity_cd` must be a table",
            "write `intensity_cd = { keys = [",
        ],
    ),
    text(
        "a texture of a layer",
        "[material.a]\nclearcoat = 1\nclearcoat_texture = \"a.png\"\n",
        [
            "unknown-key",
            "4:1",
            "`clearcoat_texture` is not a key",
            "comes from glTF files only",
        ],
    ),
    text(
        "a texture of the specular lobe",
        "[material.a]\nspecular_texture = \"a.png\"\n",
        [
            "unknown-key",
            "3:1",
            "`specular_texture` is not a key",
            "comes from glTF files only",
        ],
    ),
    text(
        "a script in Python",
        "script = \"a.py\"\n",
        [
            "script-file",
            "2:10",
            "a `.py` file",
            "write it as a `.rhai` file",
        ],
    ),
    text(
        "a model in OBJ",
        "[model.a]\nfile = \"a.obj\"\n",
        ["file-format", "3:8", "a `.obj` file", "export it as `.glb`"],
    ),
    text(
        "a texture in TGA",
        "[material.m]\nbase_color_texture = \"a.tga\"\n[model.a]\nshape = { kind = \"box\" }\n\
         material = \"m\"\n",
        ["file-format", "3:22", "a `.tga` file", "save it as `.png`"],
    ),
    text(
        "a synonym",
        "[material.a]\nalbedo = [1, 0, 0]\n",
        [
            "unknown-key",
            "3:1",
            "`albedo` is not a key",
            "did you mean `base_color`?",
        ],
    ),
    text(
        "a typing error",
        "[camera.main]\ntraget = [0, 0, 0]\n",
        [
            "unknown-key",
            "3:1",
            "`traget` is not a key",
            "did you mean `target`?",
        ],
    ),
    text(
        "a key of another kind",
        "[light.a]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_lux = 3\n",
        [
            "unknown-key",
            "5:1",
            "does not apply to `kind = \"point\"`",
            "did you mean `intensity_cd`?",
        ],
    ),
    text(
        "a table for a list",
        "[model.b]\nshape = { kind = \"box\" }\n[instance]\nmodel = \"b\"\n",
        [
            "wrong-type",
            "4:2",
            "`instance` must be a list of tables",
            "write `[[instance]]`",
        ],
    ),
    text(
        "a table without name",
        "[camera]\neye = [0, 1, 5]\n",
        ["wrong-type", "3:1", "holds names", "write `[camera.NAME]`"],
    ),
    text(
        "a dangling material",
        "[material.red]\n[model.a]\nshape = { kind = \"box\" }\nmaterial = \"rde\"\n",
        [
            "dangling-name",
            "5:12",
            "no material is named \"rde\"",
            "did you mean \"red\"?",
        ],
    ),
    text(
        "three equal names",
        "[model.b]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"b\"\nname = \"x\"\n\
         [[instance]]\nmodel = \"b\"\nname = \"x\"\n",
        [
            "duplicate-name",
            "9:8",
            "two instances are named \"x\"",
            "must be unique",
        ],
    ),
    text(
        "a missing file",
        "[model.a]\nfile = \"nowhere.glb\"\n",
        ["file-not-found", "3:8", "not found", "--assets"],
    ),
    text(
        "a key that is missing",
        "[light.a]\nkind = \"point\"\nposition = [0, 1, 0]\n",
        [
            "missing-key",
            "2:1",
            "`intensity_cd` is missing",
            "write `intensity_cd = …`",
        ],
    ),
    text(
        "a view straight down",
        "[camera.main]\neye = [0, 5, 0]\ntarget = [0, 0, 0]\n",
        [
            "zero-direction",
            "4:10",
            "`up` must not point along the view",
            "write `up = [0, 0, -1]`",
        ],
    ),
    text(
        "a scale of 0",
        "[model.b]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"b\"\nscale = [1, 0, 1]\n",
        [
            "singular",
            "6:9",
            "`scale` must not be 0",
            "leave `scale` out",
        ],
    ),
    text(
        "a word of another program",
        "[model.ring]\nshape = { kind = \"donut\" }\n",
        [
            "unknown-word",
            "3:18",
            "not \"donut\"",
            "did you mean \"torus\"?",
        ],
    ),
    text(
        "a ring without a hole",
        "[model.ring]\nshape = { kind = \"torus\", tube_radius = 2 }\n",
        [
            "out-of-range",
            "3:41",
            "`tube_radius` must be at most `radius`, which is 0.5",
            "a larger tube would pass",
        ],
    ),
    text(
        "a capsule that is too short",
        "[model.pill]\nshape = { kind = \"capsule\", radius = 1 }\n",
        [
            "out-of-range",
            "3:9",
            "`height` must be at least twice `radius`",
            "it is from end to end",
        ],
    ),
];

#[test]
fn wrong_values_are_explained() {
    check_group("values");
}
