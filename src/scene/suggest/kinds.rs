//! Keys that other programs have in tables with a `kind`, with what to write instead for this one.

/// Kinds, unsupported keys of theirs, and what to write instead.
const OF_KINDS: &[(&[&str], &[&str], &str)] = &[
    (
        &["extrude"],
        &["height", "length", "amount", "distance"],
        "write `depth`, the thickness along Z",
    ),
    (
        &["extrude"],
        &["points", "corners", "polygon"],
        "write `outline`, as in `outline = { points = [[0, 0], [1, 0], [0.5, 0.8]] }`",
    ),
    (
        &["extrude", "lathe"],
        &["path", "svg", "d"],
        "write `outline`, as in `outline = { path = \"M 0 0 H 1 V 0.5 Z\" }`",
    ),
    (
        &["extrude"],
        &["profile", "shape", "section", "radius", "rect", "size"],
        "write `outline`, as in `outline = { rect = [0.4, 0.2] }` or `outline = { radius = 0.2 }`",
    ),
    (
        &["sweep"],
        &["path", "spine", "rail", "along"],
        "write `points`, where the curve passes, as in `points = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]`",
    ),
    (
        &["sweep"],
        &[
            "profile",
            "section",
            "cross_section",
            "shape",
            "radius",
            "thickness",
            "width",
            "size",
        ],
        "write `outline`, the profile, as in `outline = { radius = 0.05 }`",
    ),
    (
        &["lathe"],
        &["profile", "curve", "section"],
        "write `points`, as in `points = [[0.3, 0], [0.2, 1]]`, or `outline`",
    ),
    (
        &["torus"],
        &["major_radius", "outer_radius", "ring_radius", "big_radius"],
        "write `radius`, from the center to the middle of the tube",
    ),
    (
        &["torus"],
        &["minor_radius", "inner_radius", "small_radius", "thickness"],
        "write `tube_radius`, the radius of the tube",
    ),
    (
        &["sphere"],
        &["size", "height", "width"],
        "write `radius`, half of the size",
    ),
    (
        &["cylinder", "capsule", "cone"],
        &["length", "depth", "size"],
        "write `height`",
    ),
    (
        &["box"],
        &["height", "side", "sides"],
        "write `size`, as in `size = [1, 2, 1]`, the lengths along X, Y and Z",
    ),
    (
        &["box", "extrude", "text"],
        &[
            "rounding",
            "round",
            "corner_radius",
            "chamfer",
            "fillet",
            "radius",
        ],
        "write `bevel`, how far the edges are rounded",
    ),
    (
        &["text"],
        &["string", "content", "value", "label", "letters"],
        "write `text`, as in `text = \"Reflet\"`",
    ),
    (
        &["text"],
        &["height", "scale"],
        "write `size`; capitals are some 0.7 of it high",
    ),
    (
        &["union", "difference", "intersection"],
        &["children", "objects", "operands", "items", "a", "b"],
        "write `parts`, as in `parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"sphere\" } }]`",
    ),
    (
        &["mesh"],
        &["vertices", "points", "verts"],
        "write `positions`, three numbers for each vertex",
    ),
    (
        &["mesh"],
        &["faces", "triangles", "tris"],
        "write `indices`, the numbers of three vertices for each triangle, from 0",
    ),
    (
        &["displaced"],
        &["amount", "strength", "amplitude"],
        "write `height`, how far the surface moves at most",
    ),
    (
        &["displaced"],
        &["levels", "iterations", "subdivisions"],
        "write `subdivide`, as in `subdivide = 3`",
    ),
    (
        &["rect"],
        &["width", "height"],
        "write `size`, its width and height, as in `size = [1, 0.5]`",
    ),
];

/// Advice for an unsupported key in a table of this kind.
pub fn absent_of_kind(kind: &str, typed: &str) -> Option<&'static str> {
    let lower = typed.to_lowercase();
    let (.., help) = OF_KINDS
        .iter()
        .find(|(kinds, absent, _)| kinds.contains(&kind) && absent.contains(&lower.as_str()))?;
    Some(help)
}

/// The key that an advice begins with, as in ``write `size`, …``.
pub fn key_of_advice(help: &str) -> Option<&str> {
    let (key, rest) = help.strip_prefix("write `")?.split_once('`')?;
    (rest.is_empty() || rest.starts_with([',', ';'])).then_some(key)
}

/// Advice for a table that lacks this list.
pub fn example(key: &str) -> String {
    match key {
        "parts" => {
            "write `parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"sphere\" } }]`"
                .to_owned()
        }
        "keys" => "write `keys = [{ at_s = 0, value = … }, { at_s = 2, value = … }]`".to_owned(),
        _ => format!("write `{key} = …`"),
    }
}
