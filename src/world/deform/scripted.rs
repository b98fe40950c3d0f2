//! Vertices that a script sets.

use std::sync::{Arc, OnceLock};

use glam::Vec3;

use super::{Deformation, Vertices};
use crate::{Mesh, corner_tangents, normal_uv::NormalUv};
use reflet_scene::motion::MeshPose;

/// Relation of the mesh's vertices to the vertices that its shape writes.
#[derive(Clone, Debug, Default)]
pub struct ScriptedVertices {
    /// For each vertex, the index of its written vertex: tangents split vertices.
    pub(super) written: Vec<u32>,
    /// Texture coordinates that the tangents follow; `None` where the mesh needs none.
    pub tangents_from: Option<NormalUv>,
}

impl Mesh {
    /// Lets scripts deform the mesh, whose vertices are as they are written.
    pub fn let_scripts_deform(&mut self) {
        let scripted = ScriptedVertices {
            written: (0..self.positions.len() as u32).collect(),
            tangents_from: None,
        };
        self.deformation = Some(Arc::new(Deformation {
            scripted: Some(scripted),
            ..Deformation::default()
        }));
        self.bind();
        // A mesh that is closed as it is written may be open, or inside out, in a pose.
        self.closed = OnceLock::from(false);
    }
}

impl ScriptedVertices {
    /// The vertices of a mesh that a script has set; directions that it leaves out come from the rest pose `bind`.
    pub(super) fn pose(&self, mesh: &Mesh, bind: &Vertices, set: &MeshPose) -> Vertices {
        let gather = |written: &[Vec3]| -> Vec<Vec3> {
            let own = self.written.iter();
            own.map(|i| written[*i as usize]).collect()
        };
        let written = vectors(&set.positions);
        let normals = match &set.normals {
            Some(normals) => vectors(normals),
            None => {
                let corners = |t: &[u32; 3]| t.map(|i| self.written[i as usize]);
                let triangles: Vec<_> = mesh.triangles.iter().map(corners).collect();
                smooth_normals(&written, &triangles)
            }
        };
        let normals = gather(&normals).into_iter().zip(&bind.normals);
        let mut vertices = Vertices {
            positions: gather(&written),
            normals: normals.map(|(n, bind)| n.normalize_or(*bind)).collect(),
            ..Vertices::default()
        };
        if let (Some(uv), false) = (&self.tangents_from, bind.tangents.is_empty()) {
            let posed = [vertices.positions.as_slice(), &vertices.normals];
            vertices.tangents = corner_tangents::of_vertices(mesh, posed, uv);
        }
        vertices
    }
}

/// Vectors of three numbers each.
pub fn vectors(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(Vec3::from_slice).collect()
}

/// Sums of the normals of the triangles that share a vertex, by their areas.
pub fn smooth_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|i| positions[i as usize].as_dvec3());
        let face = (b - a).cross(c - a).as_vec3();
        for i in triangle {
            normals[*i as usize] += face;
        }
    }
    normals
}
