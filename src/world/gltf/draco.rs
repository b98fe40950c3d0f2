//! KHR_draco_mesh_compression: primitives are decoded into new buffers, views and accessors, and are read like any
//! other primitive after that.

use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
use rayon::prelude::*;

use super::{
    Fault,
    accessor::{Component, shape},
    budget::GeometryBudget,
    container::Bytes,
    label,
    schema::{Accessor, Buffer, BufferView, Primitive, Root},
};

/// Maximum number of triangles of a stream, as decoding its connectivity takes some 100 bytes for each.
const MOST_FACES: u64 = 1 << 23;

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-draco", text)
}

/// A decoded accessor: its bytes and number of elements.
struct Decoded {
    bytes: Vec<u8>,
    count: u64,
}

/// Decoded geometry of a primitive.
#[derive(Default)]
struct Geometry {
    indices: Vec<u8>,
    num_indices: u64,
    /// Names and decoded accessors of the attributes.
    attributes: Vec<(String, Decoded)>,
}

/// Decodes every compressed primitive whose accessors have no uncompressed data. The decoded size that the
/// accessors state is taken from `budget`.
///
/// # Errors
/// The first stream that is broken, too large, or lacks an attribute that it should have.
pub fn decompress(
    root: &mut Root,
    buffers: &mut Vec<Option<Bytes>>,
    budget: &GeometryBudget,
) -> Result<(), Fault> {
    let compressed: Vec<(usize, usize)> = (root.meshes.iter().enumerate())
        .flat_map(|(m, mesh)| (0..mesh.primitives.len()).map(move |p| (m, p)))
        .filter(|&(m, p)| is_compressed(root, &root.meshes[m].primitives[p]))
        .collect();
    if compressed.is_empty() {
        return Ok(());
    }
    let shared: &Root = root;
    let at = |(m, p): (usize, usize), fault: Fault| {
        let mesh = &shared.meshes[m];
        let place = label("mesh", m, mesh.name.as_deref());
        fault.at(&format!("{place} primitive {p}"))
    };
    // Accessors state the decoded size, so the budget is checked before anything is decoded.
    let most = budget.left();
    for &(m, p) in &compressed {
        let bytes = claimed_bytes(shared, &shared.meshes[m].primitives[p]);
        budget.take(bytes).map_err(|fault| at((m, p), fault))?;
    }
    let decode = |&(m, p): &(usize, usize)| {
        let primitive = &shared.meshes[m].primitives[p];
        decode(shared, buffers, primitive, most).map_err(|fault| at((m, p), fault))
    };
    let decoded: Result<Vec<Geometry>, Fault> = compressed.par_iter().map(decode).collect();
    for ((m, p), geometry) in compressed.into_iter().zip(decoded?) {
        insert(root, buffers, (m, p), geometry);
    }
    Ok(())
}

/// Whether some accessor of the primitive has no uncompressed data.
fn is_compressed(root: &Root, primitive: &Primitive) -> bool {
    let Some(draco) = &primitive.extensions.draco else {
        return false;
    };
    let attributes = primitive.attributes.iter();
    let named = attributes.filter(|(name, _)| draco.attributes.contains_key(*name));
    let mut accessors = named.map(|(_, index)| *index).chain(primitive.indices);
    accessors.any(|index| {
        let accessor = root.accessors.get(index);
        accessor.is_some_and(|a| a.buffer_view.is_none() && a.sparse.is_none())
    })
}

/// Decoded size of a primitive by the counts of its accessors, bytes.
fn claimed_bytes(root: &Root, primitive: &Primitive) -> u64 {
    let accessors = primitive.attributes.values().chain(&primitive.indices);
    let accessors = accessors.filter_map(|index| root.accessors.get(*index));
    accessors.map(|a| a.count.saturating_mul(4)).sum()
}

fn decode(
    root: &Root,
    buffers: &[Option<Bytes>],
    primitive: &Primitive,
    budget_bytes: u64,
) -> Result<Geometry, Fault> {
    let Some(draco) = &primitive.extensions.draco else {
        return Ok(Geometry::default());
    };
    if !matches!(primitive.mode.unwrap_or(4), 4 | 5) {
        return Err(fault("only triangles can be compressed"));
    }
    let bytes = stream(root, buffers, draco.buffer_view)?;
    let limits = DecodeLimits::default()
        .with_max_points(3 * MOST_FACES)
        .with_max_faces(MOST_FACES)
        .with_max_decoded_bytes(budget_bytes);
    let mut buffer = DecoderBuffer::new(&bytes).with_limits(limits);
    let mut mesh = Mesh::new();
    (MeshDecoder::new().decode(&mut buffer, &mut mesh))
        .map_err(|error| fault(format!("its stream cannot be decoded: {error}")))?;
    let num_points = mesh.num_points();
    let corners = mesh.faces().iter().flatten().map(|point| point.0);
    let mut geometry = Geometry {
        indices: corners.flat_map(u32::to_le_bytes).collect(),
        num_indices: 3 * mesh.num_faces() as u64,
        ..Geometry::default()
    };
    for (name, id) in &draco.attributes {
        let Some(accessor) = primitive.attributes.get(name) else {
            continue;
        };
        let accessor = (root.accessors.get(*accessor))
            .ok_or_else(|| fault(format!("{name}: accessor {accessor} does not exist")))?;
        let values = mesh.attribute_by_unique_id(*id);
        let values = values.ok_or_else(|| fault(format!("{name}: no attribute {id} in it")))?;
        let decoded = Decoded {
            bytes: encode(accessor, values, num_points).map_err(|f| f.at(name))?,
            count: num_points as u64,
        };
        geometry.attributes.push((name.clone(), decoded));
    }
    Ok(geometry)
}

/// The compressed bytes of a stream.
fn stream(root: &Root, buffers: &[Option<Bytes>], view: usize) -> Result<Bytes, Fault> {
    let missing = || fault(format!("bufferView {view} does not exist or has no data"));
    let found = root.buffer_views.get(view).ok_or_else(missing)?;
    let buffer = buffers.get(found.buffer).and_then(Option::as_ref);
    let start = usize::try_from(found.byte_offset).ok();
    let length = usize::try_from(found.byte_length).ok();
    let range = start.and_then(|start| Some(start..start.checked_add(length?)?));
    (buffer.and_then(|bytes| bytes.slice(range?))).ok_or_else(missing)
}

/// Values of every point in the type of their accessor.
fn encode(
    accessor: &Accessor,
    values: &draco_core::PointAttribute,
    num_points: usize,
) -> Result<Vec<u8>, Fault> {
    let component = Component::new(accessor.component_type);
    let component = component.ok_or_else(|| fault("its componentType is unknown"))?;
    let lanes = shape(&accessor.kind, 1).map_or(0, |shape| shape.lanes);
    if lanes != usize::from(values.num_components()) {
        return Err(fault(format!(
            "the stream has {} numbers for each vertex, the accessor is {}",
            values.num_components(),
            super::uri::shorten(&accessor.kind)
        )));
    }
    let values = values.read_f32s(num_points, lanes).into_iter();
    // Casts to integers saturate; values of 8 and 16 bits are exact.
    Ok(match component {
        Component::F32 => values.flat_map(f32::to_le_bytes).collect(),
        Component::I8 => values.flat_map(|v| (v as i8).to_le_bytes()).collect(),
        Component::U8 => values.flat_map(|v| (v as u8).to_le_bytes()).collect(),
        Component::I16 => values.flat_map(|v| (v as i16).to_le_bytes()).collect(),
        Component::U16 => values.flat_map(|v| (v as u16).to_le_bytes()).collect(),
        Component::U32 => values.flat_map(|v| (v as u32).to_le_bytes()).collect(),
    })
}

/// Replaces the accessors of the primitive by uncompressed ones.
fn insert(
    root: &mut Root,
    buffers: &mut Vec<Option<Bytes>>,
    (m, p): (usize, usize),
    geometry: Geometry,
) {
    /// glTF's component type `UNSIGNED_INT`.
    const U32: u32 = 5125;
    let mut add = |root: &mut Root, bytes: Vec<u8>, accessor: Accessor| {
        let byte_length = bytes.len() as u64;
        root.buffer_views.push(BufferView {
            buffer: root.buffers.len(),
            byte_length,
            ..BufferView::default()
        });
        root.buffers.push(Buffer {
            byte_length,
            uri: None,
        });
        buffers.push(Some(Bytes::new(bytes)));
        root.accessors.push(Accessor {
            buffer_view: Some(root.buffer_views.len() - 1),
            byte_offset: 0,
            sparse: None,
            ..accessor
        });
        root.accessors.len() - 1
    };
    for (name, decoded) in geometry.attributes {
        let Some(old) = root.meshes[m].primitives[p].attributes.get(&name).copied() else {
            continue;
        };
        let accessor = Accessor {
            count: decoded.count,
            ..root.accessors[old].clone()
        };
        let new = add(root, decoded.bytes, accessor);
        root.meshes[m].primitives[p].attributes.insert(name, new);
    }
    let accessor = Accessor {
        component_type: U32,
        count: geometry.num_indices,
        kind: "SCALAR".to_owned(),
        ..Accessor::default()
    };
    let indices = add(root, geometry.indices, accessor);
    let primitive = &mut root.meshes[m].primitives[p];
    (primitive.indices, primitive.mode) = (Some(indices), Some(4));
}
