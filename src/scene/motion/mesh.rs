//! Vertices that scripts give to a mesh.

use std::sync::Arc;

/// Vertices of a mesh in a frame, in the order in which its shape is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPose {
    /// Positions, three finite numbers each, meters.
    pub positions: Arc<Vec<f32>>,
    /// Directions out of the surface, three finite numbers each, of any length; `None`: smooth over the triangles that
    /// share a vertex.
    pub normals: Option<Arc<Vec<f32>>>,
}
