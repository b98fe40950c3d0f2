//! Leaves out values of the wrong JSON type, where they only change the look.

use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};
use serde_path_to_error::Segment;

use super::{Fault, Notes, schema, uri::shorten};

/// Objects of one kind in a document.
struct Kind {
    /// Keys on the way to the objects, joined with `/`; `*` stands for all elements of a list.
    place: &'static str,
    /// Keys of an object that can be left out with all that is below them; an empty one stands for all keys.
    looks: &'static [&'static str],
    /// First value of an object that has the wrong type.
    wrong: fn(&Value) -> Option<Wrong>,
}

/// A value of the wrong type.
struct Wrong {
    /// Keys and indices on the way from its object.
    path: Vec<String>,
    /// The value's own type and the expected one.
    message: String,
}

const fn kind<T: DeserializeOwned>(place: &'static str, looks: &'static [&'static str]) -> Kind {
    let wrong = wrong::<T>;
    Kind {
        place,
        looks,
        wrong,
    }
}

/// Keys of a whole object.
const ALL: &[&str] = &[""];

/// Kinds of objects that have parts which only change the look, inner ones first.
const KINDS: [Kind; 13] = [
    kind::<schema::Material>("materials/*", ALL),
    kind::<schema::Texture>("textures/*", ALL),
    kind::<schema::Image>("images/*", ALL),
    kind::<schema::Sampler>("samplers/*", ALL),
    kind::<schema::Camera>("cameras/*", ALL),
    kind::<schema::Light>("extensions/KHR_lights_punctual/lights/*", ALL),
    kind::<schema::ImageLight>("extensions/EXT_lights_image_based/lights/*", ALL),
    kind::<schema::Variant>("extensions/KHR_materials_variants/variants/*", ALL),
    kind::<schema::Scene>("scenes/*", &["extensions"]),
    kind::<schema::Node>("nodes/*", &["name", "camera", "extensions"]),
    kind::<schema::Primitive>("meshes/*/primitives/*", OF_PRIMITIVES),
    kind::<schema::Mesh>("meshes/*", &["name"]),
    kind::<schema::Root>("", OF_FILES),
];
const OF_PRIMITIVES: &[&str] = &["material", "extensions", "attributes/*", "targets/*/*"];
const OF_FILES: &[&str] = &[
    "extensionsUsed",
    "extensions",
    "materials",
    "textures",
    "images",
    "samplers",
    "cameras",
    "animations",
];

/// Begins of keys that belong to geometry, wherever they stand.
const GEOMETRY: [&str; 5] = [
    "POSITION",
    "JOINTS_",
    "WEIGHTS_",
    "EXT_mesh_gpu_instancing",
    "KHR_draco_mesh_compression",
];

/// Maximum number of values that are left out of one object: each is searched for anew.
const MOST: usize = 100;

/// Leaves out the values of a document that have the wrong type and only change the look, with a warning.
///
/// # Errors
/// A value of meshes' geometry, nodes or skins that has the wrong type.
pub fn leave_out(document: &mut Value, notes: &mut Notes) -> Result<(), Fault> {
    replace::<schema::Accessor>(document, "accessors");
    replace::<schema::BufferView>(document, "bufferViews");
    replace::<schema::Buffer>(document, "buffers");
    for kind in &KINDS {
        let keys: Vec<&str> = kind.place.split_terminator('/').collect();
        each(document, &keys, String::new(), &mut |object, place| {
            mend(kind, object, place, notes)
        })?;
    }
    Ok(())
}

/// Puts empty objects in the place of wrong objects of a list: they are errors where they are read.
fn replace<T: DeserializeOwned>(document: &mut Value, list: &str) {
    let list = document.get_mut(list).and_then(Value::as_array_mut);
    for object in list.into_iter().flatten() {
        let Some(Wrong { path, message }) = wrong::<T>(object) else {
            continue;
        };
        let keys: String = path.iter().map(|key| shorten(key) + ": ").collect();
        *object = json!({
            "componentType": 0, "type": "", "count": 0, "buffer": 0, "byteLength": 0,
            "(wrong)": keys + message.as_str(),
        });
    }
}

/// Calls `visit` with the objects at a place below `value`, and with their JSON pointers.
fn each(
    value: &mut Value,
    keys: &[&str],
    pointer: String,
    visit: &mut dyn FnMut(&mut Value, &str) -> Result<(), Fault>,
) -> Result<(), Fault> {
    match (keys, value) {
        ([], value) => visit(value, &pointer),
        (["*", rest @ ..], Value::Array(values)) => (values.iter_mut().enumerate())
            .try_for_each(|(i, value)| each(value, rest, format!("{pointer}/{i}"), visit)),
        ([key, rest @ ..], Value::Object(map)) => map.get_mut(*key).map_or(Ok(()), |value| {
            each(value, rest, format!("{pointer}/{key}"), visit)
        }),
        _ => Ok(()),
    }
}

fn mend(kind: &Kind, object: &mut Value, place: &str, notes: &mut Notes) -> Result<(), Fault> {
    let mut last = Vec::new();
    for _ in 0..MOST {
        let Some(Wrong { path, message }) = (kind.wrong)(object) else {
            return Ok(());
        };
        let at: String = path
            .iter()
            .map(|key| format!("/{}", shorten(key)))
            .collect();
        let text = format!("{place}{at}: {message}");
        if !is_look(kind, &path) || !remove(object, &path) {
            return Err(Fault::new("gltf-json", format!("not glTF JSON: {text}")));
        }
        // An object goes too where it cannot be without a value that was left out.
        let is_new = !last.starts_with(&path) || last.is_empty();
        let what = "values have another type than glTF gives them, and are left out";
        notes.add("property-left-out", is_new.into(), what, &text);
        last = path;
    }
    let text = format!("{place} has more than {MOST} values of the wrong type");
    Err(Fault::new("gltf-json", text))
}

/// Whether an object of a kind can be shown without the value.
fn is_look(kind: &Kind, path: &[String]) -> bool {
    let has = |look: &&str| {
        let mut keys = look.split_terminator('/').zip(path);
        let depth = look.split_terminator('/').count();
        path.len() >= depth && keys.all(|(look, key)| look == "*" || look == key)
    };
    kind.looks.iter().any(has) && !path.iter().any(|key| is_geometry(key))
}

/// Whether a key is of geometry: of positions, joints or weights, or of an extension that makes or places meshes.
pub fn is_geometry(key: &str) -> bool {
    GEOMETRY.iter().any(|begin| key.starts_with(begin))
}

/// Removes a value: a key, an object of a list, or the whole list where it is of numbers. The object itself becomes one
/// without keys.
fn remove(object: &mut Value, path: &[String]) -> bool {
    let Some((last, rest)) = path.split_last() else {
        *object = Value::Object(Map::new());
        return true;
    };
    let pointer: String = rest
        .iter()
        .map(|key| format!("/{}", key.replace('~', "~0").replace('/', "~1")))
        .collect();
    match (object.pointer_mut(&pointer), last.parse::<usize>()) {
        (Some(Value::Object(map)), _) => map.remove(last).is_some(),
        (Some(Value::Array(list)), Ok(i)) if list.get(i).is_some_and(Value::is_object) => {
            list.remove(i);
            true
        }
        (Some(Value::Array(_)), _) => remove(object, rest),
        _ => false,
    }
}

fn wrong<T: DeserializeOwned>(object: &Value) -> Option<Wrong> {
    let error = serde_path_to_error::deserialize::<_, T>(object).err()?;
    let key = |segment: &Segment| match segment {
        Segment::Seq { index } => index.to_string(),
        Segment::Map { key } => key.clone(),
        Segment::Enum { .. } | Segment::Unknown => "?".into(),
    };
    Some(Wrong {
        path: error.path().iter().map(key).collect(),
        message: error.into_inner().to_string(),
    })
}
