//! KHR_draco_mesh_compression: primitives are decoded into new buffers, views and accessors, and are read like any
//! other primitive after that.

use std::collections::BTreeMap;

use draco_core::{DecoderBuffer, ErrorKind, Mesh, MeshDecoder};
use rayon::prelude::*;

use self::stream_bounds::StreamBounds;
use super::{
    Fault, Notes,
    accessor::{self, Component, shape},
    budget::GeometryBudget,
    buffer,
    container::Bytes,
    label,
    primitive::{LEFT_OUT, LEFT_OUT_WHAT},
    schema::{Accessor, Buffer, BufferView, Primitive, Root},
    wrong_types::is_geometry,
};
use reflet_base::memory::wave_length;

mod header;
mod stream_bounds;

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-draco", text)
}

/// Index of a mesh and of its primitive.
type Place = (usize, usize);
/// Number of an attribute in its stream, and index of the accessor that it becomes.
type Attribute = (u32, usize);

/// A stream, which is decoded once, and the primitives that share it.
struct Stream {
    bytes: Bytes,
    claim: StreamBounds,
    users: Vec<Place>,
    attributes: Vec<Attribute>,
    /// Most bytes of the decoded accessors.
    kept: u64,
    /// Most further bytes that are taken while it is decoded.
    working: u64,
}

/// Decoded geometry of a stream.
struct Geometry {
    indices: Vec<u8>,
    num_indices: u64,
    num_points: u64,
    /// Bytes of each attribute.
    attributes: Vec<(Attribute, Vec<u8>)>,
    /// Wrong attributes that only change the look, with their errors.
    left_out: Vec<(Attribute, Fault)>,
}

/// Decodes every compressed primitive whose accessors have no uncompressed data. The decoded size that the
/// accessors state is taken from `budget`, and streams that hold more are refused.
///
/// # Errors
/// The first stream that is broken, too large, or lacks an attribute that it should have.
pub fn decompress(
    root: &mut Root,
    buffers: &mut Vec<buffer::Buffer>,
    budget: &GeometryBudget,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let streams = streams(root, buffers)?;
    // Accessors state the decoded size, so the budget is checked before anything is decoded.
    for stream in &streams {
        let fits = budget.take(stream.kept);
        let fits = fits.and_then(|()| budget.hold(stream.working).map(drop));
        fits.map_err(|fault| place_fault(root, stream.users[0], fault))?;
    }
    let shared: &Root = root;
    let decode = |stream: &Stream| {
        decode(shared, stream).map_err(|fault| place_fault(shared, stream.users[0], fault))
    };
    let mut decoded = Vec::with_capacity(streams.len());
    while decoded.len() < streams.len() {
        let rest = &streams[decoded.len()..];
        let working = rest.iter().map(|stream| stream.working);
        let wave = &rest[..wave_length(working.clone(), budget.left())];
        let _held = budget.hold(working.take(wave.len()).sum())?;
        let geometries: Result<Vec<Geometry>, Fault> = wave.par_iter().map(decode).collect();
        decoded.extend(geometries?);
    }
    for (stream, geometry) in streams.iter().zip(decoded) {
        for (attribute, fault) in &geometry.left_out {
            leave_out(root, stream, *attribute);
            let fault = place_fault(root, stream.users[0], fault.clone());
            notes.add(LEFT_OUT, 1, LEFT_OUT_WHAT, &fault.message);
        }
        insert(root, buffers, stream, geometry);
    }
    Ok(())
}

fn place_fault(root: &Root, (m, p): Place, fault: Fault) -> Fault {
    let place = label("mesh", m, root.meshes[m].name.as_deref());
    fault.placed(&format!("{place} primitive {p}"))
}

/// All streams that must be decoded.
fn streams(root: &Root, buffers: &[buffer::Buffer]) -> Result<Vec<Stream>, Fault> {
    let mut streams: BTreeMap<usize, Stream> = BTreeMap::new();
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let Some(draco) = &primitive.extensions.draco else {
                continue;
            };
            if !is_compressed(root, primitive) {
                continue;
            }
            let blame = |fault| place_fault(root, (m, p), fault);
            let claim = StreamBounds::from_accessors(root, primitive).map_err(blame)?;
            let bytes = stream_bytes(root, buffers, draco.buffer_view).map_err(blame)?;
            let stream = streams.entry(draco.buffer_view).or_insert(Stream {
                bytes,
                claim,
                users: Vec::new(),
                attributes: Vec::new(),
                kept: 0,
                working: 0,
            });
            stream.claim = stream.claim.or(claim);
            stream.users.push((m, p));
            let used = draco.attributes.iter();
            let used = used.filter_map(|(name, id)| Some((*id, *primitive.attributes.get(name)?)));
            stream.attributes.extend(used);
        }
    }
    let mut streams: Vec<Stream> = streams.into_values().collect();
    for stream in &mut streams {
        stream.attributes.sort_unstable();
        stream.attributes.dedup();
        let bytes = |(_, accessor): &Attribute| element_bytes(root, *accessor);
        let per_point: u64 = stream.attributes.iter().map(bytes).sum();
        let points = stream.claim.points.saturating_mul(per_point);
        let indices = stream.claim.faces.saturating_mul(3 * 4);
        stream.kept = points.saturating_add(indices);
        let working = stream.claim.working_bytes(&stream.bytes);
        stream.working = working.map_err(|fault| place_fault(root, stream.users[0], fault))?;
    }
    Ok(streams)
}

/// Bytes of an element of an accessor.
fn element_bytes(root: &Root, accessor: usize) -> u64 {
    let found = root.accessors.get(accessor).and_then(|accessor| {
        let size = Component::new(accessor.component_type)?.size();
        shape(&accessor.kind, size).map(|shape| shape.pitch as u64)
    });
    found.unwrap_or(0)
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

fn decode(root: &Root, stream: &Stream) -> Result<Geometry, Fault> {
    let mut buffer = DecoderBuffer::new(&stream.bytes).with_limits(stream.claim.limits());
    let mut mesh = Mesh::new();
    let decoded = MeshDecoder::new().decode(&mut buffer, &mut mesh);
    decoded.map_err(|error| match error.kind() {
        ErrorKind::LimitExceeded => {
            let most = (stream.claim.points, stream.claim.faces);
            fault(format!(
                "its stream holds more than the {} vertices and {} triangles of its accessors",
                most.0, most.1
            ))
        }
        _ => fault(format!("its stream cannot be decoded: {error}")),
    })?;
    let num_points = mesh.num_points();
    for (m, p) in &stream.users {
        let claim = StreamBounds::from_accessors(root, &root.meshes[*m].primitives[*p])?;
        claim.check(num_points, mesh.num_faces())?;
    }
    let corners = mesh.faces().iter().flatten().map(|point| point.0);
    let mut geometry = Geometry {
        indices: corners.flat_map(u32::to_le_bytes).collect(),
        num_indices: 3 * mesh.num_faces() as u64,
        num_points: num_points as u64,
        attributes: Vec::new(),
        left_out: Vec::new(),
    };
    for &(id, index) in &stream.attributes {
        let name = attribute_name(root, stream, (id, index));
        let read = || {
            let accessor = root.accessors.get(index);
            let accessor =
                accessor.ok_or_else(|| fault(format!("accessor {index} does not exist")))?;
            let values = mesh.attribute_by_unique_id(id);
            let values = values.ok_or_else(|| fault(format!("no attribute {id} in it")))?;
            let encoded = encode(accessor, values, num_points);
            encoded.map_err(|fault| fault.placed(&format!("accessor {index}")))
        };
        match read().map_err(|fault| fault.placed(name)) {
            Err(fault) if root.is_lenient && !is_geometry(name) => {
                geometry.left_out.push(((id, index), fault));
            }
            bytes => geometry.attributes.push(((id, index), bytes?)),
        }
    }
    Ok(geometry)
}

/// Name of an attribute in the first primitive that uses it.
fn attribute_name<'a>(root: &'a Root, stream: &Stream, (id, accessor): Attribute) -> &'a str {
    let of_user = |(m, p): &Place| {
        let primitive = &root.meshes[*m].primitives[*p];
        let draco = primitive.extensions.draco.as_ref()?;
        let mut used = draco.attributes.iter();
        let found = used
            .find(|(name, own)| **own == id && primitive.attributes.get(*name) == Some(&accessor));
        found.map(|(name, _)| name.as_str())
    };
    stream.users.iter().find_map(of_user).unwrap_or_default()
}

/// The compressed bytes of a stream.
fn stream_bytes(root: &Root, buffers: &[buffer::Buffer], view: usize) -> Result<Bytes, Fault> {
    let missing = || fault(format!("bufferView {view} does not exist or has no data"));
    let found = root.buffer_views.get(view).ok_or_else(missing)?;
    let buffer = buffers.get(found.buffer).cloned().flatten().transpose()?;
    let start = usize::try_from(found.byte_offset).ok();
    let length = usize::try_from(found.byte_length).ok();
    let range = start.and_then(|start| Some(start..start.checked_add(length?)?));
    (buffer.and_then(|bytes| bytes.slice(range?))).ok_or_else(missing)
}

/// Removes an attribute of a stream from the primitives that use it.
fn leave_out(root: &mut Root, stream: &Stream, (id, accessor): Attribute) {
    for &(m, p) in &stream.users {
        let primitive = &mut root.meshes[m].primitives[p];
        let draco = primitive.extensions.draco.as_ref();
        let own = |name: &String| draco.is_some_and(|d| d.attributes.get(name) == Some(&id));
        (primitive.attributes).retain(|name, index| *index != accessor || !own(name));
    }
}

/// Values of every point in the type of their accessor.
fn encode(
    accessor: &Accessor,
    values: &draco_core::PointAttribute,
    num_points: usize,
) -> Result<Vec<u8>, Fault> {
    accessor::is_well_typed(&accessor.wrong)?;
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

/// Replaces the accessors of the primitives of a stream by uncompressed ones.
fn insert(root: &mut Root, buffers: &mut Vec<buffer::Buffer>, stream: &Stream, geometry: Geometry) {
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
            ..Buffer::default()
        });
        buffers.push(Some(Ok(Bytes::new(bytes))));
        root.accessors.push(Accessor {
            buffer_view: Some(root.buffer_views.len() - 1),
            byte_offset: 0,
            sparse: None,
            ..accessor
        });
        root.accessors.len() - 1
    };
    let mut decoded = BTreeMap::new();
    for (attribute, bytes) in geometry.attributes {
        let accessor = Accessor {
            count: geometry.num_points,
            ..root.accessors[attribute.1].clone()
        };
        decoded.insert(attribute, add(root, bytes, accessor));
    }
    let accessor = Accessor {
        component_type: U32,
        count: geometry.num_indices,
        kind: "SCALAR".to_owned(),
        ..Accessor::default()
    };
    let indices = add(root, geometry.indices, accessor);
    for &(m, p) in &stream.users {
        let primitive = &mut root.meshes[m].primitives[p];
        (primitive.indices, primitive.mode) = (Some(indices), Some(4));
        let Some(draco) = &primitive.extensions.draco else {
            continue;
        };
        for (name, accessor) in &mut primitive.attributes {
            let id = draco.attributes.get(name);
            if let Some(new) = id.and_then(|id| decoded.get(&(*id, *accessor))) {
                *accessor = *new;
            }
        }
    }
}
