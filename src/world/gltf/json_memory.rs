//! Memory that the JSON of a file becomes, before it is parsed into structs: `{}` is 3 bytes of text, a material more
//! than a thousand of memory.

use serde::{Deserialize, de::IgnoredAny};

use super::schema::{
    Accessor, Asset, BufferView, Image, Material, Mesh, Node, Primitive, Skin, Texture,
};

/// Copies of a list while it grows: it doubles, and is held twice while it is moved.
const GROWTH: u64 = 3;
/// Bytes of the map in an object, such as the attributes of a primitive or an object of an animation.
const MAP_BYTES: u64 = 640;
/// Bytes of a value in a list: numbers of 64 bits.
const ITEM_BYTES: u64 = 8 * GROWTH;
/// Bytes of a key in a map.
const KEY_BYTES: u64 = 32;
/// Bytes of any value in a tree of JSON, with its key.
const VALUE_BYTES: u64 = 128;

/// Version and requirements of a file, and the numbers of objects in its lists, counted without memory for them.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Head {
    pub asset: Asset,
    pub extensions_required: Vec<String>,
    nodes: Vec<IgnoredAny>,
    materials: Vec<IgnoredAny>,
    accessors: Vec<IgnoredAny>,
    buffer_views: Vec<IgnoredAny>,
    textures: Vec<IgnoredAny>,
    images: Vec<IgnoredAny>,
    skins: Vec<IgnoredAny>,
    meshes: Vec<IgnoredAny>,
    /// Animations, which are kept as trees of values.
    animations: Vec<IgnoredAny>,
}

/// Version and requirements of a file.
#[derive(Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Bare {
    asset: Asset,
    extensions_required: Vec<String>,
}

impl Head {
    /// Head of a file in which some of the lists may be no lists: any of its objects may be a material.
    pub fn without_lists(json: &[u8]) -> Result<Self, serde_json::Error> {
        let bare: Bare = serde_json::from_slice(json)?;
        Ok(Self {
            asset: bare.asset,
            extensions_required: bare.extensions_required,
            materials: vec![IgnoredAny; count(json, b'{') as usize],
            animations: vec![IgnoredAny],
            ..Self::default()
        })
    }

    /// Upper bound of the memory of the parsed file, bytes; `json` is its text.
    pub fn bytes(&self, json: &[u8]) -> u64 {
        let lists = [
            (self.nodes.len(), size_of::<Node>()),
            (self.materials.len(), size_of::<Material>()),
            (self.accessors.len(), size_of::<Accessor>()),
            (self.buffer_views.len(), size_of::<BufferView>()),
            (self.textures.len(), size_of::<Texture>()),
            (self.images.len(), size_of::<Image>()),
            (self.skins.len(), size_of::<Skin>()),
            (self.meshes.len(), size_of::<Mesh>()),
        ];
        let listed = lists.map(|(len, size)| (len * size) as u64 * GROWTH);
        // The largest objects in lists of their own are primitives.
        let nested = size_of::<Primitive>() as u64 * GROWTH;
        let [objects, keys, items] = [b'{', b':', b','].map(|mark| count(json, mark));
        let animated = VALUE_BYTES * u64::from(!self.animations.is_empty());
        let outer: u64 = lists.iter().map(|(len, _)| *len as u64).sum();
        listed.iter().sum::<u64>()
            + objects * MAP_BYTES
            + objects.saturating_sub(outer) * nested
            + keys * KEY_BYTES
            + items * ITEM_BYTES.max(animated)
            + json.len() as u64
    }
}

/// Upper bound of the memory of the text as a tree of values, bytes.
pub fn value_bytes(json: &[u8]) -> u64 {
    let [objects, lists, items] = [b'{', b'[', b','].map(|mark| count(json, mark));
    objects * MAP_BYTES + (lists + items) * VALUE_BYTES + json.len() as u64
}

/// Number of times that a byte stands in a text.
fn count(text: &[u8], mark: u8) -> u64 {
    text.iter().filter(|byte| **byte == mark).count() as u64
}
