//! Contents of pages as JSON: keys, panels and handles; `src/write_back/page` shows them.

use std::iter;

use glam::{Vec2, Vec3, vec2};
use serde_json::{Value, json};

use super::{
    KeyTrack, Numbers, SceneItem,
    handles::{END, Handle},
    numbers_of,
    outline::{LeftOut, OutlineRow},
    presses::{FIRST_METHODS, KEYS, KeyAction, KeyRow, rivals},
    selection::Selection,
};
use reflet_render::runtime::parameters::{DeclaredParameters, ParameterOverrides};
use reflet_scene::{
    desc::{
        CAMERA, CameraDesc, ENVIRONMENT, LIGHT, MATERIAL, MaterialDesc, Method, NEEDING, ParamValue,
    },
    manual::key_text,
    motion::DECAL,
    number::{Field, Form, find},
    parse::{SectionRecord, recorded_keys},
    range::{LIMIT, Range},
};

/// Names and texts of files beside this one.
macro_rules! files {
    ($($name:literal,)*) => { [$(($name, include_str!(concat!("page/", $name)))),*] };
}

/// Files of pages of a view, each with its name in the folder of a page and its text.
pub const FILES: [(&str, &str); 10] = files!(
    "choices.js",
    "handles.js",
    "keyboard.js",
    "keys.js",
    "numbers.js",
    "panels.js",
    "picture.js",
    "pointer.js",
    "style.css",
    "timeline.js",
);

/// Height of the picture in points, in which handles have their length.
const HEIGHT: f32 = 600.0;

/// Symbols of units by the ends of keys that name them.
const UNITS: [(&str, &str); 8] = [
    ("m", "m"),
    ("nm", "nm"),
    ("deg", "°"),
    ("cd", "cd"),
    ("lm", "lm"),
    ("lux", "lx"),
    ("w", "W"),
    ("s", "s"),
];

/// Keys that pages have in place of the window's that need a held button.
const OF_PAGES: [[&str; 2]; 2] = [
    ["arrows, + -", "orbit, closer, farther, on the picture"],
    ["W A S D Q E", "fly; Shift: four times as fast"],
];

/// Methods that pages offer: `auto`, then the methods with keys, then their rivals.
pub fn methods() -> impl Iterator<Item = Method> {
    iter::once(Method::Auto)
        .chain(FIRST_METHODS)
        .chain(rivals())
}

/// Keys of a page that has no use for some actions, and finds the presses of `own` itself: `presses` with their actions, and the
/// rows of its `help`. No page opens other scenes by a key.
pub fn keys(lost: &[KeyAction], own: &[KeyAction]) -> Value {
    let is_lost = |row: &&KeyRow| row.presses.iter().any(|press| lost.contains(&press.action));
    let is_of_window = |row: &&KeyRow| {
        row.presses.is_empty() && [" + ", "Ctrl"].iter().any(|held| row.keys.contains(held))
    };
    let rows: Vec<_> = KEYS
        .iter()
        .filter(|row| !is_lost(row) && !is_of_window(row))
        .collect();
    let presses = rows.iter().flat_map(|row| row.presses);
    let presses = presses.filter(|press| !own.contains(&press.action));
    let help = rows.iter().map(|row| [row.keys, row.what]);
    json!({
        "presses": presses.map(|press| (press.keys, press.action)).collect::<Vec<_>>(),
        "help": help.chain(OF_PAGES).collect::<Vec<_>>(),
    })
}

/// Symbol of the unit of a key: named by the end of the key, or meters where its text in the manual says so.
fn unit(key: &str, text: &str) -> Option<&'static str> {
    let end = key.rsplit_once('_').map(|(_, end)| end);
    let named = UNITS.iter().find(|(name, _)| Some(*name) == end);
    let said = text.contains(", meters").then_some("m");
    named.map(|(_, symbol)| *symbol).or(said)
}

/// A section of the manual, by its type in `desc.rs`.
fn section(type_name: &str) -> Option<&'static SectionRecord> {
    let mut all = recorded_keys().iter();
    all.find(|section| section.type_name == type_name)
}

/// Text of the manual about a key of a section, by the section's type.
fn meaning(type_name: &str, key: &str) -> Option<String> {
    let section = section(type_name)?;
    let own = section.keys.iter().map(|key| (None, key));
    let of_variants = section.variants.iter().flat_map(|variant| {
        let word = Some(variant.word);
        variant.keys.iter().map(move |key| (word, key))
    });
    let (word, key) = own.chain(of_variants).find(|(_, own)| own.name == key)?;
    Some(key_text(section, word, key))
}

/// Row of a number: key, values, whether they are a color, least and largest value, text in the manual, unit, and group.
fn row(numbers: &Numbers, is_color: bool, range: Option<&Range>, text: &str, group: &str) -> Value {
    let is_bound = |end: f64| end.abs() < LIMIT;
    let limits = range.map(|range| [range.min, range.max].map(|end| is_bound(end).then_some(end)));
    json!({
        "name": numbers.key,
        "values": numbers.values,
        "is_color": is_color,
        "limits": limits,
        "text": text,
        "unit": unit(numbers.key, text),
        "group": group,
    })
}

/// Labels and depths of an outline, and whether each thing that can be left out of the view is hidden and shown alone.
pub fn rows(outline: &[OutlineRow], view: &LeftOut) -> Value {
    let state = |row: &OutlineRow| {
        let can_hide = matches!(
            row.item,
            SceneItem::Instance(_) | SceneItem::Group(_) | SceneItem::Model(_)
        );
        let is_alone = view.solo.as_ref() == Some(&row.label);
        can_hide.then(|| [view.hidden.contains(&row.label), is_alone])
    };
    let rows = outline
        .iter()
        .map(|row| json!([row.label, row.depth, state(row)]));
    rows.collect()
}

/// The selected item, with its numbers as a drag has them, and its row in an outline.
pub fn item(selection: &Selection, outline: &[OutlineRow]) -> Value {
    let range = |item, key| match item {
        SceneItem::Instance(_) | SceneItem::Group(_) | SceneItem::Model(_) => None,
        SceneItem::Decal(_) => find(&DECAL, key).map(|field| &field.range),
        SceneItem::Light(_) => find(&LIGHT, key).map(|field| &field.range),
        SceneItem::Camera(_) => find(&CAMERA, key).map(|field| &field.range),
        SceneItem::Environment => find(&ENVIRONMENT, key).map(|field| &field.range),
    };
    let numbers = |item: SceneItem| {
        let all = selection.numbers.iter();
        let text = |key| meaning(item.section(), key).unwrap_or_default();
        let all = all.map(|n| row(n, n.is_color(), range(item, n.key), &text(n.key), ""));
        all.collect::<Vec<_>>()
    };
    json!(selection.shown().map(|shown| json!({
        "label": shown.label,
        "place": shown.place,
        "row": outline.iter().position(|row| row.item == shown.item),
        "numbers": numbers(shown.item),
        "held": shown.held,
        "refused": shown.refused,
    })))
}

/// Numbers of materials with their groups, in the order of the manual.
fn material_fields() -> Vec<(&'static str, &'static Field<MaterialDesc>)> {
    let is_of = |field: &Field<MaterialDesc>, key: &str| {
        field.key == key || (key == "checker" && field.key.starts_with("checker_"))
    };
    let mut all = Vec::new();
    for (group, keys) in section("MaterialDesc")
        .into_iter()
        .flat_map(SectionRecord::groups)
    {
        for key in keys {
            let fields = MATERIAL.iter().filter(|field| is_of(field, key.name));
            all.extend(fields.map(|field| (group, field)));
        }
    }
    all
}

/// Whether a material has the textures and numbers without which a number has no effect.
fn has_effect(numbers: &MaterialDesc, field: &Field<MaterialDesc>) -> bool {
    let mut with = numbers.clone();
    if !with.has(field.key) {
        (field.put)(&mut with, Vec3::ZERO);
    }
    let mut needing = NEEDING.iter().filter(|needing| needing.key == field.key);
    !needing.any(|needing| (needing.is_alone)(&with))
}

/// A material of the world, by its index: the sentence that tells where its numbers are written, the numbers that have
/// an effect, and further numbers that it may get, with the values that they have where they are left out.
pub fn material(index: usize, told: &str, numbers: &MaterialDesc) -> Value {
    let number = |group: &str, field: &Field<MaterialDesc>, values| {
        let key = field.key;
        let text = meaning("MaterialDesc", key).unwrap_or_else(|| field.what.to_owned());
        let (is_color, range) = (field.form == Form::Color, Some(&field.range));
        row(&Numbers { key, values }, is_color, range, &text, group)
    };
    let mut fields = material_fields();
    fields.retain(|(_, field)| has_effect(numbers, field));
    let had = |(group, field): &(&str, &Field<MaterialDesc>)| {
        let values = numbers_of(field.form, (field.get)(numbers)?);
        Some(number(group, field, values))
    };
    let lacking = |(group, field): &(&str, &Field<MaterialDesc>)| {
        Some(number(group, field, field.addition(numbers)?))
    };
    json!({
        "row": index,
        "told": told,
        "numbers": fields.iter().filter_map(had).collect::<Vec<_>>(),
        "lacking": fields.iter().filter_map(lacking).collect::<Vec<_>>(),
    })
}

/// Parameters of the script.
pub fn parameters(declared: &DeclaredParameters, overrides: &ParameterOverrides) -> Value {
    let value = |value: &ParamValue| match value {
        ParamValue::Integer(x) => json!(x),
        ParamValue::Number(x) => json!(x),
        ParamValue::Switch(x) => json!(x),
        ParamValue::Text(x) => json!(x),
        ParamValue::Numbers(x) => json!(x),
    };
    let parameters = declared.iter().map(|(name, own)| {
        let is_integer = matches!(own, ParamValue::Integer(_));
        let now = overrides.get(name).unwrap_or(own);
        json!({ "name": name, "value": value(now), "integer": is_integer })
    });
    parameters.collect()
}

/// Tracks with keys below a timeline: kind and name of the thing, key of the track, and times in seconds.
pub fn tracks(shown: &[&KeyTrack]) -> Value {
    let tracks = shown.iter().map(|of| {
        let track = &of.track;
        json!({ "kind": track.kind, "name": track.name, "key": track.key, "at_s": of.at_s })
    });
    tracks.collect()
}

/// A page's value for a parameter of the kind of `own`.
pub fn parameter(value: &Value, own: &ParamValue) -> Option<ParamValue> {
    Some(match own {
        ParamValue::Integer(_) => ParamValue::Integer(value.as_i64()?),
        ParamValue::Number(_) => ParamValue::Number(value.as_f64().filter(|x| x.is_finite())?),
        ParamValue::Switch(_) => ParamValue::Switch(value.as_bool()?),
        ParamValue::Text(_) => ParamValue::Text(value.as_str()?.to_owned()),
        ParamValue::Numbers(own) => {
            let values = value
                .as_array()
                .filter(|values| values.len() == own.len())?;
            let values = values.iter().map(|x| x.as_f64().filter(|x| x.is_finite()));
            ParamValue::Numbers(values.collect::<Option<_>>()?)
        }
    })
}

/// Size in points of a picture of this shape, in which handles are placed and dragged.
pub fn points(size: [u32; 2]) -> Vec2 {
    let [width, height] = size.map(|side| side.max(1) as f32);
    vec2(HEIGHT * width / height, HEIGHT)
}

/// Places of the handles in a camera's picture of this size, in parts of the picture, and the kinds that the item has:
/// no handles without a camera. The box of a decal is also shown where handles are not.
pub fn handles(
    selection: &Selection,
    camera: Option<&CameraDesc>,
    box_camera: Option<&CameraDesc>,
    size: [u32; 2],
) -> Value {
    let size = points(size);
    let part = |at: Vec2| (at / size).to_array();
    let kinds = Handle::ALL.into_iter();
    let kinds = kinds.filter(|kind| kind.numbers(&selection.numbers).is_some());
    let kinds: Vec<_> = kinds.map(Handle::name).collect();
    let edges = box_camera.map_or(Vec::new(), |camera| selection.box_edges(camera, size));
    let edges: Vec<_> = edges.iter().map(|ends| ends.map(part)).collect();
    let drawn = camera
        .and_then(|camera| selection.handles(camera, size))
        .map(|handles| json!({ "start": part(handles.start), "ends": handles.ends.map(part) }));
    json!({
        "kind": selection.handle.name(),
        "kinds": kinds,
        "drawn": drawn,
        "edges": edges,
        "mark": END / HEIGHT,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::desc::At;

    /// The page that runs by itself has the whole folder.
    #[test]
    fn the_preview_serves_each_file_of_pages() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/page");
        let files = std::fs::read_dir(folder).expect("a folder");
        let mut names: Vec<_> = files.map(|it| it.expect("a file").file_name()).collect();
        names.sort_unstable();
        assert!(names.iter().eq(FILES.iter().map(|(name, _)| name)));
    }

    #[test]
    fn keys_have_the_units_that_they_or_their_texts_name() {
        let unit_of = |section, key| unit(key, &meaning(section, key).unwrap_or_default());
        for (section, key, symbol) in [
            ("CameraDesc", "eye", Some("m")),
            ("CameraDesc", "fov_deg", Some("°")),
            ("CameraDesc", "aperture_f", None),
            ("LightDesc", "intensity_cd", Some("cd")),
            ("MaterialDesc", "iridescence_thickness_nm", Some("nm")),
            ("MaterialDesc", "roughness", None),
        ] {
            assert_eq!(unit_of(section, key), symbol, "{key}");
        }
    }

    #[test]
    fn a_number_is_shown_once_the_number_that_it_needs_is_added() {
        let names = |list: &str, numbers: &MaterialDesc| -> Vec<Value> {
            let shown = material(0, "", numbers);
            let rows = shown[list].as_array().expect("a list").iter();
            rows.map(|row| json!([row["group"], row["name"]])).collect()
        };
        let (coat, rough) = ("clearcoat", "clearcoat_roughness");
        let row = |key: &str| json!(["Clear coat", key]);
        let mut numbers = MaterialDesc {
            clearcoat_roughness: Some(0.0),
            ..MaterialDesc::default()
        };
        assert!(names("lacking", &numbers).contains(&row(coat)));
        assert!(!names("numbers", &numbers).contains(&row(rough)));
        numbers.normal_scale = Some(1.0);
        let relief = json!(["Surface", "normal_scale"]);
        assert!(!names("numbers", &numbers).contains(&relief));
        numbers.normal_texture = Some(At::default());
        assert!(names("numbers", &numbers).contains(&relief));
        (numbers.normal_scale, numbers.clearcoat) = (None, Some(0.0));
        // A thin sheet of glass, and a solid.
        let dispersion = json!(["Transmission", "dispersion"]);
        numbers.transmission = Some(1.0);
        assert!(!names("lacking", &numbers).contains(&dispersion));
        numbers.thickness_m = Some(1.0);
        assert!(names("lacking", &numbers).contains(&dispersion));
        (numbers.transmission, numbers.thickness_m) = (None, None);
        assert!(!names("lacking", &numbers).contains(&row(coat)));
        assert_eq!(names("numbers", &numbers), [row(coat), row(rough)]);
    }
}
