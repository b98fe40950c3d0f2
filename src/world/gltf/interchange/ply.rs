//! PLY: vertices with colors and polygons, or points, in text or binary, by `ply_rs_bw`.

use std::io::Cursor;

use ply_rs_bw::{
    parser::{ParseError, Parser, Reader},
    ply::{Property, PropertyAccess, PropertyAccessResult},
};
use reflet_base::math::linear_from_srgb;

use super::{Fault, Found, Glb, Part, Source, broken, short};

/// First coefficient of spherical harmonics, which the colors of Gaussian splats are written by.
const SH_0: f32 = 0.282_094_8;

/// Reads a model; colors are sRGB, as programs write them.
pub fn read(source: &Source<'_>, found: Found<'_>) -> Result<Glb, Fault> {
    // Further lines repeat the text of the file, with the error of the library's grammar.
    let fault = |e: ParseError| {
        let whole = e.to_string();
        broken(whole.lines().next().unwrap_or_default().to_lowercase())
    };
    let mut reader = Reader::new(Cursor::new(source.bytes));
    let header = Parser::<Vertex>::new()
        .read_header(&mut reader)
        .map_err(fault)?;
    let mut glb = Glb::new();
    let mut part = Part {
        name: "ply".to_owned(),
        material: Some(glb.matte()),
        ..Part::default()
    };
    for (name, element) in &header.elements {
        // Each element has a byte at least, but the list of its values takes more.
        let bytes = element.count as u64 * size_of::<Vertex>() as u64;
        if element.count > source.bytes.len() {
            let text = format!(
                "it declares {} of \"{name}\", more than its bytes",
                element.count
            );
            return Err(broken(text));
        }
        let held = source
            .memory
            .hold(bytes)
            .ok_or_else(|| short(bytes, source.memory))?;
        match name.as_str() {
            "vertex" => {
                let has = |key: &str| element.properties.contains_key(key);
                if !["x", "y", "z"].into_iter().all(has) {
                    return Err(broken("its vertices have no x, y and z".to_owned()));
                }
                let parser = Parser::<Vertex>::new();
                let read = parser.read_payload_for_element(&mut reader, element, &header);
                let vertices = read.map_err(fault)?;
                part.positions = vertices.iter().map(|v| v.position).collect();
                if has("nx") {
                    part.normals = vertices.iter().map(|v| v.normal).collect();
                }
                if UV[0].into_iter().any(has) {
                    part.uvs = vertices.iter().map(|v| v.uv).collect();
                }
                if RGB.into_iter().any(has) || has("f_dc_0") {
                    part.colors = vertices.iter().map(|v| v.color).collect();
                }
                let what = "Gaussian splats are shown as points of their color";
                let splats = u64::from(has("f_dc_0")) * vertices.len() as u64;
                found.notes.add("splats-as-points", splats, what, "vertex");
            }
            "face" => {
                let parser = Parser::<Face>::new();
                let read = parser.read_payload_for_element(&mut reader, element, &header);
                let faces = read.map_err(fault)?;
                let fan = |face: &Face| {
                    let corners = face.0.windows(2).skip(1);
                    let hub = face.0.first().copied().unwrap_or(0);
                    corners.flat_map(|w| [hub, w[0], w[1]]).collect::<Vec<_>>()
                };
                let corners = faces.iter().flat_map(fan);
                part.triangles = Some(corners.collect());
            }
            _ => {
                let parser = Parser::<Face>::new();
                let read = parser.read_payload_for_element(&mut reader, element, &header);
                read.map_err(fault)?;
                let what = "elements of PLY files other than vertices and faces are left out";
                found
                    .notes
                    .add("ply-left-out", element.count as u64, what, name);
            }
        }
        drop(held);
    }
    part.triangles = part.triangles.filter(|triangles| !triangles.is_empty());
    let texture = header
        .comments
        .iter()
        .find_map(|c| c.strip_prefix("TextureFile "));
    if let (Some(name), Some(material)) = (texture, part.material) {
        let texture = glb.texture(name.trim());
        let pbr = &mut glb.json["materials"][material]["pbrMetallicRoughness"];
        pbr["baseColorTexture"]["index"] = texture.into();
    }
    if (texture.is_some() || !part.colors.is_empty())
        && let Some(material) = part.material
    {
        let pbr = &mut glb.json["materials"][material]["pbrMetallicRoughness"];
        pbr["baseColorFactor"] = [1.0; 4].as_slice().into();
    }
    glb.add(&part);
    Ok(glb)
}

/// Names of the two texture coordinates.
const UV: [[&str; 3]; 2] = [["s", "u", "texture_u"], ["t", "v", "texture_v"]];
/// Names of the colors.
const RGB: [&str; 3] = ["red", "green", "blue"];

struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    color: [f32; 4],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self {
            position: [0.0; 3],
            normal: [0.0; 3],
            uv: [0.0; 2],
            color: [1.0; 4],
        }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some((value, most)) = number(&property) else {
            return PropertyAccessResult::Ignored;
        };
        let place = |names: &[&str]| names.iter().position(|known| *known == name);
        if let Some(axis) = place(&["x", "y", "z"]) {
            self.position[axis] = value;
        } else if let Some(axis) = place(&["nx", "ny", "nz"]) {
            self.normal[axis] = value;
        } else if let Some(axis) = UV.iter().position(|names| names.contains(&name)) {
            self.uv[axis] = value;
        } else if let Some(channel) = place(&RGB) {
            self.color[channel] = linear_from_srgb((value / most).clamp(0.0, 1.0));
        } else if let Some(channel) = place(&["f_dc_0", "f_dc_1", "f_dc_2"]) {
            self.color[channel] = linear_from_srgb((0.5 + SH_0 * value).clamp(0.0, 1.0));
        } else if name == "alpha" {
            self.color[3] = value / most;
        } else {
            return PropertyAccessResult::Ignored;
        }
        PropertyAccessResult::Set
    }
}

/// Value of a number, and the value that stands for 1 in colors.
fn number(property: &Property) -> Option<(f32, f32)> {
    Some(match property {
        Property::Char(v) => (f32::from(*v), 127.0),
        Property::UChar(v) => (f32::from(*v), 255.0),
        Property::Short(v) => (f32::from(*v), 32767.0),
        Property::UShort(v) => (f32::from(*v), 65535.0),
        Property::Int(v) => (*v as f32, 255.0),
        Property::UInt(v) => (*v as f32, 255.0),
        Property::Float(v) => (*v, 1.0),
        Property::Double(v) => (*v as f32, 1.0),
        _ => return None,
    })
}

/// Vertices of a polygon. A negative index is one that no file has.
struct Face(Vec<u32>);

impl PropertyAccess for Face {
    fn new() -> Self {
        Self(Vec::new())
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !["vertex_indices", "vertex_index"].contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        fn indices<T: TryInto<u32>>(list: Vec<T>) -> Vec<u32> {
            let index = |v: T| v.try_into().unwrap_or(u32::MAX);
            list.into_iter().map(index).collect()
        }
        self.0 = match property {
            Property::ListChar(list) => indices(list),
            Property::ListUChar(list) => indices(list),
            Property::ListShort(list) => indices(list),
            Property::ListUShort(list) => indices(list),
            Property::ListInt(list) => indices(list),
            Property::ListUInt(list) => list,
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}
