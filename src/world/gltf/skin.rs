//! Static skinning: vertices in one pose of the file's nodes.

use glam::{Affine3A, Mat3A, Mat4, Vec3, Vec3A, Vec4};

use super::{
    Fault,
    accessor::{self, Component, Data},
    node::Visit,
    primitive_context::Context,
    schema::Root,
};
use crate::world::Mesh;

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-skin", text)
}

/// For each joint of a skin: from the mesh's bind pose to the model (glTF 2.0 §3.7.3.3).
pub fn pose(
    root: &Root,
    data: &Data<'_>,
    visit: &Visit,
    skin: usize,
) -> Result<Vec<Affine3A>, Fault> {
    let skin = root
        .skins
        .get(skin)
        .ok_or_else(|| fault("does not exist"))?;
    let bind = match skin.inverse_bind_matrices {
        Some(i) => data.floats::<16>(i, accessor::float_only)?,
        None => vec![Mat4::IDENTITY.to_cols_array(); skin.joints.len()],
    };
    if bind.len() < skin.joints.len() {
        let (joints, matrices) = (skin.joints.len(), bind.len());
        let text = format!("{joints} joints, but {matrices} inverse bind matrices");
        return Err(fault(text));
    }
    let joint = |(&joint, bind): (&usize, &[f32; 16])| {
        let missing = || fault(format!("joint {joint} is not a node of the scene"));
        let model_from_joint = visit.model_from_joint(joint).ok_or_else(missing)?;
        Ok(model_from_joint * Affine3A::from_mat4(Mat4::from_cols_array(bind)))
    };
    skin.joints.iter().zip(&bind).map(joint).collect()
}

/// A sum of weighted transforms.
#[derive(Clone, Copy, Default)]
struct Blend {
    linear: Mat3A,
    translation: Vec3A,
    weight: f32,
}

/// Moves positions, normals and tangents of `mesh` into the pose.
///
/// # Errors
/// Joint and weight attributes of wrong type or count, joints that the skin lacks.
pub fn apply(context: &Context<'_>, pose: &[Affine3A], mesh: &mut Mesh) -> Result<(), Fault> {
    let zero = Blend {
        linear: Mat3A::ZERO,
        ..Blend::default()
    };
    let mut blends = vec![zero; mesh.positions.len()];
    for set in 0.. {
        let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
        let (Some(j), Some(w)) = (context.attribute(&joints)?, context.attribute(&weights)?) else {
            break;
        };
        let joint_type =
            |c, normalized: bool| !normalized && matches!(c, Component::U8 | Component::U16);
        let joints = (context.floats::<4>(j, joint_type)).map_err(|f| f.at(&joints))?;
        let weights =
            (context.floats::<4>(w, accessor::float_or_unsigned)).map_err(|f| f.at(&weights))?;
        for ((blend, joints), weights) in blends.iter_mut().zip(joints).zip(weights) {
            for (joint, weight) in joints.into_iter().zip(weights) {
                // Unused slots may have any value.
                if weight == 0.0 {
                    continue;
                }
                // Joint numbers are integers of at most 16 bits, exact in f32.
                let transform = pose.get(joint as usize).ok_or_else(|| {
                    fault(format!(
                        "joint {joint} is used, the skin has {}",
                        pose.len()
                    ))
                })?;
                blend.linear += transform.matrix3 * weight;
                blend.translation += transform.translation * weight;
                blend.weight += weight;
            }
        }
    }
    move_vertices(&blends, mesh);
    Ok(())
}

fn move_vertices(blends: &[Blend], mesh: &mut Mesh) {
    // Weights should sum to 1; vertices without any stay where they are.
    let used = |b: &&Blend| b.weight > 0.0;
    let all = || blends.iter().enumerate().filter(|(_, b)| used(b));
    for (i, b) in all() {
        let position = Vec3A::from(mesh.positions[i]);
        mesh.positions[i] = Vec3::from((b.linear * position + b.translation) / b.weight);
    }
    for (i, b) in all() {
        if let Some(normal) = mesh.normals.get_mut(i) {
            // The cofactor matrix turns normals as the inverse transpose does, singular or not.
            let [x, y, z] = [b.linear.x_axis, b.linear.y_axis, b.linear.z_axis];
            let cofactor = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
            *normal = Vec3::from(cofactor * Vec3A::from(*normal)).normalize_or_zero();
        }
        if let Some(tangent) = mesh.tangents.get_mut(i) {
            let turned = Vec3::from(b.linear * Vec3A::from(tangent.truncate()));
            *tangent = Vec4::from((turned.normalize_or_zero(), tangent.w));
        }
    }
}
