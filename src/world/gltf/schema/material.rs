//! Materials, textures, images and samplers of the schema.

use serde::Deserialize;

use super::{layers::MaterialExtensions, texture_info::TextureInfo};
use crate::TEXTURE_SLOTS;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Material {
    pub name: Option<String>,
    pub pbr_metallic_roughness: Pbr,
    pub normal_texture: Option<TextureInfo>,
    pub occlusion_texture: Option<TextureInfo>,
    pub emissive_texture: Option<TextureInfo>,
    pub emissive_factor: Option<[f32; 3]>,
    pub alpha_mode: Option<String>,
    pub alpha_cutoff: Option<f32>,
    pub double_sided: bool,
    pub extensions: MaterialExtensions,
    /// Arbitrary data; the USD converter marks mesh lights here.
    pub extras: serde_json::Value,
}

impl Material {
    /// The textures, in the order of [`FILE_TEXTURES`](crate::FILE_TEXTURES).
    pub fn textures(&self) -> [Option<&TextureInfo>; TEXTURE_SLOTS] {
        let pbr = &self.pbr_metallic_roughness;
        let core = [
            pbr.base_color_texture.as_ref(),
            pbr.metallic_roughness_texture.as_ref(),
            self.normal_texture.as_ref(),
            self.occlusion_texture.as_ref(),
            self.emissive_texture.as_ref(),
        ];
        let mut all = core.into_iter().chain(self.extensions.textures());
        std::array::from_fn(|_| all.next().flatten())
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Pbr {
    pub base_color_factor: Option<[f32; 4]>,
    pub base_color_texture: Option<TextureInfo>,
    pub metallic_factor: Option<f32>,
    pub roughness_factor: Option<f32>,
    pub metallic_roughness_texture: Option<TextureInfo>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Texture {
    pub sampler: Option<usize>,
    pub source: Option<usize>,
    pub extensions: TextureExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct TextureExtensions {
    #[serde(rename = "EXT_texture_webp")]
    pub webp: Option<ImageSourceExtension>,
    #[serde(rename = "KHR_texture_basisu")]
    pub basisu: Option<ImageSourceExtension>,
    /// Forerunner of KHR_texture_basisu, whose images are `.basis` files.
    #[serde(rename = "GOOGLE_texture_basis")]
    pub basis: Option<ImageSourceExtension>,
}

impl TextureExtensions {
    /// Images of all extensions.
    pub fn all(&mut self) -> [&mut Option<ImageSourceExtension>; 3] {
        [&mut self.basisu, &mut self.basis, &mut self.webp]
    }

    /// The images that take precedence over [`Texture::source`], the preferred one first.
    pub fn sources(&self) -> impl Iterator<Item = usize> {
        let extensions = [&self.basisu, &self.basis, &self.webp];
        extensions.into_iter().flatten().filter_map(|e| e.source)
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct ImageSourceExtension {
    pub source: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Image {
    pub name: Option<String>,
    pub uri: Option<String>,
    pub buffer_view: Option<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Sampler {
    pub mag_filter: Option<u32>,
    pub wrap_s: Option<u32>,
    pub wrap_t: Option<u32>,
}
