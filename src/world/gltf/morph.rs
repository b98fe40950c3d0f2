//! Morph targets: offsets of vertices (glTF 2.0 §3.7.2.2).

use glam::{Vec2, Vec3, Vec4};

use super::{
    Fault,
    accessor::{self, Component},
    primitive_context::Context,
};
use crate::deform::MorphTarget;

/// Reads the morph targets whose weight is not 0, or all where weights are animated.
///
/// # Errors
/// Offsets of wrong type or count.
pub fn targets(context: &Context<'_>) -> Result<Vec<MorphTarget>, Fault> {
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
        .map(|index| target(context, index))
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
pub fn left_out(context: &Context<'_>) -> u64 {
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

fn target(context: &Context<'_>, number: usize) -> Result<MorphTarget, Fault> {
    let accept: fn(Component, bool) -> bool = match context.quantized {
        true => accessor::any_but_u32,
        false => accessor::float_only,
    };
    let (positions, normals, tangents) = ("POSITION", "NORMAL", "TANGENT");
    let three = |name| offsets(context, number, name, accept, Vec3::from_array);
    let accept = match context.quantized {
        true => accessor::any_but_u32,
        false => accessor::float_or_normalized,
    };
    let uv_name = uv_name(context);
    let colors = offsets(context, number, "COLOR_0", accept, Vec4::from_array);
    let opaque = |[r, g, b]: [f32; 3]| Vec4::new(r, g, b, 0.0);
    Ok(MorphTarget {
        index: number,
        positions: three(positions)?,
        normals: three(normals)?,
        tangents: three(tangents)?,
        uv0: offsets(context, number, &uv_name, accept, Vec2::from_array)?,
        colors: colors.or_else(|_| offsets(context, number, "COLOR_0", accept, opaque))?,
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
