//! Morph targets: offsets of vertices (glTF 2.0 §3.7.2.2).

use glam::Vec3;

use super::{Fault, accessor, primitive_context::Context};
use crate::deform::MorphTarget;

/// Attributes of morph targets that are read.
pub const READ: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];

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

fn target(context: &Context<'_>, number: usize) -> Result<MorphTarget, Fault> {
    let count = context.num_vertices;
    let offsets = |attribute: &str| {
        let Some(&index) = context.primitive.targets[number].get(attribute) else {
            return Ok(Vec::new());
        };
        let accept = match context.quantized {
            true => accessor::any_but_u32,
            false => accessor::float_only,
        };
        let place = format!("target {number} {attribute}");
        let own = context.data.count(index).map_err(|f| f.placed(&place))?;
        if own != count {
            let text = format!("{place} has {own} elements, POSITION has {count}");
            return Err(Fault::new("gltf-attribute", text));
        }
        let offsets = (context.floats::<3>(index, accept)).map_err(|f| f.placed(&place))?;
        Ok(offsets.into_iter().map(Vec3::from_array).collect())
    };
    Ok(MorphTarget {
        index: number,
        positions: offsets("POSITION")?,
        normals: offsets("NORMAL")?,
        tangents: offsets("TANGENT")?,
    })
}
