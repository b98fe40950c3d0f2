//! Context for reading a primitive: accessors and skin pose.

use glam::Affine3A;

use super::{
    Fault,
    accessor::{Component, Data},
    schema::{Primitive, Root},
};

/// A primitive with its context.
pub struct Context<'a> {
    /// The document.
    pub root: &'a Root,
    /// Accessors of the document.
    pub data: &'a Data<'a>,
    /// The primitive.
    pub primitive: &'a Primitive,
    /// Number of vertices, which each attribute of the primitive has.
    pub num_vertices: usize,
    /// Indices of the vertices to read, where the primitive uses few of many; `None`: all.
    pub rows: Option<Vec<u32>>,
    /// The sets of texture coordinates that the material uses.
    pub uv_sets: [u32; 2],
    /// Whether KHR_mesh_quantization is in use.
    pub quantized: bool,
    /// Weights of the morph targets, finite.
    pub weights: &'a [f32],
    /// Whether an animation moves the weights.
    pub has_animated_weights: bool,
    /// Transform of each joint at rest, from the mesh's space to the model's; `None` without a skin.
    pub pose: Option<&'a [Affine3A]>,
    /// Whether an animation moves some joint.
    pub has_animated_joints: bool,
    /// Whether the winding of triangles is reversed (glTF 2.0 §3.7.4), as the node of a skinned mesh mirrors.
    pub is_mirrored: bool,
}

impl Context<'_> {
    /// The accessor of an attribute, which must have an element for each vertex.
    pub fn attribute(&self, name: &str) -> Result<Option<usize>, Fault> {
        let count = self.num_vertices;
        let Some(&index) = self.primitive.attributes.get(name) else {
            return Ok(None);
        };
        let own = self.data.count(index).map_err(|f| f.placed(name))?;
        if own != count {
            let text = format!("{name} has {own} elements, POSITION has {count}");
            return Err(Fault::new("gltf-attribute", text));
        }
        Ok(Some(index))
    }

    /// Elements of an attribute for the vertices that are read, as [`Data::floats`].
    pub fn floats<const N: usize>(
        &self,
        index: usize,
        accept: fn(Component, bool) -> bool,
    ) -> Result<Vec<[f32; N]>, Fault> {
        self.data.floats_at(index, accept, self.rows.as_deref())
    }
}
