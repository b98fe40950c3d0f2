//! Tracks of a scene, each with its name and the table that has it.

use reflet_scene::{
    desc::{
        CAMERA, DecalMotionDesc, Entry, InstanceMotionDesc, LIGHT, MATERIAL, SceneDesc, TrackDesc,
        Tracks,
    },
    diagnostic::Span,
    motion::DECAL,
    number::{Field, Form},
};

/// A track with keys: `[motion.KIND.NAME]` and the key in it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct TrackName {
    /// Kind of the thing: `camera`, `instance`, `group`, `decal`, `light` or `material`.
    pub kind: &'static str,
    /// Name of the thing.
    pub name: String,
    /// Key of the track, such as `eye`.
    pub key: &'static str,
}

/// A track in a table of `[motion]`.
#[derive(Debug)]
pub struct FoundTrack<'d> {
    /// Its thing and key.
    pub name: TrackName,
    /// Place of the table.
    pub at: &'d Span,
    /// The track.
    pub track: &'d TrackDesc,
    /// Form of its values.
    pub form: Form,
}

impl<'d> FoundTrack<'d> {
    fn new<T>(
        kind: &'static str,
        entry: &'d Entry<T>,
        key: &'static str,
        track: &'d TrackDesc,
        form: Form,
    ) -> Self {
        let name = entry.name.clone();
        Self {
            name: TrackName { kind, name, key },
            at: &entry.at,
            track,
            form,
        }
    }
}

/// Tracks that place an instance, a group or a decal.
fn placing<'d, T>(
    kind: &'static str,
    entry: &'d Entry<T>,
    moved: &'d InstanceMotionDesc,
) -> impl Iterator<Item = FoundTrack<'d>> {
    let parts = [
        ("translation", &moved.translation),
        ("rotation_deg", &moved.rotation_deg),
        ("scale", &moved.scale),
    ];
    parts.into_iter().filter_map(move |(key, track)| {
        let track = track.as_ref()?;
        Some(FoundTrack::new(kind, entry, key, track, Form::Vector))
    })
}

/// Tracks of the fields of a table.
fn fields<'d, T, F>(
    kind: &'static str,
    entry: &'d Entry<T>,
    tracks: &'d Tracks,
    table: &'static [Field<F>],
) -> impl Iterator<Item = FoundTrack<'d>> {
    tracks.iter().map(move |(field, track)| {
        let field = &table[*field];
        FoundTrack::new(kind, entry, field.key, track, field.form)
    })
}

/// Tracks of a scene.
pub fn all_tracks(desc: &SceneDesc) -> Vec<FoundTrack<'_>> {
    let motion = &desc.motion;
    let mut all = Vec::new();
    for entry in &motion.cameras {
        all.extend(fields("camera", entry, &entry.value.tracks, &CAMERA));
    }
    for (kind, list) in [("instance", &motion.instances), ("group", &motion.groups)] {
        let placed = list.iter();
        all.extend(placed.flat_map(|entry| placing(kind, entry, &entry.value)));
    }
    for entry in &motion.decals {
        let DecalMotionDesc { place, tracks } = &entry.value;
        all.extend(placing("decal", entry, place));
        all.extend(fields("decal", entry, tracks, &DECAL));
    }
    for entry in &motion.lights {
        all.extend(fields("light", entry, &entry.value.tracks, &LIGHT));
    }
    for entry in &motion.materials {
        all.extend(fields("material", entry, &entry.value.tracks, &MATERIAL));
    }
    all
}
