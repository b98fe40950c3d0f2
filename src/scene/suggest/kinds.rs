//! Keys that other programs have in tables with a `kind`, with what to write instead for this one.

use super::{Advice, advice};

/// Unsupported keys, the kinds that lack them, and what to write instead.
const OF_KINDS: &[Advice] = advice! {
    "height" | "length" | "amount" | "distance" in "extrude" =>
        "write `depth`, the thickness along Z";
    "points" | "corners" | "polygon" in "extrude" =>
        "write `outline`, as in `outline = { points = [[0, 0], [1, 0], [0.5, 0.8]] }`";
    "path" | "svg" | "d" in "extrude" | "lathe" =>
        "write `outline`, as in `outline = { path = \"M 0 0 H 1 V 0.5 Z\" }`";
    "profile" | "shape" | "section" | "radius" | "rect" | "size" in "extrude" =>
        "write `outline`, as in `outline = { rect = [0.4, 0.2] }` or `outline = { radius = 0.2 }`";
    "path" | "spine" | "rail" | "along" in "sweep" =>
        "write `points`, where the curve passes, as in `points = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]`";
    "profile" | "section" | "cross_section" | "shape" | "radius" | "thickness" | "width" | "size" in "sweep" =>
        "write `outline`, the profile, as in `outline = { radius = 0.05 }`";
    "profile" | "curve" | "section" in "lathe" =>
        "write `points`, as in `points = [[0.3, 0], [0.2, 1]]`, or `outline`";
    "major_radius" | "outer_radius" | "ring_radius" | "big_radius" in "torus" =>
        "write `radius`, from the center to the middle of the tube";
    "minor_radius" | "inner_radius" | "small_radius" | "thickness" in "torus" =>
        "write `tube_radius`, the radius of the tube";
    "size" | "height" | "width" in "sphere" =>
        "write `radius`, half of the size";
    "length" | "depth" | "size" in "cylinder" | "capsule" | "cone" =>
        "write `height`";
    "height" | "side" | "sides" in "box" =>
        "write `size`, as in `size = [1, 2, 1]`, the lengths along X, Y and Z";
    "rounding" | "round" | "corner_radius" | "chamfer" | "fillet" | "radius" in "box" | "extrude" | "text" =>
        "write `bevel`, how far the edges are rounded";
    "string" | "content" | "value" | "label" | "letters" in "text" =>
        "write `text`, as in `text = \"Reflet\"`";
    "height" | "scale" in "text" =>
        "write `size`; capitals are some 0.7 of it high";
    "children" | "objects" | "operands" | "items" | "a" | "b" in "union" | "difference" | "intersection" =>
        "write `parts`, as in `parts = [{ shape = { kind = \"box\" } }, { shape = { kind = \"sphere\" } }]`";
    "vertices" | "points" | "verts" in "mesh" =>
        "write `positions`, three numbers for each vertex";
    "faces" | "triangles" | "tris" in "mesh" =>
        "write `indices`, the numbers of three vertices for each triangle, from 0";
    "amount" | "strength" | "amplitude" in "displaced" =>
        "write `height`, how far the surface moves at most";
    "levels" | "iterations" | "subdivisions" in "displaced" =>
        "write `subdivide`, as in `subdivide = 3`";
    "smooth" | "rounded" | "smoothness" in "box" =>
        "write `bevel = 0.05`, how far the edges are rounded";
    "rings" | "stacks" | "slices" | "sectors" | "sides" | "subdivisions" | "detail" | "resolution" | "quality"
        in "sphere" | "cylinder" | "cone" | "capsule" | "disk" | "torus" =>
        "write `segments = 64`, the number of its sides";
    "subdivisions" | "segments" | "resolution" | "detail" in "plane" | "box" =>
        "leave it out: a flat side needs no more triangles; hills are `kind = \"heightfield\"`";
    "center" | "position" | "translation" | "location" | "origin" | "rotation" | "rotation_deg" | "scale"
        in "plane" | "box" | "sphere" | "cylinder" | "cone" | "disk" | "torus" | "capsule" | "lathe" | "extrude" | "sweep"
        | "text" =>
        "a shape has no place: write `translation = [0, 1, 0]`, `rotation_deg` or `scale` in its `[[instance]]`";
    "color" | "material" | "base_color" in "plane" | "box" | "sphere" | "cylinder" | "cone" | "disk" | "torus" | "capsule" =>
        "write `material = \"red\"` in `[model.NAME]`, beside `shape`, and the color in `[material.red]`";
    "width" | "height" in "rect" =>
        "write `size`, its width and height, as in `size = [1, 0.5]`";
};

/// Advice for an unsupported key in a table of this kind.
pub fn absent_of_kind(kind: &str, typed: &str) -> Option<&'static str> {
    advice(OF_KINDS, typed, |known| known == kind)
}

/// The key that an advice begins with, as in ``write `size`, …``.
pub fn key_of_advice(help: &str) -> Option<&str> {
    let (key, rest) = help.strip_prefix("write `")?.split_once('`')?;
    let (key, _) = key.split_once(" = ").unwrap_or((key, ""));
    (rest.is_empty() || rest.starts_with([',', ';', ':'])).then_some(key)
}

/// Advice for a table that lacks this key.
pub fn example(key: &str) -> String {
    format!("write {}", example_of(key))
}

/// A key with a value that it may have.
pub fn example_of(key: &str) -> String {
    let value = match key {
        "parts" => "[{ shape = { kind = \"box\" } }, { shape = { kind = \"sphere\" } }]",
        "keys" => "[{ at_s = 0, value = … }, { at_s = 2, value = … }]",
        "path" => "\"M 0 0 H 1 V 0.5 Z\"",
        "shape" => "{ kind = \"box\" }",
        "file" => "\"chair.glb\"",
        _ => "…",
    };
    format!("`{key} = {value}`")
}
