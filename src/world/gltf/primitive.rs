//! One glTF primitive becomes one [`Mesh`]: attributes checked against each other, strips and fans
//! cut into triangles, broken geometry repaired or dropped with a note.

use glam::{Vec2, Vec3, Vec4};

use super::{
    Fault, Notes,
    accessor::{self, Data},
    repair,
    schema::Primitive,
};
use crate::world::Mesh;

/// Reads a primitive; `None` where it has nothing to show (points, lines, no positions).
///
/// # Errors
/// Accessors of wrong type or count, indices out of range, an unknown mode.
pub fn build(
    data: &Data<'_>,
    primitive: &Primitive,
    name: String,
    quantized: bool,
    notes: &mut Notes,
) -> Result<Option<Mesh>, Fault> {
    let mode = primitive.mode.unwrap_or(4);
    match mode {
        0 => notes.add(
            "points-skipped",
            1,
            "primitives of points are not shown",
            &name,
        ),
        1..=3 => notes.add(
            "lines-skipped",
            1,
            "primitives of lines are not shown",
            &name,
        ),
        4..=6 => {}
        _ => {
            return Err(Fault::new(
                "gltf-mode",
                format!("mode {mode} is unknown, expected 0 to 6"),
            ));
        }
    }
    let Some(&position) = primitive.attributes.get("POSITION") else {
        notes.add(
            "positions-missing",
            1,
            "primitives without POSITION are not shown",
            &name,
        );
        return Ok(None);
    };
    if mode < 4 {
        return Ok(None);
    }
    if !primitive.targets.is_empty() {
        notes.add(
            "morph-rest-pose",
            1,
            "primitives with morph targets are shown unmorphed",
            &name,
        );
    }
    let mut mesh = Mesh {
        name,
        positions: vectors(
            data.floats::<3>(
                position,
                if quantized {
                    accessor::any_but_u32
                } else {
                    accessor::float_only
                },
            ),
            "POSITION",
            Vec3::from_array,
        )?,
        ..Mesh::default()
    };
    read_attributes(data, primitive, quantized, &mut mesh)?;
    let corners = match primitive.indices {
        Some(index) => indices(data, index, mesh.positions.len())?,
        None => {
            (0..u32::try_from(mesh.positions.len()).map_err(|_| too_many_vertices())?).collect()
        }
    };
    mesh.triangles = triangles(mode, &corners);
    drop(corners);
    repair::run(&mut mesh, notes);
    if mesh.triangles.is_empty() {
        notes.add(
            "mesh-empty",
            1,
            "primitives have no triangle to show",
            &mesh.name,
        );
        return Ok(None);
    }
    Ok(Some(mesh))
}

fn too_many_vertices() -> Fault {
    Fault::new(
        "geometry-too-large",
        "more than 2³² vertices in one primitive",
    )
}

fn vectors<T, const N: usize>(
    raw: Result<Vec<[f32; N]>, Fault>,
    attribute: &str,
    convert: fn([f32; N]) -> T,
) -> Result<Vec<T>, Fault> {
    let raw = raw.map_err(|f| f.at(attribute))?;
    Ok(raw.into_iter().map(convert).collect())
}

fn read_attributes(
    data: &Data<'_>,
    primitive: &Primitive,
    quantized: bool,
    mesh: &mut Mesh,
) -> Result<(), Fault> {
    let count = mesh.positions.len();
    let find = |attribute: &str| -> Result<Option<usize>, Fault> {
        let Some(&index) = primitive.attributes.get(attribute) else {
            return Ok(None);
        };
        let own = data.count(index).map_err(|f| f.at(attribute))?;
        if own != count {
            let text = format!("{attribute} has {own} elements, POSITION has {count}");
            return Err(Fault::new("gltf-attribute", text));
        }
        Ok(Some(index))
    };
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
        mesh.normals = vectors(data.floats::<3>(i, direction), "NORMAL", Vec3::from_array)?;
        // Without normals the specification says to ignore tangents.
        if let Some(i) = find("TANGENT")? {
            mesh.tangents = vectors(data.floats::<4>(i, direction), "TANGENT", Vec4::from_array)?;
        }
    }
    mesh.uv0 = match find("TEXCOORD_0")? {
        Some(i) => vectors(
            data.floats::<2>(i, coordinate),
            "TEXCOORD_0",
            Vec2::from_array,
        )?,
        None => vec![Vec2::ZERO; count],
    };
    if let Some(i) = find("TEXCOORD_1")? {
        mesh.uv1 = vectors(
            data.floats::<2>(i, coordinate),
            "TEXCOORD_1",
            Vec2::from_array,
        )?;
    }
    if let Some(i) = find("COLOR_0")? {
        let accept = accessor::float_or_unsigned;
        mesh.colors = match data.lanes(i) {
            3 => vectors(data.floats::<3>(i, accept), "COLOR_0", |[r, g, b]| {
                Vec4::new(r, g, b, 1.0)
            })?,
            _ => vectors(data.floats::<4>(i, accept), "COLOR_0", Vec4::from_array)?,
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
            format!("index {bad} at place {at} is out of range, there are {vertices} vertices");
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
