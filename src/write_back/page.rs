//! Contents of the panels of pages, as JSON; `src/write_back/page` has the panels.

use glam::{Vec2, vec2};
use serde_json::{Value, json};

use super::{
    KeyTrack, Numbers, SceneItem,
    handles::{END, Handle},
    numbers_of,
    outline::OutlineRow,
    selection::Selection,
};
use reflet_render::runtime::parameters::{DeclaredParameters, ParameterOverrides};
use reflet_scene::{
    desc::{CAMERA, CameraDesc, ENVIRONMENT, LIGHT, MATERIAL, MaterialDesc, ParamValue},
    manual::key_text,
    motion::DECAL,
    number::{Field, Form, find},
    parse::recorded_keys,
    range::{LIMIT, Range},
};

/// Height of the picture in points, in which handles have their length.
const HEIGHT: f32 = 600.0;

/// Text of the manual about a key of a section, by the section's type in `desc.rs`.
fn meaning(section: &str, key: &str) -> Option<String> {
    let section = (recorded_keys().iter()).find(|known| known.type_name == section)?;
    let own = section.keys.iter().map(|key| (None, key));
    let of_variants = section.variants.iter().flat_map(|variant| {
        let word = Some(variant.word);
        variant.keys.iter().map(move |key| (word, key))
    });
    let (word, key) = own.chain(of_variants).find(|(_, own)| own.name == key)?;
    Some(key_text(section, word, key))
}

/// Row of a number: key, values, whether they are a color, step, least and largest value, and its text in the manual.
fn row(section: &str, numbers: &Numbers, is_color: bool, range: Option<&Range>) -> Value {
    let key = numbers.key;
    let is_bound = |end: f64| end.abs() < LIMIT;
    let limits = range.map(|range| [range.min, range.max].map(|end| is_bound(end).then_some(end)));
    let text = meaning(section, key);
    json!([key, numbers.values, is_color, "any", limits, text])
}

/// Labels and depths of an outline.
pub fn rows(outline: &[OutlineRow]) -> Value {
    let rows = outline.iter().map(|row| json!([row.label, row.depth]));
    rows.collect()
}

/// The selected item, with its numbers as a drag has them, and its row in an outline.
pub fn item(selection: &Selection, outline: &[OutlineRow]) -> Value {
    let range = |item, key| match item {
        SceneItem::Instance(_) | SceneItem::Group(_) => None,
        SceneItem::Decal(_) => find(&DECAL, key).map(|field| &field.range),
        SceneItem::Light(_) => find(&LIGHT, key).map(|field| &field.range),
        SceneItem::Camera(_) => find(&CAMERA, key).map(|field| &field.range),
        SceneItem::Environment => find(&ENVIRONMENT, key).map(|field| &field.range),
    };
    let numbers = |item: SceneItem| {
        let all = selection.numbers.iter();
        let all = all.map(|n| row(item.section(), n, n.is_color(), range(item, n.key)));
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

/// A material of the world, by its index: the sentence that tells where its numbers are written, and the numbers.
pub fn material(index: usize, told: &str, numbers: &MaterialDesc) -> Value {
    let number = |field: &Field<MaterialDesc>| {
        let (key, form) = (field.key, field.form);
        let values = numbers_of(form, (field.get)(numbers)?);
        let numbers = Numbers { key, values };
        let is_color = form == Form::Color;
        Some(row("MaterialDesc", &numbers, is_color, Some(&field.range)))
    };
    let numbers: Vec<_> = MATERIAL.iter().filter_map(number).collect();
    json!({ "row": index, "told": told, "numbers": numbers })
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
