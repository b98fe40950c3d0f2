//! Materials after all overrides, and the table of images that they use.

use std::{
    collections::HashMap,
    io::Read as _,
    path::{Path, PathBuf},
};

use glam::Vec3;

use super::{Loader, MOST_SHOWN, error_at, foreign_formats};
use crate::{
    CoreTexture, FILE_TEXTURES, Material, TextureRef, World, Wrap,
    gltf::ImageSource,
    texture::{self, TextureRequest},
};
use reflet_base::files::File;
use reflet_scene::{
    desc::{At, MOST_PATTERNED, MaterialDesc, reflectivity_of},
    diagnostic::Diagnostic,
};

/// Bytes of an image in which its color space stands, before its pixels.
const HEADER_BYTES: u64 = 1 << 16;

/// Image key: a file by its canonical path, or an image inside a loaded file; with the image that stands in for it where
/// it is broken.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum ImageKey {
    File(PathBuf),
    Embedded { loaded: usize, image: usize },
    Replaceable(Box<[Self; 2]>),
}

/// The images that materials use, each once per color space.
#[derive(Default)]
pub struct TextureTable {
    requests: Vec<(ImageKey, TextureRequest)>,
    indices: HashMap<(ImageKey, bool), usize>,
}

impl TextureTable {
    fn index(&mut self, key: ImageKey, request: TextureRequest) -> usize {
        let next = self.requests.len();
        let index = *(self.indices.entry((key.clone(), request.srgb))).or_insert(next);
        if index == next {
            self.requests.push((key, request));
        } else if request.used_by.is_empty() {
            // The scene text names it too.
            self.requests[index].1 = request;
        }
        index
    }

    /// Drops unused requests and assigns texture indices to the world's materials.
    pub fn take_used(&mut self, world: &mut World) -> Vec<(ImageKey, TextureRequest)> {
        let mut new_index = vec![None; self.requests.len()];
        let mut used = Vec::new();
        let materials = world.materials.iter_mut();
        for slot in materials.flat_map(Material::texture_slots).flatten() {
            let old = slot.texture;
            slot.texture = *new_index[old].get_or_insert_with(|| {
                used.push(self.requests[old].clone());
                used.len() - 1
            });
        }
        self.requests.clear();
        self.indices.clear();
        used
    }
}

/// Textures that scene text may name, with their files.
fn scene_textures(desc: &MaterialDesc) -> [(CoreTexture, Option<&At<String>>); 4] {
    [
        (CoreTexture::BaseColor, desc.base_color_texture.as_ref()),
        (
            CoreTexture::MetallicRoughness,
            desc.metallic_roughness_texture.as_ref(),
        ),
        (CoreTexture::Normal, desc.normal_texture.as_ref()),
        (CoreTexture::Emission, desc.emission_texture.as_ref()),
    ]
}

impl Loader<'_> {
    /// A file's material with the overrides of `desc`; only images still in use are requested.
    pub fn file_material(&mut self, loaded: usize, index: usize, desc: &MaterialDesc) -> Material {
        let mut material = self.loaded[loaded].materials[index].clone();
        for (texture, name) in scene_textures(desc) {
            let is_checker = texture == CoreTexture::BaseColor && desc.checker.is_some();
            if name.is_some() || is_checker {
                *material.texture_slots()[texture as usize] = None;
            }
        }
        for slot in material.texture_slots() {
            *slot = slot.and_then(|used| {
                let texture = self.file_image(loaded, used.texture)?;
                Some(TextureRef { texture, ..used })
            });
        }
        self.apply(desc, &mut material);
        material
    }

    /// Index into the texture table; reports an image that cannot be found. Images that cannot be found or whose headers
    /// cannot be read give way to their fallback, or are left out, but with `strict`.
    fn file_image(&mut self, loaded: usize, index: usize) -> Option<usize> {
        let mut next = Some(index);
        while let Some(index) = next.take() {
            match self.image_request(loaded, index) {
                Ok((key, request)) => return Some(self.textures.index(key, request)),
                Err(error) if self.options.strict => self.report_once(*error),
                Err(error) => {
                    next = self.loaded[loaded].images[index].fallback;
                    self.warn_once(left_out(*error, next.is_some()));
                }
            }
        }
        None
    }

    /// Request of an image of a loaded file, with the images that stand in for it.
    ///
    /// # Errors
    /// An image that cannot be found; but with `strict` also one whose header cannot be read.
    fn image_request(
        &self,
        loaded: usize,
        index: usize,
    ) -> Result<(ImageKey, TextureRequest), Box<Diagnostic>> {
        let model = &self.loaded[loaded];
        let file = model.files[0].clone();
        let image = &model.images[index];
        let source = image.source.clone();
        let source = source.and_then(|source| match self.options.strict {
            false => texture::check_header(&source, &self.texture_limits())
                .map(|()| source)
                .map_err(|fault| fault.placed(&format!("{}, {}", image.name, image.used_by))),
            true => Ok(source),
        });
        let source = source.map_err(|fault| fault.in_file(&file))?;
        let key = match &source {
            ImageSource::File(path) => ImageKey::File(path.clone()),
            _ => ImageKey::Embedded {
                loaded,
                image: image.index,
            },
        };
        let fallback = image
            .fallback
            .and_then(|index| self.image_request(loaded, index).ok());
        let (key, fallback) = match fallback {
            Some((other, request)) => (
                ImageKey::Replaceable(Box::new([key, other])),
                Some(Box::new(request)),
            ),
            None => (key, None),
        };
        let request = TextureRequest {
            name: image.name.clone(),
            used_by: image.used_by.clone(),
            file,
            source,
            srgb: image.srgb,
            fallback,
        };
        Ok((key, request))
    }

    /// Leaves images of models out that turned out broken, by their indices; fallbacks stand in the place of others.
    pub fn leave_out_images(&mut self, broken: Vec<(Option<usize>, Diagnostic)>) {
        for (index, error) in broken {
            let materials = self.world.materials.iter_mut();
            for slot in materials.flat_map(Material::texture_slots) {
                *slot = slot.filter(|used| Some(used.texture) != index);
            }
            self.warn_once(left_out(error, index.is_none()));
        }
    }

    /// Applies the overrides of `desc` to `material`.
    pub fn apply(&mut self, desc: &MaterialDesc, material: &mut Material) {
        material.set_numbers(desc);
        material.double_sided = desc.double_sided.unwrap_or(material.double_sided);
        material.light = desc.light.unwrap_or(material.light);
        material.light_group = desc.light_group.unwrap_or(material.light_group);
        material.is_mesh_light &= desc.light.is_none();
        material.reflection = desc.reflection.unwrap_or(material.reflection);
        material.ior = desc.ior.unwrap_or(material.ior);
        material.edge_tint = desc.edge_tint.unwrap_or(material.edge_tint);
        if let Some(reflectivity) = desc.reflectivity {
            // The reader fills in the reflectivity of an index.
            material.has_index = desc.ior.map(reflectivity_of) == Some(reflectivity);
        }
        if desc.alpha.is_some() && material.alpha_cutoff.is_none() {
            material.blended = true;
        }
        if let Some(thickness_m) = desc.thickness_m {
            material.solid = thickness_m > 0.0;
        }
        if material.has_medium() || material.diffuse_transmission.is_some() {
            material.double_sided = true; // rays leave it through its back
        }
        for (texture, name) in scene_textures(desc) {
            if let Some(name) = name {
                let is_color = FILE_TEXTURES[texture as usize].is_color;
                *material.texture_slots()[texture as usize] = self.scene_image(name, is_color);
            }
        }
        match desc.unlit {
            Some(true) => *material = material.without_light(),
            Some(false) => material.unlit = false,
            None => {}
        }
        if material.patterned.len() > MOST_PATTERNED {
            let name = &material.name;
            let message = format!(
                "material \"{name}\" has more than {MOST_PATTERNED} patterns with those that are laid over it"
            );
            let error = error_at("too-many-patterns", &self.desc.own, message);
            self.report_once(error.help("leave one out, or write a number in its place"));
        }
    }

    /// Color space that an image says it has, if it is a PNG of another one than sRGB.
    fn other_space(&self, path: &Path) -> Option<String> {
        let mut start = Vec::new();
        let file = File::open(path).ok()?;
        file.take(HEADER_BYTES).read_to_end(&mut start).ok()?;
        texture::other_than_srgb(&start)
    }

    /// An image file that the scene text names, or none in place of a file's.
    fn scene_image(&mut self, name: &At<String>, srgb: bool) -> Option<TextureRef> {
        if name.value == "none" {
            return None;
        }
        if let Some((message, help)) = foreign_formats::image(Path::new(&name.value)) {
            self.report_once(error_at("file-format", &name.at, message).help(help));
            return None;
        }
        let path = match self.find(name) {
            Ok(path) => path,
            Err(error) => {
                self.report_once(*error);
                return None;
            }
        };
        if let Some(space) = srgb.then(|| self.other_space(&path)).flatten() {
            let message = format!("this image is {space}, and is shown as sRGB");
            let help = "save it as sRGB in an image program, or without that chunk";
            let warning = error_at("image-color-space", &name.at, message).help(help);
            self.world.warnings.push(warning.warning());
        }
        let request = TextureRequest {
            name: "image".into(),
            used_by: String::new(),
            file: path.clone(),
            source: ImageSource::File(path.clone()),
            srgb,
            fallback: None,
        };
        Some(TextureRef {
            texture: self.textures.index(ImageKey::File(path), request),
            uv_set: 0,
            transform: [Vec3::X, Vec3::Y],
            wrap: [Wrap::Repeat; 2],
            nearest: false,
        })
    }

    /// The `[material.NAME]` applied to `base`, or an error with a similar name.
    pub fn named_material(&mut self, name: &At<String>, base: Material) -> Material {
        let desc = self.desc;
        let known = self.named_materials.index(&name.value);
        let Some(entry) = known.map(|index| &desc.materials[index]) else {
            let text = format!("material \"{}\" is not defined", name.value);
            let mut error = error_at("unknown-name", &name.at, text);
            let known = desc.materials.iter().map(|m| m.name.as_str());
            error.help = super::did_you_mean(&name.value, known)
                .or_else(|| Some(format!("add a table [material.{}]", name.value)));
            self.report_once(error);
            return base;
        };
        let mut material = Material {
            name: entry.name.clone(),
            ..base
        };
        self.apply(&entry.value, &mut material);
        material
    }

    pub fn warn_once(&mut self, warning: Diagnostic) {
        if !self.world.warnings.contains(&warning) {
            self.world.warnings.push(warning);
        }
    }

    /// Reports an error unless it was reported before, as many instances may have the same one.
    pub fn report_once(&mut self, error: Diagnostic) {
        // A budget of all shapes together is told at the first shape that goes beyond it.
        let is_of_all = ["shapes-too-large", "memory-short"].contains(&error.name);
        let says = |said: &Diagnostic| *said == error || is_of_all && said.name == error.name;
        if self.errors.len() >= MOST_SHOWN || !self.errors.iter().any(says) {
            self.errors.push(error);
        }
    }
}

/// The warning about an image that is left out, for another one of its texture or none, because of an error.
pub fn left_out(error: Diagnostic, has_fallback: bool) -> Diagnostic {
    let instead = if has_fallback {
        " for its fallback"
    } else {
        ""
    };
    Diagnostic {
        name: "image-left-out",
        message: format!("an image is left out{instead}: {}", error.message),
        ..error
    }
    .warning()
}
