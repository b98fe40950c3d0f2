//! Context for reading a primitive: accessors and skin pose.

use glam::Affine3A;

use super::{Fault, accessor::Data, schema::Primitive};

/// A primitive with its context.
pub struct Context<'a> {
    /// Its document's accessors.
    pub data: &'a Data<'a>,
    /// The primitive.
    pub primitive: &'a Primitive,
    /// Whether KHR_mesh_quantization is in use.
    pub quantized: bool,
    /// Weights of the morph targets, finite.
    pub weights: &'a [f32],
    /// For skinned meshes: model from bind pose, for each joint.
    pub pose: Option<&'a [Affine3A]>,
}

impl Context<'_> {
    /// The accessor of an attribute, which must have `count` elements.
    pub fn attribute(&self, name: &str, count: usize) -> Result<Option<usize>, Fault> {
        let Some(&index) = self.primitive.attributes.get(name) else {
            return Ok(None);
        };
        let own = self.data.count(index).map_err(|f| f.at(name))?;
        if own != count {
            let text = format!("{name} has {own} elements, POSITION has {count}");
            return Err(Fault::new("gltf-attribute", text));
        }
        Ok(Some(index))
    }
}
