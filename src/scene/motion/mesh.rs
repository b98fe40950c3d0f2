//! Vertices that scripts and programs give to a mesh.

use std::sync::Arc;

use crate::{range::ANY, suggest};

/// Vertices of a mesh in a frame, in the order in which its shape is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshPose {
    /// Positions, three finite numbers each, meters.
    pub positions: Arc<Vec<f32>>,
    /// Directions out of the surface, three finite numbers each, of any length; `None`: smooth over the triangles that
    /// share a vertex.
    pub normals: Option<Arc<Vec<f32>>>,
}

impl MeshPose {
    /// Vertices of the model of this name, whose shape has so many of them.
    ///
    /// # Errors
    /// One sentence: another number of vertices, or numbers that are not finite or too large.
    pub fn new(
        model: &str,
        vertices: usize,
        positions: Arc<Vec<f32>>,
        normals: Option<Arc<Vec<f32>>>,
    ) -> Result<Self, String> {
        let shown = suggest::text(model);
        let lists = [
            ("positions", Some(&positions)),
            ("normals", normals.as_ref()),
        ];
        for (what, numbers) in lists {
            let (found, wanted) = (numbers.map_or(3 * vertices, |n| n.len()), 3 * vertices);
            if found != wanted {
                return Err(format!(
                    "the {what} of model {shown} must be {wanted} numbers, 3 for each of its {vertices} vertices, \
                     not {found} numbers ({} vertices); a frame moves vertices and cannot add or remove them",
                    found / 3
                ));
            }
        }
        for (what, numbers) in lists {
            let is_far = |x: &f32| !ANY.contains(f64::from(*x));
            let numbers = numbers.map_or(&[][..], |numbers| numbers);
            if let Some(at) = numbers.iter().position(is_far) {
                return Err(format!(
                    "the {what} of model {shown} must be between -1e12 and 1e12; number {at} is {}",
                    numbers[at]
                ));
            }
        }
        Ok(Self { positions, normals })
    }

    /// Refusal of a model whose vertices cannot be given.
    pub fn refusal(model: &str) -> String {
        let shown = suggest::text(model);
        format!(
            "model {shown} cannot be deformed; its shape must be of `kind = \"mesh\"` with `dynamic = true`"
        )
    }
}
