//! Keys and values that other programs have, in scenes.

use super::{Mistake, check_group, text};

pub const HABITS: &[Mistake] = &[
    text(
        "a width of the picture",
        "[image]\nwidth = 1280\n",
        [
            "unknown-key",
            "3:1",
            "`width` is not a key",
            "write `size = [1280, 720]`",
        ],
    ),
    text(
        "a rate in the picture",
        "[image]\nfps = 24\n",
        [
            "unknown-key",
            "3:1",
            "`fps` is not a key",
            "below `[timeline]`",
        ],
    ),
    text(
        "a gamma",
        "[image]\ngamma = 2.2\n",
        [
            "unknown-key",
            "3:1",
            "`gamma` is not a key",
            "`exposure_ev` makes them brighter",
        ],
    ),
    text(
        "a method of the picture",
        "[image]\nmethod = \"rt\"\n",
        [
            "unknown-key",
            "3:1",
            "`method` is not a key",
            "below `[reflection]`",
        ],
    ),
    text(
        "a focal length",
        "[camera.main]\nfocal_length = 35\n",
        [
            "unknown-key",
            "3:1",
            "`focal_length` is not a key",
            "38 is a lens of 35 mm",
        ],
    ),
    text(
        "a turned camera",
        "[camera.main]\nrotation_deg = [0, 90, 0]\n",
        [
            "unknown-key",
            "3:1",
            "`rotation_deg` is not a key",
            "write `target`, the point",
        ],
    ),
    text(
        "an up in words",
        "[camera.main]\nup = \"z\"\n",
        [
            "wrong-type",
            "3:6",
            "three numbers, not the text",
            "such as [0, 1, 0]",
        ],
    ),
    text(
        "metal as a truth",
        "[material.a]\nmetallic = true\n",
        ["wrong-type", "3:12", "a number, not true", "write 1"],
    ),
    text(
        "an index below 1",
        "[material.a]\nior = 0.9\n",
        ["out-of-range", "3:7", "1 to 4, not 0.9", "write 1"],
    ),
    text(
        "opacity",
        "[material.a]\nopacity = 0.5\n",
        [
            "unknown-key",
            "3:1",
            "`opacity` is not a key",
            "write `alpha = 0.5`",
        ],
    ),
    text(
        "a percentage",
        "[material.a]\nroughness = 30\n",
        ["out-of-range", "3:13", "0 to 1, not 30", "30 % are 0.3"],
    ),
    text(
        "an image for a color",
        "[material.a]\nbase_color = \"wood.png\"\n",
        [
            "wrong-color",
            "3:14",
            "not \"wood.png\"",
            "write `base_color_texture = \"wood.png\"`",
        ],
    ),
    text(
        "a color of CSS",
        "[material.a]\nbase_color = \"rgb(204, 34, 0)\"\n",
        [
            "wrong-color",
            "3:14",
            "not \"rgb(204, 34, 0)\"",
            "write \"#cc2200\"",
        ],
    ),
    text(
        "a color as a number",
        "[material.a]\nbase_color = 0xcc2200\n",
        ["wrong-type", "3:14", "not the number", "write \"#cc2200\""],
    ),
    text(
        "glass as a switch",
        "[material.a]\nglass = true\n",
        [
            "unknown-key",
            "3:1",
            "`glass` is not a key",
            "write `transmission = 1`",
        ],
    ),
    text(
        "a diameter",
        "[model.a]\nshape = { kind = \"sphere\", diameter = 1 }\n",
        [
            "unknown-key",
            "3:28",
            "`diameter` is not a key",
            "half of the diameter",
        ],
    ),
    text(
        "a pyramid",
        "[model.a]\nshape = { kind = \"pyramid\" }\n",
        [
            "unknown-word",
            "3:18",
            "not \"pyramid\"",
            "\"cone\" with `segments = 4`",
        ],
    ),
    text(
        "two factors",
        "[model.a]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"a\"\nscale = [1, 2]\n",
        [
            "wrong-type",
            "6:9",
            "one or three numbers",
            "such as [1, 2, 1]",
        ],
    ),
    text(
        "a count of copies",
        "[model.a]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"a\"\ncount = 5\n",
        [
            "unknown-key",
            "6:1",
            "`count` is not a key",
            "write `repeat = {",
        ],
    ),
    text(
        "a warm light",
        "[light.l]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 9\ntemperature = 3000\n",
        [
            "unknown-key",
            "6:1",
            "`temperature` is not a key",
            "\"#ffb46b\" is about 3000 K",
        ],
    ),
    text(
        "watts",
        "[light.l]\nkind = \"point\"\nposition = [0, 1, 0]\npower_w = 9\n",
        [
            "unknown-key",
            "5:1",
            "`power_w` is not a key",
            "write `intensity_cd`, in candela",
        ],
    ),
    text(
        "a soft shadow",
        "[light.l]\nkind = \"point\"\nposition = [0, 1, 0]\nintensity_cd = 9\nshadow = \"soft\"\n",
        ["unknown-word", "6:10", "not \"soft\"", "makes them soft"],
    ),
    text(
        "a number of frames",
        "[timeline]\nframes = 24\n",
        [
            "unknown-key",
            "3:1",
            "`frames` is not a key",
            "write `end`, the number of the last frame",
        ],
    ),
];

#[test]
fn habits_from_other_programs_are_explained() {
    check_group("habits");
}
