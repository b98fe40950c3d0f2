//! Transforms of nodes and of EXT_mesh_gpu_instancing's copies, checked to be finite.

use glam::{Affine3A, Mat4, Quat, Vec3};

use super::{
    Fault,
    accessor::{self, Data},
    finite,
    schema::{Instancing, Node},
};
use crate::animation::{Local, not_flat, not_flat_matrix};

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-node", text)
}

/// Transform of a node, from its space to its parent's.
pub fn of_node(node: &Node) -> Result<Local, Fault> {
    if let Some(matrix) = &node.matrix {
        let m = Mat4::from_cols_array(matrix);
        let last_row = m.row(3) - glam::Vec4::W;
        if !finite(matrix) || last_row.abs().max_element() > 1e-4 {
            return Err(fault("matrix must be finite with the last row 0 0 0 1"));
        }
        return Ok(Local::Matrix(not_flat_matrix(Affine3A::from_mat4(m))));
    }
    let translation = node.translation.unwrap_or_default();
    let rotation = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.scale.unwrap_or([1.0; 3]);
    compose(translation, rotation, scale)
}

fn compose(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Result<Local, Fault> {
    let rotation = glam::Vec4::from_array(rotation).as_dvec4().try_normalize();
    let Some(rotation) = rotation.filter(|_| finite(&translation) && finite(&scale)) else {
        return Err(fault(
            "translation, rotation and scale must be finite, the rotation not zero",
        ));
    };
    Ok(Local::Trs {
        translation: Vec3::from_array(translation),
        rotation: Quat::from_vec4(rotation.as_vec4()),
        scale: not_flat(Vec3::from_array(scale)),
    })
}

/// EXT_mesh_gpu_instancing: one transform for each element of its attributes,
/// at most `most`.
pub fn of_copies(
    data: &Data<'_>,
    instancing: &Instancing,
    most: usize,
) -> Result<Vec<Affine3A>, Fault> {
    let find = |name: &str| instancing.attributes.get(name).copied();
    let float = accessor::float_only;
    let translations = find("TRANSLATION")
        .map(|i| data.floats::<3>(i, float))
        .transpose()?;
    let rotations = find("ROTATION")
        .map(|i| data.floats::<4>(i, accessor::float_or_signed))
        .transpose()?;
    let scales = find("SCALE")
        .map(|i| data.floats::<3>(i, float))
        .transpose()?;
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let mut counts = counts.into_iter().flatten();
    // With custom attributes only, their element count is the number of copies.
    let any = || {
        instancing
            .attributes
            .values()
            .next()
            .map(|&i| data.count(i))
            .transpose()
    };
    let count = match counts.next() {
        Some(count) => count,
        None => any()?.ok_or_else(|| fault("EXT_mesh_gpu_instancing has no attributes"))?,
    };
    if counts.any(|other| other != count) {
        return Err(fault(
            "EXT_mesh_gpu_instancing: its attributes differ in count",
        ));
    }
    if count > most {
        return Err(Fault::new(
            "instances-too-many",
            format!("{count} instances, at most {most}"),
        ));
    }
    let copy = |k: usize| {
        compose(
            translations.as_ref().map_or([0.0; 3], |v| v[k]),
            rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |v| v[k]),
            scales.as_ref().map_or([1.0; 3], |v| v[k]),
        )
        .map(|local| local.transform())
        .map_err(|f| f.placed(&format!("EXT_mesh_gpu_instancing {k}")))
    };
    (0..count).map(copy).collect()
}
