//! Morph targets at constant weights: vertices moved before they are skinned (glTF 2.0 §3.7.2.2).

use glam::Vec3;

use super::{Fault, accessor, primitive_context::Context};
use crate::world::Mesh;

/// Adds the weighted offsets of positions, normals and tangents; repairs normalize them.
///
/// # Errors
/// Offsets of wrong type or count.
pub fn apply(context: &Context<'_>, mesh: &mut Mesh) -> Result<(), Fault> {
    let count = context.num_vertices;
    let used = context.primitive.targets.iter().zip(context.weights);
    for (number, (target, &weight)) in used.enumerate().filter(|(_, (_, weight))| **weight != 0.0) {
        let offsets = |attribute: &str| {
            let Some(&index) = target.get(attribute) else {
                return Ok(Vec::new());
            };
            let accept = match context.quantized {
                true => accessor::any_but_u32,
                false => accessor::float_only,
            };
            let place = format!("target {number} {attribute}");
            let own = context.data.count(index).map_err(|f| f.at(&place))?;
            if own != count {
                let text = format!("{place} has {own} elements, POSITION has {count}");
                return Err(Fault::new("gltf-attribute", text));
            }
            (context.floats::<3>(index, accept)).map_err(|f| f.at(&place))
        };
        let scaled = |offset: [f32; 3]| Vec3::from_array(offset) * weight;
        for (position, offset) in mesh.positions.iter_mut().zip(offsets("POSITION")?) {
            *position += scaled(offset);
        }
        for (normal, offset) in mesh.normals.iter_mut().zip(offsets("NORMAL")?) {
            *normal += scaled(offset);
        }
        for (tangent, offset) in mesh.tangents.iter_mut().zip(offsets("TANGENT")?) {
            *tangent += scaled(offset).extend(0.0);
        }
    }
    Ok(())
}
