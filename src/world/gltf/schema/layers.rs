//! Extensions of materials: their numbers and textures, each named once.

use serde::{
    Deserialize, Deserializer,
    de::{DeserializeSeed, IgnoredAny, MapAccess, Visitor},
};
use std::fmt;

use super::texture_info::TextureInfo;
use crate::{CORE_SLOTS, FILE_TEXTURES, LAYER_SLOTS};
use reflet_scene::{
    desc::{LAYER_NUMBERS, MATERIAL, MaterialDesc},
    number::{Field, Form, find},
};

/// Begin of the names of extensions of materials.
const KHR: &str = "KHR_materials_";

/// Extension within `KHR_materials_specular` that tints edges; as all places within an extension, with a slash.
const EDGE_COLOR: &str = "specular/edge_color";

/// Whether a number is of an extension.
fn is_in(path: &str, extension: Option<&str>) -> bool {
    path.split('/').next() == extension
}

/// The value of scene text that a number of [`LAYER_NUMBERS`] is.
pub fn layer_field(key: &str) -> Option<&'static Field<MaterialDesc>> {
    find(&MATERIAL, key)
}

/// The extensions of a material.
#[derive(Debug, Default)]
pub struct MaterialExtensions {
    /// Values of [`LAYER_NUMBERS`]; a single number is in all three components. An empty extension has `None` for
    /// each of its numbers.
    numbers: [Option<Option<[f32; 3]>>; LAYER_NUMBERS.len()],
    textures: [Option<TextureInfo>; LAYER_SLOTS],
    /// KHR_materials_unlit.
    pub unlit: Option<IgnoredAny>,
    /// EXT_materials_specular_edge_color.
    pub edge_tint: bool,
    /// KHR_materials_pbrSpecularGlossiness.
    pub specular_glossiness: Option<SpecularGlossiness>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct SpecularGlossiness {
    pub diffuse_factor: Option<[f32; 4]>,
    pub diffuse_texture: Option<TextureInfo>,
    pub specular_factor: Option<[f32; 3]>,
    pub glossiness_factor: Option<f32>,
    pub specular_glossiness_texture: Option<TextureInfo>,
}

impl MaterialExtensions {
    /// Whether the material has a layer: an extension without [`KHR`].
    pub fn has(&self, extension: &str) -> bool {
        let mut rows = LAYER_NUMBERS.iter().zip(&self.numbers);
        rows.any(|((path, _), number)| is_in(path, Some(extension)) && number.is_some())
    }

    /// A number that takes one component, by its path in [`LAYER_NUMBERS`].
    pub fn number(&self, path: &str) -> Option<f32> {
        let row = LAYER_NUMBERS.iter().position(|(own, _)| *own == path)?;
        self.numbers[row].flatten().map(|[x, ..]| x)
    }

    /// The rows of [`LAYER_NUMBERS`] whose extensions the material has, with the number that the file gives.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static str, &'static str, Option<[f32; 3]>)> {
        let rows = LAYER_NUMBERS.iter().zip(self.numbers);
        rows.filter_map(|(&(path, key), number)| Some((path, key, number?)))
    }

    /// Textures of the layers, in the order of [`crate::LayerTexture`].
    pub fn textures(&self) -> [Option<&TextureInfo>; LAYER_SLOTS] {
        self.textures.each_ref().map(Option::as_ref)
    }
}

impl<'de> Deserialize<'de> for MaterialExtensions {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let mut out = Self::default();
        from.deserialize_map(Keys {
            extension: None,
            out: &mut out,
        })?;
        Ok(out)
    }
}

/// Reader of the keys of an extension, or of the names of all.
struct Keys<'a> {
    extension: Option<&'a str>,
    out: &'a mut MaterialExtensions,
}

impl<'de> Visitor<'de> for Keys<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object")
    }

    fn visit_unit<E>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let out = self.out;
        for ((path, _), number) in LAYER_NUMBERS.iter().zip(&mut out.numbers) {
            if is_in(path, self.extension) {
                *number = Some(None);
            }
        }
        while let Some(key) = map.next_key::<String>()? {
            let Some(extension) = self.extension else {
                match key.strip_prefix(KHR) {
                    Some("unlit") => out.unlit = map.next_value()?,
                    Some("pbrSpecularGlossiness") => out.specular_glossiness = map.next_value()?,
                    extension => map.next_value_seed(Keys {
                        extension: Some(extension.unwrap_or_default()),
                        out,
                    })?,
                }
                continue;
            };
            let inner = match (extension, key.as_str()) {
                ("clearcoat", "extensions") => Some("clearcoat/extensions"),
                ("specular", "extensions") => Some("specular/extensions"),
                ("clearcoat/extensions", "KHR_materials_clearcoat_ior") => Some("clearcoat_ior"),
                ("specular/extensions", "EXT_materials_specular_edge_color") => Some(EDGE_COLOR),
                _ => None,
            };
            if inner.is_some() {
                let extension = inner;
                map.next_value_seed(Keys { extension, out })?;
                continue;
            }
            let path = format!("{extension}/{key}");
            let full = format!("extensions/{KHR}{path}");
            if let Some(row) = LAYER_NUMBERS.iter().position(|(own, _)| *own == path) {
                let form = layer_field(LAYER_NUMBERS[row].1).map(|field| field.form);
                out.numbers[row] = Some(match form {
                    Some(Form::Color) => map.next_value()?,
                    _ => map.next_value::<Option<f32>>()?.map(|x| [x; 3]),
                });
            } else if (extension, key.as_str()) == (EDGE_COLOR, "specularEdgeColorEnabled") {
                out.edge_tint = map.next_value()?;
            } else if let Some(slot) = FILE_TEXTURES.iter().position(|own| own.path == full) {
                out.textures[slot - CORE_SLOTS] = map.next_value()?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

impl<'de> DeserializeSeed<'de> for Keys<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<(), D::Error> {
        let is_own = |(path, _): &(&str, _)| is_in(path, self.extension);
        let is_within = self.extension.is_some_and(|place| place.contains('/'));
        if is_within || LAYER_NUMBERS.iter().any(is_own) {
            return from.deserialize_any(self);
        }
        IgnoredAny::deserialize(from).map(|_| ())
    }
}
