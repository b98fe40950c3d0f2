//! Reads a glTF primitive into a [`Mesh`]: validates attributes, triangulates strips and fans,
//! repairs or drops broken geometry with a warning.

use std::sync::Arc;

use glam::{Vec2, Vec3, Vec4};

use super::{
    Fault, Notes,
    accessor::{self, Component, Data},
    lenient::{LeftOut, forgiven},
    morph,
    primitive_context::Context,
    repair,
    schema::Primitive,
    skin, splats, wire,
};
use crate::{
    Mesh,
    deform::{Deformation, Vertices},
    reach::{MAX_REACH_M, TOO_FAR, too_far},
};

/// Reads a primitive; `None` where it shows nothing. Points and lines become capsules.
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
    context.num_vertices = data.count(position).map_err(|f| f.placed("POSITION"))?;
    let num_corners = match primitive.indices {
        Some(index) => data.count(index).map_err(|f| f.placed("indices"))?,
        None => context.num_vertices,
    };
    data.spend(own_bytes(&context, context.num_vertices, num_corners))?;
    let mut corners = match primitive.indices {
        Some(index) => indices(data, index, context.num_vertices)?,
        None => (0..vertex_count(context.num_vertices)?).collect(),
    };
    context.rows = used_rows(&mut corners, context.num_vertices);
    let mut mesh = Mesh {
        name,
        positions: vectors(
            context.floats(position, accept),
            "POSITION",
            Vec3::from_array,
        )?,
        ..Mesh::default()
    };
    check_reach(&mesh.positions)?;
    read_attributes(&context, &mut mesh, notes)?;
    if !has_faces(primitive) {
        let deformation = deformation(&context, &mesh.name, notes)?;
        pose_at_rest(&context, deformation, &mut mesh);
        let width_m = width_m(primitive).or(splats::read(&context, &mut mesh, notes)?);
        wire::build(&mut mesh, mode, &corners, width_m, data)?;
        repair::run(&mut mesh, notes);
    } else {
        mesh.triangles = triangles(mode, &corners);
        if context.is_mirrored {
            mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        drop(corners);
        deform(&context, &mut mesh, notes)?;
    }
    check_reach(&mesh.positions)?;
    if mesh.triangles.is_empty() {
        let what = "primitives have no point, line or triangle to show";
        notes.add("mesh-empty", 1, what, &mesh.name);
        return Ok(None);
    }
    Ok(Some(mesh))
}

/// Refuses vertices that are too far away for trees; no triangle keeps a vertex that is not finite.
fn check_reach(positions: &[Vec3]) -> Result<(), Fault> {
    let is_far = |p: &Vec3| p.is_finite() && p.abs().max_element() > MAX_REACH_M;
    let Some(at) = positions.iter().position(is_far) else {
        return Ok(());
    };
    let text = too_far(&format!("vertex {at} at {:?}", positions[at].to_array()));
    Err(Fault::new(TOO_FAR, text).help("scale the model down"))
}

/// Joints and morph targets of the primitive; `mesh` is for messages.
fn deformation(context: &Context<'_>, mesh: &str, notes: &mut Notes) -> Result<Deformation, Fault> {
    let influences = match context.pose {
        Some(pose) => skin::influences(context, pose.len())?,
        None => Vec::new(),
    };
    if context.pose.is_some() && influences.is_empty() {
        let what = "meshes have a skin without JOINTS_0 and WEIGHTS_0, which moves nothing";
        notes.add("attribute-left-out", 1, what, mesh);
    }
    Ok(Deformation {
        targets: morph::targets(context, mesh, notes)?,
        influences,
        ..Deformation::default()
    })
}

fn pose_at_rest(context: &Context<'_>, mut deformation: Deformation, mesh: &mut Mesh) {
    if !deformation.is_empty() {
        let joints = context.pose.unwrap_or_default();
        deformation.bind = Vertices::of_mesh(mesh, &deformation.targets);
        mesh.set_vertices(deformation.pose(&[], context.weights, joints));
    }
}

/// Poses a mesh at rest and repairs it; a mesh that animations deform keeps its deformation.
fn deform(context: &Context<'_>, mesh: &mut Mesh, notes: &mut Notes) -> Result<(), Fault> {
    /// Bytes per vertex of the undeformed attributes and of four joints with their weights.
    const DEFORMED_BYTES: u64 = 64;
    let deformation = deformation(context, &mesh.name, notes)?;
    let morphs = context.has_animated_weights && !context.primitive.targets.is_empty();
    if deformation.is_empty() || !(morphs || context.has_animated_joints) {
        pose_at_rest(context, deformation, mesh);
        repair::run(mesh, notes);
        return Ok(());
    }
    (context.data).spend(mesh.positions.len() as u64 * DEFORMED_BYTES)?;
    mesh.deformation = Some(Arc::new(deformation));
    repair::run(mesh, notes);
    let posed = mesh.pose(context.weights, context.pose.unwrap_or_default());
    if !posed.positions.iter().all(|p| p.is_finite()) {
        // The rest pose is not finite: its broken triangles are dropped, and the mesh is no longer deformed.
        mesh.deformation = None;
        mesh.set_vertices(posed);
        repair::run(mesh, notes);
        return Ok(());
    }
    mesh.set_vertices(posed);
    Ok(())
}

/// Whether the corners are so few that only the vertices that they use are read.
pub fn uses_few(num_corners: usize, num_vertices: usize) -> bool {
    num_corners <= num_vertices / 2
}

/// The vertices that `corners` use, if there are at most half as many corners as vertices; `corners` become indices
/// into them. Many primitives may share the vertices of a whole file.
fn used_rows(corners: &mut [u32], num_vertices: usize) -> Option<Vec<u32>> {
    if !uses_few(corners.len(), num_vertices) {
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

/// Bytes that the mesh takes beyond its decoded attributes.
pub fn own_bytes(context: &Context<'_>, num_vertices: usize, num_corners: usize) -> u64 {
    /// Bytes per vertex of texture coordinates, which are zeros without an attribute.
    const UV_BYTES: u64 = 8;
    /// Bytes per corner of positions, normals and coordinates, where flat shading gives each corner a vertex.
    const FLAT_BYTES: u64 = 32;
    /// Bytes of a corner's index.
    const INDEX_BYTES: u64 = 4;
    let vertices = num_vertices.min(num_corners) as u64;
    let is_flat =
        has_faces(context.primitive) && !context.primitive.attributes.contains_key("NORMAL");
    let corner_bytes = INDEX_BYTES + if is_flat { FLAT_BYTES } else { 0 };
    vertices * UV_BYTES + num_corners as u64 * corner_bytes
}

/// glTF's mode of triangle lists; lower modes are points and lines.
pub const TRIANGLES: u32 = 4;

/// Whether a primitive is of triangles, not of points or lines.
fn has_faces(primitive: &Primitive) -> bool {
    primitive.mode.is_none_or(|mode| mode >= TRIANGLES)
}

/// Whether a primitive is unlit, as points and lines without normals are (glTF 2.0 §3.9.7); round ones are not.
pub fn is_without_light(primitive: &Primitive) -> bool {
    let has_normals = primitive.attributes.contains_key("NORMAL");
    !has_faces(primitive) && !has_normals && width_m(primitive).is_none()
}

/// Diameter of points and lines in the file of a stage that gives it, in meters.
fn width_m(primitive: &Primitive) -> Option<f64> {
    (primitive.extras.get("width_m")).and_then(serde_json::Value::as_f64)
}

/// Accessor of the positions, and mode of the primitive; `None`, with a warning, without positions.
fn shown(
    primitive: &Primitive,
    name: &str,
    notes: &mut Notes,
) -> Result<Option<(usize, u32)>, Fault> {
    let mode = primitive.mode.unwrap_or(TRIANGLES);
    if mode > 6 {
        let text = format!("mode {mode} is unknown, expected 0 to 6");
        return Err(Fault::new("gltf-mode", text));
    }
    let position = primitive.attributes.get("POSITION").copied();
    if position.is_none() {
        let what = "primitives without POSITION are not shown";
        notes.add("positions-missing", 1, what, name);
    }
    Ok(position.map(|position| (position, mode)))
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
    let raw = raw.map_err(|f| f.placed(attribute))?;
    Ok(raw.into_iter().map(convert).collect())
}

/// Reads all attributes but the positions; a wrong one is left out where the load forgives that.
fn read_attributes(context: &Context<'_>, mesh: &mut Mesh, notes: &mut Notes) -> Result<(), Fault> {
    let direction = match context.quantized {
        true => accessor::float_or_signed,
        false => accessor::float_only,
    };
    let coordinate = match context.quantized {
        true => accessor::any_but_u32,
        false => accessor::float_or_unsigned,
    };
    let (name, mut reader) = (mesh.name.clone(), Attributes { context, notes });
    mesh.normals = reader.read(&name, "NORMAL", direction, Vec3::from_array)?;
    // Without normals the specification says to ignore tangents.
    if !mesh.normals.is_empty() {
        mesh.tangents = reader.read(&name, "TANGENT", direction, Vec4::from_array)?;
    }
    let [first, second] = context.uv_sets.map(|set| format!("TEXCOORD_{set}"));
    mesh.uv0 = reader.read(&name, &first, coordinate, Vec2::from_array)?;
    mesh.uv1 = reader.read(&name, &second, coordinate, Vec2::from_array)?;
    // Capsules have no texture coordinates where the file has none.
    if mesh.uv0.is_empty() && has_faces(context.primitive) {
        mesh.uv0 = vec![Vec2::ZERO; mesh.positions.len()];
    }
    mesh.colors = reader.colors(&name)?;
    Ok(())
}

/// Name of the warning about wrong attributes.
pub const LEFT_OUT: &str = "attribute-left-out";
/// Text of that warning.
pub const LEFT_OUT_WHAT: &str = "attributes of meshes are wrong and left out";

/// Reader of attributes that only change the look.
struct Attributes<'a, 'n> {
    context: &'a Context<'a>,
    notes: &'n mut Notes,
}

impl Attributes<'_, '_> {
    /// Values of an attribute; empty where the primitive lacks it, or it is wrong and left out. `mesh` is for messages.
    fn read<T, const N: usize>(
        &mut self,
        mesh: &str,
        attribute: &str,
        accept: fn(Component, bool) -> bool,
        convert: fn([f32; N]) -> T,
    ) -> Result<Vec<T>, Fault> {
        let context = self.context;
        let read = context.attribute(attribute).and_then(|index| {
            let read = |i| vectors(context.floats::<N>(i, accept), attribute, convert);
            index.map_or(Ok(Vec::new()), read)
        });
        let left_out = LeftOut {
            name: LEFT_OUT,
            what: LEFT_OUT_WHAT,
            place: mesh,
        };
        forgiven(context.root, read, Vec::new(), &left_out, self.notes)
    }

    /// Colors of vertices; integers that are not normalized are taken as if they were.
    fn colors(&mut self, mesh: &str) -> Result<Vec<Vec4>, Fault> {
        let (context, name) = (self.context, "COLOR_0");
        let index = context.primitive.attributes.get(name).copied();
        let layout = index.and_then(|index| context.data.layout(index).ok());
        let is_normalized = index.and_then(|index| context.data.accessor(index).ok());
        let is_normalized = is_normalized.is_none_or(|accessor| accessor.normalized);
        let most = match layout.as_ref().map(|layout| layout.component) {
            Some(Component::U8) if !is_normalized => 255.0,
            Some(Component::U16) if !is_normalized => 65535.0,
            _ => 1.0,
        };
        let is_forgiven = most > 1.0 && context.root.is_lenient;
        let accept: fn(Component, bool) -> bool = match is_forgiven {
            true => accessor::any_but_u32,
            false => accessor::float_or_unsigned,
        };
        let what =
            "colors of vertices are integers that are not normalized, and taken as if they were";
        self.notes
            .add("color-unnormalized", is_forgiven.into(), what, mesh);
        let is_opaque = layout.is_some_and(|layout| layout.lanes == 3);
        let opaque = |[r, g, b]: [f32; 3]| Vec4::new(r, g, b, 1.0);
        let mut colors = match is_opaque {
            true => self.read(mesh, name, accept, opaque)?,
            false => self.read(mesh, name, accept, Vec4::from_array)?,
        };
        if is_forgiven {
            for color in &mut colors {
                let alpha = if is_opaque { 1.0 } else { color.w / most };
                *color = (color.truncate() / most).extend(alpha);
            }
        }
        Ok(colors)
    }
}

fn indices(data: &Data<'_>, index: usize, vertices: usize) -> Result<Vec<u32>, Fault> {
    let corners = data.indices(index).map_err(|f| f.placed("indices"))?;
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
