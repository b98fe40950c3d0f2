//! Materials: the properties of a surface for shading and ray tracing.

use std::{
    ops::{Deref, DerefMut},
    path::PathBuf,
};

use super::{
    Shared, TextureRef,
    material_textures::{LAYER_SLOTS, LayerTexture, TEXTURE_SLOTS},
};
use glam::{Vec3, Vec4};
use reflet_scene::desc::{
    At, CheckerDesc, LightGroup, MATERIAL, MaterialDesc, MaterialNumbers, PatternKind,
    PatternedDesc, PatternedKey, ReflectionMode,
};
use reflet_scene::number::find;

/// A surface description after all overrides; textures are indices into [`World::textures`](super::World::textures).
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from scene text or file.
    pub name: String,
    /// Base color, linear; alpha in w.
    pub base_color: Vec4,
    /// Numbers that are plain values of its keys.
    pub numbers: MaterialNumbers,
    /// Emitted linear radiance, strength already multiplied in.
    pub emission: Vec3,
    /// Whether the emission lights the scene; else it is only seen, directly and in reflections.
    pub light: bool,
    /// Light group of the emission.
    pub light_group: LightGroup,
    /// Whether `light` comes from the file (a mesh light), and not from the scene text.
    pub is_mesh_light: bool,
    /// Whether the surface is double-sided.
    pub double_sided: bool,
    /// Whether the base color is shown unchanged, without lighting, exposure and tone mapping
    /// (KHR_materials_unlit). Such a material has no specular.
    pub unlit: bool,
    /// Whether transmitted light is refracted, and absorbed up to the other side of the mesh.
    pub solid: bool,
    /// Index of refraction inside of a solid, 1 or more.
    pub ior: f32,
    /// Whether the reflectivity is of an index of refraction that was given, for exact reflectances.
    pub has_index: bool,
    /// Whether the specular strength and color tint edges, of metals too.
    pub edge_tint: bool,
    /// Strength of the clear coat's own normal map.
    pub clearcoat_normal_scale: f32,
    /// Thickness of the film at the texture's least values, nanometers.
    pub iridescence_least_nm: f32,
    /// Whether alpha is the share of light that the surface stops (glTF's `BLEND`).
    pub blended: bool,
    /// Reflection mode.
    pub reflection: ReflectionMode,
    /// Procedural checker multiplied into the base color.
    pub checker: Option<CheckerDesc>,
    /// Numbers and colors that follow patterns, of which the fields have the means; the emission's has the strength
    /// multiplied in.
    pub patterned: Vec<PatternedDesc>,
    /// Base color texture, sRGB.
    pub base_color_texture: Option<TextureRef>,
    /// Metallic-roughness texture, linear: green = roughness, blue = metallic.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Normal map, linear, in tangent space.
    pub normal_texture: Option<TextureRef>,
    /// Occlusion texture, linear: red.
    pub occlusion_texture: Option<TextureRef>,
    /// Emission texture, sRGB.
    pub emission_texture: Option<TextureRef>,
    /// Textures of the layers, indexed by [`LayerTexture`].
    pub layer_textures: [Option<TextureRef>; LAYER_SLOTS],
}

/// Names of the contents of a file, in its order; names that it lacks are left out.
#[derive(Clone, Debug, Default)]
pub struct ListedNames {
    /// Names of its own materials.
    pub materials: Shared<String>,
    /// Names of the nodes of its scene.
    pub nodes: Shared<String>,
}

/// Contents of a model's file from which scene text chooses by name.
#[derive(Clone, Debug)]
pub struct ListedModel {
    /// Name of the `[model.NAME]`.
    pub model: String,
    /// The file.
    pub file: PathBuf,
    /// Names of materials and nodes.
    pub names: ListedNames,
    /// Names of the material variants.
    pub variants: Vec<String>,
    /// Name of the shown variant; `None`: the file's own materials are shown.
    pub shown: Option<String>,
}

impl Deref for Material {
    type Target = MaterialNumbers;

    fn deref(&self) -> &MaterialNumbers {
        &self.numbers
    }
}

impl DerefMut for Material {
    fn deref_mut(&mut self) -> &mut MaterialNumbers {
        &mut self.numbers
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            numbers: MaterialNumbers::default(),
            emission: Vec3::ZERO,
            light: false,
            light_group: LightGroup::default(),
            is_mesh_light: false,
            double_sided: false,
            unlit: false,
            solid: false,
            ior: 1.5,
            has_index: false,
            edge_tint: false,
            clearcoat_normal_scale: 1.0,
            iridescence_least_nm: 100.0,
            blended: false,
            reflection: ReflectionMode::Auto,
            checker: None,
            patterned: Vec::new(),
            base_color_texture: None,
            metallic_roughness_texture: None,
            normal_texture: None,
            occlusion_texture: None,
            emission_texture: None,
            layer_textures: [None; LAYER_SLOTS],
        }
    }
}

impl Material {
    /// Base color, metallic-roughness, normal, occlusion and emission textures, then textures of the layers, in the
    /// shaders' order, with `uv_scale` in their transforms.
    pub fn slots(&self) -> [Option<TextureRef>; TEXTURE_SLOTS] {
        self.textures().map(|slot| {
            slot.map(|mut slot| {
                slot.transform[0] *= self.uv_scale[0];
                slot.transform[1] *= self.uv_scale[1];
                slot
            })
        })
    }

    /// The unlit version of the material: only base color, its alpha and emission remain.
    pub fn without_light(&self) -> Self {
        let is_kept = |p: &&PatternedDesc| {
            use PatternedKey::{Alpha, BaseColor, Emission};
            matches!(p.value, BaseColor | Emission | Alpha)
        };
        Self {
            name: self.name.clone(),
            unlit: true,
            base_color: self.base_color,
            base_color_texture: self.base_color_texture,
            checker: self.checker,
            patterned: self.patterned.iter().filter(is_kept).copied().collect(),
            numbers: MaterialNumbers {
                uv_scale: self.uv_scale,
                alpha_cutoff: self.alpha_cutoff,
                reflectivity: 0.0,
                ..MaterialNumbers::default()
            },
            emission: self.emission,
            emission_texture: self.emission_texture,
            light: self.light,
            light_group: self.light_group,
            is_mesh_light: self.is_mesh_light,
            blended: self.blended,
            double_sided: self.double_sided,
            reflection: ReflectionMode::None,
            ..Self::default()
        }
    }

    /// Whether the material may let light through.
    pub fn passes_light(&self) -> bool {
        self.transmission.is_some() || self.blended
    }

    /// Whether the surface has a relief that follows a pattern.
    pub fn has_relief(&self) -> bool {
        (self.patterned.iter()).any(|pattern| pattern.value == PatternedKey::Bump)
    }

    /// Whether the inside of the material scatters light that enters it.
    pub fn scatters(&self) -> bool {
        let is_entered = self.passes_light() || self.diffuse_transmission.is_some();
        let is_dense = self.attenuation_distance_m.is_some();
        self.solid && is_entered && is_dense && self.scattering_color.is_some()
    }

    /// Whether light goes on inside of the material.
    pub fn has_medium(&self) -> bool {
        self.scatters() || (self.solid && self.passes_light())
    }

    /// Extinction coefficient inside the material, per meter, by the Beer-Lambert law. Light that is scattered straight on
    /// does not count as lost, so that the rest counts as scattered evenly, by the similarity relation (Wyman, Patterson &
    /// Wilson 1989).
    pub fn extinction(&self) -> Vec3 {
        const LEAST: f32 = 1e-6; // black after the distance, without infinities
        let distance_m = self.attenuation_distance_m.unwrap_or(f32::INFINITY);
        let color = self.attenuation_color.max(Vec3::splat(LEAST));
        let onward = self.scattering_anisotropy.clamp(-0.999, 0.999);
        let reduced = match self.scattering_color.filter(|_| self.scatters()) {
            Some(color) => {
                (1.0 - onward)
                    / (Vec3::ONE - onward * (Vec3::ONE - single_scattering_albedo(color)))
            }
            None => Vec3::ONE,
        };
        (color.map(|c| -c.ln()) / distance_m * reduced).min(Vec3::splat(1e12))
    }

    /// Share of the light that is lost on the way inside the material which is scattered, evenly into all directions.
    pub fn single_scattering_albedo(&self) -> Vec3 {
        (self.scattering_color.filter(|_| self.scatters()))
            .map_or(Vec3::ZERO, single_scattering_albedo)
    }

    /// The textures without `uv_scale` in their transforms, in the order of [`Self::slots`].
    pub fn textures(&self) -> [Option<TextureRef>; TEXTURE_SLOTS] {
        let core = [
            self.base_color_texture,
            self.metallic_roughness_texture,
            self.normal_texture,
            self.occlusion_texture,
            self.emission_texture,
        ];
        let mut all = core.into_iter().chain(self.layer_textures);
        std::array::from_fn(|_| all.next().flatten())
    }

    /// The texture fields for writing, in the order of [`Self::slots`].
    pub fn texture_slots(&mut self) -> [&mut Option<TextureRef>; TEXTURE_SLOTS] {
        let core = [
            &mut self.base_color_texture,
            &mut self.metallic_roughness_texture,
            &mut self.normal_texture,
            &mut self.occlusion_texture,
            &mut self.emission_texture,
        ];
        let mut all = core.into_iter().chain(&mut self.layer_textures);
        std::array::from_fn(|_| all.next().expect("a field for each"))
    }

    /// Whether the clear coat has other normals than the base: it follows its own normal map alone, not the
    /// material's (KHR_materials_clearcoat).
    pub fn has_coat_normals(&self) -> bool {
        let own = self.layer_texture(LayerTexture::ClearcoatNormal);
        let is_same = own == self.normal_texture
            && (own.is_none() || self.clearcoat_normal_scale == self.normal_scale);
        self.clearcoat.is_some() && !is_same
    }

    /// A texture of a layer.
    pub fn layer_texture(&self, which: LayerTexture) -> Option<TextureRef> {
        self.layer_textures[which as usize]
    }

    /// The values that motion may change, with the textures and the thickness that some of them need, of which only their
    /// presence is told; the emission strength is already part of the emission.
    pub fn numbers(&self) -> Box<MaterialDesc> {
        let has = |texture: Option<TextureRef>| texture.map(|_| At::default());
        let numbers = self.numbers.desc();
        Box::new(MaterialDesc {
            base_color_texture: has(self.base_color_texture),
            metallic_roughness_texture: has(self.metallic_roughness_texture),
            normal_texture: has(self.normal_texture),
            // Any further texture is repeated by `uv_scale`, too.
            emission_texture: has(self.textures().into_iter().flatten().next()),
            occlusion_strength: self.occlusion_texture.map(|_| self.occlusion_strength),
            thickness_m: self.solid.then_some(1.0),
            base_color: Some(self.base_color.truncate()),
            alpha: (self.blended || numbers.alpha_cutoff.is_some()).then_some(self.base_color.w),
            emission: Some(self.emission),
            emission_strength: Some(1.0),
            checker: self.checker,
            patterned: self.patterned.clone(),
            ..numbers
        })
    }

    /// Sets the values that motion may change, where `desc` has them.
    pub fn set_numbers(&mut self, desc: &MaterialDesc) {
        self.numbers.set(desc);
        if let Some(color) = desc.base_color {
            self.base_color = color.extend(self.base_color.w);
        }
        self.base_color.w = desc.alpha.unwrap_or(self.base_color.w);
        self.checker = desc.checker.or(self.checker);
        let new = desc.patterned.iter().chain(&desc.bump);
        let is_new = |key: PatternedKey| new.clone().any(|p| p.value == key);
        (self.patterned).retain(|old| !desc.has(old.value.key()) && !is_new(old.value));
        self.patterned.extend(new.filter(|p| !p.is_flat()));
        if let Some(emission) = desc.emission {
            self.emission = emission;
        }
        if desc.emission.is_some() || desc.emission_strength.is_some() {
            let strength = desc.emission_strength.unwrap_or(1.0);
            self.emission *= strength;
            let of_emission = |p: &&mut PatternedDesc| p.value == PatternedKey::Emission;
            for pattern in self.patterned.iter_mut().filter(of_emission) {
                pattern.from *= strength;
                pattern.to *= strength;
            }
        }
    }

    /// Kinds of the patterns of its colors and numbers.
    pub fn pattern_kinds(&self) -> impl Iterator<Item = PatternKind> + '_ {
        let own = self.checker.iter().map(|checker| checker.kind);
        own.chain(self.patterned.iter().map(|p| p.kind))
    }

    /// Least and largest value over the surface of a number without its textures; of a color, over its channels too.
    pub fn extremes(&self, of: PatternedKey) -> [f32; 2] {
        let pattern = self.patterned.iter().find(|p| p.value == of);
        let plain = || find(&MATERIAL, of.key()).and_then(|field| (field.get)(&self.numbers()));
        let ends = pattern.map_or_else(|| [plain().unwrap_or_default(); 2], |p| [p.from, p.to]);
        [
            ends[0].min(ends[1]).min_element(),
            ends[0].max(ends[1]).max_element(),
        ]
    }
}

/// Single-scattering albedo of isotropic scattering by which a thick medium returns this color of diffuse light (Kulla & Conty
/// 2017, "Revisiting Physically Based Shading at Imageworks", inverse of van de Hulst's fit).
fn single_scattering_albedo(color: Vec3) -> Vec3 {
    color.map(|c| {
        let lack = 4.09712 + 4.20863 * c - (9.59217 + 41.6808 * c + 17.7126 * c * c).sqrt();
        1.0 - lack.clamp(0.0, 1.0).powi(2)
    })
}
