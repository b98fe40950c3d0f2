//! OBJ, STL and PLY models as GLB, which the reader of glTF then checks, repairs and shows like any other.

use std::{
    io::Cursor,
    path::{Path, PathBuf},
};

use serde_json::{Value, json};

use super::{Fault, Notes, uri::Sandbox};
use reflet_base::memory::Budget;

mod mtl;
mod obj;
mod ply;

/// Memory that reading a model takes at most, in its own bytes.
const WORKING_BYTES: u64 = 12;

/// Inputs of a reader.
struct Source<'a> {
    bytes: &'a [u8],
    /// Folder of the model.
    folder: &'a Path,
    sandbox: &'a Sandbox,
    memory: &'a Budget,
}

/// Warnings of a reader, and the files that it read beside the model.
pub struct Found<'a> {
    /// Warnings.
    pub notes: &'a mut Notes,
    /// Files.
    pub files: &'a mut Vec<PathBuf>,
}

/// A model as GLB where the ending of its file is of a format that is read here, else its bytes.
///
/// # Errors
/// `model-broken` with the line or the place; `memory-short`.
pub fn as_glb(
    path: &Path,
    bytes: Vec<u8>,
    sandbox: &Sandbox,
    memory: &Budget,
    found: Found<'_>,
) -> Result<Vec<u8>, Fault> {
    let ending = path.extension().and_then(|e| e.to_str());
    let read = match ending.unwrap_or_default().to_ascii_lowercase().as_str() {
        "obj" => obj::read,
        "stl" => read_stl,
        "ply" => ply::read,
        _ => return Ok(bytes),
    };
    let working = bytes.len() as u64 * WORKING_BYTES;
    let _held = memory.hold(working).ok_or_else(|| short(working, memory))?;
    let source = Source {
        bytes: &bytes,
        folder: path.parent().unwrap_or(Path::new(".")),
        sandbox,
        memory,
    };
    Ok(read(&source, found)?.finish())
}

fn short(working: u64, memory: &Budget) -> Fault {
    let left = memory.left();
    let text = format!("reading it takes up to {working} bytes, {left} are left");
    Fault::new("memory-short", text).help("simplify the model")
}

fn broken(text: String) -> Fault {
    Fault::new("model-broken", text).help("copy or export the file again, or export it as `.glb`")
}

/// A GLB file under construction: one node for each part.
struct Glb {
    json: Value,
    bin: Vec<u8>,
}

/// Vertices with the same material; lists of attributes are as long as the positions, or empty.
#[derive(Default)]
struct Part {
    name: String,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    /// Texture coordinates with v up.
    uvs: Vec<[f32; 2]>,
    /// Linear colors with alpha.
    colors: Vec<[f32; 4]>,
    /// Corners of triangles; `None`: the vertices are points.
    triangles: Option<Vec<u32>>,
    material: Option<usize>,
}

impl Glb {
    fn new() -> Self {
        let list = || json!([]);
        Self {
            json: json!({
                "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list()}], "nodes": list(),
                "meshes": list(), "materials": list(), "textures": list(), "images": list(),
                "accessors": list(), "bufferViews": list(), "buffers": [{}],
            }),
            bin: Vec::new(),
        }
    }

    /// Adds to one of the lists; its index.
    fn push(&mut self, list: &str, value: Value) -> usize {
        let Some(list) = self.json[list].as_array_mut() else {
            return 0;
        };
        list.push(value);
        list.len() - 1
    }

    /// Adds a texture of an image file, named from the folder of the model; its index.
    fn texture(&mut self, name: &str) -> usize {
        let encoded = ['%', '#', '?']
            .into_iter()
            .fold(name.to_owned(), |name, c| {
                name.replace(c, &format!("%{:02X}", u32::from(c)))
            });
        let image = self.push("images", json!({"uri": encoded}));
        self.push("textures", json!({"source": image}))
    }

    fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend_from_slice(bytes);
        let view = self.push("bufferViews", view);
        let accessor = json!({
            "bufferView": view, "type": kind, "componentType": component, "count": count,
        });
        self.push("accessors", accessor)
    }

    /// Adds a part, if it has vertices.
    fn add(&mut self, part: &Part) {
        const FLOAT: u32 = 5126;
        const U32: u32 = 5125;
        if part.positions.is_empty() || part.triangles.as_ref().is_some_and(Vec::is_empty) {
            return;
        }
        let count = part.positions.len();
        let uvs: Vec<_> = part.uvs.iter().map(|[u, v]| [*u, 1.0 - v]).collect();
        let mut attributes = json!({});
        for (name, kind, bytes) in [
            ("POSITION", "VEC3", bytemuck::cast_slice(&part.positions)),
            ("NORMAL", "VEC3", bytemuck::cast_slice(&part.normals)),
            ("TEXCOORD_0", "VEC2", bytemuck::cast_slice(&uvs)),
            ("COLOR_0", "VEC4", bytemuck::cast_slice(&part.colors)),
        ] {
            if !bytes.is_empty() {
                attributes[name] = self.accessor(kind, FLOAT, count, bytes).into();
            }
        }
        let mut primitive = json!({"attributes": attributes, "mode": 0});
        if let Some(corners) = &part.triangles {
            let bytes = bytemuck::cast_slice(corners);
            let indices = self.accessor("SCALAR", U32, corners.len(), bytes);
            (primitive["mode"], primitive["indices"]) = (4.into(), indices.into());
        }
        if let Some(material) = part.material {
            primitive["material"] = material.into();
        }
        let mesh = self.push("meshes", json!({"primitives": [primitive]}));
        let node = self.push("nodes", json!({"mesh": mesh, "name": part.name}));
        if let Some(nodes) = self.json["scenes"][0]["nodes"].as_array_mut() {
            nodes.push(node.into());
        }
    }

    /// Adds a matte material for parts whose file has none; its index.
    fn matte(&mut self) -> usize {
        let pbr = json!({"baseColorFactor": [0.8, 0.8, 0.8, 1], "metallicFactor": 0});
        let matte = json!({"name": "matte", "pbrMetallicRoughness": pbr, "doubleSided": true});
        self.push("materials", matte)
    }

    fn finish(mut self) -> Vec<u8> {
        self.json["buffers"][0]["byteLength"] = self.bin.len().into();
        let mut text = self.json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let length = 12 + 8 + text.len() + 8 + self.bin.len();
        let mut glb = Vec::with_capacity(length);
        glb.extend_from_slice(b"glTF");
        let size = |n: usize| (n as u32).to_le_bytes();
        glb.extend([2_u32.to_le_bytes(), size(length), size(text.len())].as_flattened());
        glb.extend_from_slice(b"JSON");
        glb.append(&mut text);
        glb.extend_from_slice(&size(self.bin.len()));
        glb.extend_from_slice(b"BIN\0");
        glb.append(&mut self.bin);
        glb
    }
}

/// STL: triangles without shared vertices, in text or binary, by `stl_io`.
fn read_stl(source: &Source<'_>, _: Found<'_>) -> Result<Glb, Fault> {
    let mut bytes = Cursor::new(source.bytes);
    let triangles = stl_io::create_stl_reader(&mut bytes);
    let triangles = triangles.map_err(|e| broken(format!("the header cannot be read: {e}")))?;
    let mut glb = Glb::new();
    let mut part = Part {
        name: "solid".to_owned(),
        material: Some(glb.matte()),
        ..Part::default()
    };
    for (number, triangle) in triangles.enumerate() {
        let triangle = triangle.map_err(|e| broken(format!("triangle {number}: {e}")))?;
        part.positions.extend(triangle.vertices.map(|v| v.0));
    }
    part.triangles = Some((0..part.positions.len() as u32).collect());
    glb.add(&part);
    Ok(glb)
}
