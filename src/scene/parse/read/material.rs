//! Readers of materials and of the patterns that their colors and numbers follow.

use glam::Vec3;

use crate::{
    desc::*,
    number::Lanes,
    parse::{
        color::Color,
        table::{Section, Table, ValueOr},
        value::Value,
    },
    range::{ABOVE_0, ANY, DISPERSION, FROM_0, INDEX, Range, UNIT, range},
};

impl Section for MaterialDesc {
    const TYPE: &'static str = "MaterialDesc";
    const HEADING: &'static str = "[material.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(
            false,
            &[&["checker"], &["pattern"], &["base_color_texture"]],
        );
        let checker = t.table("checker");
        let pattern = t.table("pattern").map(|Pattern(pattern)| pattern);
        // Already resolved in the tree; asking for it makes it a known key.
        t.find::<At<String>>("extends", ANY);
        let ior = t.find("ior", INDEX);
        let mut patterned = Vec::new();
        let p = &mut patterned;
        let material = Self {
            base_color: color(t, PatternedKey::BaseColor, UNIT, p),
            base_color_texture: t.find("base_color_texture", ANY),
            checker: checker.or(pattern),
            metallic: number(t, PatternedKey::Metallic, UNIT, p),
            roughness: number(t, PatternedKey::Roughness, UNIT, p),
            metallic_roughness_texture: t.find("metallic_roughness_texture", ANY),
            normal_texture: t.find("normal_texture", ANY),
            normal_scale: t.find("normal_scale", range(0.0, 4.0)),
            occlusion_strength: t.find("occlusion_strength", UNIT),
            emission: color(t, PatternedKey::Emission, FROM_0, p),
            emission_strength: t.find("emission_strength", FROM_0),
            emission_texture: t.find("emission_texture", ANY),
            light: t.find("light", ANY),
            light_group: t.find("light_group", ANY),
            unlit: t.find("unlit", ANY),
            uv_scale: t.find("uv_scale", ANY),
            alpha_cutoff: t.find("alpha_cutoff", UNIT),
            alpha: number(t, PatternedKey::Alpha, UNIT, p),
            double_sided: t.find("double_sided", ANY),
            reflection: t.find("reflection", ANY),
            reflectivity: number(t, PatternedKey::Reflectivity, UNIT, p)
                .or(ior.map(reflectivity_of)),
            transmission: number(t, PatternedKey::Transmission, UNIT, p),
            ior,
            thickness_m: t.find("thickness_m", FROM_0),
            attenuation_color: (t.find("attenuation_color", UNIT)).map(|Color(c)| c),
            attenuation_distance_m: t.find("attenuation_distance_m", ABOVE_0),
            clearcoat: number(t, PatternedKey::Clearcoat, UNIT, p),
            clearcoat_roughness: number(t, PatternedKey::ClearcoatRoughness, UNIT, p),
            specular: number(t, PatternedKey::Specular, UNIT, p),
            specular_color: color(t, PatternedKey::SpecularColor, FROM_0, p),
            sheen_color: color(t, PatternedKey::SheenColor, UNIT, p),
            sheen_roughness: number(t, PatternedKey::SheenRoughness, UNIT, p),
            iridescence: number(t, PatternedKey::Iridescence, UNIT, p),
            iridescence_ior: t.find("iridescence_ior", INDEX),
            iridescence_thickness_nm: number(t, PatternedKey::IridescenceThickness, FROM_0, p),
            anisotropy: number(t, PatternedKey::Anisotropy, UNIT, p),
            anisotropy_rotation_deg: t.find("anisotropy_rotation_deg", ANY),
            dispersion: t.find("dispersion", DISPERSION),
            patterned: Vec::new(),
        };
        if let Some(over) = patterned.get(MOST_PATTERNED) {
            let message = format!("a material has at most {MOST_PATTERNED} patterns");
            let help = "write a number in place of a pattern, or an image file for several of them";
            t.refuse("too-many-patterns", over.value.key(), &message, help);
        }
        Some(Self {
            patterned,
            ..material
        })
    }
}

/// A number, or the mean of the pattern that stands in its place, which is added to `patterned`.
fn number(
    t: &mut Table,
    value: PatternedKey,
    range: Range,
    patterned: &mut Vec<PatternedDesc>,
) -> Option<f32> {
    let read = |t: &mut Table| VariedBy::read::<f32>(t, range, Lanes::lanes);
    match t.value_or_table::<f32, NumberPattern, _>(value.key(), range, read)? {
        ValueOr::Value(number) => Some(number),
        ValueOr::Table(varied) => Some(varied.add(value, patterned).x),
    }
}

/// A color, or the mean of the pattern that stands in its place, which is added to `patterned`.
fn color(
    t: &mut Table,
    value: PatternedKey,
    range: Range,
    patterned: &mut Vec<PatternedDesc>,
) -> Option<Vec3> {
    let read = |t: &mut Table| VariedBy::read(t, range, |Color(c)| c);
    match t.value_or_table::<Color, ColorPattern, _>(value.key(), range, read)? {
        ValueOr::Value(Color(color)) => Some(color),
        ValueOr::Table(varied) => Some(varied.add(value, patterned)),
    }
}

/// The pattern that a value follows.
struct VariedBy(PatternedDesc);

impl VariedBy {
    /// Reads a pattern between two values of a range.
    fn read<V: Value>(t: &mut Table, range: Range, lanes: fn(V) -> Vec3) -> Option<Self> {
        let kind = t.need("pattern", ANY);
        let from = t.need("from", range).map(lanes);
        let to = t.need("to", range).map(lanes);
        let size_m = t.need("size_m", ABOVE_0);
        let axis: Vec3 = t.get("axis", ANY, Vec3::X);
        let offset_m = t.get("offset_m", ANY, Vec3::ZERO);
        if t.clean() && axis == Vec3::ZERO {
            let help = "write the direction along which the pattern varies, such as [0, 1, 0]";
            t.refuse("zero-direction", "axis", "`axis` must not be zero", help);
        }
        Some(Self(PatternedDesc {
            value: PatternedKey::BaseColor, // replaced by that of the key
            kind: kind?,
            from: from?,
            to: to?,
            size_m: size_m?,
            axis: axis.as_dvec3().normalize_or_zero().as_vec3(),
            offset_m,
        }))
    }

    /// Adds the pattern of a value to a list, and returns the value's mean.
    fn add(self, value: PatternedKey, to: &mut Vec<PatternedDesc>) -> Vec3 {
        to.push(PatternedDesc { value, ..self.0 });
        0.5 * (self.0.from + self.0.to)
    }
}

/// Description of the table of a number's pattern.
struct NumberPattern;

impl Section for NumberPattern {
    const TYPE: &'static str = "NumberPatternDesc";
    const HEADING: &'static str = "roughness = { pattern = … }";

    fn read(t: &mut Table) -> Option<Self> {
        VariedBy::read::<f32>(t, ANY, Lanes::lanes).map(|_| Self)
    }
}

/// Description of the table of a color's pattern.
struct ColorPattern;

impl Section for ColorPattern {
    const TYPE: &'static str = "ColorPatternDesc";
    const HEADING: &'static str = "base_color = { pattern = … }";

    fn read(t: &mut Table) -> Option<Self> {
        VariedBy::read::<Color>(t, ANY, |Color(c)| c).map(|_| Self)
    }
}

impl Section for CheckerDesc {
    const TYPE: &'static str = "CheckerDesc";
    const HEADING: &'static str = "checker = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let colors: Option<[Color; 2]> = t.need("colors", UNIT);
        let size_m = t.need("size_m", ABOVE_0);
        Some(Self {
            colors: colors?.map(|Color(c)| c),
            size_m: size_m?,
            kind: PatternKind::Checker,
        })
    }
}

/// A pattern: a checker with a `kind`.
struct Pattern(CheckerDesc);

impl Section for Pattern {
    const TYPE: &'static str = "PatternDesc";
    const HEADING: &'static str = "pattern = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let kind = t.get("kind", ANY, PatternKind::default());
        let checker = CheckerDesc::read(t)?;
        Some(Self(CheckerDesc { kind, ..checker }))
    }
}
