//! Keys of tracks, changed in the text: moved, added and deleted; and camera flights written as keys.

use glam::Vec3;
use serde::Deserialize;

use super::{
    Change, Inspected, Layered, changed,
    places::{Place, Subject, places},
    splice::{Value, list, replace},
    tracks::{FoundTrack, TrackName, all_tracks},
    tree::numbers,
};
use reflet_scene::{
    desc::{SceneDesc, TrackDesc},
    motion::key_value,
    number::Form,
    range::LIMIT,
    syntax::{Content, Node, SyntaxTree},
};

/// Times of the keys of a track.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyTrack {
    /// The track.
    pub track: TrackName,
    /// Time of each key, seconds, increasing.
    pub at_s: Vec<f64>,
}

/// Change of the keys of a track; pages send it as JSON, such as `{ "move": [2, 1.5] }`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum KeyChange {
    /// Moves the key of this index to a time, seconds.
    Move(usize, f64),
    /// Deletes the key of this index.
    Delete(usize),
    /// Adds a key at a time, seconds, with the value that the track has there.
    Add(f64),
}

/// A change of a key of a track.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyEdit {
    /// The track.
    pub track: TrackName,
    /// The change.
    pub change: KeyChange,
}

/// Position and target of a camera at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlightPoint {
    /// Time, seconds.
    pub at_s: f64,
    /// Position, meters.
    pub eye: Vec3,
    /// Point that the camera looks at, meters.
    pub target: Vec3,
}

/// Most tracks that are listed.
const MOST: usize = 256;
/// Shortest time between two keys, seconds.
const APART_S: f64 = 1e-3;

/// Tracks that have keys, with the times of these.
pub fn key_tracks(desc: &SceneDesc) -> Vec<KeyTrack> {
    let all = all_tracks(desc).into_iter();
    let keyed = all.filter(|found| !found.track.keys.is_empty());
    let listed = keyed.map(|found| KeyTrack {
        track: found.name,
        at_s: (found.track.keys.iter())
            .map(|key| super::exact(key.at_s))
            .collect(),
    });
    listed.take(MOST).collect()
}

/// Tracks of the selected item where it has tracks with keys, else of a camera.
pub fn shown_tracks<'t>(
    tracks: &'t [KeyTrack],
    selected: Option<&Inspected>,
    camera: Option<&str>,
) -> Vec<&'t KeyTrack> {
    let of = |(kind, name): (&str, &str)| -> Vec<_> {
        let is_own = |known: &&KeyTrack| known.track.kind == kind && known.track.name == name;
        tracks.iter().filter(is_own).collect()
    };
    let named = selected.and_then(|own| Some((own.item.kind(), own.name.as_deref()?)));
    let own = named.map(of).filter(|tracks| !tracks.is_empty());
    own.unwrap_or_else(|| camera.map_or_else(Vec::new, |name| of(("camera", name))))
}

/// Change of the text that contains the keys of a track.
///
/// # Errors
/// Sentence with the reason why it cannot be written.
pub fn change_keys(scene: &Layered<'_>, edit: &KeyEdit) -> Result<Change, String> {
    let TrackName { kind, name, key } = &edit.track;
    let mut all = all_tracks(scene.desc).into_iter();
    let found = all.find(|found| found.name == edit.track);
    let FoundTrack { track, form, .. } = found.ok_or("the track is not there any more")?;
    if let Some(why) = scene.on_command_line(&["motion", kind, name], key) {
        return Err(why);
    }
    let below = [*kind, name.as_str(), key];
    let subject = motion(&below, "TrackDesc");
    let place = places(scene.desc, scene.variants, &subject, "keys")?;
    let text = &place.source.text;
    let node = place.node("keys");
    let items = node.and_then(|node| match node.get_ref() {
        Content::Array(items) if text[node.span().start..].starts_with('[') => Some(items),
        _ => None,
    });
    let is_list = |items: &&Vec<Node>| {
        items
            .iter()
            .all(|item| text[item.span().start..].starts_with('{'))
    };
    let items = items
        .filter(is_list)
        .ok_or("its keys are not written as a list")?;
    if items.len() != track.keys.len() {
        return Err("its keys are not there any more".to_owned());
    }
    let after = match edit.change {
        KeyChange::Move(index, to_s) => moved(text, items, track, index, to_s),
        KeyChange::Delete(index) => deleted(text, items, index),
        KeyChange::Add(at_s) => added(text, items, track, form, at_s),
    }?;
    Ok(changed(&place, after))
}

/// A table of `[motion]`.
fn motion<'a>(below: &'a [&'a str], section: &'static str) -> Subject<'a> {
    Subject {
        kind: "motion",
        section,
        name: None,
        at: None,
        below,
    }
}

/// The text with a key at another time, between its neighbors'.
fn moved(
    text: &str,
    items: &[Node],
    track: &TrackDesc,
    index: usize,
    to_s: f64,
) -> Result<String, String> {
    let time = |index: usize| track.keys.get(index).map(|key| super::exact(key.at_s));
    let least = index.checked_sub(1).and_then(time).map(|s| s + APART_S);
    // The loop ends after the last key.
    let ends = track
        .loop_s
        .map(|s| super::exact(s) + time(0).unwrap_or_default());
    let most = time(index + 1).or(ends).map(|s| s - APART_S);
    let to_s = to_s
        .max(least.unwrap_or(f64::MIN))
        .min(most.unwrap_or(f64::MAX));
    let node = items
        .get(index)
        .and_then(|item| item.get_ref().as_table()?.get("at_s"));
    let node = node.ok_or("the key is not there any more")?;
    replace(text, node, &Value::Numbers(vec![to_s]))
}

/// The text without a key.
fn deleted(text: &str, items: &[Node], index: usize) -> Result<String, String> {
    let item = items.get(index).ok_or("the key is not there any more")?;
    if items.len() == 1 {
        return Err("a track has at least one key; remove the track in the text".to_owned());
    }
    let range = match items.get(index + 1) {
        Some(next) => item.span().start..next.span().start,
        None => items[index - 1].span().end..item.span().end,
    };
    let mut out = text.to_owned();
    out.replace_range(range, "");
    Ok(out)
}

/// The text with one more key, whose value is the track's at its time.
fn added(
    text: &str,
    items: &[Node],
    track: &TrackDesc,
    form: Form,
    at_s: f64,
) -> Result<String, String> {
    let is_taken = |key: &reflet_scene::desc::KeyDesc| (f64::from(key.at_s) - at_s).abs() < APART_S;
    if track.keys.iter().any(is_taken) {
        return Err("there is a key at this time".to_owned());
    }
    let starts = track.keys.first().map_or(0.0, |key| super::exact(key.at_s));
    let ends = track.loop_s.map(|s| starts.min(at_s) + super::exact(s));
    let last = track.keys.last().map_or(0.0, |key| super::exact(key.at_s));
    if !(at_s.abs() <= LIMIT && ends.is_none_or(|ends| at_s.max(last) < ends)) {
        return Err(format!("a key of this track cannot stand at {at_s} s"));
    }
    // The first key tells how many numbers to write: a scale may be one or three.
    let first = items
        .first()
        .and_then(|item| item.get_ref().as_table()?.get("value"));
    let count = first.and_then(numbers).map_or(3, |numbers| numbers.len());
    let form = if count == 1 { Form::Number } else { form };
    let value = super::numbers_of(form, key_value(track, at_s));
    let key = format!("{{ at_s = {}, value = {} }}", list(&[at_s]), list(&value));
    let after = track.keys.iter().position(|key| f64::from(key.at_s) > at_s);
    let mut out = text.to_owned();
    let indent = |item: &Node| {
        let start = item.span().start;
        let line = &text[text[..start].rfind('\n').map_or(0, |end| end + 1)..start];
        line.trim().is_empty().then(|| line.to_owned())
    };
    match (after.and_then(|index| items.get(index)), items.last()) {
        (Some(next), _) => {
            let gap = indent(next).map_or(" ".to_owned(), |indent| format!("\n{indent}"));
            out.insert_str(next.span().start, &format!("{key},{gap}"));
        }
        (None, Some(last)) => {
            let gap = indent(last).map_or(" ".to_owned(), |indent| format!("\n{indent}"));
            out.insert_str(last.span().end, &format!(",{gap}{key}"));
        }
        (None, None) => return Err("its keys are not there any more".to_owned()),
    }
    Ok(out)
}

/// Change of the text that gives a camera a recorded flight: tracks of `eye` and `target` in place of its own.
///
/// # Errors
/// Sentence with the reason why it cannot be written.
pub fn change_flight(
    scene: &Layered<'_>,
    camera: &str,
    points: &[FlightPoint],
) -> Result<Change, String> {
    let desc = scene.desc;
    let index = desc.cameras.iter().position(|entry| entry.name == camera);
    let index = index.ok_or_else(|| format!("camera {camera} is not one of the scene text"))?;
    if desc.parents.of_camera(index).is_some() {
        return Err(format!("camera {camera} has a `parent`, and flies with it"));
    }
    if points.is_empty() {
        return Err("the flight is empty".to_owned());
    }
    let below = ["camera", camera];
    let subject = motion(&below, "CameraMotionDesc");
    let mut change: Option<(Change, Place)> = None;
    let of_eye: fn(&FlightPoint) -> Vec3 = |point| point.eye;
    let of_target: fn(&FlightPoint) -> Vec3 = |point| point.target;
    for (key, value) in [("eye", of_eye), ("target", of_target)] {
        if let Some(why) = scene.set_elsewhere(index, key) {
            return Err(why);
        }
        let track = Value::Toml(track_text(points, value));
        change = Some(match change {
            Some((known, place)) => {
                let after = place.put_into(&known.after, key, &track)?;
                (Change { after, ..known }, place)
            }
            None => {
                let place = places(desc, scene.variants, &subject, key)?;
                let after = place.put(key, &track)?;
                (changed(&place, after), place)
            }
        });
    }
    let (change, _) = change.ok_or("the flight is empty")?;
    let tree = SyntaxTree::parse(&change.after);
    match tree.errors().first() {
        Some(error) => Err(error.message.clone()),
        None => Ok(change),
    }
}

/// A track of points as TOML: one key a line.
fn track_text(points: &[FlightPoint], value: fn(&FlightPoint) -> Vec3) -> String {
    let key = |point: &FlightPoint| {
        let value = super::numbers_of(Form::Vector, value(point));
        format!(
            "  {{ at_s = {}, value = {} }},\n",
            list(&[point.at_s]),
            list(&value)
        )
    };
    let keys: String = points.iter().map(key).collect();
    format!("{{ keys = [\n{keys}], curve = \"centripetal\" }}")
}

/// The points of a flight without which it would differ by more than `most_m` from the straight lines between the
/// others (Douglas and Peucker, "Algorithms for the reduction of the number of points required to represent a digitized
/// line or its caricature", Cartographica 10(2), 1973; distances are taken at equal times).
pub fn reduced(points: &[FlightPoint], most_m: f32) -> Vec<FlightPoint> {
    let Some(last) = points.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[last]) = (true, true);
    let mut waiting = vec![(0, last)];
    while let Some((from, to)) = waiting.pop() {
        let (a, b) = (points[from], points[to]);
        let off = |index: &usize| {
            let point = points[*index];
            let share = ((point.at_s - a.at_s) / (b.at_s - a.at_s).max(1e-9)) as f32;
            let eye = a.eye.lerp(b.eye, share).distance(point.eye);
            eye.max(a.target.lerp(b.target, share).distance(point.target))
        };
        let far = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b)));
        if let Some(far) = far.filter(|far| off(far) > most_m) {
            kept[far] = true;
            waiting.extend([(from, far), (far, to)]);
        }
    }
    let points = points.iter().zip(kept);
    points
        .filter(|(_, kept)| *kept)
        .map(|(point, _)| *point)
        .collect()
}
