//! Test kit: generates and loads small glTF files.
#![allow(dead_code, reason = "not every test uses every helper")] // each test file uses its own part

use reflet::scene::{
    desc::{At, Entry, ModelDesc, ModelSource, PlacementDesc, StageDesc},
    diagnostic::{Diagnostic, Severity, Span},
};

// Names that most tests of glTF need, beside the functions below.
pub use crate::{
    common::{Random, assert_says, cases, folder::Folder, is_long, sampled},
    work::Most,
};
pub use glam::{Quat, Vec2, Vec3, Vec4};
pub use reflet::{
    scene::{
        desc::{AnimationDesc, InstanceDesc, SceneDesc},
        stages::{Animator, Scene},
    },
    world::{
        World,
        load::{LoadOptions, load},
    },
};
pub use serde_json::{Value, json};
pub use std::{fs, path::Path};

/// A glTF document under construction; its one buffer is GLB's binary chunk.
#[derive(Clone)]
pub struct Doc {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Doc {
    /// An empty document.
    pub fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "accessors": [], "bufferViews": [], "buffers": [{"byteLength": 0}],
            "materials": [], "textures": [], "images": [], "samplers": [],
            "extensionsUsed": [], "extensionsRequired": []
        });
        Self {
            json,
            bin: Vec::new(),
        }
    }

    /// One node with one mesh of one right-angled triangle in z = 0, counter-clockwise.
    pub fn triangle() -> Self {
        let mut doc = Self::empty();
        let positions = doc.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
        let mesh = doc.mesh(json!({"attributes": {"POSITION": positions}}));
        doc.root_node(json!({"name": "wall", "mesh": mesh}));
        doc
    }

    /// Appends to a top-level array and returns the index.
    pub fn add(&mut self, array: &str, value: Value) -> usize {
        let list = self.json[array].as_array_mut().expect("top-level array");
        list.push(value);
        list.len() - 1
    }

    /// Adds a node below no other, and returns its index.
    pub fn node(&mut self, node: Value) -> usize {
        self.add("nodes", node)
    }

    /// Adds a material, and returns its index.
    pub fn material(&mut self, material: Value) -> usize {
        self.add("materials", material)
    }

    /// Adds an image, and returns its index.
    pub fn image(&mut self, image: Value) -> usize {
        self.add("images", image)
    }

    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.json["buffers"][0]["byteLength"] = self.bin.len().into();
        self.add(
            "bufferViews",
            json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}),
        )
    }

    pub fn accessor(&mut self, kind: &str, component: u32, count: usize, bytes: &[u8]) -> usize {
        let view = self.view(bytes);
        self.add(
            "accessors",
            json!({"bufferView": view, "componentType": component, "count": count, "type": kind}),
        )
    }

    pub fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let lanes = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(kind, 5126, values.len() / lanes, &bytes)
    }

    pub fn mesh(&mut self, primitive: Value) -> usize {
        self.add("meshes", json!({"name": "wall", "primitives": [primitive]}))
    }

    pub fn root_node(&mut self, node: Value) -> usize {
        let index = self.node(node);
        self.json["scenes"][0]["nodes"]
            .as_array_mut()
            .expect("nodes")
            .push(index.into());
        index
    }

    /// Adds a node with a mesh of this primitive.
    pub fn show(&mut self, primitive: Value) -> usize {
        let mesh = self.mesh(primitive);
        self.root_node(json!({"mesh": mesh}))
    }

    /// Adds an image in the binary chunk and a texture for it.
    pub fn texture(&mut self, png: &[u8]) -> usize {
        let view = self.view(png);
        let image = self.image(json!({"bufferView": view, "mimeType": "image/png"}));
        self.add("textures", json!({"source": image}))
    }

    /// Sets values by lines of `POINTER = JSON`; an index behind the end of an array appends.
    pub fn set(&mut self, lines: &str) {
        for line in lines.lines() {
            let (pointer, value) = line.split_once(" = ").expect(line);
            let value: Value = serde_json::from_str(value).expect(line);
            let (parent, key) = pointer.rsplit_once('/').expect(line);
            let parent = self.json.pointer_mut(parent).expect(line);
            match (parent.as_array_mut(), key.parse::<usize>()) {
                (Some(list), Ok(index)) if index < list.len() => list[index] = value,
                (Some(list), Ok(_)) => list.push(value),
                _ => parent[key] = value,
            }
        }
    }

    /// Sets a key of the first primitive.
    pub fn primitive(&mut self, key: &str, value: Value) {
        self.json["meshes"][0]["primitives"][0][key] = value;
    }

    pub fn attribute(&mut self, name: &str, accessor: usize) {
        self.json["meshes"][0]["primitives"][0]["attributes"][name] = accessor.into();
    }

    /// Skins the triangle to the first joint alone.
    pub fn hold_by_first_joint(&mut self) {
        let joints = self.accessor("VEC4", 5121, 3, &[0; 12]);
        let weights = self.floats("VEC4", &[1.0, 0.0, 0.0, 0.0].repeat(3));
        self.attribute("JOINTS_0", joints);
        self.attribute("WEIGHTS_0", weights);
    }

    /// Scene of the document, as a file in a folder that goes with the first value.
    pub fn scene(&self) -> (Folder, SceneDesc) {
        let folder = Folder::new();
        folder.write("m.glb", self.glb());
        let desc = scene(&folder.0, "m.glb");
        (folder, desc)
    }

    pub fn glb(&self) -> Vec<u8> {
        // Numbers that JSON lacks stand in strings such as "bare NaN bare".
        let text = self
            .json
            .to_string()
            .replace("\"bare ", "")
            .replace(" bare\"", "");
        let mut json = text.into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend(((12 + 8 + json.len() + 8 + bin.len()) as u32).to_le_bytes());
        out.extend((json.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(json);
        out.extend((bin.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(bin);
        out
    }

    /// Writes the document as GLB and loads it as the model `m`.
    pub fn load(&self) -> Result<World, Vec<Diagnostic>> {
        self.load_with(&strict())
    }

    /// Loads the document with other options.
    pub fn load_with(&self, options: &LoadOptions) -> Result<World, Vec<Diagnostic>> {
        let (_folder, desc) = self.scene();
        load(&desc, options)
    }

    /// Loads the document, which must succeed.
    pub fn world(&self) -> World {
        self.load().expect("valid")
    }

    /// Loads the document, which must be refused with one error; returns its name and message.
    pub fn error(&self) -> (&'static str, String) {
        one_error(self.load())
    }
}

pub fn one_error(result: Result<World, Vec<Diagnostic>>) -> (&'static str, String) {
    let errors = result.expect_err("this must be refused");
    assert_eq!(errors.len(), 1, "{errors:#?}");
    assert_eq!(errors[0].severity, Severity::Error);
    (errors[0].name, errors[0].message.clone())
}

/// Scene in `folder` with `file` as model `m`, with one instance at the origin.
pub fn scene(folder: &Path, file: &str) -> SceneDesc {
    let source = ModelSource::File(unplaced(file));
    let model = ModelDesc {
        source,
        material: None,
        overrides: Vec::new(),
        lights: true,
        variant: None,
        animation: None,
        usd: StageDesc::default(),
    };
    SceneDesc {
        folder: folder.to_owned(),
        models: vec![entry("m", model)],
        ..SceneDesc::default()
    }
}

pub fn load_scene(desc: &SceneDesc) -> Result<World, Vec<Diagnostic>> {
    load(desc, &strict())
}

fn strict() -> LoadOptions {
    LoadOptions {
        strict: true,
        ..LoadOptions::default()
    }
}

/// The triangle in these nodes, of which the scene lists `roots`.
pub fn placed(nodes: Value, roots: &[usize]) -> Doc {
    let mut doc = Doc::triangle();
    doc.json["nodes"] = nodes;
    doc.json["scenes"][0]["nodes"] = json!(roots);
    doc
}

pub fn unplaced(text: &str) -> At<String> {
    At {
        value: text.to_owned(),
        at: Span::default(),
    }
}

pub fn entry<T>(name: &str, value: T) -> Entry<T> {
    Entry {
        name: name.into(),
        at: Span::default(),
        value,
    }
}

/// Names of the warnings, but that about cameras, which many documents place where nothing is seen.
pub fn warnings(world: &World) -> Vec<&'static str> {
    let names = world.warnings.iter().map(|w| w.name);
    names
        .filter(|name| *name != "cameras-see-nothing")
        .collect()
}

/// A PNG of one color.
pub fn png(width: u32, height: u32, rgba: [u8; 4]) -> Vec<u8> {
    let mut out = std::io::Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_pixel(width, height, image::Rgba(rgba));
    picture
        .write_to(&mut out, image::ImageFormat::Png)
        .expect("PNG");
    out.into_inner()
}

/// A triangle with an image as its base color.
pub fn textured(image: &[u8]) -> Doc {
    let mut doc = Doc::triangle();
    let texture = doc.texture(image);
    let pbr = json!({"baseColorTexture": {"index": texture}});
    doc.material(json!({"pbrMetallicRoughness": pbr}));
    doc.primitive("material", 0.into());
    doc
}

/// A file that uses every kind of reference.
pub fn rich() -> Doc {
    let mut doc = Doc::triangle();
    let normals = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(3));
    let uv = doc.floats("VEC2", &[0.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
    let indices = doc.accessor("SCALAR", 5123, 3, &[0, 0, 1, 0, 2, 0]);
    doc.attribute("NORMAL", normals);
    doc.attribute("TEXCOORD_0", uv);
    doc.attribute("TEXCOORD_1", uv);
    doc.primitive("indices", indices.into());
    let texture = doc.texture(&png(4, 4, [128, 128, 255, 255]));
    doc.json["samplers"] = json!([{"wrapS": 10497}]);
    doc.json["textures"][texture]["sampler"] = 0.into();
    let slot = json!({"index": texture, "texCoord": 1});
    doc.material(
        json!({"normalTexture": slot, "pbrMetallicRoughness": {"baseColorTexture": slot}}),
    );
    doc.primitive("material", 0.into());
    let sparse = doc.floats("VEC3", &[0.0; 9]);
    let (targets, values) = (doc.view(&[1, 0, 2, 0]), doc.view(&[0; 24]));
    doc.json["accessors"][sparse]["sparse"] = json!({
        "count": 2, "indices": {"bufferView": targets, "componentType": 5123}, "values": {"bufferView": values}
    });
    let offsets = doc.floats("VEC3", &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0]);
    doc.json["extensions"] =
        json!({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 3}]}});
    doc.json["cameras"] =
        json!([{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]);
    doc.json["extensionsUsed"] = json!(["KHR_lights_punctual", "EXT_mesh_gpu_instancing"]);
    let child = doc.node(json!({"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}));
    doc.root_node(
        json!({"mesh": 0, "translation": [0, 0, 2], "children": [child], "extensions":
        {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": offsets}}}}),
    );
    doc
}

pub fn instance(model: &str) -> InstanceDesc {
    InstanceDesc {
        name: None,
        model: unplaced(model),
        placement: trs(Vec3::ZERO),
        dynamic: false,
        shown: Default::default(),
        repeat: None,
        instances_from: None,
        along: None,
        over: None,
        material: None,
        animation: None,
        joints: Vec::new(),
        morphs: Vec::new(),
        at: Span::default(),
    }
}

pub fn trs(translation: Vec3) -> PlacementDesc {
    PlacementDesc::Trs {
        translation,
        rotation: Quat::IDENTITY,
        scale: Vec3::ONE,
    }
}

/// A triangle with a material "stone" that uses one image as color and as data.
pub fn stone() -> Doc {
    let mut doc = Doc::triangle();
    let texture = doc.texture(&png(3, 2, [10, 20, 30, 40]));
    doc.json["samplers"] = json!([{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}]);
    doc.json["textures"][texture]["sampler"] = 0.into();
    doc.material(json!({
            "name": "stone", "alphaMode": "MASK", "doubleSided": true, "emissiveFactor": [1, 0.5, 0],
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.25, "roughnessFactor": 0.75,
                "baseColorTexture": {"index": texture}, "metallicRoughnessTexture": {"index": texture}
            }
        }),
    );
    doc.primitive("material", 0.into());
    doc
}
