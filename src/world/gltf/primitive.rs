//! Reads a glTF primitive into a [`Mesh`]: validates attributes, triangulates strips and fans,
//! repairs or drops broken geometry with a warning.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};

use super::{
    Fault, Notes,
    accessor::{self, Data},
    morph,
    primitive_context::Context,
    repair,
    schema::Primitive,
    skin,
};
use crate::world::{
    Mesh,
    deform::{Deformation, Vertices},
};

/// Reads a primitive; `None` without triangles (points, lines, no positions).
///
/// # Errors
/// Accessors of wrong type or count, indices out of range, an unknown mode.
pub fn build(
    mut context: Context<'_>,
    name: String,
    notes: &mut Notes,
) -> Result<Option<Mesh>, Fault> {
    let (data, primitive) = (context.data, context.primitive);
    let Some((position, mode)) = shown(primitive, &name, notes)? else {
        return Ok(None);
    };
    let accept = match context.quantized {
        true => accessor::any_but_u32,
        false => accessor::float_only,
    };
    context.num_vertices = data.count(position).map_err(|f| f.at("POSITION"))?;
    let mut corners = match primitive.indices {
        Some(index) => indices(data, index, context.num_vertices)?,
        None => (0..vertex_count(context.num_vertices)?).collect(),
    };
    context.rows = used_rows(&mut corners, context.num_vertices);
    spend(&context, corners.len())?;
    let mut mesh = Mesh {
        name,
        positions: vectors(
            context.floats(position, accept),
            "POSITION",
            Vec3::from_array,
        )?,
        ..Mesh::default()
    };
    read_attributes(&context, &mut mesh)?;
    mesh.triangles = triangles(mode, &corners);
    drop(corners);
    deform(&context, &mut mesh, notes)?;
    if mesh.triangles.is_empty() {
        let what = "primitives have no triangle to show";
        notes.add("mesh-empty", 1, what, &mesh.name);
        return Ok(None);
    }
    Ok(Some(mesh))
}

/// Repairs a mesh in its rest pose; what animations deform keeps what it is deformed by.
fn deform(context: &Context<'_>, mesh: &mut Mesh, notes: &mut Notes) -> Result<(), Fault> {
    let morphs = context.has_animated_weights && !context.primitive.targets.is_empty();
    let is_animated = morphs || context.has_animated_joints;
    let joints = context.pose.unwrap_or_default();
    let influences = match context.pose {
        Some(pose) => skin::influences(context, pose.len())?,
        None => Vec::new(),
    };
    let mut deformation = Deformation {
        targets: morph::targets(context, context.has_animated_weights)?,
        influences,
        ..Deformation::default()
    };
    let is_still = deformation.targets.is_empty() && deformation.influences.is_empty();
    if !is_still && is_animated {
        mesh.deformation = Some(Arc::new(deformation));
        repair::run(mesh, notes);
        let posed = mesh.pose(context.weights, joints);
        if posed.positions.iter().all(|p| p.is_finite()) {
            mesh.set_vertices(posed);
            return Ok(());
        }
        // Triangles that the rest pose breaks are dropped, and the rest does not move.
        mesh.deformation = None;
        mesh.set_vertices(posed);
    } else if !is_still {
        deformation.bind = Vertices::take(mesh);
        mesh.set_vertices(deformation.pose(&[], context.weights, joints));
    }
    repair::run(mesh, notes);
    Ok(())
}

/// The vertices that `corners` use, if they are at most half of all; `corners` become indices
/// into them. Many primitives may share the vertices of a whole file.
fn used_rows(corners: &mut [u32], num_vertices: usize) -> Option<Vec<u32>> {
    if corners.len() > num_vertices / 2 {
        return None;
    }
    let mut rows = corners.to_vec();
    rows.sort_unstable();
    rows.dedup();
    for corner in corners {
        // Every corner is among the rows.
        *corner = rows.binary_search(corner).map_or(0, |row| row as u32);
    }
    Some(rows)
}

/// Takes from the budget what the mesh will hold beyond the attributes that are decoded.
fn spend(context: &Context<'_>, num_corners: usize) -> Result<(), Fault> {
    /// Texture coordinates, which are zeros without an attribute.
    const UV_BYTES: u64 = 8;
    /// Positions, normals and coordinates where flat shading gives each corner a vertex.
    const FLAT_BYTES: u64 = 32;
    /// Of a corner of a triangle.
    const INDEX_BYTES: u64 = 4;
    let vertices = context.rows.as_ref().map_or(context.num_vertices, Vec::len) as u64;
    let flat = !context.primitive.attributes.contains_key("NORMAL");
    let corner_bytes = INDEX_BYTES + if flat { FLAT_BYTES } else { 0 };
    context
        .data
        .spend(vertices * UV_BYTES + num_corners as u64 * corner_bytes)
}

/// The accessor of the positions and the mode, if the primitive has triangles; notes why not.
fn shown(
    primitive: &Primitive,
    name: &str,
    notes: &mut Notes,
) -> Result<Option<(usize, u32)>, Fault> {
    let mode = primitive.mode.unwrap_or(4);
    let mut note = |kind, what| notes.add(kind, 1, what, name);
    let position = primitive.attributes.get("POSITION").copied();
    match mode {
        0 => note("points-skipped", "primitives of points are not shown"),
        1..=3 => note("lines-skipped", "primitives of lines are not shown"),
        4..=6 if position.is_none() => {
            note(
                "positions-missing",
                "primitives without POSITION are not shown",
            );
        }
        4..=6 => return Ok(position.map(|position| (position, mode))),
        _ => {
            let text = format!("mode {mode} is unknown, expected 0 to 6");
            return Err(Fault::new("gltf-mode", text));
        }
    }
    Ok(None)
}

fn vertex_count(num_vertices: usize) -> Result<u32, Fault> {
    let text = "more than 2³² vertices in one primitive";
    u32::try_from(num_vertices).map_err(|_| Fault::new("geometry-too-large", text))
}

fn vectors<T, const N: usize>(
    raw: Result<Vec<[f32; N]>, Fault>,
    attribute: &str,
    convert: fn([f32; N]) -> T,
) -> Result<Vec<T>, Fault> {
    let raw = raw.map_err(|f| f.at(attribute))?;
    Ok(raw.into_iter().map(convert).collect())
}

fn read_attributes(context: &Context<'_>, mesh: &mut Mesh) -> Result<(), Fault> {
    let (data, quantized, count) = (context.data, context.quantized, mesh.positions.len());
    let find = |attribute: &str| context.attribute(attribute);
    let direction = if quantized {
        accessor::float_or_signed
    } else {
        accessor::float_only
    };
    let coordinate = if quantized {
        accessor::any_but_u32
    } else {
        accessor::float_or_unsigned
    };
    if let Some(i) = find("NORMAL")? {
        mesh.normals = vectors(
            context.floats::<3>(i, direction),
            "NORMAL",
            Vec3::from_array,
        )?;
        // Without normals the specification says to ignore tangents.
        if let Some(i) = find("TANGENT")? {
            mesh.tangents = vectors(
                context.floats::<4>(i, direction),
                "TANGENT",
                Vec4::from_array,
            )?;
        }
    }
    mesh.uv0 = match find("TEXCOORD_0")? {
        Some(i) => vectors(
            context.floats::<2>(i, coordinate),
            "TEXCOORD_0",
            Vec2::from_array,
        )?,
        None => vec![Vec2::ZERO; count],
    };
    if let Some(i) = find("TEXCOORD_1")? {
        mesh.uv1 = vectors(
            context.floats::<2>(i, coordinate),
            "TEXCOORD_1",
            Vec2::from_array,
        )?;
    }
    if let Some(i) = find("COLOR_0")? {
        let accept = accessor::float_or_unsigned;
        mesh.colors = match data.lanes(i) {
            3 => vectors(context.floats::<3>(i, accept), "COLOR_0", |[r, g, b]| {
                Vec4::new(r, g, b, 1.0)
            })?,
            _ => vectors(context.floats::<4>(i, accept), "COLOR_0", Vec4::from_array)?,
        };
    }
    Ok(())
}

fn indices(data: &Data<'_>, index: usize, vertices: usize) -> Result<Vec<u32>, Fault> {
    let corners = data.indices(index).map_err(|f| f.at("indices"))?;
    if let Some((at, bad)) = corners
        .iter()
        .enumerate()
        .find(|(_, c)| **c as usize >= vertices)
    {
        let text =
            format!("index {bad} at position {at} is out of range, there are {vertices} vertices");
        return Err(Fault::new("gltf-index", text));
    }
    Ok(corners)
}

/// glTF 2.0 §3.7.2.1: triangle lists, strips and fans; incomplete triangles at the end are ignored.
fn triangles(mode: u32, corners: &[u32]) -> Vec<[u32; 3]> {
    let windows = || corners.windows(3).enumerate();
    match (mode, corners) {
        (5, _) => (windows().map(|(i, w)| {
            if i % 2 == 0 {
                [w[0], w[1], w[2]]
            } else {
                [w[1], w[0], w[2]]
            }
        }))
        .collect(),
        (6, [hub, rim @ ..]) => rim.windows(2).map(|w| [*hub, w[0], w[1]]).collect(),
        _ => corners
            .chunks_exact(3)
            .map(|c| [c[0], c[1], c[2]])
            .collect(),
    }
}
