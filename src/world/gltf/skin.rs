//! Skins: joints, and their weights at each vertex.

use glam::{Affine3A, Mat4};

use super::{
    Fault,
    accessor::{self, Component, Data},
    node::Visit,
    primitive_context::Context,
    schema::Root,
};
use crate::deform::{Influences, Joint};

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-skin", text)
}

/// The joints of a skin with their inverse bind matrices (glTF 2.0 §3.7.3.3).
pub fn joints(
    root: &Root,
    data: &Data<'_>,
    visit: &Visit,
    skin: usize,
) -> Result<Vec<Joint>, Fault> {
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
    let joint = |(&node, bind): (&usize, &[f32; 16])| {
        if visit.model_from_node(node).is_none() {
            return Err(fault(format!("joint {node} is not a node of the scene")));
        }
        Ok(Joint {
            node,
            node_from_mesh: Affine3A::from_mat4(Mat4::from_cols_array(bind)),
        })
    };
    skin.joints.iter().zip(&bind).map(joint).collect()
}

/// Sets of four joints and weights of each vertex.
///
/// # Errors
/// Attributes of wrong type or count, joints that the skin lacks.
pub fn influences(context: &Context<'_>, num_joints: usize) -> Result<Vec<Vec<Influences>>, Fault> {
    let mut sets = Vec::new();
    for set in 0.. {
        let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
        let (Some(j), Some(w)) = (context.attribute(&joints)?, context.attribute(&weights)?) else {
            break;
        };
        let joint_type =
            |c, normalized: bool| !normalized && matches!(c, Component::U8 | Component::U16);
        let joints = (context.floats::<4>(j, joint_type)).map_err(|f| f.placed(&joints))?;
        let weights = (context.floats::<4>(w, accessor::float_or_unsigned))
            .map_err(|f| f.placed(&weights))?;
        let of_vertex = |(joints, weights): ([f32; 4], [f32; 4])| {
            // Slots with weight 0 are unused and may name any joint.
            let is_missing =
                |(joint, weight): &(&f32, &f32)| **weight != 0.0 && **joint as usize >= num_joints;
            if let Some((joint, _)) = joints.iter().zip(&weights).find(is_missing) {
                let text = format!("joint {joint} is used, the skin has {num_joints}");
                return Err(fault(text));
            }
            Ok(Influences {
                // Integers of at most 16 bits, exact in f32.
                joints: joints.map(|joint| joint as u16),
                weights,
            })
        };
        let set: Result<_, _> = joints.into_iter().zip(weights).map(of_vertex).collect();
        sets.push(set?);
    }
    Ok(sets)
}
