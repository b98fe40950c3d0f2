//! Materials of scene text: each key once, with everything that follows from it.

#[macro_use]
mod entry;
mod read;

use glam::Vec3;
use serde_json::Value as Json;

use super::{At, CheckerDesc, LightGroup, PatternKind, Tracks, track::tracks};
use crate::{
    number::{Field, Form, Lanes, find},
    range::{ABOVE_0, ANY, DISPERSION, FROM_0, INDEX, UNIT, range},
    table::{Table, color::Color},
};

declared! {
    /// How a material takes part in reflections.
    #[words]
    pub enum ReflectionMode = Auto {
        /// shows only the highlights of lights and environment; its reflections are never marched or traced.
        None = "none",
        /// reflects if its roughness is below `reflection.roughness_cutoff`, for metals below 6.25 times
        /// that. Roughness blurs the reflection: each sub-frame traces one ray in a random direction of the lobe, so
        /// more `image.samples` are smoother. Sharp up to roughness 0.04.
        Auto = "auto",
        /// reflects sharply, like polished glass, whatever its roughness.
        Mirror = "mirror",
    }
}

/// Factor on the emission, among [`LAYER_NUMBERS`].
pub const EMISSIVE_STRENGTH: &str = "emissive_strength/emissiveStrength";

/// Extensions of textures.
const TEXTURES: &[&str] = &["png", "jpg", "jpeg", "webp", "ktx2"];

material! {
    /// `[material.NAME]`, `[model.M.material.NAME]` (override of a glTF material; `"*"` means all of them and is
    /// applied first) and `material = {…}` of an instance. Keys left out keep the glTF value, or the default of a
    /// plain white, rough, non-metallic surface.
    ///
    /// A number or color whose kind says "or a table" varies over the surface where a pattern is written in its place:
    /// `roughness = { pattern = "noise", from = 0.1, to = 0.6, size_m = 0.2 }`. A track, a script or an override that
    /// sets it replaces the pattern. At most 6 in a material, with its `bump`. `"none"` in place of an image file leaves out the texture of a
    /// model's file, or of the material that this one extends, and in place of a `bump` its relief.
    ///
    /// - `pattern`: a procedural pattern of two colors, in place of `checker` and of a base color texture.
    /// - `extends`: name of a `[material.NAME]` that gives the values of keys left out here.
    pub struct MaterialDesc {
        /// Linear base color, three numbers 0 to 1, or a text, as for all colors outside of tracks: sRGB
        /// `"#ff8800"`, `"hsl(32, 100%, 50%)"` or `"hsv(32, 100%, 100%)"`, or `"3000 K"`, the glow of a black body of 1000
        /// to 40000 kelvin with 1 as its largest component, and below 1900 without the negative blue that sRGB cannot
        /// show. Default white.
        #[group("Surface")]
        base_color: Vec3, Color in UNIT, "linear base color" varies BaseColor, apart rest Vec3::ONE;
        /// Image file (PNG, JPEG, WebP or KTX2) multiplied into the base color. Its colors are sRGB; its alpha is used
        /// by `alpha` and `alpha_cutoff`.
        base_color_texture: At<String> [ANY] in TEXTURES;
        /// Procedural checker in place of a base color texture.
        checker: CheckerDesc;
        /// Metalness, 0 to 1: 0 is a dielectric such as plastic or stone, 1 a metal. Default 0.
        metallic: f32, Number in UNIT, "metalness" varies Metallic => rest 0.0;
        /// Perceptual roughness, 0 to 1: 0 is polished, 1 matte. Default 1.
        roughness: f32, Number in UNIT, "perceptual roughness" varies Roughness => rest 1.0;
        /// Roughness of the diffuse reflection, 0 to 1: 0 is Lambert's; more is flatter and brighter towards the light, as
        /// of clay, dust or the moon (the `base_diffuse_roughness` of OpenPBR). Default 0, or the glTF value.
        diffuse_roughness: f32, Number in UNIT, "roughness of the diffuse reflection" of "diffuse_roughness/diffuseRoughnessFactor" varies DiffuseRoughness => off "0";
        /// Image file with roughness in green and metalness in blue, multiplied with `roughness` and `metallic`.
        metallic_roughness_texture: At<String> [ANY] in TEXTURES;
        /// Image file with a tangent-space normal map (glTF convention, green is up).
        normal_texture: At<String> [ANY] in TEXTURES;
        /// Strength of the normal map, 0 to 4: 0 is flat, 1 as made, more is rougher relief. Default 1.
        normal_scale under normal_texture: f32, Number in range(0.0, 4.0), "strength of the normal map" => rest 1.0;
        /// Relief that only the light shows: `from` and `to` are heights above the surface, meters in object space, as in
        /// `{ pattern = "noise", from = 0, to = 0.002, size_m = 0.02 }`. Parts finer than a pixel are flat. Default: none.
        bump: PatternedDesc;
        /// Strength of the occlusion map of a glTF material, 0 to 1: how much it darkens the environment's light.
        /// Default 1, or the glTF value.
        occlusion_strength: f32, Number in UNIT, "strength of the file's occlusion map" => rest 1.0;
        /// Linear emitted color, three numbers 0 or more, multiplied by `emission_strength`. Default black.
        #[group("Emission")]
        emission: Vec3, Color in FROM_0, "linear emitted color" varies Emission, apart rest Vec3::ZERO;
        /// Factor on `emission`, 0 or more. 1 shows as white at exposure 0. Default 1.
        emission_strength under emission: f32, Number in FROM_0, "factor on `emission`" of EMISSIVE_STRENGTH, apart rest 1.0;
        /// Image file multiplied into the emission (sRGB).
        emission_texture: At<String> [ANY] in TEXTURES;
        /// Whether the surface's emission lights other surfaces, with shadows; else only reflections show it. For
        /// glowing walls or neon tubes. A scene has at most 1,048,576 such triangles, which are sampled; small or few
        /// ones need fewer `samples`. Default true for a glTF material whose own emission is above 1, else false.
        light: bool [ANY];
        /// Light group of the emission, and of all of an `unlit` surface, 1 to 31 letters, digits, `-` and `_`. Default
        /// "other".
        light_group: LightGroup [ANY];
        /// Whether the surface shows its base color and emission without lighting, as screens and signs do
        /// (`KHR_materials_unlit`). The camera also sees it without exposure and tone map. It reflects nothing.
        /// Default false, or the glTF value.
        unlit: bool [ANY];
        /// Texture repetitions per unit of the texture coordinates, two numbers: more is smaller. Default [1, 1].
        #[group("Surface")]
        uv_scale under base_color_texture | normal_texture | metallic_roughness_texture | emission_texture: [f32; 2], Pair in ANY, "texture repetitions, two numbers" => rest [1.0, 1.0];
        /// Alpha below which the surface is cut out, 0 to 1. Default: not cut out, or the glTF value.
        #[group("Opacity")]
        alpha_cutoff under base_color_texture | alpha: f32, Number in UNIT, "alpha below which the surface is cut out" => off "0";
        /// Share of light that the surface stops, 0 to 1, multiplied by the alpha of its base color texture; what is
        /// behind shows through by the rest (glTF's `BLEND`), also in reflections. Followed by rays. With an
        /// `alpha_cutoff`, the product is compared with that instead. Default 1, opaque, or the glTF value.
        alpha: f32, Number in UNIT, "share of light that the surface stops" varies Alpha, apart off "1";
        /// Whether the back of a triangle is seen. Default true for shapes; glTF's own for models.
        double_sided: bool [ANY];
        /// How the surface takes part in reflections. Default `"auto"`.
        #[group("Reflection")]
        reflection: ReflectionMode [ANY];
        /// Specular reflectance at normal incidence of the non-metallic part, 0 to 1: 0 has no specular reflection at
        /// all, 0.04 is glass or stone, 1 a perfect mirror. Default 0.04.
        reflectivity: f32, Number in UNIT, "specular reflectance at normal incidence" varies Reflectivity => rest 0.04;
        /// Share of the light that is not reflected and passes through, tinted by the base color, 0 to 1: 1 is glass.
        /// It is followed by rays, with any `reflection`. Default 0, or the glTF value.
        #[group("Transmission")]
        transmission: f32, Number in UNIT, "share of light that passes through" of "transmission/transmissionFactor" varies Transmission => off "0";
        /// Index of refraction, 1 to 4: 1.33 is water, 1.5 glass, 2.42 diamond. More bends light more if `thickness_m`
        /// is above 0, and gives more `reflectivity` if that is left out, with its exact reflectance at all angles. Default 1.5, or the glTF value.
        ior: f32;
        /// Thickness of a surface that light passes, meters, 0 or more: 0 is a thin sheet, through which light goes
        /// straight on; any other value makes the closed mesh a solid that refracts and absorbs along the way through
        /// it. Default 0, or the glTF value.
        thickness_m under transmission | scattering_color: f32 [FROM_0];
        /// Color that white light has after `attenuation_distance_m` inside a solid, three numbers 0 to 1. Default
        /// white.
        attenuation_color under transmission | scattering_color under attenuation_distance_m under thickness_m: Vec3, Color in UNIT, "color that white light gets inside a solid" of "volume/attenuationColor" => rest Vec3::ONE;
        /// Distance inside a solid after which white light has the `attenuation_color`, meters, above 0. Less absorbs
        /// more. Default: nothing is absorbed.
        attenuation_distance_m under transmission | scattering_color under thickness_m under attenuation_color: f32, Number in ABOVE_0, "distance after which white light has that color, meters" of "volume/attenuationDistance" => such_as "1";
        /// Color of a solid that scatters light within, as wax, skin, marble and milk do (subsurface scattering,
        /// `KHR_materials_volume_scatter`), three numbers 0 to 1: of the light that enters a thick piece, this is what comes
        /// out again. Light enters by `transmission`, refracted, or by `diffuse_transmission`, scattered. The attenuation says how deep
        /// it gets: of the light that is lost after that distance, most is scattered. Light that enters scattered is followed in
        /// paths with `diffuse_bounces`; past the last of them, and without, it leaves where it entered.
        /// Default black, or the glTF value.
        scattering_color under diffuse_transmission | transmission under thickness_m under attenuation_color under attenuation_distance_m: Vec3, Color in UNIT, "color of light scattered in a solid" of "volume_scatter/multiscatterColor" => off "[0, 0, 0]";
        /// How far that light is scattered onward rather than back, -1 to 1; 0 is even. More lets light get deeper, in the same color: it
        /// counts as even scattering in a less dense solid. Default 0, or the glTF value.
        scattering_anisotropy under scattering_color: f32, Number in range(-1.0, 1.0), "anisotropy of scattering in a solid" of "volume_scatter/scatterAnisotropy" => rest 0.0;
        /// Share of the diffuse light that a surface scatters to its other side rather than back, 0 to 1, as leaves, paper
        /// and lampshades do (`KHR_materials_diffuse_transmission`). Light goes through a surface as through a thin sheet,
        /// which both sides show, but for a solid with a `scattering_color`; inside a solid of `transmission` alone it is lost. Default 0, or the
        /// glTF value.
        diffuse_transmission: f32, Number in UNIT, "share of diffuse light that passes" of "diffuse_transmission/diffuseTransmissionFactor" varies DiffuseTransmission => off "0";
        /// Color of the diffuse light that passes, three numbers 0 to 1; the base color does not tint it. Default white,
        /// or the glTF value.
        diffuse_transmission_color under diffuse_transmission: Vec3, Color in UNIT, "color of the diffuse light that passes" of "diffuse_transmission/diffuseTransmissionColorFactor" varies DiffuseTransmissionColor => rest Vec3::ONE;
        /// Strength of a clear coat (varnish) over the material, 0 to 1. Default 0, or the glTF value.
        #[group("Clear coat")]
        clearcoat: f32, Number in UNIT, "strength of the clear coat" of "clearcoat/clearcoatFactor" varies Clearcoat => off "0";
        /// Perceptual roughness of the clear coat, 0 to 1. Default 0.
        clearcoat_roughness under clearcoat: f32, Number in UNIT, "perceptual roughness of the clear coat" of "clearcoat/clearcoatRoughnessFactor" varies ClearcoatRoughness => rest 0.0;
        /// Index of refraction of the clear coat, 1 to 4: more reflects more. Default 1.5, or the glTF value.
        clearcoat_ior under clearcoat: f32, Number in INDEX, "clear coat's index of refraction" of "clearcoat_ior/clearcoatIor" => off "1.5";
        /// Strength of the specular reflection of the non-metallic part, 0 to 1: a factor on `reflectivity` and on the
        /// reflectance at grazing angles (`KHR_materials_specular`); of metals too with `edge_tint`. Default 1, or the glTF value.
        #[group("Reflection")]
        specular: f32, Number in UNIT, "strength of the non-metallic specular reflection" of "specular/specularFactor" varies Specular => off "1";
        /// Color of the specular reflection of the non-metallic part at normal incidence, three numbers 0 or more: a
        /// factor on `reflectivity`, which makes at most 1; with `edge_tint` also a color of edges. Default white, or the glTF value.
        specular_color: Vec3, Color in FROM_0, "color of the non-metallic specular reflection" of "specular/specularColorFactor" varies SpecularColor => off "[1, 1, 1]";
        /// Whether `specular` times `specular_color`, at most 1, tints edges (`EXT_materials_specular_edge_color`). At an angle of 82° a metal
        /// reflects this share of the light that it would reflect without the key, and head on all of it, as real metals do (F82 of OpenPBR; `docs/light.md` has
        /// colors of some). The non-metallic part has the color at grazing angles too. A film (`iridescence`) tints in its place,
        /// but for pure metals. Default false, or the glTF value.
        edge_tint under specular_color | specular: bool [ANY];
        /// Color of a sheen over the material, the glow of cloth fibers towards grazing angles, three numbers 0 to 1
        /// (`KHR_materials_sheen`). Default black, no sheen, or the glTF value.
        #[group("Sheen")]
        sheen_color: Vec3, Color in UNIT, "color of the sheen" of "sheen/sheenColorFactor" varies SheenColor => off "[0, 0, 0]";
        /// Perceptual roughness of the sheen, 0 to 1: 0.1 is a thin rim as of satin, 1 an even glow as of felt; less
        /// than 0.07 counts as 0.07. Default 0, or the glTF value.
        sheen_roughness under sheen_color: f32, Number in UNIT, "perceptual roughness of the sheen" of "sheen/sheenRoughnessFactor" varies SheenRoughness => rest 0.0;
        /// Strength of a thin film over the material, whose interference colors change with the angle as on soap
        /// bubbles and oil, 0 to 1 (`KHR_materials_iridescence`). Default 0, none, or the glTF value.
        #[group("Thin film")]
        iridescence: f32, Number in UNIT, "strength of the thin film" of "iridescence/iridescenceFactor" varies Iridescence => off "0";
        /// Index of refraction of the thin film, 1 to 4: 1.33 is water. Default 1.3, or the glTF value.
        iridescence_ior under iridescence: f32, Number in INDEX, "thin film's index of refraction" of "iridescence/iridescenceIor" => rest 1.3;
        /// Thickness of the thin film, nanometers, 0 or more: colors are strongest from 200 to 600. Default 400, or
        /// the largest of the glTF values.
        iridescence_thickness_nm under iridescence: f32, Number in FROM_0, "thin film's thickness, nanometers" of "iridescence/iridescenceThicknessMaximum" varies IridescenceThickness => rest 400.0;
        /// Strength of the stretching of highlights and reflections along the grooves of brushed metal, 0 to 1: across
        /// the grooves they have the `roughness`, along them more, at 1 a roughness of 1 (`KHR_materials_anisotropy`).
        /// Default 0, or the glTF value.
        #[group("Anisotropy")]
        anisotropy: f32, Number in UNIT, "stretching of highlights along the grooves" of "anisotropy/anisotropyStrength" varies Anisotropy => off "0";
        /// Direction in which highlights are stretched, degrees counterclockwise from the right of an upright texture,
        /// along which u grows. Default 0, or the glTF value.
        anisotropy_rotation_deg under anisotropy: f32, Number in ANY, "direction of the grooves, degrees" of "anisotropy/anisotropyRotation" => rest 0.0;
        /// Dispersion of a solid, which bends blue light more than red, as 20 over the Abbe number, 0 to 40: 0.3 is
        /// crown glass, 0.36 diamond, 0.66 flint glass (`KHR_materials_dispersion`). Seen with 8 `samples` and more.
        /// Default 0, or the glTF value.
        #[group("Transmission")]
        dispersion under transmission under thickness_m: f32, Number in DISPERSION, "dispersion" of "dispersion/dispersion" => off "0";
    }
}

/// A key of a material that has no effect without another, or one of several.
pub struct Needing {
    /// The key.
    pub key: &'static str,
    /// The other key, or the first of several.
    pub needs: &'static str,
    /// Whether a material has the key without the other.
    pub is_alone: fn(&MaterialDesc) -> bool,
}

/// Reflectance at normal incidence of a dielectric with this index of refraction.
pub fn reflectivity_of(ior: f32) -> f32 {
    ((ior - 1.0) / (ior + 1.0)).powi(2)
}

impl MaterialDesc {
    /// Whether it has a value of this key of [`MATERIAL`].
    pub fn has(&self, key: &str) -> bool {
        find(&MATERIAL, key).is_some_and(|field| (field.get)(self).is_some())
    }
}

/// Largest number of values of one material that follow patterns.
pub const MOST_PATTERNED: usize = 6;

/// A number or color of a material that follows a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PatternedDesc {
    /// Number or color that varies.
    pub value: PatternedKey,
    /// Kind of the pattern.
    pub kind: PatternKind,
    /// Value of its first part; a number is in all three components.
    pub from: Vec3,
    /// Value of its second part.
    pub to: Vec3,
    /// Size of one cell, meters in object space, above 0.
    pub size_m: f32,
    /// Direction of the pattern's X in object space, unit length.
    pub axis: Vec3,
    /// Origin of the pattern in object space, meters.
    pub offset_m: Vec3,
    /// Whether each instance shows another part of the pattern.
    pub per_instance: bool,
}

impl PatternedDesc {
    /// A relief without heights, which takes the place of another one.
    const FLAT: Self = Self {
        value: PatternedKey::Bump,
        kind: PatternKind::Noise,
        from: Vec3::ZERO,
        to: Vec3::ZERO,
        size_m: 1.0,
        axis: Vec3::X,
        offset_m: Vec3::ZERO,
        per_instance: false,
    };

    /// Whether it is a relief of one height, which changes nothing.
    pub fn is_flat(&self) -> bool {
        self.value == PatternedKey::Bump && self.from == self.to
    }
}

declared! {
    /// `roughness = { pattern = "noise", from = 0.1, to = 0.6, size_m = 0.2 }`: a number of a material that varies over
    /// the surface, in object space, between two values. Textures multiply it. Detail finer than a pixel shows its
    /// mean.
    ///
    /// - `from`: value of the first part of the pattern, in the range of the number.
    /// - `to`: value of the second part of the pattern, in the range of the number.
    pub struct NumberPatternDesc(PatternedDesc);

    /// Keys that patterns of numbers and of colors share.
    ///
    /// - `pattern`: kind of the pattern.
    /// - `size_m`: size of one cell, brick, band or cloud, meters in object space, above 0.
    /// - `axis`: direction of the pattern's own X, three numbers, not all 0; its Y and Z turn with it by the smallest
    ///   rotation. Default [1, 0, 0].
    /// - `offset_m`: place of the pattern's origin, meters in object space, three numbers. Default [0, 0, 0].
    /// - `per_instance`: whether each instance, and each mesh of a model, shows another part of the pattern, as boards of one wood
    ///   do; not of a gradient. Which parts changes with the number of instances before. Default false.
    pub struct SharedPatternKeys;

    /// `base_color = { pattern = "noise", from = "#803010", to = "#e0e0e0", size_m = 0.2 }`: as a number that follows a
    /// pattern, with two colors.
    ///
    /// - `from`: color of the first part of the pattern, linear, or sRGB text, in the range of the color.
    /// - `to`: color of the second part of the pattern, linear, or sRGB text, in the range of the color.
    pub struct ColorPatternDesc;

    /// `[motion.material.NAME]`: tracks that change numbers of a `[material.NAME]`, wherever it is used. Values of a
    /// track outside of a number's range are clamped to it.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("[motion.material.NAME]")]
    pub struct MaterialMotionDesc {
        /// Tracks of the values of [`MATERIAL`].
        #[by(material_tracks)]
        pub tracks: Tracks,
    }
}

fn material_tracks(t: &mut Table) -> Option<Tracks> {
    let tracks = tracks(t, &MATERIAL);
    for field in &MATERIAL {
        t.explain(field.key, || field.track_text());
    }
    Some(tracks)
}

/// Track of a value of a material.
struct Track {
    /// Key that a material's own table must have before the value may change, as scene text; empty if it needs none.
    needs: &'static str,
    /// Value of that key which changes nothing; empty if there is none.
    off: &'static str,
}

/// Track of a value of the material's checker or pattern.
const OF_CHECKER: Track = Track {
    needs: "checker = { colors = [[1, 1, 1], [0, 0, 0]], size_m = 1 }",
    off: "",
};

impl Field<MaterialDesc> {
    fn track(&self) -> Option<&'static Track> {
        let index = MATERIAL.iter().position(|field| field.key == self.key)?;
        TRACKS.get(index)
    }

    /// Key that a material's own table must have before this field may change, as scene text; `None` if it needs
    /// none. Pipelines are chosen for the material at rest: one that is never cut out, say, does not test its
    /// alpha.
    pub fn lacks(&self, material: &MaterialDesc) -> Option<&'static str> {
        let needs = self.track()?.needs;
        ((self.get)(material).is_none() && !needs.is_empty()).then_some(needs)
    }

    /// Values that a material that lacks this number may get: such that change nothing, or an example; `None` where it
    /// has the number, or needs more than it.
    pub fn addition(&self, material: &MaterialDesc) -> Option<Vec<f64>> {
        let text = self.lacks(material)?.strip_prefix(self.key)?;
        let value = serde_json::from_str(text.strip_prefix(" = ")?).ok()?;
        match value {
            Json::Array(lanes) => lanes.iter().map(Json::as_f64).collect(),
            value => Some(vec![value.as_f64()?]),
        }
    }

    /// The value that changes nothing, of a number that a material may lack.
    pub fn off(&self) -> Option<Vec3> {
        let off = self.track()?.off.trim_start_matches('[');
        off.split(',').next()?.parse().ok().map(Vec3::splat)
    }

    /// Comment of the key of this field's track.
    pub fn track_text(&self) -> String {
        let Some(track) = self.track() else {
            return String::new();
        };
        let mut text = self.track_words();
        if track.needs.starts_with(&format!("{} =", self.key)) {
            let an = if self.key.starts_with(['a', 'i']) {
                "an"
            } else {
                "a"
            };
            text += &format!("; the material's own table must have {an} `{}`", self.key);
        }
        match track.off {
            "" => {}
            "[1, 1, 1]" => text += ", which may be white",
            "[0, 0, 0]" => text += ", which may be black",
            off => text += &format!(", which may be {off}"),
        }
        text + "."
    }
}
