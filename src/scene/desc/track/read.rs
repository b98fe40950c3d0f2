//! Readers of tracks, their keys and helpers.

use std::marker::PhantomData;

use glam::Vec3;

use super::*;
use crate::declared::{Described, TypeDoc};
use crate::range::{ABOVE_0, ANY, Range};
use crate::syntax::{Content, Node};
use crate::table::{Section, Table, color::Color, value::Scale, value::Value};
use crate::{
    diagnostic::{Diagnostic, Span},
    number::{Field, Form, Lanes},
};

/// Reads the tracks of all `fields`.
pub fn tracks<T>(t: &mut Table, fields: &[Field<T>]) -> Tracks {
    let read = |field: &Field<T>| {
        let track = match field.form {
            Form::Number => track::<f32>(t, field.key, field.range),
            Form::Pair => track::<[f32; 2]>(t, field.key, field.range),
            Form::Color => track::<Color>(t, field.key, field.range),
            Form::Triple | Form::Vector => track::<Vec3>(t, field.key, field.range),
        };
        if !field.what.is_empty() {
            t.explain(field.key, || field.track_words() + ".");
        }
        track
    };
    let all: Vec<_> = fields.iter().map(read).collect();
    let written = all.into_iter().enumerate();
    written
        .filter_map(|(field, track)| Some((field, track?)))
        .collect()
}

/// Type of the values of a track: one number, two or three.
pub trait Lane: Value + Lanes {
    /// Whether the value may be a position.
    const IS_VECTOR: bool;
    /// Comments and headings of the tables of a track, of a key and of `oscillate`.
    const TABLES: [(&'static TypeDoc, &'static str); 3];
}

/// Implements [`Lane`]: whether the value may be a position; then for its tracks, their keys and their swings the type
/// with the comments, and how the table is written.
macro_rules! lane {
    ($type:ty, $vector:literal, $($doc:ident $heading:literal),*) => {
        impl Lane for $type {
            const IS_VECTOR: bool = $vector;
            const TABLES: [(&'static TypeDoc, &'static str); 3] = [$(($doc::DOC, $heading)),*];
        }
    };
}

lane!(Vec3, true,
    TrackDesc "eye = { … }",
    KeyDesc "keys = [{ at_s = …, value = […] }, …]",
    OscillateDesc "oscillate = { amplitude = […], … }");
lane!(Color, false,
    ColorTrackDesc "base_color = { … }",
    ColorKeyDesc "keys = [{ at_s = …, value = \"#rrggbb\" or […] }, …]",
    ColorOscillateDesc "oscillate = { amplitude = […], … }");
lane!([f32; 2], false,
    PairTrackDesc "uv_scale = { … }",
    PairKeyDesc "keys = [{ at_s = …, value = […, …] }, …]",
    PairOscillateDesc "oscillate = { amplitude = […, …], … }");
lane!(f32, false,
    NumberTrackDesc "roughness = { … }",
    NumberKeyDesc "keys = [{ at_s = …, value = … }, …]",
    NumberOscillateDesc "oscillate = { amplitude = …, … }");
lane!(Scale, false,
    ScaleTrackDesc "scale = { … }",
    ScaleKeyDesc "keys = [{ at_s = …, value = … or […] }, …]",
    ScaleOscillateDesc "oscillate = { amplitude = … or […], … }");

/// Implements [`Lanes`] for a type with three numbers.
macro_rules! three_lanes {
    ($($type:ident),*) => {$(
        impl Lanes for $type {
            fn lanes(self) -> Vec3 {
                self.0
            }
            fn from_lanes(lanes: Vec3) -> Self {
                Self(lanes)
            }
        }
    )*};
}
three_lanes!(Scale, Color);

/// A track, a key of one or its `oscillate`, whose values are of type `L`.
struct Of<T, L>(T, PhantomData<L>);

/// The track under `key`; the values of its keys must lie in `range`.
pub fn track<L: Lane>(t: &mut Table, key: &'static str, range: Range) -> Option<TrackDesc> {
    let Of(track, _) = t.table::<Of<TrackDesc, L>>(key)?;
    for point in &track.keys {
        let lanes = point.value.to_array();
        let wrong = lanes.into_iter().find(|x| !range.contains(f64::from(*x)));
        if let Some(x) = wrong {
            let message = format!("`value` of `{key}` must be {}, not {x}", range.words());
            t.report
                .push(Diagnostic::new("key-range", point.at.clone(), message));
        }
    }
    Some(track)
}

/// The track of `shown`.
pub fn shown(t: &mut Table) -> Option<TrackDesc> {
    let ShownTrackDesc(track) = t.table("shown")?;
    Some(track)
}

impl Section for ShownTrackDesc {
    const HEADING: &'static str = "shown = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(true, &[&["keys"]]);
        let points: Vec<ShownKeyDesc> = t.list("keys");
        let track = TrackDesc {
            keys: points.into_iter().map(|ShownKeyDesc(key)| key).collect(),
            curve: CurveKind::Step,
            loop_s: t.find("loop_s", ABOVE_0),
            ..TrackDesc::default()
        };
        check_keys(t, &track);
        Some(Self(track))
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        let keys = match value.get_ref() {
            Content::Boolean(true) => {
                return Some(format!(
                    "leave `{key}` out: without it the object is always shown"
                ));
            }
            Content::Boolean(false) => "[{ at_s = 0, value = false }]",
            _ => "[{ at_s = 0, value = false }, { at_s = 2, value = true }]",
        };
        Some(format!("write `{key} = {{ keys = {keys} }}`"))
    }
}

impl Section for ShownKeyDesc {
    const HEADING: &'static str = "keys = [{ at_s = …, value = true or false }, …]";

    fn read(t: &mut Table) -> Option<Self> {
        let at_s = t.need("at_s", ANY);
        let value: Option<bool> = t.need("value", ANY);
        let at: Span = t.start();
        Some(Self(KeyDesc {
            at_s: at_s?,
            value: Vec3::splat(f32::from(u8::from(value?))),
            ease: Ease::None,
            handle_in: None,
            handle_out: None,
            at,
        }))
    }
}

impl<L: Lane> Described for Of<TrackDesc, L> {
    const DOC: &'static TypeDoc = L::TABLES[0].0;
}

impl<L: Lane> Section for Of<TrackDesc, L> {
    const ALSO: &'static [&'static TypeDoc] = &[TrackDesc::DOC];
    const HEADING: &'static str = L::TABLES[0].1;

    fn read(t: &mut Table) -> Option<Self> {
        if L::IS_VECTOR {
            t.one_of(false, &[&["keys"], &["follow"]]);
            t.one_of(true, &[&["keys", "follow", "orbit", "rate", "oscillate"]]);
        } else {
            t.one_of(true, &[&["keys", "rate", "oscillate"]]);
        }
        let points: Vec<Of<KeyDesc, L>> = t.list("keys");
        let keys: Vec<_> = points.into_iter().map(|Of(key, _)| key).collect();
        let track = TrackDesc {
            curve: t.get("curve", ANY, CurveKind::default()),
            ease: t.get("ease", ANY, Ease::default()),
            loop_s: t.find("loop_s", ABOVE_0),
            constant_speed: t.get("constant_speed", ANY, false),
            follow: if L::IS_VECTOR {
                t.table("follow")
            } else {
                None
            },
            orbit: if L::IS_VECTOR { t.table("orbit") } else { None },
            rate: t.find::<L>("rate", ANY).map(Lanes::lanes),
            oscillate: t
                .table::<Of<OscillateDesc, L>>("oscillate")
                .map(|Of(swing, _)| swing),
            keys,
        };
        check_keys(t, &track);
        warn_if_idle(t, &track);
        Some(Self(track, PhantomData))
    }

    fn instead(key: &str, _: &Node) -> Option<String> {
        let keys = "keys = [{ at_s = 0, value = … }, { at_s = 2, value = … }]";
        Some(format!(
            "write `{key} = {{ {keys} }}`; a value that does not change stands outside of `[motion]`"
        ))
    }
}

fn check_keys(t: &mut Table, track: &TrackDesc) {
    for key in t.needing("keys", &["curve", "ease", "loop_s", "constant_speed"]) {
        let message = format!("`{key}` needs `keys` to interpolate, and there are none");
        t.refuse("no-keys", key, &message, "write `keys`, or remove it");
    }
    if !t.has("keys") || !t.clean() {
        return;
    }
    let Some(last) = track.keys.last() else {
        let help = "write `keys = [{ at_s = 0, value = … }, { at_s = 2, value = … }]`";
        t.refuse("no-keys", "keys", "`keys` must have at least one key", help);
        return;
    };
    for pair in track.keys.windows(2) {
        if pair[1].at_s <= pair[0].at_s {
            let message = format!(
                "`at_s` must be later than that of the previous key, which is {}",
                pair[0].at_s
            );
            let error = Diagnostic::new("key-order", pair[1].at.clone(), message);
            let error = error.help("write the keys in the order of time, each `at_s` once");
            t.report
                .push(error.related(pair[0].at.clone(), "the previous key is here"));
        }
    }
    let run = last.at_s - track.keys[0].at_s;
    if track.loop_s.is_some_and(|l| l <= run) {
        let message =
            format!("`loop_s` must be more than the {run} s from the first key to the last");
        let help = "the path returns to the first key in the time after the last one";
        t.refuse("key-order", "loop_s", &message, help);
    }
    if let Some(key) = track.keys.iter().find(|key| key.ease != Ease::None)
        && track.constant_speed
    {
        let message = "`ease` of a key cannot be combined with `constant_speed`";
        let help = "remove it, or write `ease` beside `keys`: that eases the whole path";
        t.report
            .push(Diagnostic::new("no-ease", key.at.clone(), message).help(help));
    }
    let bent = |key: &&KeyDesc| key.handle_in.is_some() || key.handle_out.is_some();
    if let Some(key) = track.keys.iter().find(bent)
        && track.curve != CurveKind::Bezier
    {
        let message = "`handle_in` and `handle_out` need `curve = \"bezier\"`";
        let help = "write `curve = \"bezier\"` beside `keys`, or remove them";
        t.report
            .push(Diagnostic::new("no-handles", key.at.clone(), message).help(help));
    }
}

/// Warns about a track that changes nothing, as it has keys of one value alone.
fn warn_if_idle(t: &mut Table, track: &TrackDesc) {
    let is_moved = track.follow.is_some() || track.orbit.is_some() || track.oscillate.is_some();
    let is_bent = |key: &KeyDesc| key.handle_in.is_some() || key.handle_out.is_some();
    let (message, help, key) = match (track.keys.as_slice(), track.rate) {
        _ if is_moved => return,
        ([_], None) => (
            "one key holds its value at all times, before it too",
            "add another, as in `{ at_s = 0, value = … }` with the value at the start, or write the value outside of `[motion]`",
            "keys",
        ),
        ([first, rest @ ..], None)
            if rest
                .iter()
                .all(|key| key.value == first.value && !is_bent(key))
                && !is_bent(first) =>
        {
            (
                "all keys have the same value, so nothing changes",
                "write another value in one of them, or write the value outside of `[motion]`",
                "keys",
            )
        }
        _ => return,
    };
    t.warn("ignored-key", key, message, help);
}

impl<L: Lane> Described for Of<KeyDesc, L> {
    const DOC: &'static TypeDoc = L::TABLES[1].0;
}

impl<L: Lane> Section for Of<KeyDesc, L> {
    const ALSO: &'static [&'static TypeDoc] = &[KeyDesc::DOC];
    const HEADING: &'static str = L::TABLES[1].1;

    fn read(t: &mut Table) -> Option<Self> {
        let at_s = t.need("at_s", ANY);
        let value: Option<L> = t.need("value", ANY);
        let ease = t.get("ease", ANY, Ease::default());
        let handle_in: Option<L> = t.find("handle_in", ANY);
        let handle_out: Option<L> = t.find("handle_out", ANY);
        let at: Span = t.start();
        let key = KeyDesc {
            at_s: at_s?,
            value: value?.lanes(),
            ease,
            handle_in: handle_in.map(Lanes::lanes),
            handle_out: handle_out.map(Lanes::lanes),
            at,
        };
        Some(Self(key, PhantomData))
    }
}

impl<L: Lane> Described for Of<OscillateDesc, L> {
    const DOC: &'static TypeDoc = L::TABLES[2].0;
}

impl<L: Lane> Section for Of<OscillateDesc, L> {
    const ALSO: &'static [&'static TypeDoc] = &[OscillateDesc::DOC];
    const HEADING: &'static str = L::TABLES[2].1;

    fn read(t: &mut Table) -> Option<Self> {
        let amplitude: Option<L> = t.need("amplitude", ANY);
        let period_s = t.need("period_s", ABOVE_0);
        let phase = t.get("phase", ANY, 0.0);
        let swing = OscillateDesc {
            amplitude: amplitude?.lanes(),
            period_s: period_s?,
            phase,
        };
        Some(Self(swing, PhantomData))
    }
}
