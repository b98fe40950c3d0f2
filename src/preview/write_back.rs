//! Edits of the preview, written into the scene's texts: numbers of placements, lights and cameras, each
//! in its place. All other bytes of a text stay, and a file that was changed meanwhile is not
//! touched.

mod places;
mod put;
mod splice;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::{Affine3A, EulerRot, Vec3};

use self::places::{Place, places};
pub use self::put::put;
use reflet_base::files::replace_content;
use reflet_scene::{
    desc::{CAMERA, Entry, LIGHT, PlacementDesc, SceneDesc},
    diagnostic::Span,
    motion::turned,
    number::{Field, Form},
};

/// An item of a scene that has a placement: an index into the list of its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SceneItem {
    /// Index into [`SceneDesc::instances`].
    Instance(usize),
    /// Index into [`SceneDesc::groups`].
    Group(usize),
    /// Index into [`SceneDesc::lights`].
    Light(usize),
    /// Index into [`SceneDesc::cameras`].
    Camera(usize),
}

/// Numbers of one key of an item.
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Key in the item's table.
    pub key: &'static str,
    /// One, two or three values.
    pub values: Vec<f64>,
}

/// An item with its editable numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspected {
    /// The item.
    pub item: SceneItem,
    /// Kind and name of the item.
    pub label: String,
    /// File and line of its table.
    pub place: String,
    /// Editable numbers; empty if `refused`.
    pub numbers: Vec<Numbers>,
    /// Reason why nothing can be changed.
    pub refused: Option<String>,
    /// World transform, at rest, of the parent's space.
    pub world_from_parent: Affine3A,
}

/// A text before and after a change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    path: PathBuf,
    before: String,
    after: String,
}

/// Written edits, for undo and redo.
#[derive(Debug, Default)]
pub struct History {
    done: Vec<Change>,
    undone: Vec<Change>,
}

impl SceneItem {
    /// Name of the item, if it has one, and the place of its table.
    pub fn named(self, desc: &SceneDesc) -> Option<(Option<&str>, &Span)> {
        fn entry<T>(list: &[Entry<T>], index: usize) -> Option<(Option<&str>, &Span)> {
            list.get(index).map(|e| (Some(e.name.as_str()), &e.at))
        }
        match self {
            Self::Instance(i) => desc.instances.get(i).map(|i| (i.name.as_deref(), &i.at)),
            Self::Group(i) => entry(&desc.groups, i),
            Self::Light(i) => entry(&desc.lights, i),
            Self::Camera(i) => entry(&desc.cameras, i),
        }
    }

    /// The item of the same name in a reloaded scene; without a name, the one of the same index.
    pub fn again(self, desc: &SceneDesc, name: Option<&str>) -> Option<Self> {
        let Some(name) = name else {
            return self.named(desc).map(|_| self);
        };
        fn of<T>(list: &[Entry<T>], name: &str) -> Option<usize> {
            list.iter().position(|e| e.name == name)
        }
        match self {
            Self::Instance(_) => {
                let mut all = desc.instances.iter();
                all.position(|i| i.name.as_deref() == Some(name))
                    .map(Self::Instance)
            }
            Self::Group(_) => of(&desc.groups, name).map(Self::Group),
            Self::Light(_) => of(&desc.lights, name).map(Self::Light),
            Self::Camera(_) => of(&desc.cameras, name).map(Self::Camera),
        }
    }

    /// Kind and name of the item.
    pub fn label(self, desc: &SceneDesc) -> String {
        let name = self.named(desc).and_then(|(name, _)| name);
        match self {
            Self::Instance(i) => {
                let model = desc.instances.get(i).map(|i| i.model.value.as_str());
                format!("instance {}", name.or(model).unwrap_or_default())
            }
            Self::Group(_) => format!("group {}", name.unwrap_or_default()),
            Self::Light(_) => format!("light {}", name.unwrap_or_default()),
            Self::Camera(_) => format!("camera {}", name.unwrap_or_default()),
        }
    }

    /// Key of the item's kind in scene text.
    fn kind(self) -> &'static str {
        match self {
            Self::Instance(_) => "instance",
            Self::Group(_) => "group",
            Self::Light(_) => "light",
            Self::Camera(_) => "camera",
        }
    }
}

/// Editable numbers of an item, at rest.
pub fn inspect(desc: &SceneDesc, item: SceneItem) -> Option<Inspected> {
    let (_, at) = item.named(desc)?;
    let source = at.source.as_ref();
    let place = source.map_or_else(String::new, |source| {
        let line = source.place(at.range.start).line;
        format!("{}:{line}", source.path.display())
    });
    let (numbers, refused) = match numbers(desc, item).and_then(|all| {
        places::writable(source.map(Arc::as_ref))?;
        Ok(all)
    }) {
        Ok(numbers) => (numbers, None),
        Err(why) => (Vec::new(), Some(why)),
    };
    Some(Inspected {
        item,
        label: item.label(desc),
        place,
        numbers,
        refused,
        world_from_parent: world_from_parent(desc, item),
    })
}

fn world_from_parent(desc: &SceneDesc, item: SceneItem) -> Affine3A {
    let parents = &desc.parents;
    let parent = match item {
        SceneItem::Instance(i) => parents.of_node(i),
        SceneItem::Group(i) => parents.of_node(desc.instances.len() + i),
        SceneItem::Light(i) => parents.of_light(i),
        SceneItem::Camera(i) => parents.of_camera(i),
    };
    parent.map_or(Affine3A::IDENTITY, |parent| desc.rest()[parent])
}

fn numbers(desc: &SceneDesc, item: SceneItem) -> Result<Vec<Numbers>, String> {
    let placement = match item {
        SceneItem::Instance(i) => &desc.instances[i].placement,
        SceneItem::Group(i) => &desc.groups[i].value.placement,
        SceneItem::Light(i) => return Ok(fields(&desc.lights[i].value, &LIGHT)),
        SceneItem::Camera(i) => return Ok(fields(&desc.cameras[i].value, &CAMERA)),
    };
    let PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    } = *placement
    else {
        let help = "write `translation`, `rotation_deg` and `scale` in its place";
        return Err(format!("it is placed by `matrix`; {help}"));
    };
    let three = |v: Vec3| v.to_array().map(exact).to_vec();
    let written = places(desc, &[], item, "rotation_deg");
    let written = written.ok().and_then(|place| place.numbers("rotation_deg"));
    let agrees = |euler: &Vec<f64>| {
        let [x, y, z] = *euler.as_slice() else {
            return false;
        };
        let turn = turned(Vec3::new(x as f32, y as f32, z as f32));
        turn.angle_between(rotation) < 1e-3
    };
    let euler = written.filter(agrees).unwrap_or_else(|| {
        let (z, y, x) = rotation.as_dquat().to_euler(EulerRot::ZYX);
        [x, y, z]
            .map(|turn| exact(turn.to_degrees() as f32))
            .to_vec()
    });
    Ok(vec![
        Numbers {
            key: "translation",
            values: three(translation),
        },
        Numbers {
            key: "rotation_deg",
            values: euler,
        },
        Numbers {
            key: "scale",
            values: three(scale),
        },
    ])
}

/// The double with the same shortest decimal text as the float.
fn exact(x: f32) -> f64 {
    // Turns -0 into 0.
    x.to_string().parse().unwrap_or(f64::from(x)) + 0.0
}

/// Editable fields of a light or a camera.
fn fields<T>(of: &T, fields: &[Field<T>]) -> Vec<Numbers> {
    let one = |field: &Field<T>| {
        let value = (field.get)(of)?.to_array().map(exact);
        let count = match field.form {
            Form::Number => 1,
            Form::Pair => 2,
            Form::Color | Form::Vector => 3,
        };
        Some(Numbers {
            key: field.key,
            values: value[..count].to_vec(),
        })
    };
    let mut all: Vec<_> = fields.iter().filter_map(one).collect();
    // A light with a target takes its direction from there.
    let has = |key: &str| all.iter().any(|n| n.key == key);
    if has("target") && has("direction") {
        all.retain(|n| n.key != "target");
    }
    all
}

/// Change of the text that contains a key of an item; `variants` are the chosen ones.
///
/// # Errors
/// Sentence with the reason why it cannot be written.
pub fn change(
    desc: &SceneDesc,
    variants: &[String],
    item: SceneItem,
    numbers: &Numbers,
) -> Result<Change, String> {
    let place = places(desc, variants, item, numbers.key)?;
    let Place { source, .. } = &place;
    let mut values = numbers.values.clone();
    let mut key = numbers.key;
    if key == "rotation_deg"
        && place.numbers(key).is_none()
        && place.numbers("rotation_quat").is_some()
    {
        let turn = turned(Vec3::from_slice(
            &values.iter().map(|x| *x as f32).collect::<Vec<_>>(),
        ));
        key = "rotation_quat";
        values = turn.as_dquat().to_array().to_vec();
    }
    if key == "direction" && place.numbers(key).is_none() && place.numbers("target").is_some() {
        return Err("it faces its `target`; change that in the text".to_owned());
    }
    let after = place.put(key, &values)?;
    Ok(Change {
        path: source.path.clone(),
        before: source.text.clone(),
        after,
    })
}

impl Change {
    /// Path of the changed file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Replaces the text `from` on disk by the text `to`.
    fn write(&self, from: &str, to: &str) -> Result<(), String> {
        let shown = self.path.display();
        let failed = |error: std::io::Error| format!("{shown} cannot be written: {error}");
        // Symbolic links stay, and lead to the same file.
        let path = self.path.canonicalize().map_err(failed)?;
        match replace_content(&path, from.as_bytes(), to.as_bytes(), || {}).map_err(failed)? {
            true => Ok(()),
            false => Err(format!(
                "{shown} was changed on disk and is not shown yet; nothing is written"
            )),
        }
    }
}

impl History {
    /// Writes a change and records it for undo; a change without effect is skipped. One that was made from an
    /// older text than the last written one is refused.
    ///
    /// # Errors
    /// A file that is read-only, or was changed meanwhile: nothing is written.
    pub fn write(&mut self, change: Change) -> Result<(), String> {
        if change.before == change.after {
            return Ok(());
        }
        change.write(&change.before, &change.after)?;
        self.done.push(change);
        self.undone.clear();
        Ok(())
    }

    /// Undoes the last change; returns its file, or `None` if there is nothing to undo.
    ///
    /// # Errors
    /// Same errors as [`History::write`]; the change can still be undone then.
    pub fn undo(&mut self) -> Result<Option<PathBuf>, String> {
        let Some(change) = self.done.last() else {
            return Ok(None);
        };
        change.write(&change.after, &change.before)?;
        let path = change.path.clone();
        self.undone.extend(self.done.pop());
        Ok(Some(path))
    }

    /// Redoes the change that was undone last; returns its file like [`History::undo`].
    ///
    /// # Errors
    /// Same errors as [`History::undo`].
    pub fn redo(&mut self) -> Result<Option<PathBuf>, String> {
        let Some(change) = self.undone.last() else {
            return Ok(None);
        };
        change.write(&change.before, &change.after)?;
        let path = change.path.clone();
        self.done.extend(self.undone.pop());
        Ok(Some(path))
    }
}
