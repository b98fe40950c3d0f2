//! glTF materials and textures as [`Material`]: core metallic-roughness and supported extensions.

use std::{collections::HashMap, path::Path};

use glam::{Vec3, Vec4};

use super::{
    Fault, ImageSource, ImageUse, Model, Notes,
    accessor::Data,
    finite, label,
    schema::{self, Root, TextureInfo},
    uri::{self, Sandbox},
};
use crate::{
    scene::desc::ReflectionMode,
    world::{Material, TextureRef, Wrap},
};

/// Reads all materials into `model`, the default material last.
pub fn read(
    root: &Root,
    data: &Data<'_>,
    folder: &Path,
    sandbox: &Sandbox,
    model: &mut Model,
    notes: &mut Notes,
) -> Result<(), Fault> {
    let mut textures = Textures {
        root,
        data,
        folder,
        sandbox,
        uses: HashMap::new(),
        images: Vec::new(),
    };
    for (i, material) in root.materials.iter().enumerate() {
        let place = label("material", i, material.name.as_deref());
        let read = convert(material, &place, &mut textures, notes).map_err(|f| f.at(&place))?;
        let name = material
            .name
            .clone()
            .unwrap_or_else(|| format!("material {i}"));
        model.materials.push(Material { name, ..read });
    }
    // Primitives without a material get glTF's defaults: white, metallic 1, roughness 1.
    let default = convert(&schema::Material::default(), "", &mut textures, notes)?;
    model.materials.push(Material {
        name: "default".into(),
        ..default
    });
    model.images = textures.images;
    Ok(())
}

fn convert(
    material: &schema::Material,
    place: &str,
    textures: &mut Textures<'_>,
    notes: &mut Notes,
) -> Result<Material, Fault> {
    let mut out = factors(material)?;
    let pbr = &material.pbr_metallic_roughness;
    let mut texture = |info: &Option<TextureInfo>, srgb: bool, slot: &str| match info {
        Some(info) => (textures.reference(info, srgb, place, notes)).map_err(|f| f.at(slot)),
        None => Ok(None),
    };
    out.base_color_texture = texture(&pbr.base_color_texture, true, "baseColorTexture")?;
    let metallic_roughness = &pbr.metallic_roughness_texture;
    out.metallic_roughness_texture =
        texture(metallic_roughness, false, "metallicRoughnessTexture")?;
    out.normal_texture = texture(&material.normal_texture, false, "normalTexture")?;
    out.occlusion_texture = texture(&material.occlusion_texture, false, "occlusionTexture")?;
    out.emission_texture = texture(&material.emissive_texture, true, "emissiveTexture")?;
    out.alpha_cutoff = alpha(material, place, notes)?;
    out.reflectivity = reflectivity(&material.extensions, place, notes)?;
    if let Some(gloss) = &material.extensions.specular_glossiness {
        let map = match &gloss.diffuse_texture {
            Some(info) => textures.reference(info, true, place, notes),
            None => Ok(None),
        };
        specular_glossiness(gloss, map.map_err(|f| f.at("diffuseTexture"))?, &mut out)?;
        let what = "materials use specular-glossiness, whose tint and map are not shown";
        notes.add("specular-glossiness-approximated", 1, what, place);
    }
    if material.extensions.unlit.is_some() {
        unlit(&mut out, place, notes);
    }
    Ok(out)
}

/// The numbers of core glTF and KHR_materials_emissive_strength.
fn factors(material: &schema::Material) -> Result<Material, Fault> {
    let fault = |text: &str| Err(Fault::new("gltf-material", text));
    let pbr = &material.pbr_metallic_roughness;
    let base = pbr.base_color_factor.unwrap_or([1.0; 4]);
    let emission = material.emissive_factor.unwrap_or_default();
    let metallic = pbr.metallic_factor.unwrap_or(1.0);
    let roughness = pbr.roughness_factor.unwrap_or(1.0);
    if !(finite(&base) && finite(&emission) && finite(&[metallic, roughness])) {
        return fault("factors must be finite");
    }
    let strength = material.extensions.emissive_strength.as_ref();
    let strength = strength.and_then(|e| e.emissive_strength).unwrap_or(1.0);
    if !(strength >= 0.0 && strength.is_finite()) {
        return fault("emissiveStrength must be 0 or more");
    }
    let number = |info: &Option<TextureInfo>, get: fn(&TextureInfo) -> Option<f32>| {
        let number = info.as_ref().and_then(get);
        number.filter(|v| v.is_finite()).unwrap_or(1.0)
    };
    let occlusion = number(&material.occlusion_texture, |t| t.strength);
    Ok(Material {
        base_color: Vec4::from_array(base).clamp(Vec4::ZERO, Vec4::ONE),
        metallic: metallic.clamp(0.0, 1.0),
        roughness: roughness.clamp(0.0, 1.0),
        // The cap keeps products finite.
        emission: (Vec3::from_array(emission).max(Vec3::ZERO) * strength).min(Vec3::splat(1e30)),
        normal_scale: number(&material.normal_texture, |t| t.scale),
        occlusion_strength: occlusion.clamp(0.0, 1.0),
        double_sided: material.double_sided,
        ..Material::default()
    })
}

fn alpha(
    material: &schema::Material,
    place: &str,
    notes: &mut Notes,
) -> Result<Option<f32>, Fault> {
    match material.alpha_mode.as_deref().unwrap_or("OPAQUE") {
        "OPAQUE" => Ok(None),
        "MASK" => Ok(Some(
            material
                .alpha_cutoff
                .filter(|c| c.is_finite())
                .unwrap_or(0.5)
                .max(0.0),
        )),
        "BLEND" => {
            notes.add(
                "alpha-blend-opaque",
                1,
                "blended materials are rendered opaque",
                place,
            );
            Ok(None)
        }
        other => {
            let other = uri::shorten(other);
            Err(Fault::new(
                "gltf-material",
                format!("alphaMode \"{other}\" is unknown"),
            ))
        }
    }
}

/// Reflectance at normal incidence from KHR_materials_ior and KHR_materials_specular:
/// min(((ior − 1) / (ior + 1))² · specularColor, 1) · specular.
fn reflectivity(
    extensions: &schema::MaterialExtensions,
    place: &str,
    notes: &mut Notes,
) -> Result<f32, Fault> {
    let ior = extensions.ior.as_ref().and_then(|e| e.ior).unwrap_or(1.5);
    // 0 stands for an infinite index.
    if !(ior == 0.0 || ior >= 1.0 && ior.is_finite()) {
        return Err(Fault::new(
            "gltf-material",
            format!("ior is {ior}, expected 0 or at least 1"),
        ));
    }
    let f0 = if ior == 0.0 {
        1.0
    } else {
        ((ior - 1.0) / (ior + 1.0)).powi(2)
    };
    let Some(specular) = &extensions.specular else {
        return Ok(f0);
    };
    let factor = specular.specular_factor.unwrap_or(1.0);
    let color = specular.specular_color_factor.unwrap_or([1.0; 3]);
    if !(finite(&color) && factor.is_finite()) {
        return Err(Fault::new(
            "gltf-material",
            "specular factors must be finite",
        ));
    }
    let tinted = color[0] != color[1] || color[1] != color[2];
    let textured = specular.specular_texture.is_some() || specular.specular_color_texture.is_some();
    let what = "materials have a specular tint or texture, of which only the mean factor is used";
    notes.add(
        "specular-approximated",
        u64::from(tinted || textured),
        what,
        place,
    );
    let mean = color
        .iter()
        .map(|c| (f0 * c.max(0.0)).min(1.0))
        .sum::<f32>()
        / 3.0;
    Ok((mean * factor).clamp(0.0, 1.0))
}

/// KHR_materials_pbrSpecularGlossiness (archived) as a dielectric of the same diffuse color,
/// mean reflectance and gloss.
fn specular_glossiness(
    gloss: &schema::SpecularGlossiness,
    diffuse_texture: Option<TextureRef>,
    material: &mut Material,
) -> Result<(), Fault> {
    let diffuse = gloss.diffuse_factor.unwrap_or([1.0; 4]);
    let specular = gloss.specular_factor.unwrap_or([1.0; 3]);
    let glossiness = gloss.glossiness_factor.unwrap_or(1.0);
    if !(finite(&diffuse) && finite(&specular) && glossiness.is_finite()) {
        return Err(Fault::new("gltf-material", "factors must be finite"));
    }
    material.base_color = Vec4::from_array(diffuse).clamp(Vec4::ZERO, Vec4::ONE);
    material.base_color_texture = diffuse_texture;
    material.metallic = 0.0;
    material.roughness = (1.0 - glossiness).clamp(0.0, 1.0);
    material.metallic_roughness_texture = None;
    material.reflectivity = (specular.iter().sum::<f32>() / 3.0).clamp(0.0, 1.0);
    Ok(())
}

/// KHR_materials_unlit: the base color is emission, without other lighting.
fn unlit(material: &mut Material, place: &str, notes: &mut Notes) {
    notes.add(
        "unlit-as-emission",
        1,
        "unlit materials are rendered as emissive",
        place,
    );
    material.emission = material.base_color.truncate();
    material.emission_texture = material.base_color_texture;
    // The texture stays for its alpha.
    material.base_color = Vec3::ZERO.extend(material.base_color.w);
    material.metallic = 0.0;
    material.roughness = 1.0;
    material.reflectivity = 0.0;
    material.reflection = ReflectionMode::None;
    material.metallic_roughness_texture = None;
    material.normal_texture = None;
    material.occlusion_texture = None;
}

/// Collects the used images and their color spaces.
struct Textures<'a> {
    root: &'a Root,
    data: &'a Data<'a>,
    folder: &'a Path,
    sandbox: &'a Sandbox,
    uses: HashMap<(usize, bool), usize>,
    images: Vec<ImageUse>,
}

impl Textures<'_> {
    /// `None` if the texture has only images of unsupported formats.
    fn reference(
        &mut self,
        info: &TextureInfo,
        srgb: bool,
        place: &str,
        notes: &mut Notes,
    ) -> Result<Option<TextureRef>, Fault> {
        let Some(texture) = self.root.textures.get(info.index) else {
            return Err(missing("texture", info.index));
        };
        let sampler = match texture.sampler.map(|i| (i, self.root.samplers.get(i))) {
            Some((_, Some(sampler))) => sampler,
            Some((i, None)) => return Err(missing("sampler", i)),
            None => &schema::Sampler::default(),
        };
        let Some(image) = texture.source else {
            let what = "textures have no PNG or JPEG image and are left out";
            notes.add("texture-unsupported", 1, what, place);
            return Ok(None);
        };
        let transform = info.extensions.transform.as_ref();
        let uv_set = transform.and_then(|t| t.tex_coord);
        let mut uv_set = uv_set.unwrap_or(info.tex_coord);
        if uv_set > 1 {
            let what = "textures use TEXCOORD_2 or higher; TEXCOORD_0 is used";
            notes.add("uv-set-unsupported", 1, what, place);
            uv_set = 0;
        }
        Ok(Some(TextureRef {
            texture: self.image_use(image, srgb)?,
            uv_set,
            transform: rows(transform)?,
            wrap: [wrap(sampler.wrap_s)?, wrap(sampler.wrap_t)?],
            nearest: sampler.mag_filter == Some(9728),
        }))
    }

    /// Index of the image in this color space.
    fn image_use(&mut self, index: usize, srgb: bool) -> Result<usize, Fault> {
        let Some(image) = self.root.images.get(index) else {
            return Err(missing("image", index));
        };
        let next = self.images.len();
        let slot = *self.uses.entry((index, srgb)).or_insert(next);
        if slot == next {
            let uri = image.uri.as_deref().filter(|uri| !uri.starts_with("data:"));
            let name = label("image", index, image.name.as_deref().or(uri));
            let source = self.source(image).map_err(|f| f.at(&name));
            self.images.push(ImageUse {
                name,
                index,
                srgb,
                source,
            });
        }
        Ok(slot)
    }

    fn source(&self, image: &schema::Image) -> Result<ImageSource, Fault> {
        match (&image.uri, image.buffer_view) {
            (Some(_), Some(_)) => Err(Fault::new("gltf-image", "has both a uri and a bufferView")),
            (None, None) => Err(Fault::new(
                "gltf-image",
                "has neither a uri nor a bufferView",
            )),
            (None, Some(view)) => self.data.view_bytes(view).map(ImageSource::Bytes),
            (Some(text), None) => match uri::parse(text)? {
                uri::Target::Data(bytes) => Ok(ImageSource::Bytes(super::Bytes::new(bytes))),
                uri::Target::Relative(name) => self
                    .sandbox
                    .resolve(self.folder, &name)
                    .map(ImageSource::File),
            },
        }
    }
}

fn missing(kind: &str, index: usize) -> Fault {
    Fault::new("gltf-index", format!("{kind} {index} does not exist"))
}

fn wrap(code: Option<u32>) -> Result<Wrap, Fault> {
    Ok(match code {
        None | Some(10497) => Wrap::Repeat,
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        Some(other) => {
            return Err(Fault::new(
                "gltf-sampler",
                format!("wrap mode {other} is unknown"),
            ));
        }
    })
}

/// KHR_texture_transform. The extension's printed rotation matrix turns the other way than its
/// reference pictures and every viewer; see KhronosGroup/glTF#1563.
fn rows(transform: Option<&schema::TextureTransform>) -> Result<[Vec3; 2], Fault> {
    let Some(t) = transform else {
        return Ok([Vec3::X, Vec3::Y]);
    };
    let ([ox, oy], [sx, sy]) = (t.offset.unwrap_or_default(), t.scale.unwrap_or([1.0; 2]));
    let (s, c) = t.rotation.unwrap_or(0.0).sin_cos();
    if !finite(&[ox, oy, sx, sy, s, c]) {
        return Err(Fault::new(
            "gltf-material",
            "KHR_texture_transform must be finite",
        ));
    }
    Ok([
        Vec3::new(c * sx, s * sy, ox),
        Vec3::new(-s * sx, c * sy, oy),
    ])
}
