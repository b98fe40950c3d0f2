//! Reasons why another value in the text would not be seen: tracks, scripts and the command line set it.

use super::{
    item::{MaterialOrigin, SceneItem},
    places::alike,
    tracks::{FoundTrack, all_tracks},
};
use reflet_render::runtime::Session;
use reflet_scene::{
    desc::{CAMERA, Entry, LIGHT, MATERIAL, SceneDesc, TrackDesc, Tracks},
    diagnostic::Span,
    motion::{DECAL, FileMaterial, Kind, ScriptedFields, file_materials},
    number::Field,
};

/// A scene's description, with the overrides laid over its texts.
#[derive(Clone, Copy, Debug)]
pub struct Layered<'a> {
    /// The description.
    pub desc: &'a SceneDesc,
    /// Chosen variants; the last one wins.
    pub variants: &'a [String],
    /// Values of the command line, `path=value` each.
    pub set: &'a [String],
    /// Values that scripts have set in the shown frame.
    pub scripted: Option<&'a ScriptedFields>,
}

/// Parts of a node's transform, in the order of their bits in [`ScriptedFields`].
const TRANSFORM: [&str; 3] = ["translation", "rotation_deg", "scale"];

fn animated(table: &str, at: &Span) -> String {
    let place = at.source.as_ref().map_or_else(String::new, |source| {
        let line = source.place(at.range.start).line;
        format!(" ({}:{line})", source.path.display())
    });
    format!("`[motion.{table}]`{place} animates it; change its keys there")
}

/// Whether a track replaces the value at rest.
fn replaces(track: &TrackDesc) -> bool {
    !track.keys.is_empty() || track.follow.is_some()
}

/// Track of a field, if there is one.
fn track_of<'t, T>(tracks: &'t Tracks, fields: &[Field<T>], key: &str) -> Option<&'t TrackDesc> {
    let mut tracks = tracks.iter();
    tracks
        .find(|(field, _)| fields[*field].key == key)
        .map(|(_, track)| track)
}

/// Index of a field in its table.
fn index_of<T>(fields: &[Field<T>], key: &str) -> Option<usize> {
    fields.iter().position(|field| field.key == key)
}

fn named<'e, T>(entries: &'e [Entry<T>], name: Option<&str>) -> Option<&'e Entry<T>> {
    entries
        .iter()
        .find(|entry| Some(entry.name.as_str()) == name)
}

impl<'a> Layered<'a> {
    /// The description of a session's scene, with its overrides.
    pub fn of(session: &'a Session) -> Self {
        let options = &session.source().options;
        Self {
            desc: &session.scene().scene,
            variants: &options.variant,
            set: &options.set,
            scripted: session.state().map(|state| &state.scripted),
        }
    }
}

impl Layered<'_> {
    /// Reason why another value of an item in the text would not be seen.
    pub(super) fn held(&self, item: SceneItem, key: &str) -> Option<String> {
        let desc = self.desc;
        let (name, _) = item.named(desc)?;
        let path: Vec<_> = std::iter::once(item.kind()).chain(name).collect();
        let by_script = |key: &&str| {
            let (kind, index, field) = match item {
                SceneItem::Instance(i) => (Kind::Node, i, TRANSFORM.iter().position(|k| k == key)),
                SceneItem::Group(i) => {
                    let field = TRANSFORM.iter().position(|k| k == key);
                    (Kind::Node, desc.instances.len() + i, field)
                }
                SceneItem::Decal(i) => (Kind::Decal, i, index_of(&DECAL, key)),
                SceneItem::Light(i) => (Kind::Light, i, index_of(&LIGHT, key)),
                SceneItem::Camera(i) => (Kind::Camera, i, index_of(&CAMERA, key)),
                SceneItem::Model(_) | SceneItem::Environment => return None,
            };
            self.scripted_field(kind, index, field)
        };
        let by_track = || {
            let (kind, name) = (item.kind(), name?);
            let is_it = |found: &FoundTrack<'_>| {
                let of = &found.name;
                let sets = of.key == key || alike(key).contains(&of.key);
                of.kind == kind && of.name == name && sets
            };
            let found = all_tracks(desc).into_iter().find(is_it)?;
            replaces(found.track).then(|| animated(&format!("{kind}.{name}"), found.at))
        };
        self.on_command_line(&path, key)
            .or_else(|| alike(key).iter().chain([&key]).find_map(by_script))
            .or_else(by_track)
    }

    /// Reason why another value of a material in the text would not be seen.
    pub(super) fn material_held(&self, origin: &MaterialOrigin, key: &str) -> Option<String> {
        let (desc, motion) = (self.desc, &self.desc.motion);
        let (name, _) = origin.named(desc)?;
        let below = origin.below();
        let (kind, scripted, tracks) = match origin {
            MaterialOrigin::Named(i) => {
                let entry = named(&motion.materials, name);
                let tracks = entry.map(|entry| (&entry.value.tracks, &entry.at));
                ("material", (Kind::Material, Some(*i)), tracks)
            }
            MaterialOrigin::Instance(i) => {
                let entry = named(&motion.instances, name);
                let tracks = entry.and_then(|entry| {
                    let material = entry.value.material.as_ref()?;
                    Some((&material.tracks, &entry.at))
                });
                ("instance", (Kind::Override, Some(*i)), tracks)
            }
            MaterialOrigin::File(_, material) => {
                let model = named(&motion.models, name);
                let of = |wanted| named(&model?.value.materials, Some(wanted));
                let entry = of(material).or_else(|| of("*"));
                let tracks = entry.map(|entry| (&entry.value.tracks, &entry.at));
                let all = file_materials(desc);
                let index = name.and_then(|model| {
                    let is_it = |m: &FileMaterial<'_>| m.model == model && m.material == material;
                    all.iter().position(is_it)
                });
                ("model", (Kind::FileMaterial, index), tracks)
            }
        };
        let path: Vec<_> = (std::iter::once(kind).chain(name))
            .chain(below.iter().copied())
            .collect();
        let by_script = || {
            let (kind, index) = scripted;
            self.scripted_field(kind, index?, index_of(&MATERIAL, key))
        };
        let by_track = || {
            let (tracks, at) = tracks?;
            track_of(tracks, &MATERIAL, key)?;
            Some(animated(&path.join("."), at))
        };
        self.on_command_line(&path, key)
            .or_else(by_script)
            .or_else(by_track)
    }

    /// Reason why tracks of a camera in the text would not be seen.
    pub(super) fn set_elsewhere(&self, camera: usize, key: &str) -> Option<String> {
        let name = self.desc.cameras.get(camera)?.name.as_str();
        let by_script = self.scripted_field(Kind::Camera, camera, index_of(&CAMERA, key));
        by_script.or_else(|| self.on_command_line(&["motion", "camera", name], key))
    }

    fn scripted_field(&self, kind: Kind, index: usize, field: Option<usize>) -> Option<String> {
        let is_set = self.scripted?.has(kind, index, field?);
        is_set.then(|| "the script sets it in this frame; change it there".to_owned())
    }

    /// Reason why the command line sets a key of a table.
    pub(super) fn on_command_line(&self, table: &[&str], key: &str) -> Option<String> {
        let path = [table, &[key]].concat().join(".");
        let sets = |value: &&String| {
            let known = value.split('=').next().unwrap_or_default();
            let known = known.replace([' ', '"', '\''], "");
            known == path || path.starts_with(&format!("{known}."))
        };
        let value = self.set.iter().find(sets)?;
        Some(format!("`--set {value}` of the command line sets it"))
    }
}
