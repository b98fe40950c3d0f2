//! Edits of things of a scene, as changes of its texts: numbers and colors of placements, lights, cameras, materials
//! and the environment, values of parameters, and keys of tracks, each in its place. All other bytes of a text stay.
//! Nothing is written here: the preview writes files, a page its editor. All ends share the way to choose and
//! drag a thing: the [`outline`], [`picking`], the [`selection`] with its [`handles`], and the panels of [`page`]s.

pub mod camera_controls;
pub mod handles;
pub mod input;
mod insert;
mod inspect;
mod item;
mod keys;
mod material;
pub mod outline;
mod overridden;
pub mod page;
pub mod picking;
mod places;
pub mod presses;
mod put;
pub mod selection;
mod splice;
mod tracks;
mod tree;
pub mod view_channel;

use std::path::PathBuf;

use glam::{Affine3A, Vec3};

pub use self::{
    inspect::{exact, inspect, numbers_of, shown_place},
    item::{MaterialOrigin, SceneItem},
    keys::{
        FlightPoint, KeyChange, KeyEdit, KeyTrack, change_flight, change_keys, key_tracks, reduced,
        shown_tracks,
    },
    overridden::Layered,
    put::put,
    splice::list,
    tracks::{FoundTrack, TrackName, all_tracks},
};
use self::{
    places::{Place, Subject, places},
    splice::Value,
    tree::Step,
};
use reflet_render::runtime::parameters::setting;
use reflet_scene::{
    desc::{CAMERA, ENVIRONMENT, LIGHT, MATERIAL, ParamValue, turned},
    motion::DECAL,
    number::{Field, Form, find},
    range::LIMIT,
};

/// A text before and after a change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Path of the changed file.
    pub path: PathBuf,
    /// Text before the change.
    pub before: String,
    /// Text after the change.
    pub after: String,
}

/// Numbers of one key of an item.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Key in the item's table.
    pub key: &'static str,
    /// One, two or three values.
    pub values: Vec<f64>,
}

/// Keys of the position of an item, which has at most one.
pub const POSITION_KEYS: [&str; 3] = ["translation", "position", "eye"];

impl Numbers {
    /// Whether they are a color.
    pub fn is_color(&self) -> bool {
        let is_named = self.key.contains("color")
            || ["emission", "zenith", "horizon", "ground"].contains(&self.key);
        self.values.len() == 3 && is_named
    }

    /// The position of an item, moved by meters along the axes of its parent; `None` if these numbers have none.
    pub fn moved(all: &[Self], by: [f64; 3]) -> Option<Self> {
        let is_position = |numbers: &&Self| POSITION_KEYS.contains(&numbers.key);
        let mut moved = all.iter().find(is_position)?.clone();
        for (value, by) in moved.values.iter_mut().zip(by) {
            *value += by;
        }
        Some(moved)
    }
}

/// An item with its editable numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inspected {
    /// The item.
    pub item: SceneItem,
    /// Kind and name of the item.
    pub label: String,
    /// Name of its table, by which tracks find it.
    pub name: Option<String>,
    /// File and line of its table.
    pub place: String,
    /// Editable numbers; empty if `refused`.
    pub numbers: Vec<Numbers>,
    /// Keys whose values in the text are not seen, because a track, a script or the command line sets them, and why.
    pub held: Vec<(&'static str, String)>,
    /// Reason why nothing can be changed.
    pub refused: Option<String>,
    /// World transform, at rest, of the parent's space.
    pub world_from_parent: Affine3A,
}

/// Form of a key of an item, and its values within their range.
fn within<T>(
    fields: &'static [Field<T>],
    numbers: &Numbers,
) -> Option<(&'static Field<T>, Vec<f64>)> {
    let field = find(fields, numbers.key)?;
    let clamp = |x: &f64| match field.range.contains(*x) {
        true => *x,
        false => exact(field.range.clamp(*x as f32)),
    };
    Some((field, numbers.values.iter().map(clamp).collect()))
}

/// A value to write, within its range.
fn value_of<T>(fields: &'static [Field<T>], numbers: &Numbers) -> Value {
    match within(fields, numbers) {
        Some((field, values)) if field.form == Form::Color => Value::Color(values),
        Some((_, values)) => Value::Numbers(values),
        None => Value::Numbers(numbers.values.clone()),
    }
}

/// Changes of the texts that contain keys of an item, one for each text.
///
/// # Errors
/// Sentence with the reason why one cannot be written.
pub fn change(
    scene: &Layered<'_>,
    item: SceneItem,
    all: &[Numbers],
) -> Result<Vec<Change>, String> {
    let mut changes = Vec::new();
    for numbers in all {
        let (place, key, value) = written(scene, item, numbers)?;
        put_also(&mut changes, &place, key, &value)?;
    }
    Ok(changes)
}

/// Puts a further value into the changes of texts, one for each text.
fn put_also(
    changes: &mut Vec<Change>,
    place: &Place,
    key: &str,
    value: &Value,
) -> Result<(), String> {
    let known = changes.iter_mut().find(|c| c.path == place.source.path);
    match known {
        Some(known) => known.after = place.put_into(&known.after, key, value)?,
        None => changes.push(changed(place, place.put(key, value)?)),
    }
    Ok(())
}

/// Table in which numbers of an item are written, their key there, and the value.
fn written(
    scene: &Layered<'_>,
    item: SceneItem,
    numbers: &Numbers,
) -> Result<(Place, &'static str, Value), String> {
    if let Some(why) = scene.held(item, numbers.key) {
        return Err(why);
    }
    check(numbers)?;
    let subject = item.subject(scene.desc)?;
    let place = places(scene.desc, scene.variants, &subject, numbers.key)?;
    let mut key = numbers.key;
    let mut value = match item {
        SceneItem::Decal(_) => {
            let clamped = within(&DECAL, numbers).map(|(_, values)| values);
            Value::Numbers(clamped.unwrap_or_else(|| numbers.values.clone()))
        }
        SceneItem::Light(_) => value_of(&LIGHT, numbers),
        SceneItem::Camera(_) => value_of(&CAMERA, numbers),
        SceneItem::Environment => value_of(&ENVIRONMENT, numbers),
        SceneItem::Instance(_) | SceneItem::Group(_) | SceneItem::Model(_) => {
            Value::Numbers(numbers.values.clone())
        }
    };
    if key == "rotation_deg" && !place.has(key) && place.has("rotation_quat") {
        let euler = numbers.values.iter().map(|x| *x as f32);
        let turn = turned(Vec3::from_slice(&euler.collect::<Vec<_>>()));
        key = "rotation_quat";
        value = Value::Numbers(turn.as_dquat().to_array().to_vec());
    }
    if key == "direction" && !place.has(key) && place.has("target") {
        return Err("it faces its `target`; change that in the text".to_owned());
    }
    Ok((place, key, value))
}

/// Refuses numbers that scene text cannot have, with which the scene would not be read any more.
fn check(numbers: &Numbers) -> Result<(), String> {
    let (key, values) = (numbers.key, &numbers.values);
    if !values.iter().all(|value| value.abs() <= LIMIT) {
        return Err(format!("`{key}` must be between -1e12 and 1e12"));
    }
    if key == "scale" && values.contains(&0.0) {
        return Err("`scale` must not be 0, which would flatten it".to_owned());
    }
    Ok(())
}

fn changed(place: &Place, after: String) -> Change {
    Change {
        path: place.source.path.clone(),
        before: place.source.text.clone(),
        after,
    }
}

/// Change of the text that contains a number of a material.
///
/// # Errors
/// Same errors as [`change`].
pub fn change_material(
    scene: &Layered<'_>,
    origin: &MaterialOrigin,
    numbers: &Numbers,
) -> Result<Change, String> {
    let key = numbers.key;
    if let Some(why) = scene.material_held(origin, key) {
        return Err(why);
    }
    let below = origin.below();
    let subject = origin.subject(scene.desc, &below)?;
    let value = value_of(&MATERIAL, numbers);
    let Some(part) = key.strip_prefix("checker_") else {
        let place = places(scene.desc, scene.variants, &subject, key)?;
        return Ok(changed(&place, place.put(key, &value)?));
    };
    let path = match part {
        "a" => vec![Step::Key("colors".to_owned()), Step::Index(0)],
        "b" => vec![Step::Key("colors".to_owned()), Step::Index(1)],
        _ => vec![Step::Key("size_m".to_owned())],
    };
    for table in ["checker", "pattern"] {
        let place = places(scene.desc, scene.variants, &subject, table)?;
        if place.has(table) {
            let path = [vec![Step::Key(table.to_owned())], path].concat();
            return Ok(changed(&place, place.replace(&path, &value)?));
        }
    }
    Err("its pattern comes from another material; change it there".to_owned())
}

/// Changes of the texts that contain parameters of the script, one for each text.
///
/// # Errors
/// Same errors as [`change`].
pub fn change_parameters(
    scene: &Layered<'_>,
    values: &[(&str, &ParamValue)],
) -> Result<Vec<Change>, String> {
    let mut changes: Vec<Change> = Vec::new();
    for (name, value) in values {
        if let Some(why) = scene.on_command_line(&["params"], name) {
            return Err(why);
        }
        let subject = Subject {
            kind: "params",
            section: "",
            name: None,
            at: None,
            below: &[],
        };
        let place = places(scene.desc, scene.variants, &subject, name)?;
        // A key of one letter needs no quotes.
        let value = Value::Toml(setting("p", value).split_off("p = ".len()));
        put_also(&mut changes, &place, name, &value)?;
    }
    Ok(changes)
}
