//! Materials of scene text, and the table of their values that may change over time.

use glam::Vec3;

use super::{At, CheckerDesc, LightGroup, PatternedDesc, Tracks};
use crate::{
    number::{Field, Form, Lanes},
    range::{ABOVE_0, ANY, DISPERSION, FROM_0, INDEX, UNIT, range},
};

/// How a material takes part in reflections.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ReflectionMode {
    /// `"none"`: shows only the highlights of lights and environment; its reflections are never marched or traced.
    None,
    /// `"auto"`: reflects if its roughness is below `reflection.roughness_cutoff`, for metals below 6.25 times
    /// that. Roughness blurs the reflection: each sub-frame traces one ray in a random direction of the lobe, so
    /// more `image.samples` are smoother. Sharp up to roughness 0.04.
    #[default]
    Auto,
    /// `"mirror"`: reflects sharply, like polished glass, whatever its roughness.
    Mirror,
}

/// `[material.NAME]`, `[model.M.material.NAME]` (override of a glTF material; `"*"` means all of them and is
/// applied first) and `material = {…}` of an instance. Keys left out keep the glTF value, or the default of a
/// plain white, rough, non-metallic surface.
///
/// A number or color whose kind says "or a table" varies over the surface where a pattern is written in its place:
/// `roughness = { pattern = "noise", from = 0.1, to = 0.6, size_m = 0.2 }`. A track, a script or an override that sets it
/// replaces the pattern. At most 6 in a material.
///
/// - `pattern`: a procedural pattern of two colors, in place of `checker` and of a base color texture.
/// - `extends`: name of a `[material.NAME]` that gives the values of keys left out here.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct MaterialDesc {
    /// Linear base color, three numbers 0 to 1, or sRGB text such as `"#ff8800"`, as for all colors outside of
    /// tracks. Default white.
    pub base_color: Option<Vec3>,
    /// Image file (PNG, JPEG, WebP or KTX2) multiplied into the base color. Its colors are sRGB; its alpha is used
    /// by `alpha` and `alpha_cutoff`.
    pub base_color_texture: Option<At<String>>,
    /// Procedural checker in place of a base color texture.
    pub checker: Option<CheckerDesc>,
    /// Metalness, 0 to 1: 0 is a dielectric such as plastic or stone, 1 a metal. Default 0.
    pub metallic: Option<f32>,
    /// Perceptual roughness, 0 to 1: 0 is polished, 1 matte. Default 1.
    pub roughness: Option<f32>,
    /// Image file with roughness in green and metalness in blue, multiplied with `roughness` and `metallic`.
    pub metallic_roughness_texture: Option<At<String>>,
    /// Image file with a tangent-space normal map (glTF convention, green is up).
    pub normal_texture: Option<At<String>>,
    /// Strength of the normal map, 0 to 4: 0 is flat, 1 as made, more is rougher relief. Default 1.
    pub normal_scale: Option<f32>,
    /// Strength of the occlusion map of a glTF material, 0 to 1: how much it darkens the environment's light.
    /// Default 1, or the glTF value.
    pub occlusion_strength: Option<f32>,
    /// Linear emitted color, three numbers 0 or more, multiplied by `emission_strength`. Default black.
    pub emission: Option<Vec3>,
    /// Factor on `emission`, 0 or more. 1 shows as white at exposure 0. Default 1.
    pub emission_strength: Option<f32>,
    /// Image file multiplied into the emission (sRGB).
    pub emission_texture: Option<At<String>>,
    /// Whether the surface's emission lights other surfaces, with shadows; else only reflections show it. For
    /// glowing walls or neon tubes. A scene has at most 1,048,576 such triangles, which are sampled; small or few
    /// ones need fewer `samples`. Default false.
    pub light: Option<bool>,
    /// Light group of the emission, and of all of an `unlit` surface, 1 to 31 letters, digits, `-` and `_`. Default
    /// "other".
    pub light_group: Option<LightGroup>,
    /// Whether the surface shows its base color and emission without lighting, as screens and signs do
    /// (`KHR_materials_unlit`). The camera also sees it without exposure and tone map. It reflects nothing.
    /// Default false, or the glTF value.
    pub unlit: Option<bool>,
    /// Texture repetitions per unit of the texture coordinates, two numbers: more is smaller. Default [1, 1].
    pub uv_scale: Option<[f32; 2]>,
    /// Alpha below which the surface is cut out, 0 to 1. Default: not cut out, or the glTF value.
    pub alpha_cutoff: Option<f32>,
    /// Share of light that the surface stops, 0 to 1, multiplied by the alpha of its base color texture; what is
    /// behind shows through by the rest (glTF's `BLEND`), also in reflections. Followed by rays. With an
    /// `alpha_cutoff`, the product is compared with that instead. Default 1, opaque, or the glTF value.
    pub alpha: Option<f32>,
    /// Whether the back of a triangle is seen. Default true for shapes; glTF's own for models.
    pub double_sided: Option<bool>,
    /// How the surface takes part in reflections. Default `"auto"`.
    pub reflection: Option<ReflectionMode>,
    /// Specular reflectance at normal incidence of the non-metallic part, 0 to 1: 0 has no specular reflection at
    /// all, 0.04 is glass or stone, 1 a perfect mirror. Default 0.04.
    pub reflectivity: Option<f32>,
    /// Share of the light that is not reflected and passes through, tinted by the base color, 0 to 1: 1 is glass.
    /// It is followed by rays, with any `reflection`. Default 0, or the glTF value.
    pub transmission: Option<f32>,
    /// Index of refraction, 1 to 4: 1.33 is water, 1.5 glass, 2.42 diamond. More bends light more if `thickness_m`
    /// is above 0, and gives more `reflectivity` if that is left out. Default 1.5, or the glTF value.
    pub ior: Option<f32>,
    /// Thickness of a surface that light passes, meters, 0 or more: 0 is a thin sheet, through which light goes
    /// straight on; any other value makes the closed mesh a solid that refracts and absorbs along the way through
    /// it. Default 0, or the glTF value.
    pub thickness_m: Option<f32>,
    /// Color that white light has after `attenuation_distance_m` inside a solid, three numbers 0 to 1. Default
    /// white.
    pub attenuation_color: Option<Vec3>,
    /// Distance inside a solid after which white light has the `attenuation_color`, meters, above 0. Less absorbs
    /// more. Default: nothing is absorbed.
    pub attenuation_distance_m: Option<f32>,
    /// Strength of a clear coat (varnish) over the material, 0 to 1, of index of refraction 1.5. Default 0, or the
    /// glTF value.
    pub clearcoat: Option<f32>,
    /// Perceptual roughness of the clear coat, 0 to 1. Default 0.
    pub clearcoat_roughness: Option<f32>,
    /// Strength of the specular reflection of the non-metallic part, 0 to 1: a factor on `reflectivity` and on the
    /// reflectance at grazing angles (`KHR_materials_specular`). Default 1, or the glTF value.
    pub specular: Option<f32>,
    /// Color of the specular reflection of the non-metallic part at normal incidence, three numbers 0 or more: a
    /// factor on `reflectivity`; the product is at most 1. Default white, or the glTF value.
    pub specular_color: Option<Vec3>,
    /// Color of a sheen over the material, the glow of cloth fibers towards grazing angles, three numbers 0 to 1
    /// (`KHR_materials_sheen`). Default black, no sheen, or the glTF value.
    pub sheen_color: Option<Vec3>,
    /// Perceptual roughness of the sheen, 0 to 1: 0.1 is a thin rim as of satin, 1 an even glow as of felt; less
    /// than 0.07 counts as 0.07. Default 0, or the glTF value.
    pub sheen_roughness: Option<f32>,
    /// Strength of a thin film over the material, whose colors change with the angle as those of soap bubbles and
    /// oil, 0 to 1 (`KHR_materials_iridescence`). Default 0, none, or the glTF value.
    pub iridescence: Option<f32>,
    /// Index of refraction of the thin film, 1 to 4: 1.33 is water. Default 1.3, or the glTF value.
    pub iridescence_ior: Option<f32>,
    /// Thickness of the thin film, nanometers, 0 or more: colors are strongest from 200 to 600. Default 400, or
    /// the largest of the glTF values.
    pub iridescence_thickness_nm: Option<f32>,
    /// Strength of the stretching of highlights and reflections along the grooves of brushed metal, 0 to 1: across
    /// the grooves they have the `roughness`, along them more, at 1 a roughness of 1 (`KHR_materials_anisotropy`).
    /// Default 0, or the glTF value.
    pub anisotropy: Option<f32>,
    /// Direction in which highlights are stretched, degrees counterclockwise from the right of an upright texture,
    /// along which u grows. Default 0, or the glTF value.
    pub anisotropy_rotation_deg: Option<f32>,
    /// Dispersion of a solid, which bends blue light more than red, as 20 over the Abbe number, 0 to 40: 0.3 is
    /// crown glass, 0.36 diamond, 0.66 flint glass (`KHR_materials_dispersion`). Seen with 8 `samples` and more.
    /// Default 0, or the glTF value.
    pub dispersion: Option<f32>,
    /// Numbers and colors that follow a pattern; the fields above have the mean of each.
    pub patterned: Vec<PatternedDesc>,
}

/// Reflectance at normal incidence of a dielectric with this index of refraction.
pub fn reflectivity_of(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

impl MaterialDesc {
    /// Values of `over`, and of `self` where `over` has none.
    pub fn overlaid(&self, over: &Self) -> Self {
        let (b, o) = (self, over);
        let text = |over: &Option<_>, base: &Option<_>| over.clone().or_else(|| base.clone());
        let mut all = Self {
            base_color_texture: text(&o.base_color_texture, &b.base_color_texture),
            checker: o.checker.or(b.checker),
            metallic_roughness_texture: text(
                &o.metallic_roughness_texture,
                &b.metallic_roughness_texture,
            ),
            normal_texture: text(&o.normal_texture, &b.normal_texture),
            emission_texture: text(&o.emission_texture, &b.emission_texture),
            double_sided: o.double_sided.or(b.double_sided),
            light: o.light.or(b.light),
            light_group: o.light_group.or(b.light_group),
            unlit: o.unlit.or(b.unlit),
            reflection: o.reflection.or(b.reflection),
            ior: o.ior.or(b.ior),
            thickness_m: o.thickness_m.or(b.thickness_m),
            ..b.clone()
        };
        for field in &MATERIAL {
            if let Some(value) = (field.get)(over) {
                (field.put)(&mut all, value);
            }
        }
        all.patterned.extend_from_slice(&o.patterned);
        all
    }
}

/// `[motion.material.NAME]`: tracks that change numbers of a `[material.NAME]`, wherever it is used. Values of a
/// track outside of a number's range are clamped to it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MaterialMotionDesc {
    /// - `base_color`: track of the linear base color, 0 to 1.
    /// - `metallic`: track of the metalness, 0 to 1.
    /// - `roughness`: track of the perceptual roughness, 0 to 1.
    /// - `normal_scale`: track of the strength of the normal map, 0 to 4.
    /// - `occlusion_strength`: track of the strength of the file's occlusion map, 0 to 1.
    /// - `emission`: track of the linear emitted color, 0 or more.
    /// - `emission_strength`: track of the factor on `emission`, 0 or more.
    /// - `uv_scale`: track of the texture repetitions, two numbers.
    /// - `alpha_cutoff`: track of the alpha below which the surface is cut out, 0 to 1; the material's own table
    ///   must have an `alpha_cutoff`, which may be 0.
    /// - `alpha`: track of the share of light that the surface stops, 0 to 1; the material's own table must have
    ///   an `alpha`, which may be 1.
    /// - `reflectivity`: track of the specular reflectance at normal incidence, 0 to 1.
    /// - `transmission`: track of the share of light that passes through, 0 to 1; the material's own table must
    ///   have a `transmission`, which may be 0.
    /// - `attenuation_color`: track of the color that white light gets inside a solid, 0 to 1.
    /// - `attenuation_distance_m`: track of the distance after which white light has that color, meters, above 0;
    ///   the material's own table must have an `attenuation_distance_m`.
    /// - `clearcoat`: track of the strength of the clear coat, 0 to 1; the material's own table must have a
    ///   `clearcoat`, which may be 0.
    /// - `clearcoat_roughness`: track of the perceptual roughness of the clear coat, 0 to 1.
    /// - `specular`: track of the strength of the non-metallic specular reflection, 0 to 1; the material's own
    ///   table must have a `specular`, which may be 1.
    /// - `specular_color`: track of the color of the non-metallic specular reflection, 0 or more; the material's
    ///   own table must have a `specular_color`, which may be white.
    /// - `sheen_color`: track of the color of the sheen, 0 to 1; the material's own table must have a
    ///   `sheen_color`, which may be black.
    /// - `sheen_roughness`: track of the perceptual roughness of the sheen, 0 to 1.
    /// - `iridescence`: track of the strength of the thin film, 0 to 1; the material's own table must have an
    ///   `iridescence`, which may be 0.
    /// - `iridescence_ior`: track of the thin film's index of refraction, 1 to 4.
    /// - `iridescence_thickness_nm`: track of the thin film's thickness, nanometers, 0 or more.
    /// - `anisotropy`: track of the stretching of highlights along the grooves, 0 to 1; the material's own table
    ///   must have an `anisotropy`, which may be 0.
    /// - `anisotropy_rotation_deg`: track of the direction of the grooves, degrees.
    /// - `dispersion`: track of the dispersion, 0 to 40; the material's own table must have a `dispersion`, which
    ///   may be 0.
    /// - `checker_a`: track of the first color of its `checker` or `pattern`, 0 to 1.
    /// - `checker_b`: track of the second color of its `checker` or `pattern`, 0 to 1.
    /// - `checker_size_m`: track of the cell size of its `checker` or `pattern`, meters, above 0.
    pub tracks: Tracks,
}

/// Row of [`MATERIAL`] for a field that is an `Option`.
macro_rules! optional {
    ($key:ident, $form:ident, $range:expr) => {
        Field {
            key: stringify!($key),
            form: Form::$form,
            range: $range,
            get: |it| it.$key.map(Lanes::lanes),
            put: |it, value| {
                it.patterned.retain(|p| p.value.key() != stringify!($key));
                it.$key = Some(Lanes::of(value));
            },
        }
    };
}

/// Row of [`MATERIAL`] for a value of the material's checker or pattern.
macro_rules! of_checkers {
    ($key:literal, $form:ident, $range:expr, |$checker:ident| $value:expr) => {
        Field {
            key: $key,
            form: Form::$form,
            range: $range,
            get: |it| it.checker.as_ref().map(|$checker| $value.lanes()),
            put: |it, value| {
                if let Some($checker) = &mut it.checker {
                    $value = Lanes::of(value);
                }
            },
        }
    };
}

/// Number of values of a material that may change.
pub const MATERIAL_FIELDS: usize = 29;

/// Values of a material that tracks and scripts may change.
pub static MATERIAL: [Field<MaterialDesc>; MATERIAL_FIELDS] = [
    optional!(base_color, Color, UNIT),
    optional!(metallic, Number, UNIT),
    optional!(roughness, Number, UNIT),
    optional!(normal_scale, Number, range(0.0, 4.0)),
    optional!(occlusion_strength, Number, UNIT),
    optional!(emission, Color, FROM_0),
    optional!(emission_strength, Number, FROM_0),
    optional!(uv_scale, Pair, ANY),
    optional!(alpha_cutoff, Number, UNIT),
    optional!(alpha, Number, UNIT),
    optional!(reflectivity, Number, UNIT),
    optional!(transmission, Number, UNIT),
    optional!(attenuation_color, Color, UNIT),
    optional!(attenuation_distance_m, Number, ABOVE_0),
    optional!(clearcoat, Number, UNIT),
    optional!(clearcoat_roughness, Number, UNIT),
    optional!(specular, Number, UNIT),
    optional!(specular_color, Color, FROM_0),
    optional!(sheen_color, Color, UNIT),
    optional!(sheen_roughness, Number, UNIT),
    optional!(iridescence, Number, UNIT),
    optional!(iridescence_ior, Number, INDEX),
    optional!(iridescence_thickness_nm, Number, FROM_0),
    optional!(anisotropy, Number, UNIT),
    optional!(anisotropy_rotation_deg, Number, ANY),
    optional!(dispersion, Number, DISPERSION),
    of_checkers!("checker_a", Color, UNIT, |checker| checker.colors[0]),
    of_checkers!("checker_b", Color, UNIT, |checker| checker.colors[1]),
    of_checkers!("checker_size_m", Number, ABOVE_0, |checker| checker.size_m),
];

/// Default values of keys that a material leaves out.
pub const PLAIN: MaterialDesc = MaterialDesc {
    base_color: Some(Vec3::ONE),
    base_color_texture: None,
    checker: None,
    metallic: Some(0.0),
    roughness: Some(1.0),
    metallic_roughness_texture: None,
    normal_texture: None,
    normal_scale: Some(1.0),
    occlusion_strength: Some(1.0),
    emission: Some(Vec3::ZERO),
    emission_strength: Some(1.0),
    emission_texture: None,
    light: None,
    light_group: None,
    unlit: None,
    uv_scale: Some([1.0, 1.0]),
    alpha_cutoff: None,
    alpha: None,
    double_sided: None,
    reflection: None,
    reflectivity: Some(0.04),
    transmission: None,
    ior: None,
    thickness_m: None,
    attenuation_color: Some(Vec3::ONE),
    attenuation_distance_m: None,
    clearcoat: None,
    clearcoat_roughness: Some(0.0),
    specular: None,
    specular_color: None,
    sheen_color: None,
    sheen_roughness: Some(0.0),
    iridescence: None,
    iridescence_ior: Some(1.3),
    iridescence_thickness_nm: Some(400.0),
    anisotropy: None,
    anisotropy_rotation_deg: Some(0.0),
    dispersion: None,
    patterned: Vec::new(),
};

impl Field<MaterialDesc> {
    /// Key that a material's own table must have before this field may change, as scene text; `None` if it needs
    /// none. Pipelines are chosen for the material at rest: one that is never cut out, say, does not test its
    /// alpha.
    pub fn lacks(&self, material: &MaterialDesc) -> Option<&'static str> {
        if (self.get)(material).is_some() || (self.get)(&PLAIN).is_some() {
            return None;
        }
        Some(match self.key {
            "alpha_cutoff" => "alpha_cutoff = 0",
            "alpha" => "alpha = 1",
            "transmission" => "transmission = 0",
            "attenuation_distance_m" => "attenuation_distance_m = 1",
            "clearcoat" => "clearcoat = 0",
            "specular" => "specular = 1",
            "specular_color" => "specular_color = [1, 1, 1]",
            "sheen_color" => "sheen_color = [0, 0, 0]",
            "iridescence" => "iridescence = 0",
            "anisotropy" => "anisotropy = 0",
            "dispersion" => "dispersion = 0",
            _ => "checker = { colors = [[1, 1, 1], [0, 0, 0]], size_m = 1 }",
        })
    }
}
