//! Meshes whose vertices move, on the CPU: by morph targets, then linear-blend skinning (glTF 2.0 §3.7.2.2 and
//! §3.7.3.3), or to the positions that a script has set. The vertices depend on the current pose only, not on earlier
//! frames.

use std::{
    mem,
    ops::{AddAssign, Mul},
    sync::Arc,
};

use glam::{Affine3A, Mat3A, Vec2, Vec3, Vec3A, Vec4};

use super::{Mesh, Posed, rig::Player};
use reflet_base::math::Bounds;

mod deformer;
mod scripted;

pub use self::deformer::{DeformedBy, Deformer};
pub use self::scripted::{ScriptedVertices, smooth_normals, vectors};

/// Reorders a list that is parallel to vertices, or empty: its value `i` is the former value `order[i]`.
pub(crate) fn pick<T: Copy>(values: &mut Vec<T>, order: &[u32]) {
    if !values.is_empty() {
        *values = order.iter().map(|&i| values[i as usize]).collect();
    }
}

/// Morph targets and joint weights, or a script, that move the vertices of a mesh; per-vertex lists are parallel to
/// its positions, or empty.
#[derive(Clone, Debug, Default)]
pub struct Deformation {
    /// Vertices before the deformation.
    pub bind: Vertices,
    /// Morph targets whose weight may differ from 0.
    pub targets: Vec<MorphTarget>,
    /// Sets of joints and weights (`JOINTS_n`, `WEIGHTS_n` in glTF), each with four joints of every vertex.
    pub influences: Vec<Vec<Influences>>,
    /// Whether normals are computed from the triangles, none of which share a vertex then.
    pub has_flat_normals: bool,
    /// Vertices that a script may set, if any.
    pub scripted: Option<ScriptedVertices>,
}

/// The attributes that a deformation moves. Texture coordinates and colors are empty where no morph target moves them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vertices {
    /// Positions in object space, meters.
    pub positions: Vec<Vec3>,
    /// Normals of unit length.
    pub normals: Vec<Vec3>,
    /// Tangents in the layout of [`Mesh::tangents`].
    pub tangents: Vec<Vec4>,
    /// First texture coordinates.
    pub uv0: Vec<Vec2>,
    /// Colors.
    pub colors: Vec<Vec4>,
}

/// Offsets of vertices, scaled by a weight.
#[derive(Clone, Debug, Default)]
pub struct MorphTarget {
    /// Index of the target's weight.
    pub index: usize,
    /// Offsets of positions, meters; empty for none.
    pub positions: Vec<Vec3>,
    /// Offsets of normals; empty for none.
    pub normals: Vec<Vec3>,
    /// Offsets of the direction of tangents; empty for none.
    pub tangents: Vec<Vec3>,
    /// Offsets of the first texture coordinates; empty for none.
    pub uv0: Vec<Vec2>,
    /// Offsets of colors; empty for none.
    pub colors: Vec<Vec4>,
}

/// Four joints of a vertex and their weights; a weight of 0 marks an unused slot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Influences {
    /// Indices into the joints of the skin.
    pub joints: [u16; 4],
    /// Weights of the joints; their sum over all joints of a vertex is scaled to 1.
    pub weights: [f32; 4],
}

/// A joint of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Index of the joint's node in the file.
    pub node: usize,
    /// Inverse bind matrix: from the mesh's space to the node's.
    pub node_from_mesh: Affine3A,
}

/// The nodes of a file that deform a mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeformingNodes {
    /// Joints of the mesh's skin; empty without a skin.
    pub joints: Vec<Joint>,
    /// The node whose weights of morph targets are animated.
    pub weights: Option<usize>,
    /// Weights of the morph targets at rest.
    pub rest_weights: Vec<f32>,
}

/// The vertices of a deformed mesh in one pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformed {
    /// Posed vertices, parallel to the mesh's.
    pub vertices: Vertices,
    /// Bounds of the positions.
    pub bounds: Bounds,
    /// Hash of the positions.
    pub hash: u64,
}

/// Weighted sum of joint transforms, and the sum of the weights.
#[derive(Clone, Copy)]
struct Blend {
    linear: Mat3A,
    translation: Vec3A,
    weight: f32,
}

impl Vertices {
    /// Copies the vertices of a mesh, as far as the targets or joints move them.
    pub fn of_mesh(mesh: &Mesh, targets: &[MorphTarget]) -> Self {
        let mut vertices = Self {
            positions: mesh.positions.clone(),
            normals: mesh.normals.clone(),
            tangents: mesh.tangents.clone(),
            ..Self::default()
        };
        if targets.iter().any(|target| !target.uv0.is_empty()) {
            vertices.uv0.clone_from(&mesh.uv0);
        }
        if targets.iter().any(|target| !target.colors.is_empty()) {
            vertices.colors.clone_from(&mesh.colors);
        }
        vertices
    }
}

impl Deformed {
    /// The posed vertices and their bounds.
    pub fn posed(&self) -> Posed<'_> {
        Posed {
            positions: &self.vertices.positions,
            normals: &self.vertices.normals,
            tangents: &self.vertices.tangents,
            uv0: &self.vertices.uv0,
            colors: &self.vertices.colors,
            bounds: self.bounds,
        }
    }
}

impl Mesh {
    /// Replaces the vertices of the mesh and updates its bounds.
    pub fn set_vertices(&mut self, vertices: Vertices) {
        self.bounds = Bounds::around(vertices.positions.iter().copied());
        self.positions = vertices.positions;
        self.normals = vertices.normals;
        self.tangents = vertices.tangents;
        if !vertices.uv0.is_empty() {
            self.uv0 = vertices.uv0;
        }
        if !vertices.colors.is_empty() {
            self.colors = vertices.colors;
        }
    }

    /// Copies the vertices of the mesh to its deformation, as the undeformed ones.
    pub fn bind(&mut self) {
        if let Some(mut deformation) = self.deformation.take() {
            let own = Arc::make_mut(&mut deformation);
            own.bind = Vertices::of_mesh(self, &own.targets);
            self.deformation = Some(deformation);
        }
    }

    /// Swaps the vertices of the mesh with the undeformed vertices of its deformation.
    pub fn swap_bind(&mut self) {
        let Some(mut deformation) = self.deformation.take() else {
            return;
        };
        let bind = &mut Arc::make_mut(&mut deformation).bind;
        mem::swap(&mut self.positions, &mut bind.positions);
        mem::swap(&mut self.normals, &mut bind.normals);
        mem::swap(&mut self.tangents, &mut bind.tangents);
        if !bind.uv0.is_empty() {
            mem::swap(&mut self.uv0, &mut bind.uv0);
        }
        if !bind.colors.is_empty() {
            mem::swap(&mut self.colors, &mut bind.colors);
        }
        self.deformation = Some(deformation);
    }

    /// The vertices in a pose, see [`Deformation::pose`]; none without a deformation.
    pub fn pose(&self, weights: &[f32], joints: &[Affine3A]) -> Vertices {
        let deformation = self.deformation.as_ref();
        deformation.map_or_else(Vertices::default, |deformation| {
            deformation.pose(&self.triangles, weights, joints)
        })
    }
}

impl Deformation {
    /// Whether there are neither morph targets nor joints.
    pub fn is_empty(&self) -> bool {
        self.targets.is_empty() && self.influences.is_empty()
    }

    /// The vertices with these weights of morph targets and these joint transforms, each from the mesh's space to
    /// the model's. Not finite where weights or transforms are not.
    pub fn pose(&self, triangles: &[[u32; 3]], weights: &[f32], joints: &[Affine3A]) -> Vertices {
        let mut vertices = self.bind.clone();
        self.morph(weights, &mut vertices);
        if !self.influences.is_empty() {
            self.skin(joints, &mut vertices);
        }
        if self.has_flat_normals {
            vertices.normals.resize(vertices.positions.len(), Vec3::Y);
            for triangle in triangles {
                let [a, b, c] = triangle.map(|i| vertices.positions[i as usize].as_dvec3());
                if let Some(normal) = (b - a).cross(c - a).try_normalize() {
                    for corner in triangle {
                        vertices.normals[*corner as usize] = normal.as_vec3();
                    }
                }
            }
        } else {
            for (normal, bind) in vertices.normals.iter_mut().zip(&self.bind.normals) {
                *normal = normal.try_normalize().unwrap_or(*bind);
            }
        }
        for (tangent, bind) in vertices.tangents.iter_mut().zip(&self.bind.tangents) {
            let direction = tangent.truncate().try_normalize();
            *tangent = direction.map_or(*bind, |d| d.extend(bind.w));
        }
        vertices
    }

    fn morph(&self, weights: &[f32], vertices: &mut Vertices) {
        for target in &self.targets {
            let weight = weights.get(target.index).copied().unwrap_or(0.0);
            if weight == 0.0 {
                continue;
            }
            fn add<T>(to: &mut [T], offsets: &[T], weight: f32)
            where
                T: Copy + AddAssign + Mul<f32, Output = T>,
            {
                for (value, offset) in to.iter_mut().zip(offsets) {
                    *value += *offset * weight;
                }
            }
            add(&mut vertices.positions, &target.positions, weight);
            add(&mut vertices.normals, &target.normals, weight);
            add(&mut vertices.uv0, &target.uv0, weight);
            add(&mut vertices.colors, &target.colors, weight);
            for (tangent, offset) in vertices.tangents.iter_mut().zip(&target.tangents) {
                *tangent += (*offset * weight).extend(0.0);
            }
        }
    }

    fn blend(&self, vertex: usize, joints: &[Affine3A]) -> Blend {
        let mut blend = Blend {
            linear: Mat3A::ZERO,
            translation: Vec3A::ZERO,
            weight: 0.0,
        };
        for set in &self.influences {
            let of = set[vertex];
            for (joint, weight) in of.joints.into_iter().zip(of.weights) {
                if weight == 0.0 {
                    continue;
                }
                let transform = joints[joint as usize];
                blend.linear += transform.matrix3 * weight;
                blend.translation += transform.translation * weight;
                blend.weight += weight;
            }
        }
        blend
    }

    fn skin(&self, joints: &[Affine3A], vertices: &mut Vertices) {
        for i in 0..vertices.positions.len() {
            let blend = self.blend(i, joints);
            // Weights should sum to 1; vertices without any weight stay where they are.
            if blend.weight <= 0.0 {
                continue;
            }
            let position = Vec3A::from(vertices.positions[i]);
            let moved = (blend.linear * position + blend.translation) / blend.weight;
            vertices.positions[i] = moved.into();
            if let Some(normal) = vertices.normals.get_mut(i) {
                // The cofactor matrix turns normals as the inverse transpose does, singular or not.
                let [x, y, z] = [
                    blend.linear.x_axis,
                    blend.linear.y_axis,
                    blend.linear.z_axis,
                ];
                let cofactor = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
                *normal = (cofactor * Vec3A::from(*normal)).into();
            }
            if let Some(tangent) = vertices.tangents.get_mut(i) {
                let turned = blend.linear * Vec3A::from(tangent.truncate());
                *tangent = turned.extend(tangent.w);
            }
        }
    }

    /// Reorders all per-vertex lists: vertex `i` of the result is the former vertex `order[i]`.
    pub fn gather(&mut self, order: &[u32]) {
        pick(&mut self.bind.positions, order);
        pick(&mut self.bind.normals, order);
        pick(&mut self.bind.tangents, order);
        pick(&mut self.bind.uv0, order);
        pick(&mut self.bind.colors, order);
        if let Some(scripted) = &mut self.scripted {
            pick(&mut scripted.written, order);
        }
        for target in &mut self.targets {
            pick(&mut target.positions, order);
            pick(&mut target.normals, order);
            pick(&mut target.tangents, order);
            pick(&mut target.uv0, order);
            pick(&mut target.colors, order);
        }
        for set in &mut self.influences {
            pick(set, order);
        }
    }
}

impl DeformingNodes {
    /// Whether a player moves any of these joints or weights.
    pub fn are_moved_by(&self, player: &Player) -> bool {
        let moves_joint = |joint: &Joint| player.slot(joint.node).is_some();
        self.joints.iter().any(moves_joint)
            || self.weights.is_some_and(|node| player.moves_weights(node))
    }
}
