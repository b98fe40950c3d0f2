//! Shapes, patterns and decals in the words of other programs, and beyond what they can be.

use super::{Mistake, check_group, text};

pub const SHAPES: &[Mistake] = &[
    text(
        "a height of an extrusion",
        "[model.a]\nshape = { kind = \"extrude\", height = 2, outline = { rect = [1, 1] } }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:29",
            "`height` does not apply",
            "write `depth`",
        ],
    ),
    text(
        "corners of an extrusion",
        "[model.a]\nshape = { kind = \"extrude\", points = [[0, 0], [1, 0], [0, 1]] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:29",
            "does not apply to `kind = \"extrude\"`",
            "outline = { points =",
        ],
    ),
    text(
        "a path beside the outline",
        "[model.a]\nshape = { kind = \"extrude\", path = \"M 0 0 H 1 V 1 Z\" }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:29",
            "`path` is not a key",
            "outline = { path =",
        ],
    ),
    text(
        "an outline that is a path",
        "[model.a]\nshape = { kind = \"extrude\", outline = \"M 0 0 H 1 V 1 Z\" }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-type",
            "3:39",
            "must be a table",
            "write `outline = { path = \"M 0 0 H 1 V 1 Z\" }`",
        ],
    ),
    text(
        "a path with a word",
        "[model.a]\nshape = { kind = \"extrude\", outline = { path = \"M 0 0 L 1 up Z\" } }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-path",
            "3:59",
            "not understood from \"up Z\"",
            "a path is letters with numbers",
        ],
    ),
    text(
        "a hole over all of it",
        "[model.a]\nshape = { kind = \"extrude\", outline = { radius = 0.2, holes = [[[-1, -1], [1, -1], [1, 1], [-1, 1]]] } }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-outline",
            "3:39",
            "encloses nothing",
            "`holes` smaller",
        ],
    ),
    text(
        "a bevel wider than the letters",
        "[model.a]\nshape = { kind = \"text\", text = \"iii\", bevel = 0.02 }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-bevel",
            "3:33",
            "0.02 of at most 0.00649",
            "lower `bevel`",
        ],
    ),
    text(
        "a bevel wider than the box",
        "[model.a]\nshape = { kind = \"box\", bevel = 0.8 }\n[[instance]]\nmodel = \"a\"\n",
        [
            "out-of-range",
            "3:33",
            "half of the shortest length, which is 0.5",
            "write `bevel = 0.5` or less",
        ],
    ),
    text(
        "the path of a sweep",
        "[model.a]\nshape = { kind = \"sweep\", path = [[0, 0, 0], [1, 0, 0]] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:27",
            "`path` is not a key",
            "write `points`",
        ],
    ),
    text(
        "the profile of a sweep",
        "[model.a]\nshape = { kind = \"sweep\", profile = { radius = 0.1 }, points = [[0, 0, 0], [1, 0, 0]] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:27",
            "`profile` is not a key",
            "write `outline`",
        ],
    ),
    text(
        "the radius of a pipe",
        "[model.a]\nshape = { kind = \"sweep\", radius = 0.1, points = [[0, 0, 0], [1, 0, 0]] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:27",
            "does not apply to `kind = \"sweep\"`",
            "outline = { radius = 0.05 }",
        ],
    ),
    text(
        "a curve that turns back",
        "[model.a]\nshape = { kind = \"sweep\", points = [[0, 0, 0], [1, 0, 0], [0, 0, 0]] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-curve",
            "3:36",
            "turns back on itself near its point 2",
            "more than 168°",
        ],
    ),
    text(
        "a solid of revolution",
        "[model.a]\nshape = { kind = \"revolve\", points = [[0, 0], [1, 0], [0, 1]] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-word",
            "3:18",
            "not \"revolve\"",
            "did you mean \"lathe\"",
        ],
    ),
    text(
        "a rounded box",
        "[model.a]\nshape = { kind = \"rounded_box\" }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-word",
            "3:18",
            "not \"rounded_box\"",
            "write \"box\", with `bevel = 0.05`",
        ],
    ),
    text(
        "a boolean",
        "[model.a]\nshape = { kind = \"boolean\" }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-word",
            "3:18",
            "not \"boolean\"",
            "write \"union\", \"difference\" or \"intersection\"",
        ],
    ),
    text(
        "the children of a union",
        "[model.a]\nshape = { kind = \"union\", children = [] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:27",
            "`children` is not a key",
            "write `parts`",
        ],
    ),
    text(
        "a plane that cuts",
        "[model.a]\nshape = { kind = \"difference\", parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"plane\" } }] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-parts",
            "3:81",
            "part 2 cannot be combined",
            "such as `box`",
        ],
    ),
    text(
        "parts that do not meet",
        "[model.a]\nshape = { kind = \"intersection\", parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"box\" }, translation = [3, 0, 0] }] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "wrong-parts",
            "3:83",
            "nothing is left",
            "check the places of the parts",
        ],
    ),
    text(
        "the radii of a ring",
        "[model.a]\nshape = { kind = \"torus\", minor_radius = 0.2 }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:27",
            "`minor_radius` is not a key",
            "write `tube_radius`",
        ],
    ),
    text(
        "the size of a ball",
        "[model.a]\nshape = { kind = \"sphere\", size = 2 }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:28",
            "does not apply to `kind = \"sphere\"`",
            "write `radius`",
        ],
    ),
    text(
        "the string of a text",
        "[model.a]\nshape = { kind = \"text\", string = \"hi\" }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:26",
            "`string` is not a key",
            "write `text`",
        ],
    ),
    text(
        "a font of the system",
        "[model.a]\nshape = { kind = \"text\", text = \"hi\", font = \"Arial\" }\n[[instance]]\nmodel = \"a\"\n",
        [
            "file-not-found",
            "3:46",
            "file \"Arial\" not found",
            "such as \"a.ttf\"",
        ],
    ),
    text(
        "vertices of a mesh",
        "[model.a]\nshape = { kind = \"mesh\", vertices = [0, 0, 0, 1, 0, 0, 0, 1, 0], indices = [0, 1, 2] }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:26",
            "`vertices` is not a key",
            "write `positions`",
        ],
    ),
    text(
        "vertices numbered from one",
        "[model.a]\nshape = { kind = \"mesh\", positions = [0, 0, 0, 1, 0, 0, 0, 1, 0], indices = [1, 2, 3] }\n[[instance]]\nmodel = \"a\"\n",
        ["out-of-range", "3:77", "0 to 2, not 3", "numbered from 0"],
    ),
    text(
        "the amount of a displacement",
        "[model.a]\nshape = { kind = \"displaced\", amount = 0.1, shape = { kind = \"sphere\" } }\n[[instance]]\nmodel = \"a\"\n",
        [
            "unknown-key",
            "3:31",
            "`amount` is not a key",
            "write `height`",
        ],
    ),
    text(
        "the scale of a pattern",
        "[material.a]\nroughness = { pattern = \"noise\", from = 0, to = 1, scale = 0.1 }\n",
        [
            "unknown-key",
            "3:52",
            "`scale` is not a key",
            "write `size_m`",
        ],
    ),
    text(
        "the kind of a pattern",
        "[material.a]\nroughness = { kind = \"noise\", from = 0, to = 1, size_m = 0.1 }\n",
        [
            "unknown-key",
            "3:15",
            "`kind` is not a key",
            "write `pattern`",
        ],
    ),
    text(
        "a pattern of another program",
        "[material.a]\nroughness = { pattern = \"voronoi\", from = 0, to = 1, size_m = 0.1 }\n",
        [
            "unknown-word",
            "3:25",
            "not \"voronoi\"",
            "did you mean \"noise\"",
        ],
    ),
    text(
        "the image of a decal",
        "[material.a]\n[decal.d]\nimage = \"a.png\"\n",
        [
            "unknown-key",
            "4:1",
            "`image` is not a key",
            "write `material`",
        ],
    ),
    text(
        "a decal without depth",
        "[material.a]\n[decal.d]\nmaterial = \"a\"\nsize = [1, 2]\n",
        ["wrong-length", "5:8", "three numbers", "such as [1, 2, 1]"],
    ),
    text(
        "copies over a name",
        "[model.a]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"a\"\nover = \"a\"\n",
        [
            "wrong-type",
            "6:8",
            "must be a table",
            "write `over = { model = \"a\", count = 100 }`",
        ],
    ),
    text(
        "the color of a copy",
        "[model.a]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"a\"\ncolor = \"#ff0000\"\n",
        [
            "unknown-key",
            "6:1",
            "`color` is not a key",
            "write `material`",
        ],
    ),
    text(
        "the sides of a flat light",
        "[light.l]\nkind = \"rect\"\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\nintensity_cd = 30\nwidth = 1\n",
        ["unknown-key", "7:1", "`width` is not a key", "write `size`"],
    ),
    text(
        "a way from here to there",
        "timeline = { end = 9 }\n[model.a]\nshape = { kind = \"box\" }\n[[instance]]\nname = \"b\"\nmodel = \"a\"\n[motion.instance.b]\ntranslation = { from = [0, 0, 0] }\n",
        ["unknown-key", "9:17", "`from` is not a key", "write `keys`"],
    ),
    text(
        "degrees of a shutter",
        "[image]\nshutter = 180\n",
        [
            "out-of-range",
            "3:11",
            "0 to 1, not 180",
            "a shutter of 180° is open for 0.5",
        ],
    ),
    text(
        "a size by its name",
        "[image]\nsize = \"4k\"\n",
        [
            "wrong-type",
            "3:8",
            "two whole numbers",
            "write [3840, 2160]",
        ],
    ),
];

#[test]
fn shapes_in_other_words_are_explained() {
    check_group("shapes");
}
