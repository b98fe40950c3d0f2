//! Shapes that were made.

use super::Fault;
use crate::Mesh;

/// A shape that was made.
#[derive(Debug)]
pub struct Made {
    /// Its mesh.
    pub mesh: Mesh,
    /// Doubts about it.
    pub warnings: Vec<Fault>,
}

impl From<Mesh> for Made {
    fn from(mesh: Mesh) -> Self {
        let warnings = Vec::new();
        Self { mesh, warnings }
    }
}
