//! Materials: the properties of a surface for shading and ray tracing.

use glam::{Vec3, Vec4};
use serde::Serialize;

use super::{
    TextureRef,
    material_textures::{CoreTexture, LAYER_SLOTS, LayerTexture, TEXTURE_SLOTS},
};
use reflet_scene::desc::{
    CheckerDesc, LightGroup, MATERIAL, MaterialDesc, PatternKind, PatternedDesc, PatternedKey,
    ReflectionMode,
};

/// A surface description after all overrides; textures are indices into [`World::textures`](super::World::textures).
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from scene text or file.
    pub name: String,
    /// Base color, linear; alpha in w.
    pub base_color: Vec4,
    /// Metallic share, 0 to 1.
    pub metallic: f32,
    /// Perceptual roughness, 0 to 1.
    pub roughness: f32,
    /// Specular reflectance at normal incidence of the dielectric part, 0 to 1.
    pub reflectivity: f32,
    /// Emitted linear radiance, strength already multiplied in.
    pub emission: Vec3,
    /// Whether the emission lights the scene; else it is only seen, directly and in reflections.
    pub light: bool,
    /// Light group of the emission.
    pub light_group: LightGroup,
    /// Whether `light` comes from the file (a mesh light), and not from the scene text.
    pub is_mesh_light: bool,
    /// Strength of the normal map.
    pub normal_scale: f32,
    /// Texture repetitions along u and v, on top of each texture's own transform.
    pub uv_scale: [f32; 2],
    /// Strength of the occlusion map, 0 to 1; it darkens the environment's light only, not that of other lights.
    pub occlusion_strength: f32,
    /// Alpha threshold of a cut-out; `None`: no cut-out.
    pub alpha_cutoff: Option<f32>,
    /// Whether the surface is double-sided.
    pub double_sided: bool,
    /// Whether the base color is shown unchanged, without lighting, exposure and tone mapping
    /// (KHR_materials_unlit). Such a material has no specular.
    pub unlit: bool,
    /// Share of the unreflected light that is transmitted, 0 to 1; `None`: it never is.
    pub transmission: Option<f32>,
    /// Whether transmitted light is refracted, and absorbed up to the other side of the mesh.
    pub solid: bool,
    /// Index of refraction inside of a solid, 1 or more.
    pub ior: f32,
    /// Color of white light after the attenuation distance inside.
    pub attenuation_color: Vec3,
    /// Attenuation distance, meters; `None`: nothing is absorbed.
    pub attenuation_distance_m: Option<f32>,
    /// Strength of the clear coat, 0 to 1; `None`: it never has one.
    pub clearcoat: Option<f32>,
    /// Perceptual roughness of the clear coat, 0 to 1.
    pub clearcoat_roughness: f32,
    /// Strength of the clear coat's own normal map.
    pub clearcoat_normal_scale: f32,
    /// Factor on the reflectivity and on the grazing reflectance of the dielectric part, 0 to 1; `None`: always 1.
    pub specular: Option<f32>,
    /// Color factor on the reflectivity, 0 or more; `None`: always white.
    pub specular_color: Option<Vec3>,
    /// Color of the sheen, 0 to 1; `None`: it never has one.
    pub sheen_color: Option<Vec3>,
    /// Perceptual roughness of the sheen, 0 to 1.
    pub sheen_roughness: f32,
    /// Strength of the thin film, 0 to 1; `None`: it never has one.
    pub iridescence: Option<f32>,
    /// Index of refraction of the film, 1 or more.
    pub iridescence_ior: f32,
    /// Thickness of the film, nanometers; where a texture varies it, at its largest values.
    pub iridescence_thickness_nm: f32,
    /// Thickness of the film at the texture's least values, nanometers.
    pub iridescence_least_nm: f32,
    /// Strength of the anisotropy, which stretches the lobe along its direction, 0 to 1; `None`: always isotropic.
    pub anisotropy: Option<f32>,
    /// Angle of the anisotropy's direction from the tangent towards the bitangent, degrees.
    pub anisotropy_rotation_deg: f32,
    /// Dispersion: 20 divided by the Abbe number; `None`: all colors are refracted alike.
    pub dispersion: Option<f32>,
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

/// The material variants of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ListedVariants {
    /// Name of the `[model.NAME]`.
    pub model: String,
    /// Names of the variants in scene text.
    pub names: Vec<String>,
    /// Name of the shown variant; `None`: the file's own materials are shown.
    pub shown: Option<String>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: Vec4::ONE,
            metallic: 0.0,
            roughness: 1.0,
            reflectivity: 0.04,
            emission: Vec3::ZERO,
            light: false,
            light_group: LightGroup::default(),
            is_mesh_light: false,
            normal_scale: 1.0,
            uv_scale: [1.0; 2],
            occlusion_strength: 1.0,
            alpha_cutoff: None,
            double_sided: false,
            unlit: false,
            transmission: None,
            solid: false,
            ior: 1.5,
            attenuation_color: Vec3::ONE,
            attenuation_distance_m: None,
            clearcoat: None,
            clearcoat_roughness: 0.0,
            clearcoat_normal_scale: 1.0,
            specular: None,
            specular_color: None,
            sheen_color: None,
            sheen_roughness: 0.0,
            iridescence: None,
            iridescence_ior: 1.3,
            iridescence_thickness_nm: 400.0,
            iridescence_least_nm: 100.0,
            anisotropy: None,
            anisotropy_rotation_deg: 0.0,
            dispersion: None,
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
    /// Base color, metallic-roughness, normal, occlusion and emission textures and those of the layers, in the order
    /// in which the shaders know them, with `uv_scale` in their transforms.
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
            uv_scale: self.uv_scale,
            emission: self.emission,
            emission_texture: self.emission_texture,
            light: self.light,
            light_group: self.light_group,
            is_mesh_light: self.is_mesh_light,
            alpha_cutoff: self.alpha_cutoff,
            blended: self.blended,
            double_sided: self.double_sided,
            reflectivity: 0.0,
            reflection: ReflectionMode::None,
            ..Self::default()
        }
    }

    /// Whether the material may let light through.
    pub fn passes_light(&self) -> bool {
        self.transmission.is_some() || self.blended
    }

    /// Absorption coefficient inside the material, per meter, by the Beer-Lambert law.
    pub fn absorption(&self) -> Vec3 {
        const LEAST: f32 = 1e-6; // black after the distance, without infinities
        let distance_m = self.attenuation_distance_m.unwrap_or(f32::INFINITY);
        let color = self.attenuation_color.max(Vec3::splat(LEAST));
        (color.map(|c| -c.ln()) / distance_m).min(Vec3::splat(1e12))
    }

    /// The textures without `uv_scale` in their transforms, in the order of [`Self::slots`].
    pub fn textures(&self) -> [Option<TextureRef>; TEXTURE_SLOTS] {
        let core = CoreTexture::ALL.map(|texture| match texture {
            CoreTexture::BaseColor => self.base_color_texture,
            CoreTexture::MetallicRoughness => self.metallic_roughness_texture,
            CoreTexture::Normal => self.normal_texture,
            CoreTexture::Occlusion => self.occlusion_texture,
            CoreTexture::Emission => self.emission_texture,
        });
        let all = core.into_iter().chain(self.layer_textures);
        let mut slots = [None; TEXTURE_SLOTS];
        slots
            .iter_mut()
            .zip(all)
            .for_each(|(slot, used)| *slot = used);
        slots
    }

    /// The texture fields for writing, in the order of [`Self::slots`].
    pub fn texture_slots(&mut self) -> [&mut Option<TextureRef>; TEXTURE_SLOTS] {
        let [a, b, c, d, e, f, g, h, i, j, k] = &mut self.layer_textures;
        [
            &mut self.base_color_texture,
            &mut self.metallic_roughness_texture,
            &mut self.normal_texture,
            &mut self.occlusion_texture,
            &mut self.emission_texture,
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
            i,
            j,
            k,
        ]
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

    /// The values that motion may change; the emission strength is already part of the emission.
    pub fn numbers(&self) -> Box<MaterialDesc> {
        Box::new(MaterialDesc {
            base_color: Some(self.base_color.truncate()),
            metallic: Some(self.metallic),
            roughness: Some(self.roughness),
            normal_scale: Some(self.normal_scale),
            occlusion_strength: Some(self.occlusion_strength),
            uv_scale: Some(self.uv_scale),
            alpha_cutoff: self.alpha_cutoff,
            alpha: self.blended.then_some(self.base_color.w),
            emission: Some(self.emission),
            emission_strength: Some(1.0),
            reflectivity: Some(self.reflectivity),
            transmission: self.transmission,
            attenuation_color: Some(self.attenuation_color),
            attenuation_distance_m: self.attenuation_distance_m,
            clearcoat: self.clearcoat,
            clearcoat_roughness: Some(self.clearcoat_roughness),
            specular: self.specular,
            specular_color: self.specular_color,
            sheen_color: self.sheen_color,
            sheen_roughness: Some(self.sheen_roughness),
            iridescence: self.iridescence,
            iridescence_ior: Some(self.iridescence_ior),
            iridescence_thickness_nm: Some(self.iridescence_thickness_nm),
            anisotropy: self.anisotropy,
            anisotropy_rotation_deg: Some(self.anisotropy_rotation_deg),
            dispersion: self.dispersion,
            checker: self.checker,
            patterned: self.patterned.clone(),
            ..MaterialDesc::default()
        })
    }

    /// Sets the values that motion may change, where `desc` has them.
    pub fn set_numbers(&mut self, desc: &MaterialDesc) {
        fn set<T>(slot: &mut T, value: Option<T>) {
            if let Some(value) = value {
                *slot = value;
            }
        }
        if let Some(color) = desc.base_color {
            self.base_color = color.extend(self.base_color.w);
        }
        set(&mut self.base_color.w, desc.alpha);
        set(&mut self.metallic, desc.metallic);
        set(&mut self.roughness, desc.roughness);
        set(&mut self.normal_scale, desc.normal_scale);
        set(&mut self.occlusion_strength, desc.occlusion_strength);
        set(&mut self.uv_scale, desc.uv_scale);
        self.alpha_cutoff = desc.alpha_cutoff.or(self.alpha_cutoff);
        self.checker = desc.checker.or(self.checker);
        set(&mut self.reflectivity, desc.reflectivity);
        self.transmission = desc.transmission.or(self.transmission);
        set(&mut self.attenuation_color, desc.attenuation_color);
        self.attenuation_distance_m = desc.attenuation_distance_m.or(self.attenuation_distance_m);
        self.clearcoat = desc.clearcoat.or(self.clearcoat);
        set(&mut self.clearcoat_roughness, desc.clearcoat_roughness);
        self.specular = desc.specular.or(self.specular);
        self.specular_color = desc.specular_color.or(self.specular_color);
        self.sheen_color = desc.sheen_color.or(self.sheen_color);
        set(&mut self.sheen_roughness, desc.sheen_roughness);
        self.iridescence = desc.iridescence.or(self.iridescence);
        set(&mut self.iridescence_ior, desc.iridescence_ior);
        set(
            &mut self.iridescence_thickness_nm,
            desc.iridescence_thickness_nm,
        );
        self.anisotropy = desc.anisotropy.or(self.anisotropy);
        set(
            &mut self.anisotropy_rotation_deg,
            desc.anisotropy_rotation_deg,
        );
        self.dispersion = desc.dispersion.or(self.dispersion);
        self.patterned.retain(|old| {
            let field = MATERIAL.iter().find(|field| field.key == old.value.key());
            field.is_none_or(|field| (field.get)(desc).is_none())
        });
        self.patterned.extend_from_slice(&desc.patterned);
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
    pub fn extremes(&self, of: PatternedKey, value: f32) -> [f32; 2] {
        let pattern = self.patterned.iter().find(|p| p.value == of);
        pattern.map_or([value; 2], |p| {
            let (least, most) = (p.from.min(p.to), p.from.max(p.to));
            [least.min_element(), most.max_element()]
        })
    }

    /// Least and largest roughness over the surface.
    pub fn roughness_extremes(&self) -> [f32; 2] {
        self.extremes(PatternedKey::Roughness, self.roughness)
    }

    /// Least and largest roughness of the clear coat over the surface.
    pub fn coat_roughness_extremes(&self) -> [f32; 2] {
        self.extremes(PatternedKey::ClearcoatRoughness, self.clearcoat_roughness)
    }
}
