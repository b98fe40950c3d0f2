//! Morph targets: offsets of vertices (glTF 2.0 §3.7.2.2).

use glam::{Vec2, Vec3, Vec4};

use super::{
    Fault, Notes,
    accessor::{self, Component},
    lenient::{LeftOut, forgiven},
    primitive_context::Context,
};
use crate::deform::MorphTarget;

/// Name of the warnings about parts of morph targets that are left out.
const LEFT_OUT: &str = "morph-left-out";

/// Reads the morph targets whose weight is not 0, or all where weights are animated; `mesh` is for messages.
///
/// # Errors
/// Offsets of positions of wrong type or count; of other attributes too, where the load forgives nothing.
pub fn targets(
    context: &Context<'_>,
    mesh: &str,
    notes: &mut Notes,
) -> Result<Vec<MorphTarget>, Fault> {
    let what = "morphs of a second set of texture coordinates, or of colors or coordinates that the mesh lacks, are left out";
    notes.add(LEFT_OUT, left_out(context), what, mesh);
    let used = used(context);
    let arrays = used
        .iter()
        .map(|index| context.primitive.targets[*index].len() as u64);
    let vertices = arrays
        .sum::<u64>()
        .saturating_mul(context.num_vertices as u64);
    let bytes = vertices.saturating_mul(size_of::<Vec3>() as u64);
    context.data.budget.check(bytes)?;
    used.into_iter()
        .map(|index| target(context, index, mesh, notes))
        .collect()
}

/// Indices of the targets that are read.
pub fn used(context: &Context<'_>) -> Vec<usize> {
    let weight = |index: usize| context.weights.get(index).copied().unwrap_or(0.0);
    let is_used = |index: &usize| context.has_animated_weights || weight(*index) != 0.0;
    let targets = 0..context.primitive.targets.len();
    targets.filter(is_used).collect()
}

/// Whether an attribute of morph targets is read: texture coordinates and colors where the mesh has them.
pub fn is_read(context: &Context<'_>, name: &str) -> bool {
    let is_own = || context.primitive.attributes.contains_key(name);
    match name {
        "POSITION" | "NORMAL" | "TANGENT" => true,
        "COLOR_0" => is_own(),
        name => name == uv_name(context) && is_own(),
    }
}

/// Number of attributes of the targets that would show and are not read.
fn left_out(context: &Context<'_>) -> u64 {
    let [first, second] = context.uv_sets.map(|set| format!("TEXCOORD_{set}"));
    let shows = |name: &str| name == "COLOR_0" || name == first || name == second;
    let targets = used(context).into_iter();
    let names = targets.flat_map(|target| context.primitive.targets[target].keys());
    names
        .filter(|name| shows(name) && !is_read(context, name))
        .count() as u64
}

/// Name of the first set of texture coordinates that the material uses.
fn uv_name(context: &Context<'_>) -> String {
    format!("TEXCOORD_{}", context.uv_sets[0])
}

fn target(
    context: &Context<'_>,
    number: usize,
    mesh: &str,
    notes: &mut Notes,
) -> Result<MorphTarget, Fault> {
    let [wide, narrow]: [fn(Component, bool) -> bool; 2] = match context.quantized {
        true => [accessor::any_but_u32; 2],
        false => [accessor::float_or_normalized, accessor::float_only],
    };
    let positions = offsets(context, number, "POSITION", narrow, Vec3::from_array)?;
    let uv_name = uv_name(context);
    let three = |name| offsets(context, number, name, narrow, Vec3::from_array);
    let uv0 = offsets(context, number, &uv_name, wide, Vec2::from_array);
    let colors = offsets(context, number, "COLOR_0", wide, Vec4::from_array);
    let opaque = |[r, g, b]: [f32; 3]| Vec4::new(r, g, b, 0.0);
    let colors = colors.or_else(|_| offsets(context, number, "COLOR_0", wide, opaque));
    let left_out = LeftOut {
        name: LEFT_OUT,
        what: "normals, tangents, texture coordinates and colors of morphs are wrong and left out",
        place: mesh,
    };
    let root = context.root;
    Ok(MorphTarget {
        index: number,
        positions,
        normals: forgiven(root, three("NORMAL"), Vec::new(), &left_out, notes)?,
        tangents: forgiven(root, three("TANGENT"), Vec::new(), &left_out, notes)?,
        uv0: forgiven(root, uv0, Vec::new(), &left_out, notes)?,
        colors: forgiven(root, colors, Vec::new(), &left_out, notes)?,
    })
}

/// Offsets of an attribute; none where it is not read.
fn offsets<T, const N: usize>(
    context: &Context<'_>,
    number: usize,
    attribute: &str,
    accept: fn(Component, bool) -> bool,
    convert: fn([f32; N]) -> T,
) -> Result<Vec<T>, Fault> {
    let index = context.primitive.targets[number].get(attribute);
    let Some(&index) = index.filter(|_| is_read(context, attribute)) else {
        return Ok(Vec::new());
    };
    let count = context.num_vertices;
    let place = format!("target {number} {attribute}");
    let own = context.data.count(index).map_err(|f| f.placed(&place))?;
    if own != count {
        let text = format!("{place} has {own} elements, POSITION has {count}");
        return Err(Fault::new("gltf-attribute", text));
    }
    let offsets = (context.floats::<N>(index, accept)).map_err(|f| f.placed(&place))?;
    Ok(offsets.into_iter().map(convert).collect())
}
