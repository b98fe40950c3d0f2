//! Readers of materials and of the patterns that their colors and numbers follow.

use glam::Vec3;

use super::{
    ColorPatternDesc, MATERIAL, MOST_PATTERNED, MaterialDesc, NumberPatternDesc, PatternedDesc,
    PatternedKey, SharedPatternKeys, reflectivity_of,
};
use crate::declared::{Described, TypeDoc};
use crate::desc::{At, PatternDesc, PatternKind};
use crate::syntax::Node;
use crate::table::{Section, Table, ValueOr, color::Color, value::Value};
use crate::{
    number::{Lanes, find},
    range::{ABOVE_0, ANY, INDEX, Range},
};

impl Section for MaterialDesc {
    const HEADING: &'static str = "[material.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(
            false,
            &[&["checker"], &["pattern"], &["base_color_texture"]],
        );
        let checker = t.table("checker");
        let pattern = t.table("pattern").map(|PatternDesc(pattern)| pattern);
        // Already resolved in the tree; asking for it makes it a known key.
        t.find::<At<String>>("extends", ANY);
        t.refers("extends", &["material"]);
        let ior = t.find("ior", INDEX);
        let bump = t
            .table_or_none("bump", NumberPatternDesc(PatternedDesc::FLAT))
            .map(|NumberPatternDesc(heights)| PatternedDesc {
                value: PatternedKey::Bump,
                ..heights
            });
        let mut material = Self {
            checker: checker.or(pattern),
            ior,
            bump,
            ..Self::default()
        };
        let mut patterned = Vec::new();
        material.read_keys(t, &mut patterned);
        material.reflectivity = material.reflectivity.or(ior.map(reflectivity_of));
        if let Some(over) = (patterned.iter().chain(&bump))
            .filter(|pattern| !pattern.is_flat())
            .nth(MOST_PATTERNED)
        {
            let message = format!("a material has at most {MOST_PATTERNED} patterns");
            let help = "leave one out, or write a number in place of a pattern, or an image file for several of them";
            t.refuse("too-many-patterns", over.value.key(), &message, help);
        }
        Some(Self {
            patterned,
            ..material
        })
    }
}

/// A number, or the mean of the pattern that stands in its place, which is added to `patterned`.
pub fn number(
    t: &mut Table,
    value: PatternedKey,
    range: Range,
    patterned: &mut Vec<PatternedDesc>,
) -> Option<f32> {
    let read = |t: &mut Table| VariedBy::read::<f32>(t, range, Lanes::lanes);
    match t.value_or_table::<f32, NumberPatternDesc, _>(value.key(), range, read)? {
        ValueOr::Value(number) => Some(number),
        ValueOr::Table(varied) => Some(varied.add(value, patterned).x),
    }
}

/// A color, or the mean of the pattern that stands in its place, which is added to `patterned`.
pub fn color(
    t: &mut Table,
    value: PatternedKey,
    range: Range,
    patterned: &mut Vec<PatternedDesc>,
) -> Option<Vec3> {
    let read = |t: &mut Table| VariedBy::read(t, range, |Color(c)| c);
    match t.value_or_table::<Color, ColorPatternDesc, _>(value.key(), range, read)? {
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
        let per_instance = t.get("per_instance", ANY, false);
        if t.clean() && per_instance && kind == Some(PatternKind::Gradient) {
            let help = "leave it out, or take another pattern";
            let message = "a gradient has one part alone, so that `per_instance` moves it away";
            t.refuse("conflicting-keys", "per_instance", message, help);
        }
        if t.clean() && axis == Vec3::ZERO {
            let help = "write the direction along which the pattern varies, such as [0, 1, 0]";
            t.refuse("zero-direction", "axis", "`axis` must not be zero", help);
        }
        Some(Self(PatternedDesc {
            value: PatternedKey::BaseColor, // replaced by the key's
            kind: kind?,
            from: from?,
            to: to?,
            size_m: size_m?,
            axis: axis.as_dvec3().normalize_or_zero().as_vec3(),
            offset_m,
            per_instance,
        }))
    }

    /// Adds the pattern of a value to a list, and returns the middle of its two values.
    fn add(self, value: PatternedKey, to: &mut Vec<PatternedDesc>) -> Vec3 {
        to.push(PatternedDesc { value, ..self.0 });
        0.5 * (self.0.from + self.0.to)
    }
}

impl Section for NumberPatternDesc {
    const ALSO: &'static [&'static TypeDoc] = &[SharedPatternKeys::DOC];
    const HEADING: &'static str = "roughness = { pattern = … }";

    fn read(t: &mut Table) -> Option<Self> {
        VariedBy::read::<f32>(t, ANY, Lanes::lanes).map(|VariedBy(pattern)| Self(pattern))
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        if key == "bump" {
            let pattern = pattern_instead(value, ["0", "0.002"].map(str::to_owned));
            let any = "write `{ pattern = \"noise\", from = 0, to = 0.002, size_m = 0.02 }`, or `normal_texture` for an image";
            return pattern.or_else(|| Some(any.to_owned()));
        }
        let range = find(&MATERIAL, key)?.range;
        pattern_instead(value, [0.2, 0.8].map(|x| range.clamp(x).to_string()))
    }
}

impl Section for ColorPatternDesc {
    const ALSO: &'static [&'static TypeDoc] = &[SharedPatternKeys::DOC];
    const HEADING: &'static str = "base_color = { pattern = … }";

    fn read(t: &mut Table) -> Option<Self> {
        VariedBy::read::<Color>(t, ANY, |Color(c)| c).map(|_| Self)
    }

    fn instead(_: &str, value: &Node) -> Option<String> {
        pattern_instead(value, ["\"#404040\"", "\"#c0c0c0\""].map(str::to_owned))
    }
}

/// Advice for the name of a pattern in place of its table: a pattern between these two values.
fn pattern_instead(value: &Node, [from, to]: [String; 2]) -> Option<String> {
    let name = value.get_ref().as_str()?;
    PatternKind::from_name(name)?;
    Some(format!(
        "write {{ pattern = \"{name}\", from = {from}, to = {to}, size_m = 0.1 }}"
    ))
}
