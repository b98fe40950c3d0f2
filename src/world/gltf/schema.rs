//! Supported subset of the glTF 2.0 JSON schema as plain data; validated by the modules that use
//! it.

use std::collections::BTreeMap;

use serde::Deserialize;

mod image_light;
mod layers;
mod material;
mod texture_info;

pub use image_light::{ImageLight, ImageLights, SceneExtensions};
pub use layers::{MaterialExtensions, SpecularGlossiness, layer_field};
pub use material::{Image, Material, Sampler, Texture};
pub use texture_info::{TextureInfo, TextureTransform};

/// The whole document.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Root {
    pub asset: Asset,
    pub extensions_used: Vec<String>,
    pub extensions_required: Vec<String>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub samplers: Vec<Sampler>,
    pub cameras: Vec<Camera>,
    pub skins: Vec<Skin>,
    /// Animations, whose channels and samplers are parsed one by one: a broken animation is an error only where it is played.
    pub animations: Vec<serde_json::Value>,
    pub extensions: RootExtensions,
    /// Whether references to parts that the file does not have are dropped.
    #[serde(skip)]
    pub is_lenient: bool,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Asset {
    pub version: Option<serde_json::Value>,
    pub min_version: Option<serde_json::Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: Option<Lights>,
    #[serde(rename = "KHR_materials_variants")]
    pub variants: Option<Variants>,
    #[serde(rename = "EXT_lights_image_based")]
    pub image_lights: Option<ImageLights>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Variants {
    pub variants: Vec<Variant>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Variant {
    pub name: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Lights {
    pub lights: Vec<Light>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Light {
    pub name: Option<String>,
    #[serde(rename = "type")]
    pub kind: String,
    pub color: Option<[f32; 3]>,
    pub intensity: Option<f32>,
    pub range: Option<f32>,
    pub spot: Option<Spot>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Spot {
    pub inner_cone_angle: Option<f32>,
    pub outer_cone_angle: Option<f32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Scene {
    pub nodes: Vec<usize>,
    /// Arbitrary data; the USD converter stores stage metadata here.
    pub extras: serde_json::Value,
    pub extensions: SceneExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Node {
    pub name: Option<String>,
    pub children: Vec<usize>,
    pub matrix: Option<[f32; 16]>,
    pub translation: Option<[f32; 3]>,
    pub rotation: Option<[f32; 4]>,
    pub scale: Option<[f32; 3]>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    /// Weights of the morph targets, in place of the mesh's.
    pub weights: Option<Vec<f32>>,
    pub camera: Option<usize>,
    pub extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub light: Option<NodeLight>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Option<Visibility>,
}

#[derive(Debug, Deserialize)]
pub struct NodeLight {
    pub light: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Instancing {
    pub attributes: BTreeMap<String, usize>,
}

#[derive(Debug, Deserialize)]
pub struct Visibility {
    #[serde(default = "yes")]
    pub visible: bool,
}

fn yes() -> bool {
    true
}

#[derive(Debug, Deserialize)]
pub struct Mesh {
    pub name: Option<String>,
    #[serde(default)]
    pub primitives: Vec<Primitive>,
    /// Weights of the morph targets.
    #[serde(default)]
    pub weights: Vec<f32>,
    #[serde(default)]
    pub extras: serde_json::Value,
}

#[derive(Debug, Deserialize)]
pub struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u32>,
    /// Accessors of the offsets of each morph target, by attribute.
    #[serde(default)]
    pub targets: Vec<BTreeMap<String, usize>>,
    #[serde(default)]
    pub extensions: PrimitiveExtensions,
    /// Arbitrary data; the USD converter stores the width of points and lines here.
    #[serde(default)]
    pub extras: serde_json::Value,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct PrimitiveExtensions {
    #[serde(rename = "KHR_materials_variants")]
    pub variants: Option<VariantMappings>,
    #[serde(rename = "KHR_draco_mesh_compression")]
    pub draco: Option<Draco>,
    #[serde(rename = "KHR_gaussian_splatting")]
    pub splats: Option<Splats>,
}

/// Gaussian splats, whose attributes are beside the primitive's others.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Splats {
    pub color_space: Option<String>,
}

/// A compressed primitive.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Draco {
    /// Buffer view of the stream.
    pub buffer_view: usize,
    /// Unique id of each attribute in the stream, by the attribute's name.
    #[serde(default)]
    pub attributes: BTreeMap<String, u32>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct VariantMappings {
    pub mappings: Vec<VariantMapping>,
}

/// The material that a primitive has in some of [`Variants`].
#[derive(Debug, Deserialize)]
pub struct VariantMapping {
    pub material: usize,
    pub variants: Vec<usize>,
}

#[derive(Clone, Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Sparse>,
    /// Wrong value that `wrong_types` found, with its place, where this stands for an object that cannot be read.
    #[serde(rename = "(wrong)")]
    pub wrong: Option<Box<str>>,
}

#[derive(Clone, Debug, Deserialize)]
pub struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseValues {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
    #[serde(default)]
    pub extensions: BufferViewExtensions,
    /// Wrong value that `wrong_types` found, with its place, where this stands for an object that cannot be read.
    #[serde(rename = "(wrong)")]
    pub wrong: Option<Box<str>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct BufferViewExtensions {
    #[serde(rename = "KHR_meshopt_compression")]
    khr_meshopt: Option<MeshoptCompression>,
    #[serde(rename = "EXT_meshopt_compression")]
    ext_meshopt: Option<MeshoptCompression>,
}

impl BufferViewExtensions {
    /// Parameters of either extension; they differ only in the modes that encoders may write.
    pub fn meshopt(&self) -> Option<&MeshoptCompression> {
        self.khr_meshopt.as_ref().or(self.ext_meshopt.as_ref())
    }
}

/// Position of the compressed bytes of a buffer view, and how they are decoded.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct MeshoptCompression {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: u64,
    pub count: u64,
    pub mode: String,
    pub filter: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Buffer {
    pub byte_length: u64,
    pub uri: Option<String>,
    /// Wrong value that `wrong_types` found, with its place, where this stands for an object that cannot be read.
    #[serde(rename = "(wrong)")]
    pub wrong: Option<Box<str>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Skin {
    pub inverse_bind_matrices: Option<usize>,
    pub joints: Vec<usize>,
}

#[derive(Debug, Deserialize)]
pub struct Channel {
    pub sampler: usize,
    pub target: ChannelTarget,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct ChannelTarget {
    pub node: Option<usize>,
    pub path: String,
    pub extensions: ChannelTargetExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct ChannelTargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub pointer: Option<AnimationPointer>,
}

#[derive(Debug, Deserialize)]
pub struct AnimationPointer {
    pub pointer: String,
}

#[derive(Debug, Deserialize)]
pub struct AnimationSampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: Option<String>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Camera {
    pub name: Option<String>,
    #[serde(rename = "type")]
    pub kind: Option<String>,
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
    pub extras: serde_json::Value,
}

#[derive(Debug, Deserialize)]
pub struct Perspective {
    pub yfov: f32,
    pub znear: f32,
}

#[derive(Debug, Deserialize)]
pub struct Orthographic {
    pub ymag: f32,
    pub znear: f32,
}
